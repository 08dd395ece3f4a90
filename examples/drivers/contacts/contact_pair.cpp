// SPDX-License-Identifier: Apache-2.0
#include "examples/drivers/contacts/contact_pair.hpp"

#include <cmath>
#include <cstdio>

#include "geometry/check.hpp"
#include "geometry/primitives.hpp"

namespace aussois {
namespace {

// Points of a closed polygon in the plane z = 0, counter-clockwise.
using Loop = std::vector<Vec3>;

Vec3 polar(double radius, double angle) {
  return {radius * std::cos(angle), radius * std::sin(angle), 0};
}

Loop circle(double radius, int facets) {
  Loop loop;
  for (int i = 0; i < facets; ++i) loop.push_back(polar(radius, 2 * kPi * i / facets));
  return loop;
}

// A square of the given half side, seen from its middle in the directions of a circle of as many points.
Loop square(double half, int points) {
  Loop loop = circle(1, points);
  for (Vec3& x : loop) x *= half / x.cwiseAbs().maxCoeff();
  return loop;
}

// Teeth between two radii: each tooth is a trapezium, with four points a pitch.
Loop toothed(double root, double tip, int teeth) {
  Loop loop;
  for (int i = 0; i < teeth; ++i) {
    const double pitch = 2 * kPi / teeth;
    loop.push_back(polar(root, (i - 0.25) * pitch));
    loop.push_back(polar(tip, (i - 0.12) * pitch));
    loop.push_back(polar(tip, (i + 0.12) * pitch));
    loop.push_back(polar(root, (i + 0.25) * pitch));
  }
  return loop;
}

// The solid between an outer and an inner loop of as many points, both seen from the origin, for z in [0,
// height].
SimplicialComplex make_ring(const Loop& outer, const Loop& inner, double height) {
  const int n = int(outer.size());
  std::vector<Vec3> vertices;
  for (const double z : {0.0, height})
    for (const Loop* loop : {&outer, &inner})
      for (const Vec3& x : *loop) vertices.push_back(x + z * Vec3::UnitZ());
  std::vector<std::array<int, 3>> triangles;
  const auto quad = [&](int a, int b, int c, int d) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  };
  const int lower_out = 0, lower_in = n, upper_out = 2 * n, upper_in = 3 * n;
  for (int i = 0; i < n; ++i) {
    const int j = (i + 1) % n;
    quad(lower_out + i, lower_out + j, upper_out + j, upper_out + i);
    quad(lower_in + j, lower_in + i, upper_in + i, upper_in + j);
    quad(upper_out + i, upper_out + j, upper_in + j, upper_in + i);
    quad(lower_out + j, lower_out + i, lower_in + i, lower_in + j);
  }
  return make_complex(std::move(vertices), std::move(triangles), {}, true);
}

// The solid that a profile of points (radius, 0, z) sweeps around z, from the axis below to the axis above.
SimplicialComplex make_revolved(const std::vector<Vec3>& profile, int facets) {
  std::vector<Vec3> vertices{profile.front(), profile.back()};
  for (std::size_t k = 1; k + 1 < profile.size(); ++k)
    for (int i = 0; i < facets; ++i)
      vertices.push_back(polar(profile[k].x(), 2 * kPi * i / facets) + profile[k].z() * Vec3::UnitZ());
  const int rings = int(profile.size()) - 2;
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i < facets; ++i) {
    const int j = (i + 1) % facets;
    const auto at = [&](int ring, int k) { return 2 + ring * facets + k; };
    triangles.push_back({0, at(0, j), at(0, i)});
    for (int ring = 0; ring + 1 < rings; ++ring) {
      triangles.push_back({at(ring, i), at(ring, j), at(ring + 1, j)});
      triangles.push_back({at(ring, i), at(ring + 1, j), at(ring + 1, i)});
    }
    triangles.push_back({1, at(rings - 1, i), at(rings - 1, j)});
  }
  return make_complex(std::move(vertices), std::move(triangles), {}, true);
}

AssemblyPart part(std::string name, SimplicialComplex complex) {
  AssemblyPart out{.name = std::move(name), .complex = std::move(complex)};
  out.report = report_mesh(out.complex);
  return out;
}

constexpr double kDilation = 1e-4;  // of every part here [m]
constexpr double kTilt = 0.3 * kPi / 180;

SE3 tilted(double x, double y, double z, double yaw = 0) {
  return translation(x, y, z) * rotation(Vec3(2, 1, 0), kTilt) * rotation(Vec3::UnitZ(), yaw);
}

}  // namespace

SE3 parse_pose(const std::string& text, double scale) {
  double x[7];
  char rest = 0;
  const int count = std::sscanf(text.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%lf%c", &x[0], &x[1], &x[2], &x[3],
                                &x[4], &x[5], &x[6], &rest);
  require(count == 7, "--pose = " + text + " must be seven numbers x,y,z,qw,qx,qy,qz");
  return checked_pose({Quat(x[3], x[4], x[5], x[6]), scale * Vec3(x[0], x[1], x[2])},
                      ("--pose = " + text).c_str());
}

ContactPair builtin_pair(const std::string& name) {
  ContactPair pair{.name = name, .dilation_a = kDilation, .dilation_b = kDilation, .threshold = 1e-3};
  const AssemblyPart plate = part("plate", make_plate(0.1, 0.1, 4, 4));
  if (name == "box_on_plate") {
    pair.a = part("box", make_box(0.04, 0.03, 0.02));
    pair.b = plate;
    pair.poses = {tilted(0.004, -0.006, 0.0104, 0.4)};
  } else if (name == "cylinder_standing") {
    pair.a = part("cylinder", make_cylinder(0.01, 0.03, 24));
    pair.b = plate;
    pair.poses = {tilted(0.004, -0.006, 0.0154)};
  } else if (name == "cylinder_lying") {
    pair.a = part("cylinder", make_cylinder(0.01, 0.03, 24));
    pair.b = plate;
    pair.poses = {tilted(0.004, -0.006, 0.0103, 0.4) * rotation(Vec3::UnitX(), kPi / 2)};
  } else if (name == "peg") {
    pair.a = part("peg", make_cylinder(0.01, 0.03, 32));
    pair.b = part("hole", make_ring(square(0.02, 32), circle(0.0104, 32), 0.02));
    pair.poses = {tilted(0, 0, 0.02)};
    pair.threshold = 5e-4;
  } else if (name == "gear") {
    pair.a = part("gear", make_ring(toothed(0.018, 0.023, 18), circle(0.0104, 72), 0.01));
    pair.b = part("shaft", make_revolved({Vec3(0, 0, -0.008), Vec3(0.015, 0, -0.008), Vec3(0.015, 0, 0),
                                          Vec3(0.01, 0, 0), Vec3(0.01, 0, 0.025), Vec3(0, 0, 0.025)},
                                         36));
    pair.poses = {translation(0, 0, 3e-4) * rotation(Vec3::UnitX(), kTilt / 3)};
    pair.threshold = 5e-4;
  } else if (name == "bolt_nut") {
    return contact_pair(builtin_assembly(name));
  } else {
    std::string known;
    for (const std::string& one : kBuiltinPairs) known += " " + one;
    throw std::invalid_argument("--builtin = " + name + " must be one of" + known);
  }
  return pair;
}

ContactPair contact_pair(AssemblyInput input) {
  return {.name = input.name,
          .a = std::move(input.moving),
          .b = std::move(input.fixed),
          .poses = std::move(input.poses)};
}

}  // namespace aussois
