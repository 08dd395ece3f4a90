// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/toss/toss_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include "geometry/parallel.hpp"

namespace aussois {
namespace {

constexpr double kGridMu = 0.0025, kGridRestitution = 0.0125;
constexpr int kAtOnce = 32;  // tosses between two looks at their sum

// A compass search: strides of the grid are halved where no neighbour is better.
struct FitStage {
  int substeps, first_stride, last_stride;
};
// Of the 347 tosses, steps per row are worth: 1: 14.9 % and 16.9 degrees, 3: 13.8 and 16.2, 10: 13.7
// and 16.2; a point costs 2.8, 5.1 and 13.9 s.
constexpr FitStage kFitStages[] = {{1, 8, 4}, {3, 2, 1}};

using Point = std::pair<int, int>;  // of the grid

TossWorld world_at(TossWorld world, Point p) {
  world.law.mu = kGridMu * p.first;
  world.law.restitution = kGridRestitution * p.second;
  return world;
}

// Mean way of the centres of the faces [m]; an edge for a toss that was not rolled out to its end.
double way_off(const TossRun& run) {
  return run.failure.empty() ? run.errors.position + kTossEdge / 2 * run.errors.rotation : kTossEdge;
}

// (TOSS-5) of points of the grid.
class MeanError {
 public:
  // `start` is the place of the first point, but for its number.
  MeanError(const FitPlace& start, int threads, const TossKeep& keep)
      : place_(start), threads_(threads), keep_(keep), order_(start.tosses.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t(0));
  }

  // The mean over all tosses if it is less than `bound`, else infinite, as soon as that is certain.
  double operator()(Point p, double bound) {
    const TossWorld world = world_at(place_.start, p);
    if (world.law.mu < 0 || world.law.restitution < 0 || world.law.restitution > 1) return kInf;
    if (const auto [at, fresh] = tried_.emplace(p, kInf); !fresh) return at->second;
    place_.number = points();
    place_.mu = p.first, place_.restitution = p.second;
    place_.bound = bound;
    std::optional<FitPoint> point = read_point(keep_, place_);
    known_ += point.has_value();
    if (!point) {
      point = roll_out_at(world, bound);
      write_point(keep_, place_, *point);
    }
    steps_ += point->steps;
    add(point->audit, audit_);
    if (point->error < kInf)
      std::ranges::stable_sort(order_, std::ranges::greater(), [&](std::size_t k) { return point->each[k]; });
    return tried_[p] = point->error;
  }

  int points() const { return int(tried_.size()); }
  int known() const { return known_; }
  std::int64_t steps() const { return steps_; }
  const RunAudit& audit() const { return audit_; }

 private:
  FitPoint roll_out_at(const TossWorld& world, double bound) const {
    const double most = bound * double(order_.size());
    FitPoint out{.each = std::vector<double>(order_.size(), 0.0)};
    double sum = 0;
    for (std::size_t first = 0; first < order_.size(); first += kAtOnce) {
      const std::span<const std::size_t> batch =
          std::span(order_).subspan(first, std::min(std::size_t(kAtOnce), order_.size() - first));
      std::vector<TossRun> runs(batch.size());
      parallel_for(int(batch.size()), threads_,
                   [&](int i) { runs[i] = roll_out(place_.tosses[batch[i]], world, place_.watch, {}); });
      for (std::size_t i = 0; i < batch.size(); ++i) {
        out.each[batch[i]] = way_off(runs[i]);
        sum += out.each[batch[i]];
        out.steps += runs[i].steps;
        add(runs[i].audit, out.audit);
      }
      if (!(sum < most)) return out;
    }
    out.error = sum / double(order_.size());
    return out;
  }

  FitPlace place_{};
  int threads_ = 1;
  const TossKeep& keep_;
  std::vector<std::size_t> order_;  // of tosses: those first that were worst at the best point so far
  std::map<Point, double> tried_{};
  int known_ = 0;
  std::int64_t steps_ = 0;
  RunAudit audit_{};
};

}  // namespace

double board_of(const std::vector<Toss>& tosses) {
  std::vector<double> heights;
  for (const Toss& toss : tosses) heights.push_back(toss.pose.back().p.z() - kTossEdge / 2);
  std::ranges::nth_element(heights, heights.begin() + std::ptrdiff_t(heights.size() / 2));
  return heights[heights.size() / 2];
}

TossFit fit(const std::vector<Toss>& tosses, const TossWorld& world, int threads,
            const std::function<bool(const TossFit&)>& seen, const TossKeep& keep, const WatchFlags& watch) {
  Point best{int(std::lround(world.law.mu / kGridMu)),
             int(std::lround(world.law.restitution / kGridRestitution))};
  TossFit out;
  bool go_on = true;
  FitPlace start{.tosses = tosses, .start = world, .watch = watch};
  start.watch.dump = {};
  for (const FitStage& stage : kFitStages) {
    ++start.stage;
    start.start.substeps = std::min(stage.substeps, world.substeps);
    MeanError error_at(start, threads, keep);
    const TossFit before = out;
    const auto better = [&](Point p, double bound) {
      const int tried = error_at.points();
      const double error = error_at(p, bound);
      if (error < bound) out.error = error, best = p;
      out.mu = kGridMu * best.first;
      out.restitution = kGridRestitution * best.second;
      out.points = before.points + error_at.points();
      out.steps = before.steps + error_at.steps();
      out.known = before.known + error_at.known();
      out.audit = before.audit;
      add(error_at.audit(), out.audit);
      if (error_at.points() > tried) go_on = seen(out);
    };
    if (go_on) better(best, kInf);
    for (int stride = stage.first_stride; stride >= stage.last_stride && go_on;) {
      const Point from = best;
      for (const auto& [dm, de] : std::array<Point, 4>{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}})
        if (go_on) better({from.first + stride * dm, from.second + stride * de}, out.error);
      if (best == from) stride /= 2;
    }
  }
  return out;
}

}  // namespace aussois
