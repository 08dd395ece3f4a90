// SPDX-License-Identifier: Apache-2.0
#include "examples/common/many_tasks.hpp"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <string_view>
#include <thread>

namespace aussois {

int ManyTasks::all_cores() {
  return int(std::max(1u, std::thread::hardware_concurrency()));
}

void add_options(Cli& cli, ManyTasks& options, const std::string& tasks, const std::string& numbers) {
  cli.group("output");
  cli.option("-o,--out", options.out,
             "folder for the results, created if missing; " + tasks +
                 " that this program has already saved there are not repeated");
  cli.option("--json", options.json, "also write " + numbers + " to this JSON file");
  cli.option("--threads", options.threads,
             "number of " + tasks + " to run at the same time; does not affect the results", "", kThreads);
  cli.flag("--quiet", options.quiet, "omit progress and the table; still print warnings and the counts");
}

void make_folders(const ManyTasks& options) {
  for (const std::filesystem::path& folder : {options.json.parent_path(), options.out})
    if (!folder.empty()) std::filesystem::create_directories(folder);
}

void tell_known(int known, std::size_t all, const std::filesystem::path& folder, const std::string& results) {
  if (known > 0)
    std::printf("%d of %zu %swere already in %s\n", known, all,
                (results.empty() ? "" : results + " ").c_str(), folder.c_str());
}

std::pair<int, int> shard_of(const std::string& text) {
  int k = 0, n = 0, end = 0;
  const bool whole =
      std::sscanf(text.c_str(), "%d/%d%n", &k, &n, &end) == 2 && std::size_t(end) == text.size();
  require(whole && n >= 1 && k >= 1 && k <= n, "--shard " + text + " must be k/n with 1 <= k <= n");
  return {k, n};
}

std::string file_stem(std::string words) {
  constexpr std::string_view kKept = "_.-";
  std::ranges::replace_if(
      words,
      [&](char x) { return !std::isalnum(static_cast<unsigned char>(x)) && kKept.find(x) == kKept.npos; },
      '_');
  return words;
}

}  // namespace aussois
