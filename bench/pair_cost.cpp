// SPDX-License-Identifier: Apache-2.0
#include "bench/pair_cost.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <optional>

#include "examples/common/driver.hpp"
#ifdef AUSSOIS_BENCH_FCL
#include "bench/peer_fcl.hpp"
#endif
#ifdef AUSSOIS_BENCH_CGAL
#include "bench/peer_cgal.hpp"
#endif

namespace aussois {
namespace {

// Of each part, in moving radii. Two of them fit the tightest pair of the shared data (4.2e-4), and planes
// count as planes up to a thousandth of it.
constexpr double kDilation = 2e-4;

double thread_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * double(t.tv_sec) + 1e-6 * double(t.tv_nsec);
}

// The fastest of `repeats`, but no further one after two seconds: long calls need no repeats.
double fastest_ms(int repeats, const std::function<void()>& work) {
  const double start = thread_ms();
  double best = kInf;
  for (int i = 0; i < repeats && (i == 0 || thread_ms() - start < 2000); ++i) {
    const double begin = thread_ms();
    work();
    best = std::min(best, thread_ms() - begin);
  }
  return best;
}

double median(std::vector<double> values) {
  if (values.empty()) return kNotMeasured;
  std::ranges::sort(values);
  return values[values.size() / 2];
}

std::vector<SE3> spread_evenly(const std::vector<SE3>& path, int count) {
  std::vector<SE3> poses;
  const int n = std::min(count, int(path.size()));
  for (int i = 0; i < n; ++i)
    poses.push_back(path[n == 1 ? path.size() / 2 : std::size_t(i) * (path.size() - 1) / std::size_t(n - 1)]);
  return poses;
}

struct Peers {
#ifdef AUSSOIS_BENCH_FCL
  std::optional<FclPair> fcl{};
#endif
#ifdef AUSSOIS_BENCH_CGAL
  std::optional<CgalPair> cgal{};
#endif
};

struct Measurement {
  const LmdShape &moving, &fixed;
  const Peers& peers;
  const std::vector<SE3>& poses;
  int repeats;
  double radius;
};

QueryCost measure_query(const Measurement& m, double threshold, const SearchTests& tests, bool with_peers) {
  std::vector<double> ms, contacts, node_pairs, leaf_pairs, exact_tests, ms_cgal, cgal_pairs;
  const double reach = threshold * m.radius, dilations = m.moving.radius + m.fixed.radius;
  const LmdOptions options{.threshold = std::max(0.0, reach - dilations), .tests = tests};
  for (std::size_t i = 0; i < m.poses.size(); ++i) {
    LmdStatistics count;
    ContactSet found;
    ms.push_back(fastest_ms(m.repeats, [&] {
      found = find_contacts({&m.moving, m.poses[i], 1}, {&m.fixed, {}, 0}, options, &count);
    }));
    contacts.push_back(double(found.points.size()));
    node_pairs.push_back(double(count.node_pairs));
    leaf_pairs.push_back(double(count.leaf_pairs));
    exact_tests.push_back(double(count.exact_tests));
#ifdef AUSSOIS_BENCH_CGAL
    if (with_peers && (i % 3 == 1 || m.poses.size() == 1)) {
      long pairs = 0;
      ms_cgal.push_back(fastest_ms(1, [&] { pairs = m.peers.cgal->count_near(m.poses[i], reach); }));
      cgal_pairs.push_back(double(pairs));
    }
#else
    (void)with_peers;
#endif
  }
  return {.threshold = threshold,
          .ms = median(ms),
          .contacts = median(contacts),
          .node_pairs = median(node_pairs),
          .leaf_pairs = median(leaf_pairs),
          .exact_tests = median(exact_tests),
          .ms_cgal = median(ms_cgal),
          .cgal_pairs = median(cgal_pairs)};
}

std::vector<AblationCost> ablation(const Measurement& m, double threshold) {
  std::vector<AblationCost> table;
  for (const auto& [without, tests] : {std::pair<const char*, SearchTests>{"nothing", {}},
                                       {"cones", {.cones = false}},
                                       {"directions", {.directions = false}},
                                       {"boxes", {.boxes = false}},
                                       {"quick", {.quick = false}},
                                       {"instructions", {.instructions = false}}}) {
    table.push_back({without, measure_query(m, threshold, tests, false)});
    if (table.back().cost.contacts != table.front().cost.contacts)
      throw NumericalFailure(std::string("contacts change without the test of ") + without);
  }
  return table;
}

}  // namespace

const QueryCost* query_at(const PairCost& pair, double threshold) {
  for (const QueryCost& q : pair.queries)
    if (q.threshold == threshold) return &q;
  return nullptr;
}

PairCost measure_pair(const AssemblyInput& input, const CostOptions& options,
                      const std::function<bool(double)>& step) {
  const SimplicialComplex &moving_mesh = input.moving.complex, &fixed_mesh = input.fixed.complex;
  const Box& box = input.moving.report.box;
  PairCost out{.name = input.name,
               .triangles = double(moving_mesh.triangles.size() + fixed_mesh.triangles.size()),
               .radius = radius_about(moving_mesh, (box.lo + box.hi) / 2)};
  const double stages = 2 + double(options.thresholds.size()) + (options.ablation > 0 ? 1 : 0);
  double done = 0;
  const auto stage_done = [&] { return step(++done / stages); };

  LmdShape moving, fixed;
  out.ms_build = fastest_ms(options.repeats, [&] {
    moving = prepare({.complex = moving_mesh, .radius = kDilation * out.radius});
    fixed = prepare({.complex = fixed_mesh, .radius = kDilation * out.radius});
  });
  for (const LmdShape* s : {&moving, &fixed})
    out.leaves += double(s->vertices.size() + s->edges.size() + s->faces.size());
  out.bytes_per_triangle = double(search_bytes(moving) + search_bytes(fixed)) / out.triangles;
  Peers peers;
#ifdef AUSSOIS_BENCH_FCL
  out.ms_build_fcl = fastest_ms(options.repeats, [&] { peers.fcl.emplace(moving_mesh, fixed_mesh); });
#endif
#ifdef AUSSOIS_BENCH_CGAL
  peers.cgal.emplace(moving_mesh, fixed_mesh);
#endif
  if (!stage_done()) return out;

  const std::vector<SE3> poses = spread_evenly(input.poses, options.poses);
#ifdef AUSSOIS_BENCH_FCL
  std::vector<double> ms;
  for (const SE3& g : poses) ms.push_back(fastest_ms(options.repeats, [&] { peers.fcl->distance(g, {}); }));
  out.ms_fcl = median(ms);
#endif
  if (!stage_done()) return out;

  const Measurement all{moving, fixed, peers, poses, options.repeats, out.radius};
  for (const double threshold : options.thresholds) {
    out.queries.push_back(measure_query(all, threshold, {}, true));
    if (!stage_done()) return out;
  }
  if (options.ablation > 0) {
    const std::vector<SE3> few = spread_evenly(input.poses, std::min(3, options.poses));
    out.ablation = ablation({moving, fixed, peers, few, options.repeats, out.radius}, options.ablation);
    stage_done();
  }
  return out;
}

}  // namespace aussois
