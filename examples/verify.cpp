// SPDX-License-Identifier: Apache-2.0
// Does it hold? Cases of the verification list, each figure beside its bound and where the bound comes from.
//
// Theory   doc/theory/verification_list.md
// Run      verify --list
//          verify --case A4.unequal_balls --json out/verified.json
// Expect   "holds" in every row; the exit code says whether
//
// verify --all runs the whole list. Interrupt it when you like: the next call of the same program with the
// same -o goes on.
#include <algorithm>
#include <cstdio>
#include <mutex>
#include <numeric>
#include <sstream>
#include <thread>

#include "examples/common/driver.hpp"
#include "examples/common/progress.hpp"
#include "examples/verification/list.hpp"
#include "geometry/check.hpp"
#include "geometry/parallel.hpp"
#include "io/atomic_file.hpp"
#include "io/build_info.hpp"
#include "io/text.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::string group{}, case_name{};
  bool all = false, list = false, quiet = false;
  int threads = 1;
  std::filesystem::path out = "out", json{}, page{};
};

/// `word` is the letter of the case's group, or a name as --case takes it.
bool is_asked(const VerificationCase& c, const std::string& word) {
  return word.size() == 1 ? c.name[0] == word[0] : is_named(c, word);
}

/// The cases that the user asks for, in the order of the list; nothing measured yet.
List asked_for(const Arguments& a) {
  std::vector<std::string> words;
  std::istringstream groups(a.group);
  for (std::string word; std::getline(groups, word, ',');) words.push_back(word);
  if (!a.case_name.empty()) words.push_back(a.case_name);
  for (const std::string& word : words)
    require(std::ranges::any_of(verification_cases(), [&](const auto& c) { return is_asked(c, word); }),
            "the list has no group or case '" + word + "'; verify --list names them");
  List out;
  for (const VerificationCase& c : verification_cases())
    if (a.all || words.empty() ||
        std::ranges::any_of(words, [&](const auto& word) { return is_asked(c, word); }))
      out.push_back({&c, {}});
  return out;
}

/// Measures what the folder does not know, slow cases first. How many it knew.
int measure_all(List& list, const Arguments& a) {
  const std::uint64_t program = program_digest();
  std::vector<std::size_t> order(list.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(
      order, [&](std::size_t i, std::size_t k) { return list[i].asked->slow > list[k].asked->slow; });
  std::mutex mutex;  // of progress and counts
  int done = 0, known = 0;
  Progress progress("verify", double(list.size()), Progress::style_of_stderr(a.quiet));
  parallel_for(int(list.size()), a.threads, [&](int i) {
    if (interrupted()) return;
    Entry& entry = list[order[std::size_t(i)]];
    const std::filesystem::path file = a.out / "verify" / (file_stem(*entry.asked) + ".json");
    entry.measured = read_measured(file, *entry.asked, program);
    const bool was_known = entry.measured.has_value();
    if (!was_known) {
      entry.measured = measure(*entry.asked);
      if (entry.measured->missing.empty())
        write_whole_file(file, to_json(*entry.asked, *entry.measured, program));
    }
    const std::lock_guard lock(mutex);
    known += was_known;
    progress.at(++done, entry.asked->name + " " + entry.asked->setting);
  });
  return known;
}

ExitCode run(const Arguments& a) {
  require(a.list || a.all || !a.group.empty() || !a.case_name.empty(),
          "give --group A, --case NAME, --all or --list");
  require(a.page.empty() || a.all, "--page goes with --all: a page has all rows");
  List list = asked_for(a);
  if (a.list) {
    std::printf("%s", to_text(list).c_str());
    return ExitCode::ok;
  }
  if (!a.page.empty() && !has_list(read_file(a.page)))  // refused before anything runs
    throw std::runtime_error(a.page.string() + ": no lines between which --page could write");
  std::filesystem::create_directories(a.out / "verify");
  if (a.json.has_parent_path()) std::filesystem::create_directories(a.json.parent_path());

  const int known = measure_all(list, a);
  if (interrupted()) return ExitCode::interrupted;
  if (!a.quiet) std::printf("%s", to_text(list).c_str());
  if (!a.json.empty()) write_whole_file(a.json, to_json(list));
  if (known > 0) std::printf("%d of %zu cases were in %s already\n", known, list.size(), a.out.c_str());
  const int failed = count(list, Verdict::fail), skipped = count(list, Verdict::skipped);
  std::printf("verify: %d rows hold, %d fail, %d are skipped%s\n", count(list, Verdict::pass), failed,
              skipped, skipped > 0 ? " without the shared data (AUSSOIS_DATA_DIR)" : "");
  if (!a.page.empty() && failed + skipped == 0)
    write_whole_file(a.page, with_list(read_file(a.page), to_markdown(list)));
  else if (!a.page.empty())
    std::fprintf(stderr, "verify: %s is left as it is: not all rows hold\n", a.page.c_str());
  return failed == 0 ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  a.threads = int(std::max(1u, std::thread::hardware_concurrency()));
  Cli cli("verify",
          "Runs cases of the verification list: each figure, its bound, where the bound comes from, and "
          "whether it holds.");
  cli.group("list");
  cli.flag("--list", a.list, "print the rows, those asked for or all, and run nothing");
  cli.flag("--all", a.all, "every case");
  cli.option("--group", a.group,
             "groups by their letters, or cases, between commas: A, or A,B3,D1.first_flip");
  cli.option("--case", a.case_name,
             "the case, or the case of the row, with this name; A5.paper: in all its settings");
  cli.group("output");
  cli.option("-o,--out", a.out,
             "folder of the results, made if missing; cases that it has of this program are not run again");
  cli.option("--json", a.json, "also write the rows to this file");
  cli.option("--page", a.page,
             "also write the rows into this page if all hold: doc/theory/verification_list.md");
  cli.option("--threads", a.threads, "cases at the same time; the results do not depend on it", "", {1, 256});
  cli.flag("--quiet", a.quiet, "no progress and no rows; the count stays");
  cli.example("verify --group A -o verified", "all impacts without friction");
  cli.example("verify --all -o verified --page doc/theory/verification_list.md",
              "the whole list, and its page");
  return run_driver(cli, argc, argv, [&] { return run(a); });
}
