// SPDX-License-Identifier: Apache-2.0
// Tests T-1.1 to T-1.13 of doc/theory/mesh_features.md.
#include "geometry/mesh_features.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <map>
#include <set>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "lmd/lmd_shape.hpp"
#include "tests/support/change.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

using Triangles = std::vector<std::array<int, 3>>;
constexpr VertexRule kRules[] = {VertexRule::tangent_cone, VertexRule::moravanszky_terdiman};

MeshFeatures features(const SimplicialComplex& mesh, VertexRule rule = VertexRule::tangent_cone) {
  return find_mesh_features(mesh, {.vertex_rule = rule});
}

int vertex_bits(const MeshFeatures& f) {
  int n = 0;
  for (const std::uint8_t flags : f.triangle_flags) n += std::popcount(unsigned(flags & 7u));
  return n;
}
int edge_bits(const MeshFeatures& f) {
  int n = 0;
  for (const std::uint8_t flags : f.triangle_flags) n += std::popcount(unsigned(flags & 56u));
  return n;
}
int count(const MeshFeatures& f, EdgeClass c) {
  return int(std::count(f.edge_class.begin(), f.edge_class.end(), c));
}

// How often each vertex and each edge stands in a triangle.
std::pair<std::map<int, int>, std::map<int, int>> told(const MeshFeatures& f) {
  std::map<int, int> vertices, edges;
  for (std::size_t t = 0; t < f.triangle_flags.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      if (f.triangle_flags[t] >> k & 1u) ++vertices[f.complex.triangles[t][k]];
      if (f.triangle_flags[t] >> (3 + k) & 1u) ++edges[f.complex.triangle_edges[t][k]];
    }
  return {vertices, edges};
}

void expect_each_active_feature_once(const MeshFeatures& f) {
  const auto [vertices, edges] = told(f);
  for (int v = 0; v < int(f.vertex_active.size()); ++v)
    EXPECT_EQ(vertices.contains(v) ? vertices.at(v) : 0, int(f.vertex_active[v])) << v;
  for (int e = 0; e < int(f.edge_class.size()); ++e)
    EXPECT_EQ(edges.contains(e) ? edges.at(e) : 0, int(is_active(f.edge_class[e]))) << e;
}

int vertex_at(const MeshFeatures& f, const Vec3& x) {
  const auto& all = f.complex.vertices;
  return int(std::find(all.begin(), all.end(), x) - all.begin());
}

SimplicialComplex turned_inside_out(const SimplicialComplex& mesh) {
  Triangles triangles = mesh.triangles.to_vector();
  for (auto& t : triangles) std::swap(t[0], t[1]);
  return make_complex(mesh.vertices, triangles);
}

// A square pyramid of height 1 over [-1, 1]^2 with a groove from the apex down the middle of its side y < 0.
SimplicialComplex grooved_pyramid() {
  const std::vector<Vec3> v = {{-1, -1, 0}, {-0.2, -1, 0}, {0, -0.4, 0}, {0.2, -1, 0},
                               {1, -1, 0},  {1, 1, 0},     {-1, 1, 0},   {0, 0, 1}};
  return make_complex(v, {{0, 1, 7},
                          {1, 2, 7},
                          {2, 3, 7},
                          {3, 4, 7},
                          {4, 5, 7},
                          {5, 6, 7},
                          {6, 0, 7},
                          {0, 2, 1},
                          {0, 6, 2},
                          {2, 6, 5},
                          {2, 5, 4},
                          {2, 4, 3}});
}

// A sphere whose vertices move along their rays by up to `bumps` of the radius: pits, saddles and tips.
SimplicialComplex bumpy_sphere(Random& random, int subdivisions, double bumps) {
  const SimplicialComplex sphere = make_sphere(1, subdivisions);
  std::vector<Vec3> vertices = sphere.vertices.to_vector();
  for (Vec3& x : vertices) x *= 1 + random.uniform(-bumps, bumps);
  return make_complex(vertices, sphere.triangles, {}, true);
}

