// SPDX-License-Identifier: Apache-2.0
#include "lmd/covering_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "geometry/box_tree.hpp"
#include "geometry/check.hpp"
#include "geometry/parallel.hpp"
#include "geometry/surface_tree.hpp"
#include "lmd/simplex_distance.hpp"

namespace aussois {
namespace {

using Piece = std::array<Vec3, 3>;

constexpr double kSlack = 1.25;         // of the largest distance seen: a bound so good is good enough
constexpr double kSmallest = 1 / 32.0;  // of the mean edge of the other surface: smaller pieces are not split
constexpr double kFolded = 0.1;         // least cosine between a piece and what lies over it
constexpr double kRounding = 1e-13;     // of the size
constexpr double kNothing = 1e-9;       // of the size: surfaces so near lie on each other
constexpr int kChunk = 1024;            // triangles

Piece corners(const SimplicialComplex& complex, int t) {
  const auto& [i, j, k] = complex.triangles[t];
  return {complex.vertices[i], complex.vertices[j], complex.vertices[k]};
}

Vec3 middle(const Piece& piece) {
  return (piece[0] + piece[1] + piece[2]) / 3;
}

double longest_edge(const Piece& p) {
  return std::sqrt(
      std::max({(p[1] - p[0]).squaredNorm(), (p[2] - p[1]).squaredNorm(), (p[0] - p[2]).squaredNorm()}));
}

std::array<Piece, 4> quarters(const Piece& p) {
  const Vec3 a = (p[1] + p[2]) / 2, b = (p[2] + p[0]) / 2, c = (p[0] + p[1]) / 2;
  return {{{p[0], c, b}, {c, p[1], a}, {b, a, p[2]}, {a, b, c}}};
}

double mean_edge(const SimplicialComplex& complex) {
  double sum = 0;
  for (const auto& [i, j] : complex.edges) sum += (complex.vertices[i] - complex.vertices[j]).norm();
  return sum / double(complex.edges.size());
}

// The inside of a piece, without a rim of the size of rounding: points exactly on its edges are beside it.
class Ground {
 public:
  Ground(const Piece& piece, double rounding) : piece_(piece), rounding_(rounding) {
    normal_ = (piece[1] - piece[0]).cross(piece[2] - piece[0]).stableNormalized();
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 along = (piece[(k + 1) % 3] - piece[k]).stableNormalized(),
                 back = (piece[(k + 2) % 3] - piece[k]).stableNormalized();
      side_[k] = along.cross(normal_).stableNormalized();
      half_sine_ = std::min(half_sine_, std::sqrt(std::max(0.0, (1 - along.dot(back)) / 2)));
      flatness_ = std::max(flatness_, std::abs(height(piece[k])));
    }
  }
  const Vec3& normal() const { return normal_; }
  bool is_wide() const { return !normal_.isZero(0) && half_sine_ > 1e-4; }
  double height(const Vec3& x) const { return normal_.dot(x - piece_[0]); }
  bool holds(const Vec3& x) const {
    return outside(x, 0) < -rounding_ && outside(x, 1) < -rounding_ && outside(x, 2) < -rounding_;
  }
  // Whether one side parts a segment from it.
  bool is_beside(const Vec3& a, const Vec3& b) const {
    for (std::size_t k = 0; k < 3; ++k)
      if (outside(a, k) >= -rounding_ && outside(b, k) >= -rounding_) return true;
    return false;
  }
  // The lowest and the highest of what of a triangle is over it; (kInf, -kInf): nothing is.
  std::pair<double, double> heights_over(const Piece& triangle) const {
    std::vector<Vec3> part(triangle.begin(), triangle.end()), kept;
    for (std::size_t k = 0; k < 3; ++k, std::swap(part, kept)) {
      kept.clear();
      for (std::size_t i = 0; i < part.size(); ++i) {
        const Vec3 &x = part[i], &y = part[(i + 1) % part.size()];
        const double at_x = outside(x, k) + rounding_, at_y = outside(y, k) + rounding_;
        if (at_x < 0) kept.push_back(x);
        if ((at_x < 0) != (at_y < 0)) kept.push_back(x + at_x / (at_x - at_y) * (y - x));
      }
    }
    std::pair<double, double> out{kInf, -kInf};
    for (const Vec3& x : part) out = {std::min(out.first, height(x)), std::max(out.second, height(x))};
    return out;
  }
  // How far a point of the piece is from it at most, and from its plane.
  double rim() const { return rounding_ / half_sine_ + flatness_; }

 private:
  double outside(const Vec3& x, std::size_t k) const { return side_[k].dot(x - piece_[k]); }

  const Piece& piece_;
  double rounding_, half_sine_ = 1, flatness_ = 0;  // half_sine: of half its smallest angle
  Vec3 normal_ = Vec3::Zero();
  std::array<Vec3, 3> side_{};  // unit, in its plane, outwards
};

class Covering {
 public:
  Covering(const SimplicialComplex& from, const SimplicialComplex& to, int threads);
  double distance() const;

 private:
  double seen(int t) const;
  double bound(const Piece& piece) const;
  double over_one_triangle(const Piece& piece, const SurfacePoint& foot) const;
  double over_a_graph(const Piece& piece, const SurfacePoint& foot) const;
  bool is_inner(int t, const Ground& ground) const;
  template <class F>
  double largest(const F& f) const;

