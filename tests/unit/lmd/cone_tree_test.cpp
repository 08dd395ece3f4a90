// SPDX-License-Identifier: Apache-2.0
// The invariants of the hierarchy (LMD-9), read from the floats as they are stored, and what stands in it.
#include "lmd/cone_tree.hpp"

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <functional>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/fastener.hpp"
#include "io/mesh_file.hpp"
#include "lmd/leaf.hpp"
#include "tests/support/random_pair.hpp"

namespace aussois {
namespace {

/// What must lie inside: points in the ball and the box, directions in the cap.
struct Content {
  std::vector<Vec3> points{};      // [m]
  std::vector<Vec3> directions{};  // unit
};
using ContentOf = std::function<Content(std::size_t simplex)>;

constexpr double kCapRounding = 1e-6;  // of single precision [rad]

class TreeCheck {
 public:
  TreeCheck(const ConeTree& tree, const Vec3& centre, const ContentOf& content_of, std::size_t simplices)
      : tree_(tree), centre_(centre), content_of_(content_of), seen_(simplices) {
    if (!tree.nodes.empty()) check_node(0, 0);
    EXPECT_EQ(nodes_, tree.nodes.size());
    EXPECT_TRUE(std::ranges::all_of(seen_, [](int n) { return n == 1; })) << "each simplex in one bucket";
    EXPECT_EQ(outside_ball_, 0);
    EXPECT_EQ(outside_box_, 0);
    EXPECT_EQ(outside_cap_, 0);
  }

 private:
  // Returns the simplices below the node.
  std::size_t check_node(std::size_t i, int depth) {
    ++nodes_;
    EXPECT_LT(depth, 32);
    const ConeNode& node = tree_.nodes[i];
    std::vector<std::size_t> size;
    std::size_t below = 0;
    for (int lane = 0; lane < 4; ++lane) {
      if (node.r[lane] < 0) {  // not there
        EXPECT_EQ(node.r[lane], -1);
        EXPECT_EQ(node.count[lane], 0U);
        continue;
      }
      EXPECT_EQ(size.size(), std::size_t(lane)) << "a lane in use after one that is not";
      path_.emplace_back(i, lane);
      size.push_back(node.count[lane] > 0 ? check_bucket(node.child[lane], node.count[lane])
                                          : check_node(node.child[lane], depth + 1));
      path_.pop_back();
      below += size.back();
    }
    EXPECT_GE(size.size(), depth == 0 ? 1U : 2U);
    std::size_t full = kBucket;  // four to the power of the levels below, times a bucket
    while (full < *std::ranges::max_element(size)) full *= 4;
    for (std::size_t lane = 0; lane + 1 < size.size(); ++lane) EXPECT_EQ(size[lane], full);
    return below;
  }

  std::size_t check_bucket(std::size_t first, std::size_t count) {
    EXPECT_LE(count, std::size_t(kBucket));
    for (std::size_t s = first; s < first + count; ++s) {
      ++seen_.at(s);
      const Content content = content_of_(s);
      for (const auto& [node, lane] : path_) check_inside(tree_.nodes[node], lane, content);
    }
    return count;
  }

  void check_inside(const ConeNode& node, int lane, const Content& content) {
    const auto at = [lane](const float(&v)[3][4]) { return Vec3(v[0][lane], v[1][lane], v[2][lane]); };
    const Vec3 c = at(node.c) + centre_;
    const Vec3 axes[3] = {at(node.u[0]), at(node.u[1]), at(node.u[0]).cross(at(node.u[1]))};
    for (const Vec3& x : content.points) {
      outside_ball_ += !((x - c).norm() <= double(node.r[lane]));
      for (int k = 0; k < 3; ++k) outside_box_ += !(std::abs(axes[k].dot(x - c)) <= double(node.h[k][lane]));
    }
    if (node.cos[lane] == -1 && node.sin[lane] == 0) return;  // any direction
    const Vec3 axis = at(node.axis);
    const double half_angle = std::atan2(double(node.sin[lane]), double(node.cos[lane]));
    for (const Vec3& n : content.directions)
      outside_cap_ += !(std::atan2(axis.cross(n).norm(), axis.dot(n)) <= half_angle + kCapRounding);
  }

