// SPDX-License-Identifier: Apache-2.0
// The recorded assemblies that tests replay: "peg_in_socket", our own, and the shared ones.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

#include "examples/drivers/assembly/assembly_input.hpp"

namespace aussois {

/// Nothing without AUSSOIS_DATA_DIR, unless the pair is our own.
inline std::optional<AssemblyInput> recorded_pair(const std::string& name) {
  if (name == "peg_in_socket") {
    const std::filesystem::path own = std::filesystem::path(AUSSOIS_SOURCE_DIR) / "examples/data";
    return read_assembly_files(own / "socket.obj", own / "peg.obj", own / "peg_out.csv", 1e-3);
  }
  const char* data = std::getenv("AUSSOIS_DATA_DIR");
  if (!data || !*data) return std::nullopt;
  return read_assembly_pair(data, name, 1e-3);
}

}  // namespace aussois
