// SPDX-License-Identifier: Apache-2.0
#include "reduction/reduce.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <tuple>

#include <Eigen/Geometry>

#include "geometry/check.hpp"
#include "geometry/frame.hpp"

namespace aussois {
namespace {

constexpr double kIsotropic = 1e-6;  // relative difference of principal moments below which no direction is
                                     // principal: above it, rounding turns the axis by less than 1e-9
constexpr double kSamePlace = 1e-9;  // fraction of the extent within which points are one point
constexpr double kFlat = 1e-9;       // thickness over extent below which a hull is a segment

Vec3 mid_point(const ContactPoint& c) {
  return 0.5 * (c.x_a + c.x_b);
}

void check(const ContactSet& found) {
  for (std::size_t i = 0; i < found.points.size(); ++i) {
    const ContactPoint& c = found.points[i];
    const std::string name = "contact " + std::to_string(i);
    require(c.x_a.allFinite() && c.x_b.allFinite() && std::isfinite(c.gap),
            name + ": points and gap must be finite");
    require(std::abs(c.normal.norm() - 1) <= 1e-6, name + ": the normal must have unit length (within 1e-6)");
  }
}

// Pairs one after the other, the deepest of a pair first; then whatever tells two contacts apart, so that the
// order does not depend on how the set is stored.
bool before(const ContactPoint& c, const ContactPoint& d) {
  const Vec3 p = mid_point(c), q = mid_point(d);
  const auto key = [](const ContactPoint& x, const Vec3& at) {
    return std::make_tuple(x.a.body, x.b.body, x.gap, x.a.dim, x.a.simplex, x.b.dim, x.b.simplex, at.x(),
                           at.y(), at.z());
  };
  return key(c, p) < key(d, q);
}

// Clusters as lists of indices, the deepest first (RED-2).
std::vector<std::vector<int>> clusters_of(const ContactSet& found, double angle) {
  const std::vector<ContactPoint>& c = found.points;
  std::vector<int> order(c.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int i, int j) { return before(c[std::size_t(i)], c[std::size_t(j)]); });