  const ConeTree& tree_;
  Vec3 centre_;
  const ContentOf& content_of_;
  std::vector<int> seen_;
  std::vector<std::pair<std::size_t, int>> path_{};  // nodes and lanes above
  std::size_t nodes_ = 0;
  long outside_ball_ = 0, outside_box_ = 0, outside_cap_ = 0;
};

// Directions of the normal cone of a corner: where two planes of its rays meet, and random ones (LMD-2).
std::vector<Vec3> normals_of_corner(const Leaf& leaf, Random& random) {
  std::vector<Vec3> normals;
  const auto add_if_normal = [&](const Vec3& n) {
    if (std::ranges::all_of(leaf.rays, [&](const Vec3& g) { return g.dot(n) <= 1e-9; })) normals.push_back(n);
  };
  for (std::size_t i = 0; i < leaf.rays.size() && leaf.rays.size() <= 30; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const Vec3 n = leaf.rays[i].cross(leaf.rays[j]);
      if (n.norm() < 1e-3) continue;  // its direction would not be known to 1e-9
      add_if_normal(n.normalized());
      add_if_normal(-n.normalized());
    }
  for (int i = 0; i < 8; ++i) add_if_normal(random.direction());
  Vec3 mean = Vec3::Zero();  // towards it, away from the border of N by more than rounding
  for (const Vec3& n : normals) mean += n;
  std::vector<Vec3> inside;
  for (const Vec3& n : normals) {
    const Vec3 m = (0.99 * n + 0.01 * mean.normalized()).normalized();
    if (std::ranges::all_of(leaf.rays, [&](const Vec3& g) { return g.dot(m) <= -1e-9; })) inside.push_back(m);
  }
  return inside;
}

std::vector<Vec3> normals_of_chain(const Leaf& leaf, Random& random) {
  std::vector<Vec3> normals;
  const std::span<const Vec3> conormals{leaf.conormals.data(), leaf.conormal_count};
  const auto add_if_normal = [&](const Vec3& n) {
    if (std::ranges::all_of(conormals, [&](const Vec3& g) { return g.dot(n) <= 1e-9; })) normals.push_back(n);
  };
  for (const Vec3& g : conormals) {
    add_if_normal(leaf.direction.cross(g).normalized());
    add_if_normal(-leaf.direction.cross(g).normalized());
  }
  for (int i = 0; i < 8; ++i) add_if_normal(leaf.direction.cross(random.direction()).normalized());
  return normals;
}

Content content_of(const LmdShape& shape, LeafId id, Random& random) {
  const Leaf leaf = leaf_of(shape, id);
  Content content;
  for (int k = 0; k <= leaf.dim; ++k) content.points.push_back(leaf.x[k]);
  if (leaf.dim == 0) content.directions = normals_of_corner(leaf, random);
  if (leaf.dim == 1) content.directions = normals_of_chain(leaf, random);
  if (leaf.dim == 2) content.directions = {leaf.direction};
  return content;
}

void check_shape(const LmdShape& shape) {
  Random random(1);
  const auto leaves = [&](int dim, int first) -> ContentOf {
    return [&shape, &random, dim, first](std::size_t i) {
      return content_of(shape, {.index = first + int(i), .dim = std::int8_t(dim)}, random);
    };
  };
  const auto check = [&](const char* name, const ConeTree& tree, const ContentOf& content,
                         std::size_t count) {
    SCOPED_TRACE(name);
    const TreeCheck checked(tree, shape.centre, content, count);
  };
  const int narrow_v = shape.narrow_vertices, narrow_e = shape.narrow_edges;
  check("corners", shape.vertex_tree, leaves(0, 0), std::size_t(narrow_v));
  check("wide vertices", shape.wide_vertex_tree, leaves(0, narrow_v),
        shape.vertices.size() - std::size_t(narrow_v));
  check("creases", shape.edge_tree, leaves(1, 0), std::size_t(narrow_e));
  check("wide edges", shape.wide_edge_tree, leaves(1, narrow_e), shape.edges.size() - std::size_t(narrow_e));
  check("faces", shape.face_tree, leaves(2, 0), shape.faces.size());
  const ContentOf rest = [&shape](std::size_t i) {
    Content content;
    const BaseSimplex& simplex = shape.rest[i];
    for (std::size_t k = 0; k <= std::size_t(simplex.dim); ++k)
      content.points.push_back(shape.complex.vertices[simplex.vertex[k]]);
    return content;
  };
  check("rest", shape.rest_tree, rest, shape.rest.size());
  for (std::size_t i = 0; i < shape.vertices.size(); ++i)
    EXPECT_EQ(class_of(shape.vertices[i]), int(i) < narrow_v ? SimplexClass::v_corner : SimplexClass::v_wide);
  for (std::size_t i = 0; i < shape.edges.size(); ++i)
    EXPECT_EQ(class_of(shape.edges[i]), int(i) < narrow_e ? SimplexClass::e_crease : SimplexClass::e_wide);
}

class ConeTrees : public ::testing::TestWithParam<unsigned> {};

// Question 9 of doc/theory/lmd.md: after rounding to float, far from the origin too, at sizes of a micrometre
// and a kilometre.
TEST_P(ConeTrees, HoldEveryLeafOfRandomComplexes) {
  Random random(GetParam());
  const double size = random.log_uniform(1e-6, 1e3);
  const SE3 g = random.pose(GetParam() % 3 == 0 ? 1000 * size : size);
  SCOPED_TRACE("seed " + std::to_string(GetParam()));
  check_shape(prepare(dilate(transformed_complex(random_shape(random), g, size), 0.01 * size)));
}

// Points, segments and triangles with caps of any half angle, heaps of equal ones among them.
TEST_P(ConeTrees, HoldRandomItemsInTheirOrder) {
  Random random(GetParam());
  std::vector<ConeTreeItem> items(std::size_t(random.index(GetParam() % 2 == 0 ? 20 : 700)));
  const Vec3 middle = random.vector(100);
  std::vector<Vec3> vertices = {Vec3::Zero()};
  for (ConeTreeItem& item : items) {
    if (random.index(10) == 0) {
      item = items[0];
      continue;
    }
    item.vertex_count = 1 + random.index(3);
    const Vec3 x = middle + random.vector();
    for (std::size_t k = 0; k < std::size_t(item.vertex_count); ++k) {
      item.vertex[k] = int(vertices.size());
      vertices.push_back(x + random.vector(0.05));
    }
    item.axis = random.index(2) == 0 ? random.direction()
                                     : Vec3(0.1 * random.direction() + Vec3::UnitX()).normalized();
    item.half_angle = random.index(5) == 0 ? kPi : random.uniform(0, random.index(2) == 0 ? 0.3 : 1.5);
  }
  std::vector<int> order;
  const ConeTree tree = build_cone_tree(items, vertices, middle, order);
  const ContentOf content_of_item = [&](std::size_t i) {
    const ConeTreeItem& item = items.at(order.at(i));
    Content content;
    for (std::size_t k = 0; k < std::size_t(item.vertex_count); ++k)
      content.points.push_back(vertices[item.vertex[k]]);
    for (int k = 0; k < 8; ++k)  // on the rim of the cap
      content.directions.push_back(
          Eigen::AngleAxisd(item.half_angle, item.axis.cross(random.direction()).normalized()) * item.axis);
    return content;
  };
  SCOPED_TRACE("seed " + std::to_string(GetParam()));
  const TreeCheck checked(tree, middle, content_of_item, items.size());
  std::ranges::sort(order);
  for (std::size_t i = 0; i < items.size(); ++i) EXPECT_EQ(order[i], int(i));
  const ConeTree enclosing = enclosing_cone_tree(items, vertices, middle);
  const TreeCheck checked_too(enclosing, middle, content_of_item, items.size());
  EXPECT_EQ(enclosing.nodes.size(), tree.nodes.size());
  std::size_t most = items.empty() ? 0 : 1;  // nodes if all were full
  for (std::size_t full = 4 * kBucket; full < items.size(); full *= 4)
    most += (items.size() + full - 1) / full;
  EXPECT_LE(tree.nodes.size(), most);
}

INSTANTIATE_TEST_SUITE_P(Seeds, ConeTrees, ::testing::Range(0U, 100U));

TEST(ConeTree, HoldsEveryLeafOfShapesThatDeform) {
  Random random(7);
  for (const SimplicialComplex& complex :
       {make_sphere(0.5, 3), make_plate(1, 1, 12, 12), make_box(1, 0.8, 0.6, 5),
        make_polyline({{-0.6, 0, 0}, {-0.2, 0.1, 0}, {0.3, 0, 0.1}, {0.6, 0.2, 0}, {0.7, 0.2, 0}})}) {
    const LmdShape shape = prepare(dilate(complex, 0.01), {.deforming = true});
    SCOPED_TRACE(std::to_string(complex.vertices.size()) + " vertices");
    check_shape(shape);
    for (const double size : {1e-3, 0.05, 1.0}) {  // the last one crumples it
      SCOPED_TRACE("moved by " + std::to_string(size));
      std::vector<Vec3> there = shape.complex.vertices.to_vector();
      for (Vec3& x : there) x += size * random.vector() + Vec3(0, 0, 100);
      check_shape(refit(shape, there));
    }
  }
}

TEST(ConeTree, HoldsEveryLeafOfABolt) {
  check_shape(prepare(dilate(make_bolt(), 1e-5)));
}

TEST(ConeTree, NodesAreFiveCacheLines) {
  EXPECT_EQ(sizeof(ConeNode), 5U * 64);
  EXPECT_EQ(alignof(ConeNode), 64U);
  std::vector<int> order;
  EXPECT_TRUE(build_cone_tree({}, {}, Vec3::Zero(), order).nodes.empty());
  std::vector<ConeTreeItem> items(16 *
                                  64);  // full lanes at every level: a node per 16, 64, 256 and 1024 items
  Random random(1);
  std::vector<Vec3> vertices;
  for (ConeTreeItem& item : items) {
    item.vertex[0] = int(vertices.size());
    vertices.push_back(random.vector());
  }
  EXPECT_EQ(build_cone_tree(items, vertices, Vec3::Zero(), order).nodes.size(), 64U + 16 + 4 + 1);
}

SimplicialComplex as_in_file(const std::filesystem::path& path) {
  MeshFile mesh = read_mesh(path, 1e-3);
  weld_mesh_file(mesh);
  SimplicialComplex complex = make_complex(std::move(mesh.vertices), std::move(mesh.triangles), mesh.wires);
  complex.solid = is_closed_oriented(complex) && signed_volume(complex) > 0;
  return complex;
}

TEST(ConeTree, HoldsEveryLeafOfTheSharedMeshes) {
  const char* data = std::getenv("AUSSOIS_DATA_DIR");
  if (!data || !*data) GTEST_SKIP() << "AUSSOIS_DATA_DIR names no folder";
  int checked = 0;  // 200 bytes per triangle at most: most are taken by rounded parts, where every edge is a
                    // crease (bearing)
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(data) / "meshes")) {
    if (entry.path().extension() != ".obj") continue;
    SCOPED_TRACE(entry.path().filename().string());
    const LmdShape shape = prepare(dilate(as_in_file(entry.path()), 1e-5));
    check_shape(shape);
    const std::size_t triangles = shape.complex.triangles.size();
    EXPECT_TRUE(triangles < 1000 || search_bytes(shape) <= 200 * triangles) << search_bytes(shape);
    ++checked;
  }
  EXPECT_GT(checked, 50);
}

