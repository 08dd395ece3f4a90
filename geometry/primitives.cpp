// SPDX-License-Identifier: Apache-2.0
#include "geometry/primitives.hpp"

#include <cmath>
#include <numeric>

#include "geometry/check.hpp"
#include "geometry/polygon.hpp"

namespace aussois {
namespace {

using Triangles = std::vector<std::array<int, 3>>;

void require_length(const char* field, double value) {
  require_field(value > 0 && std::isfinite(value), field, value, "be finite and > 0 [m]");
}

// The quadrilateral a, b, c, d, counter-clockwise from outside, as two triangles.
void add_quad(Triangles& triangles, int a, int b, int c, int d) {
  triangles.push_back({a, b, c});
  triangles.push_back({a, c, d});
}

// One triangle into four; the vertex halfway along edge e gets the index vertex count + e.
SimplicialComplex subdivided(const SimplicialComplex& complex) {
  std::vector<Vec3> vertices = complex.vertices.to_vector();
  for (const auto& [a, b] : complex.edges) {
    vertices.push_back((complex.vertices[a] + complex.vertices[b]) / 2);
  }
  Triangles triangles;
  const int n = int(complex.vertices.size());
  for (std::size_t t = 0; t < complex.triangles.size(); ++t) {
    const auto& [a, b, c] = complex.triangles[t];
    const auto& [ab, bc, ca] = complex.triangle_edges[t];
    triangles.push_back({a, n + ab, n + ca});
    triangles.push_back({b, n + bc, n + ab});
    triangles.push_back({c, n + ca, n + bc});
    triangles.push_back({n + ab, n + bc, n + ca});
  }
  return make_complex(std::move(vertices), std::move(triangles));
}

}  // namespace

SimplicialComplex make_point() {
  return make_complex({Vec3::Zero()}, {});
}

SimplicialComplex make_segment(double length) {
  require_length("length", length);
  return make_complex({Vec3(-length / 2, 0, 0), Vec3(length / 2, 0, 0)}, {}, {{0, 1}});
}

SimplicialComplex make_polyline(const std::vector<Vec3>& points) {
  require_field(points.size() >= 2, "number of points of a polyline", points.size(), "be at least 2");
  std::vector<std::array<int, 2>> wires;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    require(points[i] != points[i + 1],
            "point " + std::to_string(i + 1) + " of a polyline repeats the one before");
    wires.push_back({int(i), int(i + 1)});
  }
  return make_complex(points, {}, wires);
}

SimplicialComplex make_plate(double x, double y, int nx, int ny) {
  require_length("x", x);
  require_length("y", y);
  require_field(nx >= 1, "nx", nx, "be at least 1");
  require_field(ny >= 1, "ny", ny, "be at least 1");
  std::vector<Vec3> vertices;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i)
      vertices.emplace_back(x * (double(i) / nx - 0.5), y * (double(j) / ny - 0.5), 0);
  Triangles triangles;
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      const int a = j * (nx + 1) + i, d = a + nx + 1;
      add_quad(triangles, a, a + 1, d + 1, d);
    }
  }
  return make_complex(std::move(vertices), std::move(triangles));
}

SimplicialComplex make_box(double x, double y, double z, int subdivisions) {
  const Vec3 size(x, y, z);
  require_length("x", x);
  require_length("y", y);
  require_length("z", z);
  require_field(subdivisions >= 1 && subdivisions <= 256, "subdivisions", subdivisions, "lie in [1, 256]");
  const int n = subdivisions;
  std::vector<Vec3> vertices;
  const std::size_t side_count = std::size_t(n) + 1;
  std::vector<int> index_of(side_count * side_count * side_count,
                            -1);  // of the lattice points on the surface
  const auto vertex = [&](const Eigen::Vector3i& at) {
    const int place = (at.z() * (n + 1) + at.y()) * (n + 1) + at.x();
    int& index = index_of[place];
    if (index < 0) {
      index = int(vertices.size());
      vertices.push_back(size.cwiseProduct(at.cast<double>() / n - Vec3::Constant(0.5)));
    }
    return index;
  };
  Triangles triangles;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, n}) {
      const int u = (axis + (side ? 1 : 2)) % 3, v = (axis + (side ? 2 : 1)) % 3;  // u x v points outwards
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          Eigen::Vector3i at;
          at[axis] = side;
          at[u] = i;
          at[v] = j;
          const Eigen::Vector3i du = Eigen::Vector3i::Unit(u), dv = Eigen::Vector3i::Unit(v);
          const int a = vertex(at), b = vertex(at + du), c = vertex(at + du + dv), d = vertex(at + dv);
          add_quad(triangles, a, b, c, d);
        }
      }
    }
  }
  return make_complex(std::move(vertices), std::move(triangles), {}, true);
}

