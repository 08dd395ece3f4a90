// SPDX-License-Identifier: Apache-2.0
#include "lmd/nesting.hpp"

#include <algorithm>
#include <sstream>

namespace aussois {
namespace {

bool holds(const Box& outer, const Box& inner) {
  return (outer.lo.array() <= inner.lo.array()).all() && (inner.hi.array() <= outer.hi.array()).all();
}

// A piece inside a solid is inside one of its shells, whose box holds the piece's in any frame.
Nesting pieces_within(const PosedShape& inner, const Pieces& pieces, const PosedShape& outer,
                      const Pieces& shells) {
  Nesting out{.of = int(pieces.vertex.size())};
  if (!outer.shape->complex.solid) return out;
  const SE3 g = inverse(outer.g_ws) * inner.g_ws;
  const std::span<const Vec3> vertices = inner.shape->complex.vertices;
  std::vector<Box> boxes(pieces.vertex.size());
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const Vec3 x = g * vertices[v];
    Box& box = boxes[pieces.of_vertex[v]];
    box.lo = box.lo.cwiseMin(x), box.hi = box.hi.cwiseMax(x);
  }
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    if (std::ranges::none_of(shells.box, [&](const Box& shell) { return holds(shell, boxes[k]); })) continue;
    const Vec3& x = vertices[pieces.vertex[k]];
    if (is_inside(outer.shape->complex, shells, g * x) && out.pieces++ == 0) out.place = inner.g_ws * x;
  }
  return out;
}

}  // namespace

std::optional<Nesting> find_nesting(const PosedShape& a, const Pieces& pieces_a, const PosedShape& b,
                                    const Pieces& pieces_b) {
  Nesting out = pieces_within(a, pieces_a, b, pieces_b);
  out.a_in_b = out.pieces > 0;
  if (!out.a_in_b) out = pieces_within(b, pieces_b, a, pieces_a);
  return out.pieces > 0 ? std::optional(out) : std::nullopt;
}

std::string to_string(const Nesting& nesting, const std::string& name_a, const std::string& name_b) {
  const std::string &inner = nesting.a_in_b ? name_a : name_b, &outer = nesting.a_in_b ? name_b : name_a;
  std::ostringstream text;
  if (nesting.pieces == nesting.of) {
    text << inner << " lies inside the solid of " << outer;
  } else {
    text << nesting.pieces << " of " << nesting.of << " pieces of " << inner << " lie inside the solid of "
         << outer << ", one at (" << nesting.place.x() << ", " << nesting.place.y() << ", "
         << nesting.place.z() << ") m";
  }
  return text.str();
}

}  // namespace aussois