TEST(MeshFeatures, T_1_1_OfACubeStandInOneTriangleEach) {
  const SimplicialComplex cube = make_box(1, 1, 1);
  for (const VertexRule rule : kRules) {
    const MeshFeatures f = features(cube, rule);
    EXPECT_EQ(f.edge_class.size(), 18u);
    EXPECT_EQ(count(f, EdgeClass::convex), 12);
    EXPECT_EQ(count(f, EdgeClass::interior), 6);
    EXPECT_EQ(edge_bits(f), 12);
    EXPECT_EQ(vertex_bits(f), 8);
    expect_each_active_feature_once(f);
    EXPECT_EQ(f.cells.both, 8);
    for (std::size_t e = 0; e < f.edge_class.size(); ++e)
      EXPECT_NEAR(f.edge_bend[e], f.edge_class[e] == EdgeClass::convex ? kPi / 2 : 0, 1e-15);
  }
  const MeshFeatures paper = features(cube, VertexRule::paper_exact);
  EXPECT_EQ(edge_bits(paper), 12);
  EXPECT_GT(vertex_bits(paper), 8);  // against the paper's own "in one of the triangles"
  EXPECT_LE(vertex_bits(paper), 24);
}

TEST(MeshFeatures, T_1_2_OfARoomAreNone) {
  for (const VertexRule rule : kRules) {
    const MeshFeatures f = features(turned_inside_out(make_box(1, 1, 1)), rule);
    EXPECT_EQ(edge_bits(f) + vertex_bits(f), 0);
    EXPECT_EQ(count(f, EdgeClass::concave), 12);
    EXPECT_EQ(std::count(f.vertex_class.begin(), f.vertex_class.end(), VertexClass::concave), 8);
  }
}

TEST(MeshFeatures, T_1_3_OfAFlatGridAreItsBorder) {
  constexpr int kCells = 7;
  const SimplicialComplex grid = make_plate(1, 1, kCells, kCells);
  const MeshFeatures cone = features(grid), paper = features(grid, VertexRule::moravanszky_terdiman);
  for (const MeshFeatures* f : {&cone, &paper}) {
    EXPECT_EQ(edge_bits(*f), 4 * kCells);
    EXPECT_EQ(count(*f, EdgeClass::boundary), 4 * kCells);
    expect_each_active_feature_once(*f);
  }
  EXPECT_EQ(vertex_bits(cone), 4);
  EXPECT_EQ(vertex_bits(paper), 4 * kCells);
  EXPECT_EQ(cone.cells.both, 4);
  EXPECT_EQ(cone.cells.only_moravanszky_terdiman, 4 * kCells - 4);
  EXPECT_EQ(cone.cells.neither, (kCells - 1) * (kCells - 1));
}

TEST(MeshFeatures, T_1_4_OfAStepAreNotAtTheEndsOfItsCrease) {
  const SimplicialComplex step = make_extrusion({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 1);
  for (const VertexRule rule : kRules) {
    const MeshFeatures f = features(step, rule);
    EXPECT_EQ(count(f, EdgeClass::concave), 1);
    for (const double z : {-0.5, 0.5}) {
      const int v = vertex_at(f, {1, 1, z});
      EXPECT_FALSE(f.vertex_active.at(std::size_t(v)));
      EXPECT_EQ(f.vertex_class[v], VertexClass::concave);
    }
    EXPECT_EQ(vertex_bits(f), 10);
    expect_each_active_feature_once(f);
  }
}

TEST(MeshFeatures, T_1_5_OfAGroovedPyramidHaveAnApexByTangentConesOnly) {
  const SimplicialComplex pyramid = grooved_pyramid();
  ASSERT_TRUE(is_closed_oriented(pyramid) && signed_volume(pyramid) > 0);
  const MeshFeatures cone = features(pyramid), paper = features(pyramid, VertexRule::moravanszky_terdiman);
  EXPECT_TRUE(cone.vertex_active[7]);
  EXPECT_FALSE(paper.vertex_active[7]);
  EXPECT_EQ(cone.vertex_class[7], VertexClass::saddle_apex);
  EXPECT_EQ(cone.cells.only_tangent_cone, 1);
  expect_each_active_feature_once(cone);
}

TEST(MeshFeatures, T_1_6_OfASubdividedEdgeRepeatByThePaperOnly) {
  const MeshFeatures f = features(make_box(1, 1, 1, 2));
  EXPECT_EQ(f.cells.both, 8);
  EXPECT_EQ(f.cells.only_moravanszky_terdiman, 12);  // the middles of the edges
  EXPECT_EQ(f.cells.only_tangent_cone, 0);
  EXPECT_EQ(vertex_bits(features(make_box(1, 1, 1, 2), VertexRule::moravanszky_terdiman)), 20);
}

TEST(MeshFeatures, T_1_7_OfThreeTrianglesOnAnEdgeAreActiveOnce) {
  const std::vector<Vec3> v = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}};
  for (const VertexRule rule : kRules) {
    const MeshFeatures f = features(make_complex(v, {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}}), rule);
    EXPECT_EQ(count(f, EdgeClass::nonmanifold), 1);
    EXPECT_EQ(count(f, EdgeClass::boundary), 6);
    expect_each_active_feature_once(f);
  }
  // Two triangles that run through their edge in one direction are no surface either.
  const MeshFeatures twisted = features(make_complex(v, {{0, 1, 2}, {0, 1, 3}}));
  EXPECT_EQ(count(twisted, EdgeClass::nonmanifold), 1);
}

