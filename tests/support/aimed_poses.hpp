// SPDX-License-Identifier: Apache-2.0
// Poses that put a corner, a crease or a face of a small probe just where the tests of neighbouring simplices
// of a shape meet: above its vertices and the borders of its regions, along the normals of the regions, and
// across its wires from any side, exactly or a little beside. Random poses never hit such places, features
// cut by one CAD program do. The judge is the distance of the base complexes, which knows no regions, no
// chains and no cones (lmd.md, Coverage).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <tuple>
#include <utility>

#include <Eigen/Geometry>

#include "geometry/primitives.hpp"
#include "lmd/certificate.hpp"
#include "lmd/coverage.hpp"
#include "lmd/find_contacts.hpp"
#include "lmd/nesting.hpp"
#include "tests/support/random.hpp"

namespace aussois {

/// What poses were judged, and how far the smallest gap was from the distance of the bases less the
/// dilations.
struct CoverageAudit {
  long poses = 0;            // judged; bases that touch have no contacts
  long missed = 0;           // that were due, for want of poses
  long hidden = 0;           // where every probe touches the shape, or is inside
  long holes = 0;            // no contact as near as the bases, or no contact at all
  long early = 0;            // a contact nearer than the bases
  double worst = 0;          // difference over the tolerances of both shapes [-]
  std::string first_hole{};  // for the message of a test
};

/// A place on a border of the base complex where |n . (x - y)| of the tests of its neighbours is zero.
struct Aim {
  Vec3 x = Vec3::Zero();        // frame of the shape [m]
  Vec3 u = Vec3::UnitZ();       // unit, away from the shape, on the border of the normal cone
  Vec3 beside = Vec3::UnitX();  // unit, across u
  double off = 0;               // how far beside, of the size of the shape [-]
};

/// How far beside a border, of the size of the shape.
inline constexpr double kBeside[] = {0, 1e-12, 1e-10, 1e-8, 1e-6};

class AimedPoses {
 public:
  explicit AimedPoses(const LmdShape& shape) : s_(shape), k_(shape.complex) {
    for (int e = 0; e < int(k_.edges.size()); ++e) {
      const auto around = k_.edge_triangles[e];
      const bool inside = around.size() == 2 && region(around[0]) == region(around[1]);
      if (!inside) borders_.push_back(e);
    }
    std::vector<int> border_edges(k_.vertices.size(), 0);
    for (const int e : borders_)
      for (const int v : k_.edges[e]) ++border_edges[v];
    std::vector<char> essential(k_.vertices.size(), 0);
    for (const VertexLeaf& leaf : s_.vertices) essential[leaf.vertex] = 1;
    std::vector<char> listed(k_.vertices.size(), 0);
    for (const int e : borders_)
      for (const int v : k_.edges[e])
        if (border_edges[v] == 2 && !essential[v]) {
          bent_.push_back(e);
          if (!std::exchange(listed[v], 1)) inner_.push_back({e, v == k_.edges[e][1]});
        }
  }
  bool empty() const { return borders_.empty(); }
  /// Every vertex inside a chain, every border of a region and every edge of a wire, at each of kBeside.
  long due_count() const { return long(std::size(kBeside) * (inner_.size() + borders_.size())); }

  /// The `i`-th of those that are due.
  Aim due(long i, Random& random) const {
    const std::size_t at = std::size_t(i) / std::size(kBeside);
    const auto [e, s] =
        at < inner_.size() ? inner_[at] : std::pair(borders_[at - inner_.size()], random.uniform());
    Aim aim = over(e, s, random);
    aim.off = kBeside[std::size_t(i) % std::size(kBeside)];
    return aim;
  }

  /// Any: at one half of them a vertex inside a chain is near, if there is one.
  Aim any(Random& random) const {
    const std::vector<int>& edges = bent_.empty() || random.index(2) ? borders_ : bent_;
    const int e = edges[random.index(int(edges.size()))];
    Aim aim = over(e, random.index(3) ? double(random.index(2)) : random.uniform(), random);
    aim.off =
        random.index(2) ? kBeside[random.index(int(std::size(kBeside)))] : random.log_uniform(1e-11, 1e-6);
    return aim;
  }

