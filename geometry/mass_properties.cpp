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
    const Vec3 a = complex.vertices[std::size_t(i)] - origin;
    const Vec3 b = complex.vertices[std::size_t(j)] - origin;
    const Vec3 c = complex.vertices[std::size_t(k)] - origin;
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

}  // namespace aussois
