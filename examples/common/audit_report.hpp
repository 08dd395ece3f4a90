// SPDX-License-Identifier: Apache-2.0
// What --certify N found, for people and for summaries.
#pragma once

#include "integrators/path_audit.hpp"
#include "io/summary.hpp"

namespace aussois {

/// certify_samples, certify_steps, certify_violations, certify_min_distance [m]; nothing if nothing was
/// asked.
void set_audit(Summary& summary, const PathAudit& audit);

/// Prints one line if samples were asked for. True: no violation.
bool tell(const PathAudit& audit);

}  // namespace aussois