 private:
  // Unit, across a wire.
  static Vec3 any_across(const Vec3& along, Random& random) {
    const Vec3 x = along.unitOrthogonal();
    const double angle = random.uniform(0, 2 * kPi);
    return std::cos(angle) * x + std::sin(angle) * along.cross(x);
  }
  // A place on an edge, from its first end (0) to the other (1).
  Aim over(int e, double s, Random& random) const {
    const auto& ends = k_.edges[e];
    const Vec3 &p = k_.vertices[ends[0]], &q = k_.vertices[ends[1]];
    const Vec3 along = (q - p).normalized();
    const auto around = s == 0   ? k_.vertex_triangles[ends[0]]
                        : s == 1 ? k_.vertex_triangles[ends[1]]
                                 : k_.edge_triangles[e];
    const auto normal = [&] {
      if (k_.edge_triangles[e].empty()) return any_across(along, random);
      const int t = around[random.index(int(around.size()))];
      const double side = k_.solid || random.index(2) ? 1 : -1;
      return Vec3(side * double(s_.triangle_sign[t]) * s_.regions[region(t)].normal);
    };
    Aim aim{.x = p + s * (q - p), .u = normal()};
    if (random.index(4) == 0) {
      const double share = random.uniform();
      aim.u = (aim.u + share * normal()).stableNormalized();
    }
    if (!(aim.u.norm() > 0.5)) aim.u = Vec3::UnitZ();
    const Vec3 across[] = {along.cross(aim.u), along, random.direction()};
    aim.beside = across[random.index(3)];
    aim.beside = (aim.beside - aim.beside.dot(aim.u) * aim.u).stableNormalized();
    if (!(aim.beside.norm() > 0.5)) aim.beside = aim.u.unitOrthogonal();
    return aim;
  }

  std::size_t region(int t) const { return std::size_t(s_.triangle_region[t]); }
  const LmdShape& s_;
  const SimplicialComplex& k_;
  std::vector<int> borders_{}, bent_{};  // edges, those of wires too; those with an end inside a chain
  std::vector<std::pair<int, double>> inner_{};  // each vertex inside a chain as an end, 0 or 1, of an edge
};

/// A probe: its frame is put on the aim with z along u.
struct Probe {
  LmdShape shape{};
  Vec3 place = Vec3::Zero();  // of the probe, that comes above the aim; frame of the probe
};

/// A point, a corner, a crease and a face (in the middle, on a border, at a corner), of size `size`, looking
/// down.
inline std::vector<Probe> make_probes(double size, double dilation) {
  const SimplicialComplex corner = make_complex(
      {{0, 0, 0}, {0.4 * size, 0, size}, {-0.2 * size, 0.34 * size, size}, {-0.2 * size, -0.34 * size, size}},
      {{0, 2, 1}, {0, 3, 2}, {0, 1, 3}, {1, 2, 3}}, {}, true);
  const double h = size / 2;
  const SimplicialComplex crease = make_complex(
      {{-h, 0, 0}, {-h, h, h}, {-h, -h, h}, {h, 0, 0}, {h, h, h}, {h, -h, h}},
      {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}}, {}, true);
  const SimplicialComplex box = transformed_complex(make_box(size, size, size), translation(0, 0, h));
  std::vector<Probe> probes;
  for (const auto& [complex, place] :
       std::initializer_list<std::pair<SimplicialComplex, Vec3>>{{make_point(), Vec3::Zero()},
                                                                 {corner, Vec3::Zero()},
                                                                 {crease, Vec3(0.3 * h, 0, 0)},
                                                                 {crease, Vec3(h, 0, 0)},
                                                                 {box, Vec3(0.3 * h, 0.1 * h, 0)},
                                                                 {box, Vec3(h, 0.1 * h, 0)},
                                                                 {box, Vec3(h, h, 0)}})
    probes.push_back({prepare(dilate(complex, dilation)), place});
  return probes;
}

/// Surfaces that do not meet may be nested: they have no contacts then.
inline bool nested(const PosedShape& a, const PosedShape& b) {
  return find_nesting(a, connected_pieces(a.shape->complex), b, connected_pieces(b.shape->complex))
      .has_value();
}

inline std::string in_words(const PosedShape& a, const char* what, double distance, double late) {
  const auto& [R, p] = a.g_ws;
  char text[400];
  std::snprintf(text, sizeof text,
                "%s at a base distance of %.9g m: smallest gap %.3g tolerances late; wxyz %.17g %.17g %.17g "
                "%.17g, xyz %.17g %.17g %.17g",
                what, distance, late, R.w(), R.x(), R.y(), R.z(), p.x(), p.y(), p.z());
  return text;
}

