// SPDX-License-Identifier: Apache-2.0
// Rejects leaf pairs quickly, four at a time in single precision, by pair of dimensions. The tests forgive
// more than rounding, so whatever they reject, the tests of minimum_test.hpp reject as well.
#pragma once

#include "lmd/cone_tree.hpp"
#include "lmd/leaf.hpp"
#include "lmd/simd.hpp"

namespace aussois {

static_assert(kBucket == 4, "a bucket is one vector");

AUSSOIS_INLINE V4 times(const Eigen::Matrix3f& A, const V4& x) {
  return {A(0, 0) * x.x + A(0, 1) * x.y + A(0, 2) * x.z, A(1, 0) * x.x + A(1, 1) * x.y + A(1, 2) * x.z,
          A(2, 0) * x.x + A(2, 1) * x.y + A(2, 2) * x.z};
}
AUSSOIS_INLINE V4 spread(const Eigen::Vector3f& x) {
  return {splat(x[0]), splat(x[1]), splat(x[2])};
}

/// Maps from the frame of a shape to the frame in which the pair is tested.
struct LeafFrame {
  const LmdShape* shape = nullptr;
  Eigen::Matrix3f R = Eigen::Matrix3f::Identity();
  Vec3 centre = Vec3::Zero();  // subtracted first [m]
  Eigen::Vector3f t = Eigen::Vector3f::Zero();
  AUSSOIS_INLINE V4 directions(const V4& d) const { return times(R, d); }
  AUSSOIS_INLINE V4 points(const V4& from_centre) const { return times(R, from_centre) + spread(t); }
};

struct FilterLimits {
  float reach = 0;       // largest distance [m]
  float foot = 0;        // how far a foot may lie outside [m]
  float sin_vertex = 0;  // of the enlargement of a vertex's cone
  float sin_edges = 0;   // of the enlargement of the arcs of two edges
  bool moving = false;   // the pair may move: where and how edges cross is then not tested
};

struct VertexLanes {
  V4 p;
};
struct EdgeLanes {
  V4 p, e;            // first end, chord
  V4 g[2];            // conormals; zero: none
  F4 square, length;  // of the chord
  F4 misfit;          // how far feet may lie beyond the ends, per distance
};
struct FaceLanes {
  V4 x[3], n;    // corners, normal
  V4 inward[3];  // across the sides, not unit
  F4 side[3];    // lengths of the sides
};

AUSSOIS_INLINE void set(V4& v, int lane, const Vec3& x) {
  v.x[lane] = float(x[0]), v.y[lane] = float(x[1]), v.z[lane] = float(x[2]);
}

/// The `count` leaves from `first` on; surplus lanes repeat the last.
AUSSOIS_INLINE VertexLanes vertex_lanes(const LeafFrame& f, int first, int count) {
  VertexLanes out{};
  for (int k = 0; k < 4; ++k) {
    const VertexLeaf& v = f.shape->vertices[first + std::min(k, count - 1)];
    set(out.p, k, f.shape->complex.vertices[v.vertex] - f.centre);
  }
  out.p = f.points(out.p);
  return out;
}

AUSSOIS_INLINE EdgeLanes edge_lanes(const LeafFrame& f, int first, int count) {
  EdgeLanes out{};
  V4 n[2]{};
  F4 sign[2]{};
  for (int k = 0; k < 4; ++k) {
    const int i = first + std::min(k, count - 1);
    const EdgeLeaf& e = f.shape->edges[i];
    const Vec3 &p = f.shape->complex.vertices[e.first], &q = f.shape->complex.vertices[e.last];
    set(out.p, k, p - f.centre);
    set(out.e, k, q - p);  // from rounded points, short edges could get any direction
    out.misfit[k] = misfit_of(*f.shape, i);
    for (int c = 0; c < 2; ++c) {
      const int region = e.conormals[c];
      set(n[c], k, region == 0 ? Vec3::Zero() : f.shape->regions[std::abs(region) - 1].normal);
      sign[c][k] = region > 0 ? 1.0F : -1.0F;
    }
  }
  out.p = f.points(out.p);
  out.e = f.directions(out.e);
  out.square = dot(out.e, out.e);
  out.length = sqrt4(out.square);
  for (int c = 0; c < 2; ++c) out.g[c] = (sign[c] / out.length) * cross(f.directions(n[c]), out.e);
  return out;
}

AUSSOIS_INLINE FaceLanes face_lanes(const LeafFrame& f, int first, int count, int side) {
  FaceLanes out{};
  F4 sign{};
  for (int k = 0; k < 4; ++k) {
    const auto t = std::size_t(f.shape->faces[first + std::min(k, count - 1)]);
    set(out.n, k, f.shape->regions[f.shape->triangle_region[t]].normal);
    sign[k] = float(side * f.shape->triangle_sign[t]);
    for (std::size_t c = 0; c < 3; ++c)
      set(out.x[c], k, f.shape->complex.vertices[f.shape->complex.triangles[t][c]] - f.centre);
  }
  out.n = sign * f.directions(out.n);
  for (V4& x : out.x) x = f.points(x);
  for (int c = 0; c < 3; ++c) {
    const V4 e = out.x[(c + 1) % 3] - out.x[c];
    out.inward[c] = splat(float(side)) * cross(out.n, e);
    out.side[c] = sqrt4(dot(e, e));
  }
  return out;
}

/// Turns directions back into the frame of the shape.
AUSSOIS_INLINE V4 in_own_frame(const LeafFrame& frame, const V4& d) {
  return times(frame.R.transpose(), d);
}

/// Which of the four directions d, seen from the vertex, lie in its enlarged cone? They need not be unit;
/// `limit` is scaled by their lengths.
AUSSOIS_INLINE I4 in_vertex_cone(const LeafFrame& frame, const VertexLeaf& v, const V4& d, F4 limit) {
  const V4 local = in_own_frame(frame, d);
  I4 in = {-1, -1, -1, -1};
  const Vec3* g = frame.shape->rays.data() + v.first_ray;
  for (std::uint32_t k = 0; k < v.ray_count; ++k)
    in &= float(g[k].x()) * local.x + float(g[k].y()) * local.y + float(g[k].z()) * local.z <= limit;
  return in;
}

/// Tests a corner at p against four simplices: bits of those that it may touch.
AUSSOIS_INLINE int may_touch(const LeafFrame& frame, const VertexLeaf& v, const V4& p, const FaceLanes& f,
                             const FilterLimits& limits) {
  const F4 h = dot(f.n, p - f.x[0]);
  I4 in = (h <= limits.reach) & (h >= -limits.foot);
  for (int c = 0; c < 3; ++c) in &= dot(f.inward[c], p - f.x[c]) >= -limits.foot * f.side[c];
  if (!bits(in)) return 0;
  return bits(in & in_vertex_cone(frame, v, V4{-f.n.x, -f.n.y, -f.n.z}, splat(limits.sin_vertex)));
}

AUSSOIS_INLINE int may_touch(const LeafFrame& frame, const VertexLeaf& v, const V4& p, const EdgeLanes& e,
                             const FilterLimits& limits) {
  const V4 w = p - e.p;
  const F4 s = dot(e.e, w) / e.square;
  const F4 slack = (limits.foot + limits.reach * e.misfit) / e.length;
  const V4 d = w - s * e.e;  // from the foot to the vertex
  const F4 square = dot(d, d);
  I4 in = (s >= -slack) & (s <= 1.0F + slack) & (square <= limits.reach * limits.reach);
  for (const V4& g : e.g) in &= dot(g, d) <= limits.foot;
  if (!bits(in)) return 0;
  return bits(in & in_vertex_cone(frame, v, V4{-d.x, -d.y, -d.z},
                                  (limits.sin_vertex + 2.0F * e.misfit) * sqrt4(square) + limits.foot));
}

AUSSOIS_INLINE int may_touch(const LeafFrame& frame, const VertexLeaf& v, const V4& p,
                             const VertexLanes& other, const FilterLimits& limits) {
  const V4 d = other.p - p;
  const F4 square = dot(d, d);
  const I4 in = square <= limits.reach * limits.reach;
  if (!bits(in)) return 0;
  return bits(in & in_vertex_cone(frame, v, d, limits.sin_vertex * sqrt4(square) + limits.foot));
}

/// An edge in lane `k` of its bucket against four others.
struct EdgeCrossing {
  V4 e, w;       // the edge; from its first end to those of the four
  V4 n;          // common perpendicular, not unit
  F4 det, sin2;  // square of n; of the sine of the angle in between
  F4 s, r;       // where they cross, as fractions
};
AUSSOIS_INLINE EdgeCrossing crossing(const EdgeLanes& a, int k, const EdgeLanes& b) {
  EdgeCrossing out;
  out.e = spread(a.e, k), out.w = b.p - spread(a.p, k);
  const F4 aa = splat(a.square[k]);
  const F4 ab = dot(out.e, b.e), aw = dot(out.e, out.w), bw = dot(b.e, out.w);
  out.n = cross(out.e, b.e);
  out.det = dot(out.n, out.n);
  out.sin2 = out.det / (aa * b.square);
  out.s = (b.square * aw - ab * bw) / out.det, out.r = (ab * aw - aa * bw) / out.det;
  return out;
}

/// Tests the edge in lane `k` of `a`, the side that u points away from, against the four edges of `b`.
AUSSOIS_INLINE int may_touch(const EdgeLanes& a, int k, const EdgeLanes& b, const FilterLimits& limits) {
  const EdgeCrossing c = crossing(a, k, b);
  const V4 &e = c.e, &w = c.w, &n = c.n;
  const F4 length = splat(a.length[k]), sin2 = c.sin2, s = c.s, r = c.r;
  // Nearly parallel: single precision cannot tell where they cross, only how far the lines are apart.
  const V4 off = w - (dot(b.e, w) / b.square) * b.e;
  const F4 near = limits.reach + 0.01F * length;
  const I4 parallel = (sin2 < 1e-4F) & (dot(off, off) <= near * near);
  const F4 fuzz = limits.foot + 2e-6F * (sqrt4(dot(w, w)) + length + b.length) / sin2;
  const F4 slack_a = fuzz / length, slack_b = fuzz / b.length;
  const V4 d = w + r * b.e - s * e;
  const F4 reach = limits.reach + fuzz;
  I4 in = (sin2 >= 1e-4F) & (dot(d, d) <= reach * reach);
  if (limits.moving) {
    const V4 middles = w + splat(0.5F) * (b.e - e);
    const F4 apart = limits.reach + 0.5F * (length + b.length);
    return bits((parallel | in) & (dot(middles, middles) <= apart * apart));
  }
  in &= (s >= -slack_a) & (s <= 1.0F + slack_a) & (r >= -slack_b) & (r <= 1.0F + slack_b);
  if (!bits(parallel | in)) return 0;
  const F4 size = sqrt4(c.det), along = dot(n, w);
  const F4 limit = limits.sin_edges * size;
  I4 out = {0, 0, 0, 0};
  for (const float sign : {1.0F, -1.0F}) {  // u = n or -n; both where the lines nearly meet
    I4 ok = sign * along >= -fuzz * size;
    for (const V4& g : a.g) ok &= sign * dot(spread(g, k), n) <= limit;
    for (const V4& g : b.g) ok &= -sign * dot(g, n) <= limit;
    out |= ok;
  }
  return bits(parallel | (in & out));
}

}  // namespace aussois
