// SPDX-License-Identifier: Apache-2.0
#include "lmd/mitre.hpp"

#include <algorithm>
#include <array>

#include <Eigen/Dense>

namespace aussois {
namespace {

using Triples = std::vector<std::array<int, 3>>;

constexpr int kMostPlanes = 10;        // 1430 ways to split
constexpr double kLongestMitre = 1e3;  // three planes that meet farther away are taken as parallel to a line
constexpr double kReach = 2;  // a split that goes farther than this times the one point is the worse choice:
                              // of the facets of a thread, planes that differ by 1e-3 meet 40 depths away
constexpr double kRank = 1e-9;  // singular values below this are rounding

struct MeetingPoint {
  Vec3 x = Vec3::Zero();
  double residual = kInf;  // largest distance from a plane
};

// The shortest of the points that all planes pass within `tolerance`, or else the one of full rank (ERO-2).
// Directions in which the planes hardly say anything are used only if they are needed.
MeetingPoint meeting_point(std::span<const VertexPlane> planes, double tolerance) {
  MatX n(Eigen::Index(planes.size()), 3);
  VecX wanted(n.rows());
  for (std::size_t k = 0; k < planes.size(); ++k) {
    n.row(Eigen::Index(k)) = planes[k].normal;
    wanted[Eigen::Index(k)] = planes[k].offset;
  }
  const Eigen::JacobiSVD<MatX> svd(n, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const VecX along = svd.matrixU().transpose() * wanted;
  MeetingPoint best;
  for (Eigen::Index r = 0; r < svd.singularValues().size(); ++r) {
    if (svd.singularValues()[r] < kRank) break;
    best.x += along[r] / svd.singularValues()[r] * svd.matrixV().col(r);
    best.residual = (n * best.x - wanted).cwiseAbs().maxCoeff();
    if (best.residual <= tolerance) break;
  }
  return best;
}

// All ways to cut the polygon with corners first, ..., last into triangles.
std::vector<Triples> triangulations(int first, int last) {
  if (last - first < 2) return {{}};
  std::vector<Triples> all;
  for (int middle = first + 1; middle < last; ++middle) {
    const std::vector<Triples> left = triangulations(first, middle), right = triangulations(middle, last);
    for (const Triples& l : left)
      for (const Triples& r : right) {
        Triples both = l;
        both.insert(both.end(), r.begin(), r.end());
        both.push_back({first, middle, last});
        all.push_back(std::move(both));
      }
  }
  return all;
}

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double abc = cross(b - a, c - a), abd = cross(b - a, d - a), cda = cross(d - c, a - c),
               cdb = cross(d - c, b - c);
  return ((abc >= 0 && abd <= 0) || (abc <= 0 && abd >= 0)) &&
         ((cda >= 0 && cdb <= 0) || (cda <= 0 && cdb >= 0));
}

// The border of a plane's part near the vertex: in along the spoke after, over the points, out along its own.
bool is_simple(const std::vector<Vec2>& line) {
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    if (i + 2 < line.size()) {
      const Vec2 a = line[i] - line[i + 1], b = line[i + 2] - line[i + 1];  // folded back?
      if (a.dot(b) > 0 && std::abs(cross(a, b)) <= 1e-9 * a.norm() * b.norm()) return false;
    }
    for (std::size_t j = i + 2; j + 1 < line.size(); ++j)
      if (segments_meet(line[i], line[i + 1], line[j], line[j + 1])) return false;
  }
  return true;
}

struct Split {
  Mitre mitre{};
  double length = 0;  // largest displacement
};

// The points of one way to cut the polygon of planes; points that coincide become one.
Split split_by(const Triples& triples, const std::vector<MeetingPoint>& of_triple, std::size_t plane_count,
               double meet) {
  Split out;
  std::vector<int> point_of(triples.size());
  for (std::size_t t = 0; t < triples.size(); ++t) {
    const Vec3& x = of_triple[t].x;
    const auto same =
        std::ranges::find_if(out.mitre.points, [&](const Vec3& p) { return (p - x).norm() <= meet; });
    point_of[t] = int(same - out.mitre.points.begin());
    if (same == out.mitre.points.end()) out.mitre.points.push_back(x);
    out.length = std::max(out.length, x.norm());
    out.mitre.deviation = std::max(out.mitre.deviation, of_triple[t].residual);
  }
  // Around plane i its triangles follow each other from the polygon's side (i - 1, i) to (i, i + 1).
  const int d = int(plane_count);
  for (int i = 0; i < d; ++i) {
    std::vector<int> path;
    for (int at = (i + d - 1) % d; at != (i + 1) % d;) {
      for (std::size_t t = 0; t < triples.size(); ++t) {
        const auto& [a, b, c] = triples[t];  // ascending, so counter-clockwise
        const int after = a == i && c == at ? b : b == i && a == at ? c : c == i && b == at ? a : -1;
        if (after < 0) continue;
        if (path.empty() || path.back() != point_of[t]) path.push_back(point_of[t]);
        at = after;
        break;
      }
    }
    out.mitre.of_plane.push_back(std::move(path));
  }
  return out;
}

// Six times the volume below the parts of the planes within `reach` of the vertex along the spokes, up to a
// constant; none unless the border of each part is simple.
std::optional<double> volume_below(const Split& split, std::span<const VertexPlane> planes, double reach) {
  double volume = 0;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const VertexPlane &plane = planes[i], &after = planes[(i + 1) % planes.size()];
    const std::vector<int>& path = split.mitre.of_plane[i];
    const Vec3 u = plane.normal.unitOrthogonal(), v = plane.normal.cross(u);
    std::vector<Vec2> line;
    const auto add = [&](const Vec3& x) { line.emplace_back(u.dot(x), v.dot(x)); };
    const auto far = [&](const Vec3& x, const Vec3& spoke) { add(x + (reach - spoke.dot(x)) * spoke); };
    far(split.mitre.points[std::size_t(path.back())], after.spoke);
    for (auto p = path.rbegin(); p != path.rend(); ++p) add(split.mitre.points[std::size_t(*p)]);
    far(split.mitre.points[std::size_t(path.front())], plane.spoke);
    if (path.size() > 1 && !is_simple(line)) return std::nullopt;
    double area = 0;
    for (std::size_t k = 0; k < line.size(); ++k) area += cross(line[k], line[(k + 1) % line.size()]);
    volume += plane.offset * area;
  }
  return volume;
}