SimplicialComplex make_cylinder(double radius, double height, int facets) {
  require_length("radius", radius);
  require_length("height", height);
  require_field(facets >= 3, "facets", facets, "be at least 3");
  std::vector<Vec3> vertices;
  for (int i = 0; i < facets; ++i) {  // 2 i below, 2 i + 1 above
    const double angle = 2 * kPi * i / facets;
    for (const double z : {-height / 2, height / 2})
      vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  const int below = 2 * facets, above = below + 1;  // the centres of the two caps
  vertices.emplace_back(0, 0, -height / 2);
  vertices.emplace_back(0, 0, height / 2);
  Triangles triangles;
  for (int i = 0; i < facets; ++i) {
    const int a = 2 * i, b = 2 * ((i + 1) % facets);
    add_quad(triangles, a, b, b + 1, a + 1);
    triangles.push_back({below, b, a});
    triangles.push_back({above, a + 1, b + 1});
  }
  return make_complex(std::move(vertices), std::move(triangles), {}, true);
}

SimplicialComplex make_sphere(double radius, int subdivisions) {
  require_length("radius", radius);
  require_field(subdivisions >= 0 && subdivisions <= 8, "subdivisions", subdivisions, "lie in [0, 8]");
  const double s =
      (1 + std::sqrt(5.0)) / 2;  // golden section: the corners of three rectangles are the icosahedron
  SimplicialComplex sphere =
      make_complex({{-1, s, 0},
                    {1, s, 0},
                    {-1, -s, 0},
                    {1, -s, 0},
                    {0, -1, s},
                    {0, 1, s},
                    {0, -1, -s},
                    {0, 1, -s},
                    {s, 0, -1},
                    {s, 0, 1},
                    {-s, 0, -1},
                    {-s, 0, 1}},
                   {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}});
  for (int level = 0; level < subdivisions; ++level) {
    sphere = subdivided(sphere);
    std::vector<Vec3> vertices = sphere.vertices.to_vector();
    for (Vec3& vertex : vertices) vertex.normalize();  // at every level, for even triangles
    sphere.vertices = std::move(vertices);
  }
  std::vector<Vec3> vertices = sphere.vertices.to_vector();
  for (Vec3& vertex : vertices) vertex *= radius / vertex.norm();
  return make_complex(std::move(vertices), sphere.triangles, {}, true);
}

SimplicialComplex make_extrusion(const std::vector<Vec2>& profile, double height) {
  require_length("height", height);
  require_field(profile.size() >= 3, "number of points of a profile", profile.size(), "be at least 3");
  const int n = int(profile.size());
  std::vector<int> loop(profile.size());
  std::iota(loop.begin(), loop.end(), 0);
  std::vector<Vec3> vertices;  // i below, n + i above
  for (const double z : {-height / 2, height / 2})
    for (const Vec2& x : profile) vertices.emplace_back(x.x(), x.y(), z);
  const double area = twice_area(profile, loop) / 2;
  require_field(area > 0, "area of a profile", area, "be > 0 (does it run clockwise?)");
  const auto cap = triangulate(profile, {loop});
  require(cap.has_value(), "a profile must not cross itself");
  Triangles triangles;
  for (const auto& [a, b, c] : *cap) {
    triangles.push_back({a, c, b});
    triangles.push_back({n + a, n + b, n + c});
  }
  for (int i = 0; i < n; ++i) add_quad(triangles, i, (i + 1) % n, n + (i + 1) % n, n + i);
  return make_complex(std::move(vertices), std::move(triangles), {}, true);
}

SimplicialComplex make_torus(double major, double minor, int n_major, int n_minor) {
  require_length("major", major);
  require_length("minor", minor);
  require_field(minor < major, "minor", minor, "be smaller than major");
  require_field(n_major >= 3, "n_major", n_major, "be at least 3");
  require_field(n_minor >= 3, "n_minor", n_minor, "be at least 3");
  std::vector<Vec3> vertices;
  for (int i = 0; i < n_major; ++i) {
    const double around = 2 * kPi * i / n_major;
    for (int j = 0; j < n_minor; ++j) {
      const double tube = 2 * kPi * j / n_minor, r = major + minor * std::cos(tube);
      vertices.emplace_back(r * std::cos(around), r * std::sin(around), minor * std::sin(tube));
    }
  }
  Triangles triangles;
  for (int i = 0; i < n_major; ++i) {
    for (int j = 0; j < n_minor; ++j) {
      const int here = i * n_minor, next = (i + 1) % n_major * n_minor, up = (j + 1) % n_minor;
      add_quad(triangles, here + j, next + j, next + up, here + up);
    }
  }
  return make_complex(std::move(vertices), std::move(triangles), {}, true);
}

std::vector<Vec2> gear_profile(int teeth, double root_radius, double tip_radius) {
  require_field(teeth >= 3, "teeth", teeth, "be at least 3");
  require_length("root_radius", root_radius);
  require_length("tip_radius", tip_radius);
  require_field(root_radius < tip_radius, "root_radius", root_radius, "be smaller than tip_radius");
  std::vector<Vec2> profile;
  for (int i = 0; i < 4 * teeth; ++i) {
    const double angle = kPi * i / (2 * teeth), r = i % 4 < 2 ? root_radius : tip_radius;
    profile.emplace_back(r * std::cos(angle), r * std::sin(angle));
  }
  return profile;
}

}  // namespace aussois
