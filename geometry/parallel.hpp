// SPDX-License-Identifier: Apache-2.0
// The only place that starts threads. Chunks are fixed by the caller, so results do not depend on `threads`.
#pragma once

#include <functional>

namespace aussois {

/// Calls f(i) for i in [0, n), on at most `threads` threads. Each call must write only to its own place i;
/// combine the places in index order. An exception thrown by f is rethrown here.
void parallel_for(int n, int threads, const std::function<void(int)>& f);

}  // namespace aussois
