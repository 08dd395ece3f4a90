// SPDX-License-Identifier: Apache-2.0
// Does it hold? Runs cases of the verification list and prints each figure beside its bound and the source of
// the bound.
//
// Theory   doc/theory/verification_list.md
// Run      verify --list
//          verify --case A4.unequal_balls --json out/verified.json
// Expect   "holds" in every row; exit code 0: all rows that ran hold, 1: a row fails, 3: no row ran
//
// verify --all runs the whole list. It can be interrupted at any time: the next call of the same program with
// the same -o continues.
#include <algorithm>
#include <cstdio>
#include <mutex>
#include <numeric>

#include "examples/common/many_tasks.hpp"
#include "examples/common/progress.hpp"
#include "examples/scenes/shared_series.hpp"
#include "examples/studies/verification/list.hpp"
#include "geometry/check.hpp"
#include "geometry/digest.hpp"
#include "geometry/parallel.hpp"
#include "io/atomic_file.hpp"
#include "io/build_info.hpp"
#include "io/text.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::vector<std::string> groups{}, names{};
  bool all = false, list = false;
  std::filesystem::path page{};
  ManyTasks tasks{};
};

/// `word` is the letter of the case's group, or a name as --case takes it.
bool is_asked(const VerificationCase& c, const std::string& word) {
  return word.size() == 1 ? c.name[0] == word[0] : is_named(c, word);
}

/// The cases that the user asks for, in the order of the list; nothing measured yet.
List asked_for(const Arguments& a) {
  std::vector<std::string> words = a.groups;
  words.insert(words.end(), a.names.begin(), a.names.end());
  for (const std::string& word : words)
    require(std::ranges::any_of(verification_cases(), [&](const auto& c) { return is_asked(c, word); }),
            "the list has no group or case '" + word + "'; verify --list shows all");
  List out;
  for (const VerificationCase& c : verification_cases())
    if (a.all || words.empty() ||
        std::ranges::any_of(words, [&](const auto& word) { return is_asked(c, word); }))
      out.push_back({&c, {}});
  return out;
}

/// Measures what the folder does not know, slow cases first. How many it knew.
int measure_all(List& list, const Arguments& a) {
  Digest program;  // and what it reads
  program.add(program_digest());
  program.add(shared_series_digest());
  std::vector<std::size_t> order(list.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(
      order, [&](std::size_t i, std::size_t k) { return list[i].asked->slow > list[k].asked->slow; });
  std::mutex mutex;  // of progress and counts
  int done = 0, known = 0;
  Progress progress("verify", double(list.size()), Progress::style_of_stderr(a.tasks.quiet));
  parallel_for(int(list.size()), a.tasks.threads, [&](int i) {
    if (interrupted()) return;
    Entry& entry = list[order[i]];
    const std::filesystem::path file = a.tasks.out / "verify" / (stem_of(*entry.asked) + ".json");
    entry.measured = read_measured(file, *entry.asked, program.value);
    const bool was_known = entry.measured.has_value();
    if (!was_known) {
      entry.measured = measure(*entry.asked);
      if (entry.measured->missing.empty()) write_measured(file, *entry.asked, *entry.measured, program.value);
    }
    const std::lock_guard lock(mutex);
    known += was_known;
    progress.at(++done, entry.asked->name + " " + entry.asked->setting);
  });
  return known;
}

/// Rows that hold, fail and are skipped, and what the latter lack.
std::string summary(const List& list) {
  char text[96];
  std::snprintf(text, sizeof text, "verify: %d rows hold, %d fail, %d are skipped\n",
                count(list, Verdict::pass), count(list, Verdict::fail), count(list, Verdict::skipped));
  std::string out;
  for (const auto& [what, rows] : missing(list))
    out += std::to_string(rows) + " rows skipped: " + what + "\n";
  if (const int guards = count_guards(list); guards > 0)
    out +=
        std::to_string(guards) + " of the rows that hold are guards: no worse than when they were written\n";
  return out + text;
}

ExitCode run(const Arguments& a) {
  require(a.list || a.all || !a.groups.empty() || !a.names.empty(),
          "give --group A, --case NAME, --all or --list");
  require(a.page.empty() || a.all, "--page needs --all: a page has all rows");
  List list = asked_for(a);
  if (a.list) {
    std::printf("%s", to_text(list).c_str());
    return ExitCode::ok;
  }
  if (!a.page.empty() && !has_list(read_file(a.page)))  // refused before anything runs
    throw std::runtime_error(a.page.string() + ": no marked section for --page to write");
  make_folders(a.tasks);
  std::filesystem::create_directories(a.tasks.out / "verify");

  const int known = measure_all(list, a);
  if (interrupted()) return ExitCode::interrupted;
  if (!a.tasks.quiet) std::printf("%s", to_text(list).c_str());
  if (!a.tasks.json.empty()) write_whole_file(a.tasks.json, to_json(list));
  tell_known(known, list.size(), a.tasks.out);
  std::printf("%s", summary(list).c_str());
  const int held = count(list, Verdict::pass), failed = count(list, Verdict::fail);
  if (!a.page.empty() && failed + count(list, Verdict::skipped) == 0)
    write_whole_file(a.page, with_list(read_file(a.page), to_markdown(list)));
  else if (!a.page.empty())
    std::fprintf(stderr, "verify: %s is unchanged: not all rows hold\n", a.page.c_str());
  if (failed > 0) return ExitCode::not_accepted;
  return held > 0 ? ExitCode::ok : ExitCode::missing;  // nothing ran: nothing is known to hold
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli("verify",
          "Runs cases of the verification list and prints each figure, its bound, the source of the bound, "
          "and whether it holds. Exit code 0: at least one row ran, and all that ran hold; 1: a row fails; "
          "3: all rows were skipped, because the shared data is missing (AUSSOIS_DATA_DIR).");
  cli.group("list");
  cli.flag("--list", a.list, "list the selected rows, or all, and run nothing");
  cli.flag("--all", a.all, "run every case");
  cli.option("--group", a.groups, "groups, by their letters, or cases to run: A; A B3; A,B3,D1.first_flip");
  cli.option("--case", a.names,
             "cases to run, by their names or those of rows: A4.column; C8 C9; A5.paper, in all its "
             "settings; 'A5.paper (event_driven, 10 starts)'");
  add_options(cli, a.tasks, "cases", "the rows");
  cli.option("--page", a.page,
             "if all rows hold, also write them to this page: doc/theory/verification_list.md");
  cli.example("verify --group A -o verified", "all impacts without friction");
  cli.example("verify --all -o verified --page doc/theory/verification_list.md",
              "the whole list, and its page");
  return run_driver(cli, argc, argv, [&] { return run(a); });
}
