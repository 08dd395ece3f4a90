// SPDX-License-Identifier: Apache-2.0
// What drivers share that do many tasks apart from each other, each of them kept in a file of its own: all
// cores, and nothing is done twice.
#pragma once

#include "examples/common/driver.hpp"

namespace aussois {

struct ManyTasks {
  std::filesystem::path out = "out", json{};
  int threads = all_cores();
  bool quiet = false;
  static int all_cores();
};

/// -o, --json, --threads and --quiet; `tasks` as one calls them, `numbers` that go into the JSON file.
void add_options(Cli& cli, ManyTasks& options, const std::string& tasks, const std::string& numbers);
/// Makes the folder of the results and that of the JSON file.
void make_folders(const ManyTasks& options);
/// Prints a line if results of an earlier call were found in the folder: "3 of 7 levels were already in out".
void tell_known(int known, std::size_t all, const std::filesystem::path& folder,
                const std::string& results = {});

/// --shard "K/N": each N-th task from the K-th on. Throws std::invalid_argument unless 1 <= K <= N.
std::pair<int, int> shard_of(const std::string& text);

/// "A4.unequal_balls", "ball_e05_moreau_jean_theta_0.5": the name of a file, of letters, digits, '_', '.' and
/// '-'; what is none of them in `words` becomes '_'.
std::string file_stem(std::string words);

}  // namespace aussois
