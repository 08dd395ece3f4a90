// SPDX-License-Identifier: Apache-2.0
// The recorded assemblies that tests replay: "peg_in_socket", our own, and the shared ones.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "tests/support/shared_pair.hpp"

namespace aussois {

/// Nothing without AUSSOIS_DATA_DIR, unless the pair is our own.
inline std::optional<AssemblyInput> recorded_pair(const std::string& name) {
  if (name == "peg_in_socket") {
    const std::filesystem::path own = std::filesystem::path(AUSSOIS_SOURCE_DIR) / "examples/data";
    return read_assembly_files(own / "socket.obj", own / "peg.obj", own / "peg_out.csv", 1e-3);
  }
  return shared_pair(name);
}

}  // namespace aussois
