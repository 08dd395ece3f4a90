// SPDX-License-Identifier: Apache-2.0
#include "lmd/mitre.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "geometry/settings.hpp"
#include "lmd/largest_split.hpp"

namespace aussois {
namespace {

constexpr std::size_t kMostPlanes = 40;  // the search for a split takes O(d^4) and more
constexpr double kLongestMitre = 1e5;    // depths
constexpr double kLongSplit =
    2;  // a split that goes farther than this times the one point is the worse choice:
        // of the facets of a thread, planes that differ by 1e-3 meet 40 depths away

// Points that coincide are one.
Mitre joined(const std::vector<SplitPoint>& triples, std::span<const VertexPlane> planes, double meet) {
  Mitre out;
  std::vector<int> point_of(triples.size());
  for (std::size_t t = 0; t < triples.size(); ++t) {
    const Vec3& x = triples[t].x;
    const auto same = std::ranges::find_if(out.points, [&](const Vec3& p) { return (p - x).norm() <= meet; });
    point_of[t] = int(same - out.points.begin());
    if (same == out.points.end()) out.points.push_back(x);
    for (int k : triples[t].planes) {
      const VertexPlane& plane = planes[k];
      out.deviation = std::max(out.deviation, std::abs(plane.normal.dot(x) - plane.offset));
    }
  }
  // Around plane i its triangles follow each other from the polygon's side (i - 1, i) to (i, i + 1).
  const int d = int(planes.size());
  for (int i = 0; i < d; ++i) {
    std::vector<int> path;
    for (int at = (i + d - 1) % d; at != (i + 1) % d;) {
      for (std::size_t t = 0; t < triples.size(); ++t) {
        const auto& [a, b, c] = triples[t].planes;  // ascending, so counter-clockwise
        const int after = a == i && c == at ? b : b == i && a == at ? c : c == i && b == at ? a : -1;
        if (after < 0) continue;
        if (path.empty() || path.back() != point_of[t]) path.push_back(point_of[t]);
        at = after;
        break;
      }
    }
    out.of_plane.push_back(std::move(path));
  }
  return out;
}

}  // namespace

void describe(SettingVisitor& visit, MitreOptions& o) {
  visit.begin("MitreOptions");
  visit.number({"meet", "distance of planes from a point at which they meet", "-", positive_range()}, o.meet);
  visit.number({"deviation", "distance of planes from a point at which they may be taken to meet", "-",
                not_negative_range()},
               o.deviation);
  visit.toggle({"split", "let a vertex become several"}, o.split);
}

std::optional<Mitre> mitre(std::span<const VertexPlane> planes, const MitreOptions& options) {
  check_ranges(options);
  const auto at_one_point = [&](const MeetingPoint& p) {
    return Mitre{.points = {p.x},
                 .of_plane = std::vector<std::vector<int>>(planes.size(), {0}),
                 .deviation = p.residual};
  };
  const MeetingPoint exact = meeting_point(planes, options.meet);
  if (exact.residual <= options.meet) return at_one_point(exact);
  const MeetingPoint near = meeting_point(planes, options.deviation);
  const bool near_enough = near.residual <= options.deviation;
  if (options.split && planes.size() > 3 && planes.size() <= kMostPlanes)
    if (const auto split =
            largest_split(planes, options.meet, near_enough ? kLongSplit * near.x.norm() : kLongestMitre))
      return joined(*split, planes, options.meet);
  return near_enough ? std::optional(at_one_point(near)) : std::nullopt;
}

Vec3 least_mitre(std::span<const VertexPlane> planes) {
  MatX n(Eigen::Index(planes.size()), 3);
  VecX wanted(n.rows());
  for (std::size_t k = 0; k < planes.size(); ++k) {
    n.row(Eigen::Index(k)) = planes[k].normal;
    wanted[Eigen::Index(k)] = planes[k].offset;
  }
  Eigen::JacobiSVD<MatX> svd(n, Eigen::ComputeThinU | Eigen::ComputeThinV);
  svd.setThreshold(0.1);  // by choice: no vertex moves farther than some ten times the planes
  return svd.solve(wanted);
}

}  // namespace aussois
