// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <Eigen/Geometry>

#include "geometry/box_tree.hpp"
#include "geometry/point_in_solid.hpp"
#include "geometry/repair_steps.hpp"

namespace aussois {
namespace {

// Triangles joined by edges that have two triangles.
struct Piece {
  std::vector<int> triangles{};
  bool closed = true;      // all its edges have two triangles
  bool orientable = true;  // its triangles can agree
};

class Orientation {
 public:
  explicit Orientation(const SimplicialComplex& complex)
      : complex_(complex), reached_(complex.triangles.size()), turned_(complex.triangles.size()) {}

  OrientedComplex run() {
    OrientedComplex out;
    std::vector<Piece> shells;
    for (int t = 0; t < int(complex_.triangles.size()); ++t) {
      if (reached_[t]) continue;
      Piece piece = piece_of(t);
      out.one_sided += !piece.orientable;
      if (!piece.orientable) continue;
      turn_fewest(piece);
      if (piece.closed) shells.push_back(std::move(piece));
    }
    for (std::size_t t = 0; t < turned_.size(); ++t)
      if (turned_[t]) out.turned_triangles.add(centre_of(int(t)), 0);
    out.shells = int(shells.size());
    face_outwards(shells, out);
    const bool same = out.turned_triangles.count + out.turned_shells.count == 0;
    out.complex = same ? complex_ : make_complex(complex_.vertices, triangles(), wires_of(complex_));
    return out;
  }

 private:
  const Vec3& x(int vertex) const { return complex_.vertices[vertex]; }
  std::array<int, 3> corners(int t) const {
    std::array<int, 3> c = complex_.triangles[t];
    if (turned_[t]) std::swap(c[1], c[2]);
    return c;
  }
  Vec3 centre_of(int t) const {
    const auto [a, b, c] = corners(t);
    return (x(a) + x(b) + x(c)) / 3;
  }
  std::vector<std::array<int, 3>> triangles() const {
    std::vector<std::array<int, 3>> all(turned_.size());
    for (int t = 0; t < int(all.size()); ++t) all[t] = corners(t);
    return all;
  }

  // From its lowest triangle, turning what disagrees with the triangle it was reached from; a piece in which
  // this leads to a contradiction is left as it was.
  Piece piece_of(int lowest) {
    Piece piece;
    piece.triangles.push_back(lowest);
    reached_[lowest] = true;
    for (std::size_t i = 0; i < piece.triangles.size(); ++i) {
      const int t = piece.triangles[i];
      for (const int e : complex_.triangle_edges[t]) {
        const std::span<const int> around = complex_.edge_triangles[e];
        piece.closed &= around.size() == 2;
        if (around.size() != 2) continue;
        const int other = around[0] == t ? around[1] : around[0];
        const bool twisted = runs_upwards(complex_, t, e) == runs_upwards(complex_, other, e);
        const bool turn = turned_[t] != twisted;
        if (reached_[other]) {
          piece.orientable &= turned_[other] == turn;
          continue;
        }
        reached_[other] = true;
        turned_[other] = turn;
        piece.triangles.push_back(other);
      }
    }
    if (!piece.orientable)
      for (const int t : piece.triangles) turned_[t] = false;
    return piece;
  }

  void turn(const Piece& piece) {
    for (const int t : piece.triangles) turned_[t] = !turned_[t];
  }

  void turn_fewest(const Piece& piece) {
    const auto count = std::ranges::count_if(piece.triangles, [&](int t) { return turned_[t]; });
    if (2 * std::size_t(count) > piece.triangles.size()) turn(piece);
  }

  // (CPX-12)
  void face_outwards(const std::vector<Piece>& shells, OrientedComplex& out) {
    std::vector<Box> boxes(shells.size());
    std::vector<int> items;
    for (std::size_t i = 0; i < shells.size(); ++i) {
      items.push_back(int(i));
      for (const int t : shells[i].triangles)
        for (const int v : complex_.triangles[t]) boxes[i] = bounding_box(boxes[i], {x(v), x(v)});
    }
    const BoxTree tree(boxes, std::move(items));
    std::vector<std::size_t> wrong;
    for (std::size_t i = 0; i < shells.size(); ++i) {
      const double volume = volume_of(shells[i]);
      out.flat_shells += volume == 0;
      if (volume == 0) continue;
      const Vec3 place = centre_of(shells[i].triangles.front());
      int depth = 0;
      tree.for_each(
          [&](const Box& box) {
            return (box.lo.array() <= boxes[i].lo.array()).all() &&
                   (box.hi.array() >= boxes[i].hi.array()).all();
          },
          [&](int j) { depth += j != int(i) && is_inside(place, shells[j]); });
      if ((volume > 0) != (depth % 2 == 0)) wrong.push_back(i);
    }
    for (const std::size_t i : wrong) {
      turn(shells[i]);
      out.turned_shells.add(centre_of(shells[i].triangles.front()), 0);
    }
  }

  // Enclosed volume [m^3]; 0 if rounding could have made it.
  double volume_of(const Piece& shell) const {
    const Vec3& origin = x(complex_.triangles[shell.triangles.front()][0]);
    double sum = 0, scale = 0;
    for (const int t : shell.triangles) {
      const auto [a, b, c] = corners(t);
      const Vec3 area = (x(b) - x(a)).cross(x(c) - x(a)), arm = x(a) - origin;
      sum += arm.dot(area);
      scale += arm.norm() * area.norm();
    }
    return std::abs(sum) > 1e-12 * scale ? sum / 6 : 0;
  }

  // Goes the shell round it, whichever way it faces? (CPX-13)
  bool is_inside(const Vec3& place, const Piece& shell) const {
    int turns = 0;
    for (const int t : shell.triangles) {
      const auto [i, j, k] = corners(t);
      turns += crossing_sign(place, x(i), x(j), x(k));
    }
    return turns != 0;
  }

  const SimplicialComplex& complex_;
  std::vector<bool> reached_, turned_;
};

}  // namespace

OrientedComplex orient_surface(const SimplicialComplex& complex) {
  return Orientation(complex).run();
}

}  // namespace aussois