  const double chord = 2 * std::sin(angle / 2);
  std::vector<std::vector<int>> clusters;
  for (auto begin = order.begin(); begin != order.end();) {  // one body pair after the other
    const ContactPoint& first = c[std::size_t(*begin)];
    const auto end = std::find_if(begin, order.end(), [&](int i) {
      const ContactPoint& x = c[std::size_t(i)];
      return x.a.body != first.a.body || x.b.body != first.b.body;
    });
    for (auto seed = begin; seed != end;) {
      const Vec3 normal = c[std::size_t(*seed)].normal;
      const auto rest = std::stable_partition(
          seed, end, [&](int i) { return (c[std::size_t(i)].normal - normal).norm() <= chord; });
      clusters.emplace_back(seed, rest);
      seed = rest;
    }
    begin = end;
  }
  return clusters;
}

// The members seen along their mean normal, about their mean point, first coordinate along the principal
// direction.
std::vector<Vec2> in_plane(const ContactSet& found, std::span<const int> members) {
  Vec3 n = Vec3::Zero(), mean = Vec3::Zero();
  for (const int i : members) {
    n += found.points[std::size_t(i)].normal;  // never zero: all are within a right angle of the seed
    mean += mid_point(found.points[std::size_t(i)]);
  }
  n.normalize();
  mean /= double(members.size());

  const Mat3 frame = frame_of(n);
  std::vector<Vec2> x;
  Mat2 S = Mat2::Zero();
  for (const int i : members) {
    const Vec3 d = mid_point(found.points[std::size_t(i)]) - mean;
    x.push_back((frame.transpose() * d).tail<2>());
    S += x.back() * x.back().transpose();
  }
  const double difference = 0.5 * (S(0, 0) - S(1, 1));
  if (std::hypot(difference, S(0, 1)) <= 0.5 * kIsotropic * S.trace()) return x;

  const double turn = 0.5 * std::atan2(S(0, 1), difference);
  const Eigen::Rotation2D<double> to_principal(-turn);
  for (Vec2& point : x) point = to_principal * point;
  return x;
}

double extent(const std::vector<Vec2>& x) {
  Vec2 lo = x.front(), hi = x.front();
  for (const Vec2& point : x) {
    lo = lo.cwiseMin(point);
    hi = hi.cwiseMax(point);
  }
  return (hi - lo).maxCoeff();
}

// E(d, e) of (RED-3): the farthest along d; of those tied, the farthest along e; of those at one place, the
// first.
std::size_t extreme(const std::vector<Vec2>& x, const Vec2& d, const Vec2& e, double tie, double same_place) {
  double far = -kInf, side = -kInf;
  for (const Vec2& point : x) far = std::max(far, d.dot(point));
  const auto tied = [&](const Vec2& point) { return d.dot(point) >= far - tie; };
  for (const Vec2& point : x)
    if (tied(point)) side = std::max(side, e.dot(point));
  const auto first = std::find_if(x.begin(), x.end(),
                                  [&](const Vec2& p) { return tied(p) && e.dot(p) >= side - same_place; });
  return std::size_t(first - x.begin());
}

std::vector<int> extremes(const ContactSet& found, std::span<const int> members,
                          const ReductionOptions& options) {
  if (int(members.size()) <= options.min_per_cluster) return {members.begin(), members.end()};
  const std::vector<Vec2> x = in_plane(found, members);
  const double size = extent(x);
  const Vec2 u = Vec2::UnitX(), v = Vec2::UnitY();
  std::vector<int> result;
  for (const auto& [d, e] : {std::pair{u, v}, std::pair<Vec2, Vec2>{v, -u}, std::pair<Vec2, Vec2>{-u, -v},
                             std::pair<Vec2, Vec2>{-v, u}})
    result.push_back(members[extreme(x, d, e, options.tie * size, kSamePlace * size)]);
  return result;
}

// The deepest, the extremes of all and those of the closed layer (RED-4).
std::vector<int> kept_of(const ContactSet& found, const std::vector<int>& cluster,
                         const ReductionOptions& options) {
  const double closed = found.points[std::size_t(cluster.front())].gap + options.layer;
  const auto open = std::find_if(cluster.begin(), cluster.end(),
                                 [&](int i) { return found.points[std::size_t(i)].gap > closed; });
  std::vector<int> kept = extremes(found, cluster, options);
  if (open != cluster.end()) {
    const std::vector<int> layer = extremes(found, {cluster.begin(), open}, options);
    kept.insert(kept.end(), layer.begin(), layer.end());
  }
  kept.push_back(cluster.front());
  return kept;
}

// Corners of the convex hull, counter-clockwise, without points on its sides (Andrew's monotone chain).
std::vector<Vec2> hull_of(std::vector<Vec2> x) {
  const auto by_coordinates = [](const Vec2& p, const Vec2& q) {
    return std::make_pair(p.x(), p.y()) < std::make_pair(q.x(), q.y());
  };
  std::sort(x.begin(), x.end(), by_coordinates);
  x.erase(std::unique(x.begin(), x.end()), x.end());
  if (x.size() < 3) return x;

  const auto turns_left = [](const Vec2& a, const Vec2& b, const Vec2& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x()) > 0;
  };
  std::vector<Vec2> hull;
  for (int side = 0; side < 2; ++side) {  // below from left to right, above from right to left
    const std::size_t start = hull.size();
    for (const Vec2& point : x) {
      while (hull.size() >= start + 2 && !turns_left(hull[hull.size() - 2], hull.back(), point))
        hull.pop_back();
      hull.push_back(point);
    }
    hull.pop_back();  // the first of the other side
    std::reverse(x.begin(), x.end());
  }
  return hull;
}

struct Region {
  double area = 0;
  Vec2 centroid = Vec2::Zero();
};
Region region_of(const std::vector<Vec2>& hull) {
  Region region;
  const Vec2 origin = hull.front();
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2 a = hull[i] - origin, b = hull[(i + 1) % hull.size()] - origin;
    const double triangle = 0.5 * (a.x() * b.y() - a.y() * b.x());
    region.area += triangle;
    region.centroid += triangle * (a + b) / 3;
  }
  region.centroid = origin + region.centroid / region.area;
  return region;
}

double support(const std::vector<Vec2>& hull, const Vec2& d) {
  double far = -kInf;
  for (const Vec2& point : hull) far = std::max(far, d.dot(point));
  return far;
}

