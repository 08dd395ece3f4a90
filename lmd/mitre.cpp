// SPDX-License-Identifier: Apache-2.0
#include "lmd/mitre.hpp"

#include <algorithm>
#include <array>

#include <Eigen/Dense>

namespace aussois {
namespace {

using Triples = std::vector<std::array<int, 3>>;

constexpr std::size_t kMostPlanes = 100;  // 160 000 triples of planes
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

// The points of one way to cut the polygon of planes; points that coincide become one.
Mitre split_by(const Triples& triples, const std::vector<MeetingPoint>& of_triple, std::size_t plane_count,
               double meet) {
  Mitre out;
  std::vector<int> point_of(triples.size());
  for (std::size_t t = 0; t < triples.size(); ++t) {
    const Vec3& x = of_triple[t].x;
    const auto same =
        std::ranges::find_if(out.points, [&](const Vec3& p) { return (p - x).norm() <= meet; });
    point_of[t] = int(same - out.points.begin());
    if (same == out.points.end()) out.points.push_back(x);
    out.deviation = std::max(out.deviation, of_triple[t].residual);
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
    out.of_plane.push_back(std::move(path));
  }
  return out;
}

// The border of each plane's part near the vertex is simple.
bool is_embedded(const Mitre& mitre, std::span<const VertexPlane> planes) {
  double reach = 10;
  for (const Vec3& p : mitre.points) reach = std::max(reach, 10 * p.norm());
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const std::vector<int>& path = mitre.of_plane[i];
    if (path.size() < 2) continue;
    const Vec3 u = planes[i].normal.unitOrthogonal(), v = planes[i].normal.cross(u);
    std::vector<Vec2> line;
    const auto add = [&](const Vec3& x) { line.emplace_back(u.dot(x), v.dot(x)); };
    add(mitre.points[std::size_t(path.back())] + reach * planes[(i + 1) % planes.size()].spoke);
    for (auto p = path.rbegin(); p != path.rend(); ++p) add(mitre.points[std::size_t(*p)]);
    add(mitre.points[std::size_t(path.front())] + reach * planes[i].spoke);
    if (!is_simple(line)) return false;
  }
  return true;
}

// Among all ways to cut the polygon of planes into triangles, the one of the largest solid (ERO-4) whose
// vertices are all locally simple: at most one of the three planes has an angle above 180 degrees there. Both are
// sums over triangles and the sides between them, so the best of each part of the polygon is part of the best.
class LargestSplit {
 public:
  LargestSplit(std::span<const VertexPlane> planes, double meet)
      : planes_(planes), d_(int(planes.size())), meet_(meet) {
    const auto d3 = std::size_t(d_ * d_ * d_);
    meeting_.resize(d3);
    for (int a = 0; a < d_; ++a)
      for (int b = a + 1; b < d_; ++b)
        for (int c = b + 1; c < d_; ++c) meeting_[at(a, b, c)] = meeting(a, b, c);
    triangle_.assign(d3, {});
    side_.assign(d3, {});
  }

  std::optional<Triples> find() {
    for (int length = 2; length < d_; ++length)
      for (int i = 0; i + length < d_; ++i) solve(i, i + length);
    int apex = -1, sense = 0;
    double most = -kInf;
    for (int j = 1; j + 1 < d_; ++j)
      for (int s : {0, 1}) {
        if (s != sense_of_spoke(0, d_ - 1)) continue;
        const double value = triangle_[at(0, j, d_ - 1)][std::size_t(s)].value +
                             to_infinity(d_ - 1, 0, meeting_[at(0, j, d_ - 1)].x);
        if (value > most) most = value, apex = j, sense = s;
      }
    if (apex < 0) return std::nullopt;
    Triples out;
    collect(0, apex, d_ - 1, sense, out);
    return out;
  }

  const MeetingPoint& point(const std::array<int, 3>& t) const { return meeting_[at(t[0], t[1], t[2])]; }

 private:
  // The best of a part of the polygon, by the sense along n_i x n_k in which the edge leaves it: 0, 1.
  struct Best {
    double value = -kInf;
    int apex = -1;                      // of a side: of the triangle inside
    std::array<int, 2> inner = {0, 0};  // of a triangle: the senses in which the edges of its parts arrive
  };
  using BySense = std::array<Best, 2>;

  std::size_t at(int a, int b, int c) const { return std::size_t((a * d_ + b) * d_ + c); }
  const VertexPlane& plane(int i) const { return planes_[std::size_t(i)]; }
  Vec3 line(int i, int k) const { return plane(i).normal.cross(plane(k).normal); }
  bool is_usable(const MeetingPoint& p) const { return p.residual <= meet_ && p.x.norm() <= kLongestMitre; }