struct Counts {
  int v_corner = 0, v_wide = 0, e_crease = 0, e_wide = 0, faces = 0, rest = 0;
  bool operator==(const Counts&) const = default;
};

Counts counts_of(const LmdShape& s) {
  return {s.narrow_vertices,   int(s.vertices.size()) - s.narrow_vertices,
          s.narrow_edges,      int(s.edges.size()) - s.narrow_edges,
          int(s.faces.size()), int(s.rest.size())};
}

Counts classes(SimplicialComplex complex) {
  return counts_of(prepare(dilate(std::move(complex), 0.01)));
}

/// A cube with a pyramid cut out of its top, apex down.
SimplicialComplex make_pit() {
  return make_complex({{0, 0, 0},
                       {1, 0, 0},
                       {1, 1, 0},
                       {0, 1, 0},
                       {0, 0, 1},
                       {1, 0, 1},
                       {1, 1, 1},
                       {0, 1, 1},
                       {0.5, 0.5, 0.4}},
                      {{0, 2, 1},
                       {0, 3, 2},
                       {0, 1, 5},
                       {0, 5, 4},
                       {1, 2, 6},
                       {1, 6, 5},
                       {2, 3, 7},
                       {2, 7, 6},
                       {3, 0, 4},
                       {3, 4, 7},
                       {4, 5, 8},
                       {5, 6, 8},
                       {6, 7, 8},
                       {7, 4, 8}},
                      {}, true);
}

