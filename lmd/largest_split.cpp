// SPDX-License-Identifier: Apache-2.0
#include "lmd/largest_split.hpp"

#include <algorithm>
#include <cmath>
#include <queue>

#include <Eigen/Dense>

#include "geometry/polygon.hpp"

namespace aussois {
namespace {

constexpr double kReach = 1e6;   // where the edges of the vertex end
constexpr double kRank = 1e-9;   // singular values below this are rounding
constexpr int kMostSteps = 500;  // of the search: beyond, no split is likely (taste)

bool segments_meet(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double abc = cross(b - a, c - a), abd = cross(b - a, d - a), cda = cross(d - c, a - c),
               cdb = cross(d - c, b - c);
  return ((abc >= 0 && abd <= 0) || (abc <= 0 && abd >= 0)) &&
         ((cda >= 0 && cdb <= 0) || (cda <= 0 && cdb >= 0));
}

// The best of a part of the polygon that an edge joins to the rest; by the sense in which this edge leaves
// the part, along n_i x n_k (1) or against (0), for planes i < k.
using BySense = std::array<double, 2>;

// One point between three planes, with the senses in which the edges from the parts beyond arrive.
struct EdgeChoice {
  int apex = 0, left = 0, right = 0;
  double value = -kInf;
};

// A side of a triangle that is chosen; what lies beyond it is not.
struct Open {
  int i = 0, k = 0;  // planes
  int l = 0;         // third plane of the triangle
  int sense = 0;
};

// A piece of a plane's border; rays leave the vertex.
struct Piece {
  int plane = 0;
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
};

// A way to cut the polygon of which a part is chosen.
struct Partial {
  double bound = 0;  // no completion of it is better
  std::vector<SplitPoint> points{};
  std::vector<Open> open{};
  std::vector<Piece> pieces{};
  bool operator<(const Partial& other) const { return bound < other.bound; }
};

// Both the solid and the demand that at most one of the three planes at a point has an angle above 180
// degrees there are sums over triangles and the sides between them, so the best of each part of the polygon
// is found from the best of smaller parts. That the borders are simple is not: with these bounds the best is
// searched for among all, best first.
class LargestSplit {
 public:
  LargestSplit(std::span<const VertexPlane> planes, double meet, double longest)
      : planes_(planes),
        d_(int(planes.size())),
        meet_(meet),
        longest_(longest),
        meeting_(std::size_t(d_ * d_ * d_)) {
    for (int a = 0; a < d_; ++a)
      for (int b = a + 1; b < d_; ++b)
        for (int c = b + 1; c < d_; ++c) meeting_[at(a, b, c)] = meeting(a, b, c);
    triangle_.assign(meeting_.size(), {-kInf, -kInf});
    side_.assign(meeting_.size(), {-kInf, -kInf});
    for (int length = 2; length < d_; ++length)
      for (int i = 0; i + length < d_; ++i) solve(i, i + length);
  }

  std::optional<std::vector<SplitPoint>> find() const {
    std::priority_queue<Partial> queue;
    const int root = sense_of_spoke(0, d_ - 1);
    for (int j = 1; j + 1 < d_; ++j)
      for (const EdgeChoice& c : choices(0, j, d_ - 1, root)) {
        const Vec3& p = meeting_[at(0, j, d_ - 1)].x;
        extend({.bound = c.value + to_infinity(d_ - 1, 0, p)}, 0, d_ - 1, c, queue);
      }
    for (int step = 0; step < kMostSteps && !queue.empty(); ++step) {
      Partial best = queue.top();
      queue.pop();
      if (best.open.empty()) return best.points;
      const Open o = best.open.back();
      best.open.pop_back();
      const double without = best.bound - side_[at(o.i, o.k, o.l)][o.sense];
      const Vec3& q = point(o.i, o.k, o.l);
      for (int j = o.i + 1; j < o.k; ++j) {
        const Vec3& p = meeting_[at(o.i, j, o.k)].x;
        if (!arrives(o.i, o.k, p, q, o.sense)) continue;
        for (const EdgeChoice& c : choices(o.i, j, o.k, o.sense)) {
          Partial next = best;
          next.bound = without + c.value + below(o.i, o.k, p, q);
          if (add(next, {o.i, p, q}) && add(next, {o.k, p, q})) extend(std::move(next), o.i, o.k, c, queue);
        }
      }
    }
    return std::nullopt;
  }

 private:
  std::size_t at(int a, int b, int c) const { return std::size_t((a * d_ + b) * d_ + c); }
  const VertexPlane& plane(int i) const { return planes_[i]; }
  Vec3 line(int i, int k) const { return plane(i).normal.cross(plane(k).normal); }
  bool is_usable(const MeetingPoint& p) const { return p.residual <= meet_ && p.x.norm() <= longest_; }
  const Vec3& point(int i, int k, int l) const {
    return (l < i ? meeting_[at(l, i, k)] : l < k ? meeting_[at(i, l, k)] : meeting_[at(i, k, l)]).x;
  }

  MeetingPoint meeting(int a, int b, int c) const {
    const Vec3 &n = plane(a).normal, &m = plane(b).normal, &l = plane(c).normal;
    const double det = n.dot(m.cross(l));
    if (std::abs(det) < 1e-8) return meeting_point(std::array{plane(a), plane(b), plane(c)}, 1e-14);
    const Vec3 x =
        (plane(a).offset * m.cross(l) + plane(b).offset * l.cross(n) + plane(c).offset * n.cross(m)) / det;
    const Vec3 rest(n.dot(x) - plane(a).offset, m.dot(x) - plane(b).offset, l.dot(x) - plane(c).offset);
    return {x, rest.cwiseAbs().maxCoeff()};
  }