TEST(MeshFeatures, T_1_8_OfATJunctionAreBoundariesOnBothSides) {
  const std::vector<Vec3> v = {{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, 0, 0}, {1, -1, 0}};
  const MeshFeatures f = features(make_complex(v, {{0, 1, 2}, {0, 4, 3}, {3, 4, 1}}));
  EXPECT_EQ(count(f, EdgeClass::interior), 1);  // between the two small triangles
  EXPECT_EQ(count(f, EdgeClass::boundary), 7);  // the long one and both its halves are
  EXPECT_EQ(edge_bits(f), 7);
}

TEST(MeshFeatures, T_1_9_OfTwoTrianglesBackToBackAreActive) {
  const std::vector<Vec3> v = {{0, 0, 0.1}, {1, 0.3, 0}, {0.2, 1, 0.5}};
  for (const VertexRule rule : kRules) {
    const MeshFeatures f = features(make_complex(v, {{0, 1, 2}, {0, 2, 1}}), rule);
    EXPECT_EQ(count(f, EdgeClass::convex), 3);
    EXPECT_EQ(edge_bits(f), 3);
    EXPECT_EQ(vertex_bits(f), 3);
  }
}

// Classes by place, for comparison across renumbering.
using Classes = std::map<std::array<int, 2>, int>;
Classes classes(const MeshFeatures& f, const std::vector<int>& name) {
  Classes out;
  for (std::size_t e = 0; e < f.edge_class.size(); ++e) {
    const int a = name[f.complex.edges[e][0]], b = name[f.complex.edges[e][1]];
    out[{std::min(a, b), std::max(a, b)}] = int(f.edge_class[e]);
  }
  for (std::size_t v = 0; v < f.vertex_class.size(); ++v)
    out[{name[v], -1}] = 2 * int(f.vertex_class[v]) + f.vertex_active[v];
  return out;
}

TEST(MeshFeatures, T_1_10_DoNotDependOnOrderPoseOrScale) {
  std::set<int> seen;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    Random random(seed);
    const SimplicialComplex mesh = bumpy_sphere(random, int(seed % 2), 0.25);
    const int n = int(mesh.vertices.size());
    std::vector<int> same(static_cast<std::size_t>(n)), place = same;  // of vertex i in the copy
    for (int i = 0; i < n; ++i) same[i] = place[i] = i;
    for (int i = n - 1; i > 0; --i) std::swap(place[i], place[random.index(i + 1)]);

    const SE3 g = random.pose(1);
    const double scale = random.log_uniform(1e-3, 1e3);
    std::vector<Vec3> vertices(mesh.vertices.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) vertices[place[i]] = scale * (g * mesh.vertices[i]);
    Triangles triangles = mesh.triangles.to_vector();
    for (auto& t : triangles) {
      for (int& v : t) v = place[v];
      std::rotate(t.begin(), t.begin() + random.index(3), t.end());
    }
    for (int i = int(triangles.size()) - 1; i > 0; --i)
      std::swap(triangles[i], triangles[random.index(i + 1)]);
    std::vector<int> name(same.size());
    for (std::size_t i = 0; i < name.size(); ++i) name[place[i]] = int(i);

    const Classes before = classes(features(mesh), same);
    ASSERT_EQ(classes(features(make_complex(vertices, triangles)), name), before) << "seed " << seed;
    for (const auto& [where, c] : before) seen.insert(where[1] < 0 ? 100 + c : c);
  }
  for (const EdgeClass c : {EdgeClass::convex, EdgeClass::concave})
    EXPECT_TRUE(seen.contains(int(c))) << "the sample has no " << int(c);
  for (const auto& [c, active] : {std::pair{VertexClass::concave, 0}, std::pair{VertexClass::saddle_apex, 1},
                                  std::pair{VertexClass::convex, 1}})
    EXPECT_TRUE(seen.contains(100 + 2 * int(c) + active)) << "the sample has no vertex " << int(c);
}