// (RED-7) for one cluster; `part` is a subset of `all`.
LossReport loss_of(const std::vector<Vec2>& all, const std::vector<Vec2>& part) {
  const double size = extent(all);
  if (!(size > 0)) return {};
  std::vector<Vec2> P = hull_of(all), S = hull_of(part);
  const Region full = region_of(P);
  const bool flat = !(full.area > kFlat * size * size);
  const auto [left, right] =
      std::minmax_element(P.begin(), P.end(), [](const Vec2& p, const Vec2& q) { return p.x() < q.x(); });
  const Vec2 centre =
      flat ? Vec2(0.5 * (*left + *right)) : full.centroid;  // flat ones lie along the first axis

  LossReport loss{.area = flat ? 1 : region_of(S).area / full.area};
  std::vector<Vec2> directions = {Vec2::UnitX(), -Vec2::UnitX()};  // the two that a flat hull needs
  for (std::vector<Vec2>* hull : {&P, &S}) {
    for (Vec2& point : *hull) point -= centre;
    for (std::size_t i = 0; i < hull->size(); ++i) {
      const Vec2 side = (*hull)[(i + 1) % hull->size()] - (*hull)[i];
      directions.push_back(Vec2(side.y(), -side.x()).stableNormalized());
    }
  }
  for (const Vec2& d : directions) {
    const double h_P = support(P, d);
    if (h_P > kFlat * size) loss.margin = std::min(loss.margin, support(S, d) / h_P);
  }
  return loss;
}

}  // namespace

void validate(const ReductionOptions& options) {
  require_field(options.cluster_angle > 0 && options.cluster_angle <= kPi / 2,
                "ReductionOptions::cluster_angle", options.cluster_angle, "lie in (0, pi/2] rad");
  require_field(options.min_per_cluster >= 1, "ReductionOptions::min_per_cluster", options.min_per_cluster,
                "be at least 1");
  require_field(options.tie >= 0 && options.tie <= 0.1, "ReductionOptions::tie", options.tie,
                "lie in [0, 0.1]");
  require_field(options.layer >= 0, "ReductionOptions::layer", options.layer, "be at least 0 m");
}

Selection reduce(const ContactSet& found, const ReductionOptions& options) {
  validate(options);
  check(found);
  const std::vector<std::vector<int>> clusters = clusters_of(found, options.cluster_angle);
  Selection selection;
  selection.cluster.resize(found.points.size());
  selection.cluster_count = int(clusters.size());
  for (std::size_t k = 0; k < clusters.size(); ++k) {
    for (const int i : clusters[k]) selection.cluster[std::size_t(i)] = int(k);
    const std::vector<int> kept =
        options.reducer == Reducer::none ? clusters[k] : kept_of(found, clusters[k], options);
    selection.kept.insert(selection.kept.end(), kept.begin(), kept.end());
  }
  std::sort(selection.kept.begin(), selection.kept.end());
  selection.kept.erase(std::unique(selection.kept.begin(), selection.kept.end()), selection.kept.end());
  return selection;
}

ContactSet select(const ContactSet& found, const std::vector<int>& kept) {
  ContactSet result;
  for (const int i : kept) {
    require(i >= 0 && std::size_t(i) < found.points.size(), "select: index " + std::to_string(i) +
                                                                " must lie in [0, " +
                                                                std::to_string(found.points.size()) + ")");
    result.points.push_back(found.points[std::size_t(i)]);
  }
  return result;
}

LossReport measure_loss(const ContactSet& found, const Selection& selection) {
  require(selection.cluster.size() == found.points.size(),
          "measure_loss: the selection belongs to another set");
  std::vector<std::vector<int>> members(std::size_t(selection.cluster_count));
  for (std::size_t i = 0; i < found.points.size(); ++i)
    members[std::size_t(selection.cluster[i])].push_back(int(i));

  LossReport worst;
  for (const std::vector<int>& cluster : members) {
    const std::vector<Vec2> all = in_plane(found, cluster);
    std::vector<Vec2> part;
    for (std::size_t i = 0; i < cluster.size(); ++i)
      if (std::binary_search(selection.kept.begin(), selection.kept.end(), cluster[i]))
        part.push_back(all[i]);
    const LossReport loss = part.empty() ? LossReport{.margin = -kInf, .area = 0} : loss_of(all, part);
    worst = {.margin = std::min(worst.margin, loss.margin), .area = std::min(worst.area, loss.area)};
  }
  return worst;
}

}  // namespace aussois