  const SimplicialComplex &from_, &to_;
  int threads_;
  SurfaceTree nearest_;
  BoxTree boxes_;
  double smallest_ = 0, enough_ = 0, rounding_ = 0;
};

std::vector<Box> boxes_of(const SimplicialComplex& complex) {
  std::vector<Box> out(complex.triangles.size());
  for (std::size_t t = 0; t < out.size(); ++t)
    for (const Vec3& x : corners(complex, int(t))) out[t] = bounding_box(out[t], {x, x});
  return out;
}

std::vector<int> all_triangles(const SimplicialComplex& complex) {
  std::vector<int> out(complex.triangles.size());
  for (std::size_t t = 0; t < out.size(); ++t) out[t] = int(t);
  return out;
}

Covering::Covering(const SimplicialComplex& from, const SimplicialComplex& to, int threads)
    : from_(from), to_(to), threads_(threads), nearest_(to), boxes_(boxes_of(to), all_triangles(to)) {
  const double size = bounding_box(to).diagonal() + bounding_box(from).diagonal();
  rounding_ = kRounding * size;
  enough_ = std::max(kSlack * largest([&](int t) { return seen(t); }), kNothing * size);
  smallest_ = std::max(enough_, kSmallest * std::min(mean_edge(from), mean_edge(to)));
}

// The largest f(t) of all triangles.
template <class F>
double Covering::largest(const F& f) const {
  const int count = int(from_.triangles.size()), chunks = (count + kChunk - 1) / kChunk;
  std::vector<double> of_chunk(std::size_t(chunks), 0.0);
  parallel_for(chunks, threads_, [&](int k) {
    for (int t = k * kChunk; t < std::min(count, (k + 1) * kChunk); ++t)
      of_chunk[k] = std::max(of_chunk[k], f(t));
  });
  return *std::ranges::max_element(of_chunk);
}

// At the corners and in the middle: a lower bound.
double Covering::seen(int t) const {
  const Piece piece = corners(from_, t);
  double out = nearest_.nearest(middle(piece)).distance;
  for (const Vec3& x : piece) out = std::max(out, nearest_.nearest(x).distance);
  return out;
}

// Distance from a triangle is convex: on a piece it is largest at a corner.
double Covering::over_one_triangle(const Piece& piece, const SurfacePoint& foot) const {
  const Piece other = corners(to_, foot.triangle);
  double out = 0;
  for (const Vec3& x : piece) out = std::max(out, closest_points({&x, 1}, other).distance);
  return out;
}

// Whether the surface goes on, and faces the same side, beyond all edges of a triangle that are over the
// ground.
bool Covering::is_inner(int t, const Ground& ground) const {
  return std::ranges::all_of(to_.triangle_edges[t], [&](int e) {
    const std::span<const int> sides = to_.edge_triangles[e];
    return (sides.size() == 2 && runs_upwards(to_, sides[0], e) != runs_upwards(to_, sides[1], e)) ||
           ground.is_beside(to_.vertices[to_.edges[e][0]], to_.vertices[to_.edges[e][1]]);
  });
}

// The largest height of the surface over the piece, if the surface covers it without a fold (LOD-8);
// otherwise kInf.
double Covering::over_a_graph(const Piece& piece, const SurfacePoint& foot) const {
  const Ground ground(piece, rounding_);
  const double high = 2 * enough_;
  if (!ground.is_wide() || !ground.holds(foot.x) || std::abs(ground.height(foot.x)) > high) return kInf;
  Box near;
  for (const Vec3& x : piece) near = bounding_box(near, {x, x});
  near.lo.array() -= high;
  near.hi.array() += high;
  double out = 0;
  boxes_.for_each([&](const Box& box) { return out < kInf && overlap(box, near); },
                  [&](int t) {
                    const auto [low, top] = ground.heights_over(corners(to_, t));
                    if (low > high || top < -high) return;  // also where nothing of it is over the ground
                    const double up = nearest_.normal(t).dot(ground.normal());
                    const bool covers = low > -high && top < high && std::abs(up) > kFolded &&
                                        up * nearest_.normal(foot.triangle).dot(ground.normal()) > 0 &&
                                        is_inner(t, ground);
                    out = covers ? std::max({out, top, -low}) : kInf;
                  });
  return out + ground.rim();
}

double Covering::bound(const Piece& piece) const {
  const SurfacePoint foot = nearest_.nearest(middle(piece));
  double best = over_one_triangle(piece, foot);
  if (best > enough_) best = std::min(best, over_a_graph(piece, foot));
  if (best <= enough_ || longest_edge(piece) <= smallest_) return best;
  double out = 0;
  for (const Piece& quarter : quarters(piece)) {
    out = std::max(out, bound(quarter));
    if (out >= best) return best;
  }
  return out;
}

double Covering::distance() const {
  return largest([&](int t) { return bound(corners(from_, t)); }) + rounding_;
}

}  // namespace

double covering_distance(const SimplicialComplex& from, const SimplicialComplex& to, int threads) {
  require(!from.triangles.empty() && !to.triangles.empty(), "covering_distance: both need triangles");
  return Covering(from, to, threads).distance();
}

}  // namespace aussois