TEST(MeshFeatures, T_1_11_OfASphereAreAllItsEdgesAndVertices) {
  const SimplicialComplex sphere = make_sphere(1, 4);
  const MeshFeatures f = features(sphere);
  EXPECT_EQ(count(f, EdgeClass::convex), int(sphere.edges.size()));
  EXPECT_EQ(f.cells.both, int(sphere.vertices.size()));
}

// Solid angle of the mesh seen from x, in full turns: 1 inside, 0 outside [van Oosterom and Strackee 1983].
double winding(const SimplicialComplex& k, const Vec3& x) {
  double sum = 0;
  for (const auto& t : k.triangles) {
    const Vec3 a = k.vertices[t[0]] - x, b = k.vertices[t[1]] - x, c = k.vertices[t[2]] - x;
    sum += std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                             b.dot(c) * a.norm() + c.dot(a) * b.norm());
  }
  return sum / (2 * kPi);
}

// How many of `n` directions lie in the polar of the tangent cone at v, found by distances: the point a
// little out is outside and nearer to v than to any point of the edges and faces there.
int sampled_polar(const SimplicialComplex& k, int v, int n, Random& random) {
  const Vec3& x = k.vertices[v];
  int inside_polar = 0;
  for (int i = 0; i < n; ++i) {
    const Vec3 d = random.direction();
    bool nearest = true;
    for (const int t : k.vertex_triangles[v]) {
      for (const int w : k.triangles[t])
        if (w != v) nearest = nearest && d.dot(k.vertices[w] - x) <= 0;
      if (!nearest) break;
    }
    if (nearest && winding(k, x + 1e-6 * d) < 0.5) ++inside_polar;
  }
  return inside_polar;
}

TEST(MeshFeatures, T_1_11_OfATorusAreThoseThatSamplingFinds) {
  const SimplicialComplex torus = make_torus(2, 0.7, 24, 16);
  const MeshFeatures f = features(torus);
  Random random(11);
  int active = 0, inactive = 0;
  for (int v = 0; v < int(torus.vertices.size()); v += 5) {  // all places round the tube
    const int found = sampled_polar(torus, v, 10000, random);
    if (f.vertex_active[v]) {
      EXPECT_GT(found, 0) << v;
    } else {
      EXPECT_EQ(found, 0) << v;
    }
    (f.vertex_active[v] ? active : inactive) += 1;
  }
  EXPECT_GT(active, 10);
  EXPECT_GT(inactive, 10);
  RecordProperty("active_by_tangent_cones", f.cells.both + f.cells.only_tangent_cone);
  RecordProperty("active_by_the_paper", f.cells.both + f.cells.only_moravanszky_terdiman);
  EXPECT_EQ(f.cells.both + f.cells.neither + f.cells.only_moravanszky_terdiman + f.cells.only_tangent_cone,
            int(torus.vertices.size()));
}

// Distance of x from the interior of a simplex, its relative interior up to rounding; kInf if the foot is not
// on it.
double interior_distance(const std::vector<Vec3>& s, const Vec3& x) {
  if (s.size() == 1) return (x - s[0]).norm();
  if (s.size() == 2) {
    const Vec3 d = s[1] - s[0];
    const double along = d.dot(x - s[0]) / d.squaredNorm();
    return along < 0 || along > 1 ? kInf : (x - s[0] - along * d).norm();
  }
  const Vec3 n = (s[1] - s[0]).cross(s[2] - s[0]).normalized();
  for (std::size_t k = 0; k < 3; ++k)
    if (n.cross(s[(k + 1) % 3] - s[k]).dot(x - s[k]) < -1e-12) return kInf;
  return std::abs(n.dot(x - s[0]));
}