TEST(LmdShape, OfNamedShapesHasTheClassesOfTheManual) {
  EXPECT_EQ(classes(make_box(1, 2, 3)), (Counts{.v_corner = 8, .e_crease = 12, .faces = 12}));
  EXPECT_EQ(classes(make_box(1, 2, 3, 3)), (Counts{.v_corner = 8, .e_crease = 12, .faces = 108}));
  // 12 corners and 18 edges; the concave edge and its ends are silent
  EXPECT_EQ(classes(make_l_shape(1)), (Counts{.v_corner = 10, .e_crease = 17, .faces = 20}));
  EXPECT_EQ(classes(make_plate(1, 2, 3, 2)), (Counts{.v_wide = 4, .e_wide = 4, .faces = 12}));
  EXPECT_EQ(classes(make_segment(1)), (Counts{.v_wide = 2, .e_wide = 1, .rest = 1}));
  EXPECT_EQ(classes(make_polyline({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}})),
            (Counts{.v_wide = 2, .e_wide = 1, .rest = 2}));  // straight: the middle is silent
  EXPECT_EQ(classes(make_polyline({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}})),
            (Counts{.v_wide = 3, .e_wide = 2, .rest = 2}));
  EXPECT_EQ(classes(make_point()), (Counts{.v_wide = 1, .rest = 1}));
  // The apex and the four concave edges that lead to it are silent; the rim stays.
  EXPECT_EQ(classes(make_pit()), (Counts{.v_corner = 8, .e_crease = 12, .faces = 14}));
}

