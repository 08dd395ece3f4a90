// SPDX-License-Identifier: Apache-2.0
#include "geometry/mass_properties.hpp"

#include <cmath>

#include "geometry/check.hpp"
#include "geometry/convex_hull.hpp"

namespace aussois {
namespace {

// Mean of the vertices: an origin within the part, so that a far frame costs no digits.
Vec3 vertex_mean(const SimplicialComplex& complex) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& x : complex.vertices) sum += x;
  return sum / double(complex.vertices.size());
}

void check_density(double density) {
  require_field(std::isfinite(density) && density > 0, "density [kg/m^3]", density, "be finite and > 0");
}

// Of a ball if both ends are one place (MASS-4).
MassProperties capsule(const Vec3& a, const Vec3& b, double radius, double density) {
  const Vec3 axis = b - a;
  const double length = axis.norm(), square = radius * radius;
  const double cylinder = density * kPi * square * length, ball = density * 4 / 3 * kPi * square * radius;
  const double along = cylinder * square / 2 + ball * 2 / 5 * square;
  const double across = cylinder * (length * length / 12 + square / 4) +
                        ball * (2.0 / 5 * square + length * length / 4 + 3.0 / 8 * length * radius);
  const Vec3 n = length > 0 ? Vec3(axis / length) : Vec3::UnitX();
  const Mat3 N = n * n.transpose();
  return {.volume = (cylinder + ball) / density,
          .mass = cylinder + ball,
          .centre = (a + b) / 2,
          .inertia = along * N + across * (Mat3::Identity() - N)};
}

MassProperties sum_of(const std::vector<MassProperties>& parts) {
  MassProperties out;
  for (const MassProperties& part : parts) out.volume += part.volume, out.mass += part.mass;
  for (const MassProperties& part : parts) out.centre += part.mass / out.mass * part.centre;
  for (const MassProperties& part : parts) {  // Huygens and Steiner
    const Vec3 arm = part.centre - out.centre;
    out.inertia += part.inertia + part.mass * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
  }
  return out;
}

}  // namespace

MassProperties mass_properties(const SimplicialComplex& complex, double density) {
  check_density(density);
  require(is_closed_oriented(complex),
          "mass properties need a closed oriented surface; give the mass, or use the convex hull");

  const Vec3 origin = vertex_mean(complex);
  double six_volume = 0;
  Vec3 first = Vec3::Zero();   // 24 times the integral of x
  Mat3 second = Mat3::Zero();  // 120 times the integral of x x'
  for (const auto& [i, j, k] : complex.triangles) {
    const Vec3 a = complex.vertices[i] - origin;
    const Vec3 b = complex.vertices[j] - origin;
    const Vec3 c = complex.vertices[k] - origin;
    const Vec3 sum = a + b + c;
    const double determinant = a.dot(b.cross(c));
    six_volume += determinant;
    first += determinant * sum;
    second +=
        determinant * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }

  MassProperties result;
  result.volume = six_volume / 6;  // (MASS-1)
  require_field(result.volume > 0, "enclosed volume [m^3]", result.volume,
                "be > 0 (do the triangles face inwards?)");
  result.mass = density * result.volume;
  const Vec3 centre = first / (24 * result.volume);  // (MASS-2)
  result.centre = origin + centre;
  const Mat3 covariance = second / 120 - result.volume * centre * centre.transpose();
  result.inertia = density * (covariance.trace() * Mat3::Identity() - covariance);  // (MASS-3)
  return result;
}

MassProperties convex_hull_mass_properties(const SimplicialComplex& complex, double density) {
  check_density(density);
  return mass_properties(make_complex(complex.vertices, convex_hull(complex.vertices)), density);
}

MassProperties wire_mass_properties(const SimplicialComplex& complex, double radius, double density) {
  check_density(density);
  require_field(std::isfinite(radius) && radius > 0, "radius [m]", radius, "be finite and > 0");
  require(complex.triangles.empty(), "a wire's mass is that of edges and points, without triangles");
  std::vector<MassProperties> parts;
  for (int v = 0; v < int(complex.vertices.size()); ++v)
    if (const Vec3& x = complex.vertices[v]; complex.vertex_edges[v].empty())
      parts.push_back(capsule(x, x, radius, density));
  for (const auto& [i, j] : complex.edges)
    parts.push_back(capsule(complex.vertices[i], complex.vertices[j], radius, density));
  return sum_of(parts);
}

}  // namespace aussois
