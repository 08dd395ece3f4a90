// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace aussois {

/// Runs `gnuplot SCRIPT` in `folder`; false if it is not installed or fails.
bool run_gnuplot(const std::filesystem::path& folder, const std::string& script);
/// Tells so on stderr.
void tell_no_picture();

}  // namespace aussois