// The largest of the solids whose planes all have a simple border (ERO-4).
std::optional<Mitre> split_vertex(std::span<const VertexPlane> planes, double meet) {
  const int d = int(planes.size());
  const auto place = [&](const std::array<int, 3>& t) { return std::size_t((t[0] * d + t[1]) * d + t[2]); };
  std::vector<MeetingPoint> meeting(std::size_t(d * d * d));
  for (int a = 0; a < d; ++a)
    for (int b = a + 1; b < d; ++b)
      for (int c = b + 1; c < d; ++c)
        meeting[place({a, b, c})] = meeting_point(
            std::array{planes[std::size_t(a)], planes[std::size_t(b)], planes[std::size_t(c)]}, 1e-14);
  std::vector<Split> candidates;
  for (const Triples& triples : triangulations(0, d - 1)) {
    std::vector<MeetingPoint> points;
    for (const auto& triple : triples) points.push_back(meeting[place(triple)]);
    const auto far = [&](const MeetingPoint& p) { return p.residual > meet || p.x.norm() > kLongestMitre; };
    if (std::ranges::none_of(points, far))
      candidates.push_back(split_by(triples, points, planes.size(), meet));
  }
  double reach = 10;
  for (const Split& split : candidates) reach = std::max(reach, 10 * split.length);
  std::optional<Mitre> best;
  double most = -kInf;
  for (const Split& split : candidates)
    if (const std::optional<double> volume = volume_below(split, planes, reach); volume && *volume > most) {
      most = *volume;
      best = split.mitre;
    }
  return best;
}

}  // namespace

std::optional<Mitre> mitre(std::span<const VertexPlane> planes, const MitreOptions& options) {
  const auto at_one_point = [&](const MeetingPoint& p) {
    return Mitre{.points = {p.x},
                 .of_plane = std::vector<std::vector<int>>(planes.size(), {0}),
                 .deviation = p.residual};
  };
  const MeetingPoint exact = meeting_point(planes, options.meet);
  if (exact.residual <= options.meet) return at_one_point(exact);
  const MeetingPoint near = meeting_point(planes, options.deviation);
  const bool near_enough = near.residual <= options.deviation;
  if (options.split && planes.size() > 3 && int(planes.size()) <= kMostPlanes)
    if (std::optional<Mitre> split = split_vertex(planes, options.meet)) {
      const auto in_reach = [&](const Vec3& p) { return p.norm() <= kReach * near.x.norm(); };
      if (!near_enough || std::ranges::all_of(split->points, in_reach)) return split;
    }
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
  svd.setThreshold(0.1);  // taste: nothing goes farther than some ten times the way of the planes
  return svd.solve(wanted);
}

}  // namespace aussois
