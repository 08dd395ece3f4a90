// SPDX-License-Identifier: Apache-2.0
// The recorded assemblies of the shared test data.
#pragma once

#include <cstdlib>
#include <optional>
#include <string>

#include "examples/drivers/assembly/assembly_input.hpp"

namespace aussois {

/// Nothing without AUSSOIS_DATA_DIR. Lengths of the files are in millimetres.
inline std::optional<AssemblyInput> shared_pair(const std::string& name) {
  const char* data = std::getenv("AUSSOIS_DATA_DIR");
  if (!data || !*data) return std::nullopt;
  return read_assembly_pair(data, name, 1e-3);
}

}  // namespace aussois