TEST(MeshFeatures, T_1_12_AreEnoughForEveryDistance) {
  int concave = 0;
  for (unsigned seed = 0; seed < 100; ++seed) {
    Random random(seed);
    const MeshFeatures f = find_mesh_features(bumpy_sphere(random, 1, 0.3), {.flat_angle = 1e-6});
    const SimplicialComplex& k = f.complex;
    const auto at = [&](int v) { return k.vertices[v]; };
    concave += count(f, EdgeClass::concave);
    for (int pose = 0; pose < 100; ++pose) {
      const auto& t = k.triangles[random.index(int(k.triangles.size()))];
      const double a = random.uniform(), b = random.uniform(0, 1 - a);
      const Vec3 x = (at(t[0]) + a * (at(t[1]) - at(t[0])) + b * (at(t[2]) - at(t[0]))) *
                     (1 + random.log_uniform(1e-3, 1));  // outside: the mesh is a star
      double all = kInf, active = kInf, on_concave = kInf;
      for (int i = 0; i < int(k.vertices.size()); ++i) {
        const double d = interior_distance({at(i)}, x);
        all = std::min(all, d);
        if (f.vertex_active[i]) active = std::min(active, d);
        if (f.vertex_class[i] == VertexClass::concave) on_concave = std::min(on_concave, d);
      }
      for (std::size_t e = 0; e < k.edges.size(); ++e) {
        const double d = interior_distance({at(k.edges[e][0]), at(k.edges[e][1])}, x);
        all = std::min(all, d);
        if (is_active(f.edge_class[e])) active = std::min(active, d);
        if (f.edge_class[e] == EdgeClass::concave) on_concave = std::min(on_concave, d);
      }
      for (const auto& c : k.triangles) {
        const double d = interior_distance({at(c[0]), at(c[1]), at(c[2])}, x);
        all = std::min(all, d);
        active = std::min(active, d);
      }
      ASSERT_NEAR(active, all, 1e-12) << "seed " << seed << ", pose " << pose;
      ASSERT_GT(on_concave, all) << "seed " << seed << ", pose " << pose;
    }
  }
  EXPECT_GT(concave, 1000) << "the sample is not what it should be";
}

TEST(MeshFeatures, T_1_13_OfATerrainSaveThreeQuartersOfTheEdgeTests) {
  SimplicialComplex plate = make_plate(1, 1, 224, 224);
  Random random(13);
  change_each(plate.vertices, [&](Vec3& x) { x.z() = random.uniform(0, 2e-3); });
  const MeshFeatures f = features(plate);
  const double all = 3.0 * double(f.complex.triangles.size());
  EXPECT_GT(f.complex.triangles.size(), 100000u);
  EXPECT_NEAR(edge_bits(f) / all, 0.25, 0.02);
}

// What contact determination keeps of a mesh in which idealisation joins nothing.
TEST(MeshFeatures, AreTheCornersAndCreasesOfContactDetermination) {
  int vertices = 0, edges = 0, saddles = 0;
  for (unsigned seed = 0; seed < 30; ++seed) {
    Random random(seed);
    const SimplicialComplex mesh = bumpy_sphere(random, 2, 0.2);
    const MeshFeatures f = find_mesh_features(mesh, {.flat_angle = 0});
    const LmdShape shape = prepare({.complex = mesh, .radius = 1e-4});
    ASSERT_EQ(shape.regions.size(), mesh.triangles.size()) << "idealisation joined something";
    std::set<int> corners, active;
    std::set<std::array<int, 2>> creases, active_edges;
    for (const VertexLeaf& leaf : shape.vertices) corners.insert(leaf.vertex);
    for (const EdgeLeaf& leaf : shape.edges)
      creases.insert({std::min(leaf.first, leaf.last), std::max(leaf.first, leaf.last)});
    for (int v = 0; v < int(f.vertex_active.size()); ++v) {
      if (f.vertex_active[v]) active.insert(v);
      saddles += f.vertex_class[v] == VertexClass::saddle_apex;
    }
    for (std::size_t e = 0; e < f.edge_class.size(); ++e)
      if (is_active(f.edge_class[e])) active_edges.insert(f.complex.edges[e]);
    EXPECT_EQ(corners, active) << "seed " << seed;
    EXPECT_EQ(creases, active_edges) << "seed " << seed;
    vertices += int(active.size()), edges += int(active_edges.size());
  }
  EXPECT_GT(vertices, 500);
  EXPECT_GT(edges, 2000);
  EXPECT_GT(saddles, 100);
}