TEST(LmdShape, OfATriangleWithoutAreaKeepsItsEdges) {
  const LmdShape shape = prepare(dilate(make_complex({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}), 0.01));
  EXPECT_EQ(shape.flat_triangles, 1);
  EXPECT_TRUE(shape.faces.empty());
  ASSERT_EQ(shape.rest.size(), 1U);
  EXPECT_EQ(shape.rest[0].dim, 2);
}

template <class T>
bool same_bytes(const SharedArray<T>& a, const SharedArray<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

TEST(LmdShape, IsTheSameForAnyNumberOfThreads) {
  for (const SimplicialComplex& complex :
       {make_bolt({}), make_sphere(1, 5), make_plate(1, 1), make_point()}) {
    const LmdShape one = prepare(dilate(complex, 1e-5)),
                   four = prepare(dilate(complex, 1e-5), {.threads = 4});
    for (ConeTree LmdShape::*tree :
         {&LmdShape::vertex_tree, &LmdShape::wide_vertex_tree, &LmdShape::edge_tree,
          &LmdShape::wide_edge_tree, &LmdShape::face_tree, &LmdShape::rest_tree, &LmdShape::unproven_tree})
      EXPECT_TRUE(same_bytes((one.*tree).nodes, (four.*tree).nodes));
    EXPECT_EQ(one.rays, four.rays);
    EXPECT_EQ(one.paths, four.paths);
    EXPECT_EQ(one.faces, four.faces);
    EXPECT_EQ(one.unproven, four.unproven);
    EXPECT_EQ(one.misfits, four.misfits);
    EXPECT_TRUE(
        std::ranges::equal(one.vertices, four.vertices, {}, &VertexLeaf::vertex, &VertexLeaf::vertex));
    EXPECT_TRUE(std::ranges::equal(one.edges, four.edges, {}, &EdgeLeaf::first, &EdgeLeaf::first));
    EXPECT_TRUE(std::ranges::equal(one.edges, four.edges, {}, &EdgeLeaf::last, &EdgeLeaf::last));
  }
}

TEST(LmdShape, OfABoxIsReadInSoManyBytes) {
  const std::size_t mesh = 8 * 24 + 12 * 12, regions = 6 * 32 + 12 * (4 + 1);
  const std::size_t leaves = 8 * (12 + 3 * 24) + 12 * 24 + 12 * 4, trees = 3 * 320;
  EXPECT_EQ(search_bytes(prepare(dilate(make_box(1, 1, 1), 0))), mesh + regions + leaves + trees);
}

}  // namespace
}  // namespace aussois
