// SPDX-License-Identifier: Apache-2.0
// Generates friction problems that are rare in public libraries: stacks, arches, piles, chains and mechanisms
// of any size, from a seed. The same seed gives the same bytes.
//
// Theory   doc/theory/problem_families.md (FAM-1) to (FAM-6); the files: doc/fclib_file.md
// Run      generate_friction_problems --family all --sizes 20,100 --count 2 -o out/problems
// Expect   48 files, two per family and size; solve_friction_problem out/problems solves all of them to 1e-8
#include <charconv>
#include <cstdio>

#include "examples/common/driver.hpp"
#include "examples/common/progress.hpp"
#include "examples/studies/families/problem_families.hpp"
#include "geometry/check.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::string family = "all", sizes = "100,300,1000";
  int count = 1;
  std::uint64_t seed = 1;
  std::filesystem::path out = "out";
  bool quiet = false;
};

std::vector<int> sizes_of(const std::string& list) {
  std::vector<int> sizes;
  for (std::size_t at = 0; at <= list.size();) {
    const std::size_t comma = std::min(list.find(',', at), list.size());
    int size = 0;
    const char *begin = list.data() + at, *end = list.data() + comma;
    const auto [stopped, error] = std::from_chars(begin, end, size);
    require(error == std::errc() && stopped == end && size >= 10 && size <= 1000000,
            "--sizes " + list + " must be comma-separated whole numbers in [10, 1000000]");
    sizes.push_back(size);
    at = comma + 1;
  }
  return sizes;
}

ExitCode generate(const Arguments& a) {
  const std::vector<int> sizes = sizes_of(a.sizes);
  std::vector<ProblemFamily> families;
  if (a.family == "all")
    families.assign(problem_families().begin(), problem_families().end());
  else
    families = {family_named(a.family)};
  std::filesystem::create_directories(a.out);

  const double total = double(families.size() * sizes.size()) * a.count;
  int done = 0;
  Progress progress("generate_friction_problems", total, Progress::style_of_stderr(a.quiet));
  for (const ProblemFamily& family : families)
    for (const int size : sizes)
      for (std::uint64_t seed = a.seed; seed < a.seed + std::uint64_t(a.count); ++seed) {
        if (interrupted()) return ExitCode::interrupted;
        const std::string stem = family_file_stem(family, size, seed);
        progress.at(done++, stem);
        write_fclib(a.out / (stem + ".hdf5"), family_file(family, size, seed));
      }
  progress.at(total);
  std::printf("generate_friction_problems: %s in %s\n", counted_noun(done, "file").c_str(), a.out.c_str());
  return ExitCode::ok;
}

std::string what_families_are() {
  std::string text = "Writes one-step friction problems as HDF5 files in FCLIB's layout. Families:";
  for (const ProblemFamily& family : problem_families())
    text += "\n  " + std::string(family.name) + ": " + family.what;
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli("generate_friction_problems", what_families_are());
  std::vector<std::string> names{"all"};
  for (const ProblemFamily& family : problem_families()) names.emplace_back(family.name);
  cli.group("scene");
  cli.choice("--family", a.family, "family of problems to generate", names);
  cli.option("--sizes", a.sizes, "approximate numbers of contacts, comma-separated, each in [10, 1000000]");
  cli.option("--count", a.count, "number of seeds per family and size", "", {1, 1e6});
  cli.option("--seed", a.seed, "first seed");
  cli.group("output");
  cli.option("-o,--out", a.out, "folder for the files FAMILY_nSIZE_sSEED.hdf5, created if missing");
  cli.flag("--quiet", a.quiet, "omit progress");
  cli.example("generate_friction_problems --sizes 100,1000 --count 10 -o problems", "240 problems");
  cli.example("generate_friction_problems --family arch --sizes 10000 --seed 7 -o problems",
              "one large vault");
  return run_driver(cli, argc, argv, [&] { return generate(a); });
}
