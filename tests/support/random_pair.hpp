// SPDX-License-Identifier: Apache-2.0
// Random pairs of prepared shapes: solids convex and not, sheets, wires, points, of about a metre.
#pragma once

#include <memory>

#include "geometry/primitives.hpp"
#include "lmd/certificate.hpp"
#include "lmd/find_contacts.hpp"
#include "tests/support/random.hpp"

namespace aussois {

/// An L in the plane x, z, two by two squares of side `s` without one, extruded along y by s: one concave
/// edge.
inline SimplicialComplex make_l_shape(double s) {
  const double x[6][2] = {{-s, -s}, {s, -s}, {s, 0}, {0, 0}, {0, s}, {-s, s}};
  std::vector<Vec3> v;
  for (const double y : {s / 2, -s / 2})
    for (const auto& p : x) v.push_back({p[0], y, p[1]});
  std::vector<std::array<int, 3>> t;
  for (int i = 0; i < 6; ++i) {
    const int j = (i + 1) % 6;
    t.push_back({j + 6, i + 6, i});
    t.push_back({j + 6, i, j});
  }
  for (const auto& f : std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}) {
    t.push_back({f[0] + 6, f[1] + 6, f[2] + 6});
    t.push_back({f[0], f[2], f[1]});
  }
  return make_complex(v, t, {}, true);
}

inline SimplicialComplex random_shape(Random& random) {
  switch (random.index(9)) {
    case 0: {
      const Vec3 size{random.uniform(0.5, 1), random.uniform(0.5, 1), random.uniform(0.5, 1)};
      return make_box(size.x(), size.y(), size.z(), 1 + random.index(2));
    }
    case 1: {
      const double radius = random.uniform(0.2, 0.6), height = random.uniform(0.3, 1);
      return make_cylinder(radius, height, 3 + random.index(10));
    }
    case 2:
      return make_sphere(0.6, random.index(2));
    case 3: {
      const int around = 5 + random.index(6);
      return make_torus(0.6, 0.2, around, 3 + random.index(4));
    }
    case 4: {
      const int along = 1 + random.index(3);
      return make_plate(1, 0.7, along, 1 + random.index(3));
    }
    case 5:
      return make_polyline({random.vector(0.6), random.vector(0.6), random.vector(0.6)});
    case 6:
      return make_segment(random.uniform(0.5, 1));
    case 7:
      return make_l_shape(random.uniform(0.3, 0.5));
    default:
      return make_point();
  }
}

struct RandomPair {
  LmdShape a{}, b{};
  SE3 g_a{}, g_b{};
  double distance = 0;  // of the base complexes [m]
  PosedShape posed_a() const { return {&a, g_a, 0}; }
  PosedShape posed_b() const { return {&b, g_b, 1}; }
};

/// Two shapes moved towards each other from afar until their bases are `gap` apart, or until the line of
/// approach has missed. Odd seeds: nearly aligned, so that faces and edges are nearly parallel.
inline RandomPair random_pair(std::uint64_t seed, double gap) {
  Random random(seed);
  RandomPair pair{.a = prepare(dilate(random_shape(random), 0.01)),
                  .b = prepare(dilate(random_shape(random), 0.02)),
                  .g_a = random.pose(1),
                  .g_b = random.pose(1)};
  Vec3 away = random.direction();
  if (seed % 2 == 1) {
    const Quat tilt = exp_so3(random.vector_of_length(0, 0.03));
    const Quat quarter = exp_so3(kPi / 2 * random.index(2) * Vec3::UnitX());
    pair.g_a.R = (pair.g_b.R * quarter * tilt).normalized();
    away = pair.g_b.R * Vec3{random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), 1}.normalized();
  }
  pair.distance = kInf;
  for (double s = 4; pair.distance > gap + 1e-4 && s > -4; s -= pair.distance - gap) {
    pair.g_a.p = pair.g_b.p + s * away;
    pair.distance = base_distance({&pair.a, {}, {.g = pair.g_a}}, {&pair.b, {}, {.g = pair.g_b}}, 10);
  }
  return pair;
}

}  // namespace aussois