/// Judges one pose: gap = base distance - dilations, to two tolerances of each shape.
inline void judge_coverage(const PosedShape& a, const PosedShape& b, const char* what, CoverageAudit& audit) {
  const double dilation = a.shape->radius + b.shape->radius;
  const double tolerance = a.shape->tolerance + b.shape->tolerance;
  const double d = base_distance({a.shape, {}, {.g = a.g_ws}}, {b.shape, {}, {.g = b.g_ws}}, 100 * dilation);
  if (d < 1e-3 * dilation || d >= 100 * dilation) return;
  const double off = gap_beyond_distance(a, b, d);
  if (off > 2 * tolerance && nested(a, b)) return;
  ++audit.poses;
  if (off > 2 * tolerance) {
    ++audit.holes;
    if (audit.first_hole.empty()) audit.first_hole = in_words(a, what, d, off / tolerance);
    return;
  }
  audit.early += off < -2 * tolerance;
  audit.worst = std::max(audit.worst, std::abs(off) / tolerance);
}

/// So many poses are enough for all that are due.
inline long poses_of_all_due(const LmdShape& shape) {
  return AimedPoses(shape).due_count() / 3 * 4 + 4;
}

/// 0 ... n - 1 in an order of chance.
inline std::vector<long> shuffled(long n, Random& random) {
  std::vector<long> out;
  for (long i = 0; i < n; ++i) {
    out.push_back(i);
    std::swap(out.back(), out[random.index(int(i) + 1)]);
  }
  return out;
}

/// Part `number` of `of` parts of all poses.
struct PoseSlice {
  int number = 0, of = 1;
};

/// Where a probe stands beside an aim, at a random height above it and turned at random.
inline SE3 put_on(const Aim& aim, const Probe& probe, double size, double dilation, Random& random) {
  const double away = dilation * random.log_uniform(0.1, 20);
  const double turn = random.index(3) ? random.uniform(0, 2 * kPi) : 0;
  const Vec3 y = aim.u.cross(aim.beside);
  Mat3 axes;
  axes << std::cos(turn) * aim.beside + std::sin(turn) * y, std::cos(turn) * y - std::sin(turn) * aim.beside,
      aim.u;
  Quat R(axes);
  if (random.index(3) == 0) R = R * exp_so3(random.vector_of_log_length(1e-10, 0.5));
  R.normalize();
  const double beside = (random.index(2) ? size : -size) * aim.off;
  return {R, aim.x + away * aim.u + beside * aim.beside - R * probe.place};
}

/// `poses` poses of the probes aimed at the borders and wires of `shape`, from the seed: three of four go
/// where one is due, until none is. Where a probe touches the shape the next takes its place: any seven, then
/// points, which reach into concave edges. Where all touch the place is hidden. Those of the slice are
/// judged; each pose has random numbers of its own.
inline CoverageAudit audit_coverage(const LmdShape& shape, long poses, std::uint64_t seed,
                                    PoseSlice slice = {}) {
  constexpr int kTries = 40, kAny = 7;
  static constexpr const char* kNames[] = {"point", "corner",           "crease",          "end of a crease",
                                           "face",  "border of a face", "corner of a face"};
  CoverageAudit audit;
  const AimedPoses aimed(shape);
  if (aimed.empty()) return audit;
  Random shuffle(seed);
  const std::vector<long> due = shuffled(aimed.due_count(), shuffle);
  const double size = 2 * shape.bounding_radius;
  const std::vector<Probe> probes = make_probes(std::max(0.02 * size, 10 * shape.radius), shape.radius);
  for (long i = 0; i < poses; ++i) {
    const long next = i - (i + 1) / 4;  // of those due: every fourth pose is any
    const bool any = i % 4 == 3 || next >= std::ssize(due);
    if (i * slice.of / poses != slice.number) continue;
    Random random(seed + 0x9E3779B97F4A7C15U * std::uint64_t(i + 1));
    const long before = audit.poses;
    for (int k = 0; k < kTries && audit.poses == before; ++k) {
      const Aim aim = any ? aimed.any(random) : aimed.due(due[std::size_t(next)], random);
      const std::size_t which = k < kAny ? std::size_t(random.index(int(probes.size()))) : 0;
      const SE3 g = put_on(aim, probes[which], size, shape.radius, random);
      judge_coverage({&probes[which].shape, g, 0}, {&shape, {}, 1}, kNames[which], audit);
    }
    audit.hidden += audit.poses == before;
  }
  audit.missed = std::max(0L, std::ssize(due) - (poses - poses / 4));
  return audit;
}

}  // namespace aussois
