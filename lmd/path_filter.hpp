// SPDX-License-Identifier: Apache-2.0
// Rejects, four at a time in single precision, pairs of leaves that become no minimum nearer than a reach
// while one leaf moves past the other (CA-22). What leaf_filter.hpp compares with a limit at one pose goes
// straight from the start of the path to its end, but for what the limits allow: where it is outside at both
// ends, it is outside in between.
#pragma once

#include "lmd/leaf_filter.hpp"

namespace aussois {

/// Limits of lengths contain `bend`.
struct PathLimits {
  float reach = 0;       // largest distance that matters [m]
  float foot = 0;        // how far a foot may lie outside [m]
  float sin_vertex = 0;  // of the enlargement of a vertex's cone, with the turn of the path
  float sin_edges = 0;   // of the enlargement of the arcs of two edges
  float turn = 0;        // how far the one leaf turns past the other [rad]
  float way = 0;         // how far its points move at most [m]
  float bend = 0;        // how far they are off the chords of their paths at most [m]
};

/// Four points, or one in all lanes, at the start and at the end of a path.
struct PointPath {
  V4 now, end;
};
AUSSOIS_INLINE PointPath spread(const PointPath& p, int lane) {
  return {spread(p.now, lane), spread(p.end, lane)};
}

/// Square of the smallest distance from the origin on the way from `now` to `end`.
AUSSOIS_INLINE F4 nearest_square(const V4& now, const V4& end) {
  const V4 way = end - now;
  const F4 square = dot(way, way), along = -dot(now, way);
  const F4 s = along <= 0 ? splat(0) : along >= square ? splat(1) : along / square;
  const V4 x = now + s * way;
  return dot(x, x);
}

/// `in_vertex_cone` for directions that turn from one to the other and are scaled by lengths up to that of
/// the longer one.
AUSSOIS_INLINE I4 passes_vertex_cone(const LeafFrame& frame, const VertexLeaf& v, const V4& now,
                                     const V4& end, F4 limit) {
  const V4 a = in_own_frame(frame, now), b = in_own_frame(frame, end);
  I4 in = {-1, -1, -1, -1};
  const Vec3* g = frame.shape->rays.data() + v.first_ray;
  for (std::uint32_t k = 0; k < v.ray_count; ++k) {
    const float x = float(g[k].x()), y = float(g[k].y()), z = float(g[k].z());
    in &= min4(x * a.x + y * a.y + z * a.z, x * b.x + y * b.y + z * b.z) <= limit;
  }
  return in;
}

/// Tests a corner on its path against four simplices: bits of those that it may touch.
AUSSOIS_INLINE int may_meet(const LeafFrame& frame, const VertexLeaf& v, const PointPath& p,
                            const FaceLanes& f, const PathLimits& limits) {
  const F4 now = dot(f.n, p.now - f.x[0]), end = dot(f.n, p.end - f.x[0]);
  I4 in = (min4(now, end) <= limits.reach) & (max4(now, end) >= -limits.foot);
  for (int c = 0; c < 3; ++c)
    in &=
        max4(dot(f.inward[c], p.now - f.x[c]), dot(f.inward[c], p.end - f.x[c])) >= -limits.foot * f.side[c];
  if (!bits(in)) return 0;
  return bits(in & in_vertex_cone(frame, v, V4{-f.n.x, -f.n.y, -f.n.z}, splat(limits.sin_vertex)));
}

AUSSOIS_INLINE int may_meet(const LeafFrame& frame, const VertexLeaf& v, const PointPath& p,
                            const EdgeLanes& e, const PathLimits& limits) {
  const V4 w[2] = {p.now - e.p, p.end - e.p};
  const F4 s[2] = {dot(e.e, w[0]) / e.square, dot(e.e, w[1]) / e.square};
  const F4 slack = (limits.foot + limits.reach * e.misfit) / e.length;
  const V4 d[2] = {w[0] - s[0] * e.e, w[1] - s[1] * e.e};  // from the foot to the vertex
  I4 in = (max4(s[0], s[1]) >= -slack) & (min4(s[0], s[1]) <= 1.0F + slack) &
          (nearest_square(d[0], d[1]) <= limits.reach * limits.reach);
  for (const V4& g : e.g) in &= min4(dot(g, d[0]), dot(g, d[1])) <= limits.foot;
  if (!bits(in)) return 0;
  const F4 most = sqrt4(max4(dot(d[0], d[0]), dot(d[1], d[1])));
  return bits(in & passes_vertex_cone(frame, v, V4{-d[0].x, -d[0].y, -d[0].z}, V4{-d[1].x, -d[1].y, -d[1].z},
                                      (limits.sin_vertex + 2.0F * e.misfit) * most + limits.foot));
}

AUSSOIS_INLINE int may_meet(const LeafFrame& frame, const VertexLeaf& v, const PointPath& p,
                            const VertexLanes& other, const PathLimits& limits) {
  const V4 now = other.p - p.now, end = other.p - p.end;
  const I4 in = nearest_square(now, end) <= limits.reach * limits.reach;
  if (!bits(in)) return 0;
  const F4 most = sqrt4(max4(dot(now, now), dot(end, end)));
  return bits(in & passes_vertex_cone(frame, v, now, end, limits.sin_vertex * most + limits.foot));
}

/// Whether a plane across m parts the edges by the reach at both ends (CA-7).
AUSSOIS_INLINE I4 parted_along(const V4& m, const EdgeCrossing& now, const EdgeCrossing& end,
                               const EdgeLanes& b, float reach) {
  const F4 half = splat(0.5F), along_b = dot(m, b.e);
  const F4 from = dot(m, now.w) + half * (along_b - dot(m, now.e));  // from middle to middle
  const F4 to = dot(m, end.w) + half * (along_b - dot(m, end.e));
  const F4 start = abs4(from) - half * (abs4(dot(m, now.e)) + abs4(along_b));
  const F4 last = (from < 0 ? -to : to) - half * (abs4(dot(m, end.e)) + abs4(along_b));
  return min4(start, last) > reach * sqrt4(dot(m, m));
}

/// Tests the edge in lane `k` of `now` and `end`, the side that u points away from, against four edges that
/// rest.
AUSSOIS_INLINE int may_meet(const EdgeLanes& now, const EdgeLanes& end, int k, const EdgeLanes& b,
                            const PathLimits& limits) {
  const EdgeCrossing c0 = crossing(now, k, b), c1 = crossing(end, k, b);
  const V4 middles = c0.w + splat(0.5F) * (b.e - c0.e);
  const V4 off = middles - (dot(middles, b.e) / b.square) * b.e;
  const I4 near = ~(parted_along(c0.n, c0, c1, b, limits.reach) | parted_along(off, c0, c1, b, limits.reach));
  if (!bits(near)) return 0;
  // Nearly parallel at some time: how they cross says nothing.
  const F4 low = sqrt4(min4(c0.sin2, c1.sin2)) - limits.turn, low2 = low * low;
  const I4 parallel = ~(low >= 0.01F);
  const F4 length = splat(now.length[k]);
  const F4 size = sqrt4(max4(dot(c0.w, c0.w), dot(c1.w, c1.w))) + length + b.length;
  const F4 fuzz = limits.foot + limits.bend / low +
                  (2e-6F * size + limits.turn * (limits.way + limits.turn * size)) / low2;
  const F4 slack_a = fuzz / length, slack_b = fuzz / b.length;
  const I4 in = (max4(c0.s, c1.s) >= -slack_a) & (min4(c0.s, c1.s) <= 1.0F + slack_a) &
                (max4(c0.r, c1.r) >= -slack_b) & (min4(c0.r, c1.r) <= 1.0F + slack_b);
  if (!bits(near & (parallel | in))) return 0;
  const F4 most = sqrt4(max4(c0.det, c1.det));
  const F4 limit = (limits.sin_edges + limits.turn * limits.turn / low) * most;
  const F4 along[2] = {dot(c0.n, c0.w), dot(c1.n, c1.w)};
  I4 out = {0, 0, 0, 0};
  for (const float sign : {1.0F, -1.0F}) {  // u = n or -n; both where the lines nearly meet
    I4 ok = max4(sign * along[0], sign * along[1]) >= -fuzz * most;
    for (int c = 0; c < 2; ++c) {
      ok &= min4(sign * dot(spread(now.g[c], k), c0.n), sign * dot(spread(end.g[c], k), c1.n)) <= limit;
      ok &= min4(-sign * dot(b.g[c], c0.n), -sign * dot(b.g[c], c1.n)) <= limit;
    }
    out |= ok;
  }
  return bits(near & (parallel | (in & out)));
}

}  // namespace aussois