  MeetingPoint meeting(int a, int b, int c) const {
    const Vec3 &n = plane(a).normal, &m = plane(b).normal, &l = plane(c).normal;
    const double det = n.dot(m.cross(l));
    if (std::abs(det) < 1e-8) return meeting_point(std::array{plane(a), plane(b), plane(c)}, 1e-14);
    const Vec3 x =
        (plane(a).offset * m.cross(l) + plane(b).offset * l.cross(n) + plane(c).offset * n.cross(m)) / det;
    const Vec3 rest(n.dot(x) - plane(a).offset, m.dot(x) - plane(b).offset, l.dot(x) - plane(c).offset);
    return {x, rest.cwiseAbs().maxCoeff()};
  }

  // The edge between planes i and i + 1 leads away from the vertex; seen from a triangle it arrives.
  int sense_of_spoke(int i, int k) const {
    const Vec3& spoke = plane(k == i + 1 ? k : i).spoke;
    const bool along = spoke.dot(line(i, k)) > 0;
    return k == i + 1 ? !along : along;
  }

  // Six times the volume below the border of two planes, with plane i on the left from p to q.
  double below(int i, int k, const Vec3& p, const Vec3& q) const {
    return (plane(i).offset * plane(i).normal - plane(k).offset * plane(k).normal).dot(p.cross(q));
  }
  double to_infinity(int i, int k, const Vec3& p) const {
    const Vec3& spoke = plane(k).spoke;
    return below(i, k, p + (kLongestMitre - spoke.dot(p)) * spoke, p);
  }

  // All triangles on the side (i, k), and for all triangles beyond the best of them.
  void solve(int i, int k) {
    for (int j = i + 1; j < k; ++j) {
      const MeetingPoint& p = meeting_[at(i, j, k)];
      if (!is_usable(p)) continue;
      for (int left : {0, 1})
        for (int right : {0, 1}) {
          const double value = part(i, j, k, p.x, left) + part(j, k, i, p.x, right);
          if (value == -kInf) continue;
          for (int out : {0, 1}) {
            const Vec3 ij = (left ? -1 : 1) * line(i, j), jk = (right ? -1 : 1) * line(j, k),
                       ki = (out ? 1 : -1) * line(i, k);  // all leave the point
            const int wide = (ki.cross(ij).dot(plane(i).normal) < 0) + (ij.cross(jk).dot(plane(j).normal) < 0) +
                             (jk.cross(ki).dot(plane(k).normal) < 0);
            Best& best = triangle_[at(i, j, k)][std::size_t(out)];
            if (wide <= 1 && value > best.value) best = {value, j, {left, right}};
          }
        }
    }
    for (int l = 0; l < d_; ++l) {
      if (l >= i && l <= k) continue;
      const MeetingPoint& q = l < i ? meeting_[at(l, i, k)] : meeting_[at(i, k, l)];
      if (!is_usable(q)) continue;
      for (int j = i + 1; j < k; ++j) {
        const Vec3& p = meeting_[at(i, j, k)].x;
        const double way = (q.x - p).dot(line(i, k));
        for (int s : {0, 1}) {
          const double value = triangle_[at(i, j, k)][std::size_t(s)].value;
          if (value == -kInf || ((way > 0) != (s == 1) && (q.x - p).norm() > meet_)) continue;
          const double all = value + below(i, k, p, q.x);
          Best& best = side_[at(i, k, l)][std::size_t(s)];
          if (all > best.value) best = {all, j};
        }
      }
    }
  }

  // The value of what lies beyond the side (i, k) of the triangle with apex l at p.
  double part(int i, int k, int l, const Vec3& p, int sense) const {
    if (k == i + 1) return sense == sense_of_spoke(i, k) ? to_infinity(i, k, p) : -kInf;
    return side_[at(i, k, l)][std::size_t(sense)].value;
  }

  void collect(int i, int j, int k, int sense, Triples& out) const {
    out.push_back({i, j, k});
    const auto& [left, right] = triangle_[at(i, j, k)][std::size_t(sense)].inner;
    if (j > i + 1) collect(i, side_[at(i, j, k)][std::size_t(left)].apex, j, left, out);
    if (k > j + 1) collect(j, side_[at(j, k, i)][std::size_t(right)].apex, k, right, out);
  }

  std::span<const VertexPlane> planes_;
  int d_ = 0;
  double meet_ = 0;
  std::vector<MeetingPoint> meeting_{};
  std::vector<BySense> triangle_{}, side_{};
};

std::optional<Mitre> split_vertex(std::span<const VertexPlane> planes, double meet) {
  LargestSplit largest(planes, meet);
  const std::optional<Triples> triples = largest.find();
  if (!triples) return std::nullopt;
  std::vector<MeetingPoint> points;
  for (const auto& triple : *triples) points.push_back(largest.point(triple));
  Mitre out = split_by(*triples, points, planes.size(), meet);
  return is_embedded(out, planes) ? std::optional(std::move(out)) : std::nullopt;
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
  if (options.split && planes.size() > 3 && planes.size() <= kMostPlanes)
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
