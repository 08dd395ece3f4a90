// SPDX-License-Identifier: Apache-2.0
// What a contact query costs, against looking at all pairs of simplices and against a peer's distance of the
// same meshes, in one run: read the ratios, not the times.
//
// Run      bench_contacts
//          bench_contacts --data DIR --pair own_tslot
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <functional>

#include "examples/assembly/assembly_input.hpp"
#include "examples/common/driver.hpp"
#include "geometry/check.hpp"
#include "io/csv_table.hpp"
#include "lmd/certificate.hpp"
#include "lmd/find_contacts.hpp"
#ifdef AUSSOIS_BENCH_FCL
#include "bench/peer_fcl.hpp"
#endif

using namespace aussois;

namespace {

struct Arguments {
  std::filesystem::path data{};
  std::string pair{};
  double scale = 1e-3;
  int poses = 9, repeats = 3;
  CommonOptions common{};
};

double milliseconds(int repeats, const std::function<void()>& work) {  // the fastest of several
  double best = kInf;
  for (int i = 0; i < repeats; ++i) {
    const std::clock_t begin = std::clock();
    work();
    best = std::min(best, 1e3 * double(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  return best;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

ExitCode bench(const Arguments& a) {
  require(a.pair.empty() == a.data.empty(), "--data and --pair belong together");
  const AssemblyInput input =
      a.pair.empty() ? builtin_assembly("bolt_nut") : read_assembly_pair(a.data, a.pair, a.scale);
  const LmdShape moving = prepare({.complex = input.moving.complex, .radius = 1e-6});
  const LmdShape fixed = prepare({.complex = input.fixed.complex, .radius = 1e-6});
#ifdef AUSSOIS_BENCH_FCL
  const FclPair fcl(input.moving.complex, input.fixed.complex);
#endif
  const double size =
      radius_about(input.moving.complex, (input.moving.report.box.lo + input.moving.report.box.hi) / 2);
  std::filesystem::create_directories(a.common.out);
  CsvTable csv(a.common.out / "bench_contacts.csv",
               {"threshold", "contacts", "ms_query", "ms_certificate", "ms_exhaustive", "ms_fcl"});
  std::printf("%s: %zu + %zu triangles, medians over %d poses\n", input.name.c_str(),
              input.fixed.complex.triangles.size(), input.moving.complex.triangles.size(), a.poses);
  std::printf("%12s %9s %10s %10s %12s %10s %10s %12s\n", "threshold", "contacts", "query ms", "cert. ms",
              "all pairs ms", "FCL ms", "query/FCL", "all/query");
  for (const double relative : {1e-3, 1e-2, 5e-2}) {
    std::vector<double> contacts, query, certificate, exhaustive, peer;
    for (int i = 0; i < a.poses; ++i) {
      const std::size_t at =
          std::size_t(i) * (input.poses.size() - 1) / std::size_t(std::max(1, a.poses - 1));
      const PosedShape pm{&moving, input.poses[at], 1}, pf{&fixed, {}, 0};
      const LmdOptions options{.threshold = relative * size, .threads = a.common.threads};
      ContactSet found;
      query.push_back(milliseconds(a.repeats, [&] { found = find_contacts(pm, pf, options); }));
      contacts.push_back(double(found.points.size()));
      certificate.push_back(milliseconds(a.repeats, [&] {
        certify({&moving, {}, {.g = input.poses[at], .v = {0, 0, relative * size}}}, {&fixed, {}, {}}, 1e-2,
                {.required = 1e-9, .wanted = 2e-6, .threads = a.common.threads});
      }));
      if (i == a.poses / 2)  // slow, and the same for any pose
        exhaustive.push_back(milliseconds(1, [&] { found = find_contacts_exhaustive(pm, pf, options); }));
#ifdef AUSSOIS_BENCH_FCL
      peer.push_back(milliseconds(a.repeats, [&] { fcl.distance(input.poses[at], {}); }));
#else
      peer.push_back(std::nan(""));
#endif
    }
    const double q = median(query), f = median(peer), e = median(exhaustive);
    std::printf("%9.3g %%R %9.0f %10.3f %10.3f %12.1f %10.3f %10.2f %12.0f\n", 100 * relative,
                median(contacts), q, median(certificate), e, f, q / f, e / q);
    csv.add({relative * size, median(contacts), q, median(certificate), e, f});
  }
  csv.close();
  return ExitCode::ok;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli("bench_contacts",
          "Times contact queries and certificates along an assembly path, with ratios to a peer.");
  cli.group("scene");
  cli.input("--data", a.data, "folder with meshes/ and assembly/; without it our own bolt and nut");
  cli.option("--pair", a.pair, "name of a pair in assembly/pairs.csv");
  cli.option("--scale", a.scale, "metres per unit of the files", "m", {1e-12, 1e12});
  cli.option("--poses", a.poses, "of the path, spread evenly", "", {1, 1000});
  cli.option("--repeats", a.repeats, "per pose; the fastest counts", "", {1, 1000});
  cli.common(a.common);
  cli.example("bench_contacts -o out", "our own bolt and nut");
  cli.example("bench_contacts --data DIR --pair own_tslot", "a pair of the data folder");
  return run_driver(cli, argc, argv, [&] { return bench(a); });
}