TEST(MeshFeatures, CountWhatTheyWeldAndLeaveOut) {
  const std::vector<Vec3> v = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0, 0}};
  const MeshFeatures f = features(make_complex(v, {{0, 1, 2}, {3, 4, 5}, {0, 6, 1}, {0, 3, 1}}));
  EXPECT_EQ(f.welded_vertices, 2);
  EXPECT_EQ(f.removed_triangles, 2);  // one without area, one whose corners became one
  EXPECT_EQ(f.complex.triangles.size(), 2u);
  EXPECT_EQ(count(f, EdgeClass::interior), 1);
  EXPECT_EQ(f.vertex_of[3], f.vertex_of[1]);
  EXPECT_EQ(f.vertex_class[f.vertex_of[6]], VertexClass::unused);
}

// A cube with what meshes have wrong: everything that is a cube's own keeps its class.
TEST(MeshFeatures, OfADamagedCubeAreThoseOfTheCube) {
  const SimplicialComplex cube = make_box(1, 1, 1);
  const auto expect_cube = [](const MeshFeatures& f) {
    EXPECT_EQ(count(f, EdgeClass::convex), 12);
    EXPECT_EQ(count(f, EdgeClass::interior), 6);
    EXPECT_EQ(edge_bits(f), 12);
    EXPECT_EQ(vertex_bits(f), 8);
    expect_each_active_feature_once(f);
  };
  std::vector<Vec3> v = cube.vertices.to_vector();
  const int n = int(v.size());
  {  // a soup: every triangle has corners of its own
    std::vector<Vec3> corners;
    Triangles triangles;
    for (const auto& t : cube.triangles) {
      triangles.push_back({int(corners.size()), int(corners.size()) + 1, int(corners.size()) + 2});
      for (const int i : t) corners.push_back(v[i]);
    }
    const MeshFeatures f = features(make_complex(corners, triangles));
    expect_cube(f);
    EXPECT_EQ(f.welded_vertices, 28);
  }
  {  // a triangle without area along an edge of the cube, and one of a single place
    std::vector<Vec3> more = v;
    const auto& e = cube.triangles[0];
    more.push_back((v[e[0]] + v[e[1]]) / 2);
    more.push_back(v[e[0]]);
    Triangles triangles = cube.triangles.to_vector();
    triangles.push_back({e[0], n, e[1]});
    triangles.push_back({e[0], n + 1, e[1]});
    const MeshFeatures f = features(make_complex(more, triangles));
    expect_cube(f);
    EXPECT_EQ(f.removed_triangles, 2);
    EXPECT_EQ(f.vertex_class[f.vertex_of[n]], VertexClass::unused);
  }
  {  // a vertex of no triangle
    std::vector<Vec3> more = v;
    more.push_back({3, 3, 3});
    const MeshFeatures f = features(make_complex(more, cube.triangles));
    expect_cube(f);
    EXPECT_EQ(f.vertex_class[f.vertex_of[n]], VertexClass::unused);
    EXPECT_FALSE(f.vertex_active[f.vertex_of[n]]);
  }
}

// A fin on one edge of the cube: that edge is nonmanifold, its own two are boundaries, all are active once.
TEST(MeshFeatures, OfAFinnedCubeHaveOneNonManifoldEdge) {
  const SimplicialComplex cube = make_box(1, 1, 1);
  std::vector<Vec3> v = cube.vertices.to_vector();
  v.push_back({2, 2, 2});
  int corner = 0;  // (1, 1, 1) / 2 and the one below
  while ((v[corner] - Vec3(0.5, 0.5, 0.5)).norm() > 1e-12) ++corner;
  int below = 0;
  while ((v[below] - Vec3(0.5, 0.5, -0.5)).norm() > 1e-12) ++below;
  Triangles triangles = cube.triangles.to_vector();
  triangles.push_back({corner, below, int(v.size()) - 1});
  const MeshFeatures f = features(make_complex(v, triangles));
  EXPECT_EQ(count(f, EdgeClass::nonmanifold), 1);
  EXPECT_EQ(count(f, EdgeClass::boundary), 2);
  EXPECT_EQ(count(f, EdgeClass::convex), 11);
  expect_each_active_feature_once(f);
  EXPECT_EQ(f.vertex_class[vertex_at(f, v[corner])], VertexClass::nonmanifold);
}

