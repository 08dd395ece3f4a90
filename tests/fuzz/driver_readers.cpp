// SPDX-License-Identifier: Apache-2.0
#include <stdexcept>

#include "examples/drivers/assembly/assembly_input.hpp"
#include "examples/studies/convergence/study_files.hpp"
#include "tests/fuzz/readers.hpp"

namespace aussois {
namespace {

namespace fs = std::filesystem;

// As the folder of a user has it.
void make_pairs(const fs::path& file, Bytes input) {
  fs::create_directories(file.parent_path() / "assembly");
  write_input(file.parent_path() / "assembly" / "pairs.csv", input);
}

void use_pairs(const fs::path& file) {
  try {
    read_assembly_pair(file.parent_path(), "peg", 1e-3);
  } catch (const std::invalid_argument&) {  // no pair of that name
  }
}

void use_study(const fs::path& file) {
  const std::optional<Study> study =
      read_study(file, {.case_name = "ball_e05", .scheme = "moreau_jean theta 0.5 combined"}, 1);
  if (!study) return;
  order_table({*study});
  write_input(file, {});
  if (read_study(file, *study, 1)) throw std::logic_error("an empty file is no study");
}

}  // namespace

std::vector<FuzzedReader> driver_readers() {
  return {{"pairs", ".csv", make_pairs, use_pairs}, {"study", ".json", write_input, use_study}};
}

}  // namespace aussois
