// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace aussois {

/// Runs `gnuplot SCRIPT` in `folder`; false if it is not installed or fails.
bool run_gnuplot(const std::filesystem::path& folder, const std::string& script);

}  // namespace aussois