TEST(MeshFeatures, RefuseWhatIsNoNumber) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    SimplicialComplex mesh = make_box(1, 1, 1);
    change(mesh.vertices, [&](auto& all) { all[5].y() = bad; });
    const std::string message = message_of([&] { features(mesh); });
    EXPECT_NE(message.find("SimplicialComplex::vertices[5] = "), std::string::npos) << message;
    EXPECT_NE(message.find("must be finite"), std::string::npos) << message;
    EXPECT_NE(message_of([&] { make_complex(mesh.vertices, mesh.triangles); }).find("vertex 5"),
              std::string::npos);
  }
}

TEST(MeshFeatures, RefuseBadAngles) {
  EXPECT_EQ(message_of([] { find_mesh_features(make_box(1, 1, 1), {.flat_angle = -1}); }),
            "MeshFeatureOptions::flat_angle = -1 must lie in [0, 1.5708) rad");
  EXPECT_TRUE(find_mesh_features(SimplicialComplex{}).triangle_flags.empty());
}

// Of a cube: the corner's octant is kept, what points beside it goes to the nearest of its edges and faces.
TEST(AdmissibleNormal, OfACubesCornerLiesInItsOctant) {
  const MeshFeatures f = features(make_box(2, 2, 2));
  const int corner = vertex_at(f, {1, 1, 1});
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 n = random.direction();
    const Vec3 expected = n.cwiseMax(0);
    const Vec3 got = admissible_normal(f, 0, corner, n);
    EXPECT_NEAR(got.norm(), 1, 1e-12);
    if (expected.norm() > 0.01)
      EXPECT_LT((got - expected.normalized()).norm(), 1e-9) << n.transpose();
    else
      EXPECT_GE(got.minCoeff(), -1e-12);
  }
}

TEST(AdmissibleNormal, OfEdgesIsInTheFanOrOneOfTheFaces) {
  const SimplicialComplex step = make_extrusion({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}, 1);
  const MeshFeatures f = features(step);
  Random random(4);
  int fans = 0;
  for (int e = 0; e < int(f.edge_class.size()); ++e) {
    const auto t = f.complex.edge_triangles[e];
    const Vec3 a = admissible_normal(f, 2, t[0], Vec3::UnitZ()),
               b = admissible_normal(f, 2, t[1], Vec3::UnitZ());
    for (int i = 0; i < 20; ++i) {
      const Vec3 n = random.direction();
      const Vec3 got = admissible_normal(f, 1, e, n);
      if (f.edge_class[e] != EdgeClass::convex) {
        EXPECT_EQ(got, b.dot(n) > a.dot(n) ? b : a);
        continue;
      }
      Vec3 best = b.dot(n) > a.dot(n) ? b : a;  // by scanning the fan
      for (int s = 0; s <= 1000; ++s) {
        const Vec3 in_fan = (a + s / 1000.0 * (b - a)).normalized();
        if (in_fan.dot(n) > best.dot(n)) best = in_fan;
      }
      if (best.dot(n) < 0.01) continue;  // nothing of the fan is near
      EXPECT_NEAR(got.dot(n), best.dot(n), 1e-6);
      ++fans;
    }
  }
  EXPECT_GT(fans, 100);
}

// In a pit, on a flat patch or at the end of a crease only the faces are left.
TEST(AdmissibleNormal, OfAnInactiveVertexIsOneOfItsFaces) {
  const MeshFeatures room = features(turned_inside_out(make_box(2, 2, 2)));
  const Vec3 n = Vec3(-0.3, -0.8, -0.2).normalized();
  EXPECT_EQ(admissible_normal(room, 0, vertex_at(room, {1, 1, 1}), n), -Vec3::UnitY());
  EXPECT_NE(message_of([&] { admissible_normal(room, 0, 8, n); }).find("simplex = 8"), std::string::npos);
  EXPECT_NE(message_of([&] { admissible_normal(room, 0, 0, 2 * n); }).find("unit length"), std::string::npos);
}

}  // namespace
}  // namespace aussois