  // An edge of the vertex, between neighbours i and k, leads away from it; to a triangle it arrives.
  int sense_of_spoke(int i, int k) const {
    const bool along = plane(k == i + 1 ? k : i).spoke.dot(line(i, k)) > 0;
    return k == i + 1 ? !along : along;
  }
  bool arrives(int i, int k, const Vec3& p, const Vec3& q, int sense) const {
    return ((q - p).dot(line(i, k)) > 0) == (sense == 1) || (q - p).norm() <= meet_;
  }

  // Six times the volume below the border of two planes, with plane i on the left from p to q.
  double below(int i, int k, const Vec3& p, const Vec3& q) const {
    return (plane(i).offset * plane(i).normal - plane(k).offset * plane(k).normal).dot(p.cross(q));
  }
  Vec3 far(int k, const Vec3& p) const { return p + (kReach - plane(k).spoke.dot(p)) * plane(k).spoke; }
  double to_infinity(int i, int k, const Vec3& p) const { return below(i, k, far(k, p), p); }

  // What lies beyond the side (i, k) of the triangle with third plane l at p, if the edge arrives in this
  // sense.
  double beyond(int i, int k, int l, const Vec3& p, int sense) const {
    if (k == i + 1) return sense == sense_of_spoke(i, k) ? to_infinity(i, k, p) : -kInf;
    return side_[at(i, k, l)][sense];
  }

  // Ways to take the triangle (i, j, k) if its edge between i and k leaves in this sense.
  std::vector<EdgeChoice> choices(int i, int j, int k, int out) const {
    std::vector<EdgeChoice> all;
    const MeetingPoint& p = meeting_[at(i, j, k)];
    if (!is_usable(p)) return all;
    for (int left : {0, 1})
      for (int right : {0, 1}) {
        const double value = beyond(i, j, k, p.x, left) + beyond(j, k, i, p.x, right);
        const Vec3 ij = (left ? -1 : 1) * line(i, j), jk = (right ? -1 : 1) * line(j, k),
                   ki = (out ? 1 : -1) * line(i, k);  // all leave the point
        const int wide = (ki.cross(ij).dot(plane(i).normal) < 0) + (ij.cross(jk).dot(plane(j).normal) < 0) +
                         (jk.cross(ki).dot(plane(k).normal) < 0);
        if (value > -kInf && wide <= 1) all.push_back({j, left, right, value});
      }
    return all;
  }

  // All triangles on the side (i, k), and the best of them for each triangle beyond.
  void solve(int i, int k) {
    for (int j = i + 1; j < k; ++j)
      for (int s : {0, 1})
        for (const EdgeChoice& c : choices(i, j, k, s)) {
          double& best = triangle_[at(i, j, k)][s];
          best = std::max(best, c.value);
        }
    for (int l = 0; l < d_; ++l) {
      if (l >= i && l <= k) continue;
      const Vec3& q = point(i, k, l);
      for (int j = i + 1; j < k; ++j)
        for (int s : {0, 1}) {
          const Vec3& p = meeting_[at(i, j, k)].x;
          const double value = triangle_[at(i, j, k)][s];
          double& best = side_[at(i, k, l)][s];
          if (value > -kInf && arrives(i, k, p, q, s)) best = std::max(best, value + below(i, k, p, q));
        }
    }
  }

  void extend(Partial partial, int i, int k, const EdgeChoice& c, std::priority_queue<Partial>& queue) const {
    const int j = c.apex;
    const Vec3& p = meeting_[at(i, j, k)].x;
    partial.points.push_back({{i, j, k}, p});
    bool simple = true;
    const auto ray = [&](int a, int b) {  // the edge of the vertex between neighbours a and b
      simple = simple && add(partial, {a, p, far(b, p)}) && add(partial, {b, p, far(b, p)});
    };
    if (i == 0 && k == d_ - 1) ray(k, i);
    if (j == i + 1) ray(i, j);
    if (k == j + 1) ray(j, k);
    if (j > i + 1) partial.open.push_back({i, j, k, c.left});
    if (k > j + 1) partial.open.push_back({j, k, i, c.right});
    if (simple) queue.push(std::move(partial));
  }

  // False if the piece meets another of the same plane elsewhere than in their common end.
  bool add(Partial& partial, const Piece& piece) const {
    if ((piece.to - piece.from).norm() <= meet_) return true;
    const Vec3& n = plane(piece.plane).normal;
    const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
    const auto flat = [&](const Vec3& x) { return Vec2(u.dot(x), v.dot(x)); };
    const Vec2 a = flat(piece.from), b = flat(piece.to);
    for (const Piece& other : partial.pieces) {
      if (other.plane != piece.plane) continue;
      const Vec2 c = flat(other.from), d = flat(other.to);
      bool touch = false;
      for (const auto& [end, tip] : {std::pair(a, b), std::pair(b, a)})
        for (const auto& [other_end, other_tip] : {std::pair(c, d), std::pair(d, c)})
          if ((end - other_end).norm() <= meet_) {
            touch = true;
            const Vec2 one = tip - end, two = other_tip - other_end;
            if (one.dot(two) > 0 && std::abs(cross(one, two)) <= 1e-9 * one.norm() * two.norm()) return false;
          }
      if (!touch && segments_meet(a, b, c, d)) return false;
    }
    partial.pieces.push_back(piece);
    return true;
  }

  std::span<const VertexPlane> planes_;
  int d_ = 0;
  double meet_ = 0, longest_ = 0;
  std::vector<MeetingPoint> meeting_{};
  std::vector<BySense> triangle_{}, side_{};
};

}  // namespace

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

std::optional<std::vector<SplitPoint>> largest_split(std::span<const VertexPlane> planes, double meet,
                                                     double longest) {
  return LargestSplit(planes, meet, longest).find();
}

}  // namespace aussois
