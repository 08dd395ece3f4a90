// SPDX-License-Identifier: Apache-2.0
// Shapes whose vertices move: features keep their numbers, contacts are those of a fresh shape, and what is
// certified of two of them holds at all times.
#include <algorithm>

#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "lmd/certificate.hpp"
#include "lmd/find_contacts.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random_pair.hpp"

namespace aussois {
namespace {

LmdShape soft(const SimplicialComplex& complex, double radius) {
  return prepare(dilate(complex, radius), {.deforming = true});
}

std::vector<Vec3> random_field(const LmdShape& shape, Random& random, double size) {
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < shape.complex.vertices.size(); ++i) out.push_back(size * random.vector());
  return out;
}

std::vector<Vec3> moved(const LmdShape& shape, const std::vector<Vec3>& field, double time) {
  std::vector<Vec3> out = shape.complex.vertices.to_vector();
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += time * field[i];
  return out;
}

SimplicialComplex some_complex(int k) {
  return k % 4 == 0   ? make_box(1, 0.8, 0.6, 2)
         : k % 4 == 1 ? make_sphere(0.5, 1)
         : k % 4 == 2 ? make_plate(1, 1, 3, 3)
                      : make_polyline({{-0.6, 0, 0}, {-0.2, 0.1, 0}, {0.3, 0, 0.1}, {0.6, 0.2, 0}});
}

TEST(DeformingShape, KeepsTheNumbersOfItsFeatures) {
  Random random(5);
  for (int k = 0; k < 8; ++k) {
    const LmdShape shape = soft(some_complex(k), 0.01);
    EXPECT_TRUE(shape.deforming);
    const LmdShape there = refit(shape, moved(shape, random_field(shape, random, 0.05), 1));
    EXPECT_TRUE(there.deforming);
    EXPECT_EQ(there.complex.triangles, shape.complex.triangles);
    for (int t = 0; t < int(there.triangle_region.size()); ++t) EXPECT_EQ(there.triangle_region[t], t);
    for (const EdgeLeaf& edge : there.edges) {
      EXPECT_EQ(edge.path_length, 1U);
      const std::array<int, 2> ends = there.complex.edges[edge.path];
      EXPECT_EQ((std::array{edge.first, edge.last}), ends);
    }
  }
  EXPECT_FALSE(prepare(dilate(make_box(1, 1, 1, 2), 0.01)).deforming);
  const LmdShape shape = soft(make_box(1, 1, 1), 0.01);
  EXPECT_EQ(message_of([&] { (void)refit(shape, std::vector<Vec3>(3)); }),
            "refit: number of vertices = 3 must be 8, as the shape has");
}

// Leaves, keys, gaps and normals, to the last bit.
TEST(DeformingShape, HasTheContactsOfAFreshOne) {
  Random random(6);
  const auto fresh = [](const LmdShape& shape) {
    DilatedShape dilated{.complex = shape.complex, .radius = shape.radius};
    return prepare(std::move(dilated), {.deforming = true});
  };
  int contacts = 0;
  for (int k = 0; k < 240; ++k) {
    const LmdShape a0 = soft(some_complex(k), 0.02), b0 = soft(some_complex(k / 4), 0.02);
    const LmdShape a = refit(a0, moved(a0, random_field(a0, random, 0.3), 1)),
                   b = refit(b0, moved(b0, random_field(b0, random, 0.04), 1)), new_a = fresh(a),
                   new_b = fresh(b);
    const SE3 g = random.pose(0.7);
    const LmdOptions options{.threshold = 0.3};
    const ContactSet here = find_contacts({&a, SE3{}, BodyId(0)}, {&b, g, BodyId(1)}, options),
                     there = find_contacts({&new_a, SE3{}, BodyId(0)}, {&new_b, g, BodyId(1)}, options);
    ASSERT_EQ(here.points.size(), there.points.size());
    for (std::size_t i = 0; i < here.points.size(); ++i) {
      const ContactPoint &c = here.points[i], &d = there.points[i];
      EXPECT_EQ(c.a.dim, d.a.dim);
      EXPECT_EQ(c.a.simplex, d.a.simplex);
      EXPECT_EQ(c.b.simplex, d.b.simplex);
      EXPECT_EQ(c.gap, d.gap);
      EXPECT_EQ(c.normal, d.normal);
    }
    contacts += int(here.points.size());
  }
  EXPECT_GT(contacts, 200);
}

// The oracle looks at every pair of leaves; coverage knows the distance of the bases alone.
TEST(DeformingShape, HasTheContactsOfAnExhaustiveSearch) {
  Random random(9);
  int found = 0;
  for (int k = 0; k < 240; ++k) {
    const LmdShape a0 = soft(some_complex(k), 0.02), b0 = soft(some_complex(k / 4), 0.02);
    const LmdShape a = refit(a0, moved(a0, random_field(a0, random, 0.04), 1)),
                   b = refit(b0, moved(b0, random_field(b0, random, 0.04), 1));
    const PosedShape at{&a, random.pose(0.7), 0}, other{&b, random.pose(0.7), 1};
    const LmdOptions options{.threshold = 0.3};
    const ContactSet quick = find_contacts(at, other, options),
                     all = find_contacts_exhaustive(at, other, options);
    ASSERT_EQ(quick.points.size(), all.points.size());
    for (std::size_t i = 0; i < all.points.size(); ++i) {
      EXPECT_EQ(key_of(quick.points[i]), key_of(all.points[i]));
      EXPECT_EQ(quick.points[i].gap, all.points[i].gap);
      for (const Feature* f : {&quick.points[i].a, &quick.points[i].b}) EXPECT_EQ(f->region, f->simplex);
    }
    found += int(all.points.size());
  }
  EXPECT_GT(found, 100);
}

// Two faces, one above the other, flat but for what a solver leaves: each vertex, and each crossing of edges,
// is a contact. (DEF-5)
TEST(DeformingShape, TouchesWithEveryPointOfAFlatFace) {
  for (const bool solid : {true, false}) {
    std::size_t when_flat = 0;
    for (const double rough : {0.0, 1e-10, 1e-8, 1e-6, 1e-4}) {  // [m]
      Random random(11);
      const auto flat = [&](int cells, double z) {
        const SimplicialComplex k = solid ? make_box(1, 1, 0.2, cells) : make_plate(1, 1, cells, cells);
        std::vector<Vec3> places;
        for (const Vec3& x : k.vertices) {
          const bool inside = std::abs(x.x()) < 0.49 && std::abs(x.y()) < 0.49;
          const double aside = inside ? 0.1 / cells : 0;
          places.push_back(x + Vec3(aside * random.uniform(-1, 1), aside * random.uniform(-1, 1),
                                    z + rough * random.uniform(-1, 1)));
        }
        return soft(make_complex(places, k.triangles, {}, k.solid), 0.01);
      };
      const LmdShape lower = flat(4, 0), upper = flat(3, solid ? 0.23 : 0.03);
      const ContactSet found = find_contacts({&upper, {}, 1}, {&lower, {}, 0}, {.threshold = 0.02});
      int crossings = 0;
      for (const ContactPoint& c : found.points) {
        EXPECT_NEAR(c.gap, 0.01, 1e-12 + 2 * rough);
        EXPECT_NEAR(c.normal.z(), 1, 1e-12 + 20 * rough);
        crossings += c.a.dim == 1 && c.b.dim == 1;
      }
      const auto expect_everywhere = [&](const LmdShape& s, double z) {
        for (const Vec3& x : s.complex.vertices) {
          if (std::abs(x.z() - z) > 1e-3) continue;
          const bool there = std::ranges::any_of(found.points, [&](const ContactPoint& c) {
            return (mid_point(c) - x).head<2>().norm() < 1e-6 + rough;
          });
          EXPECT_TRUE(there) << x.transpose() << " rough " << rough;
        }
      };
      expect_everywhere(lower, solid ? 0.1 : 0);
      expect_everywhere(upper, solid ? 0.13 : 0.03);
      EXPECT_GT(crossings, 30);
      if (rough == 0) when_flat = found.points.size();
      EXPECT_GE(found.points.size(), when_flat) << rough;
    }
  }
}

// A side that something flat has pressed is flat up to the tolerance of the solver: there, its vertices are
// neither corners nor inside a face.
TEST(DeformingShape, TouchesWithEveryVertexOfASideThatWasPressedFlat) {
  const LmdShape floor = prepare(dilate(make_plate(4, 4), 0.01)), block = soft(make_box(1, 1, 1, 6), 0.01);
  Random random(3);
  for (double size = 1e-13; size < 2e-3; size *= 10) {  // [m]; slopes within the tolerance of angles
    std::vector<Vec3> vertices = block.complex.vertices.to_vector();
    int below = 0;
    for (Vec3& x : vertices)
      if (x.z() < -0.5 + 1e-9) x.z() += size * random.uniform(-1, 1), ++below;
    const LmdShape pressed = refit(block, vertices);
    int found = 0;
    for (const ContactPoint& c :
         find_contacts({&pressed, translation(0, 0, 0.53), 1}, {&floor, {}, 0}, {.threshold = 0.05}).points)
      found += (c.a.body == BodyId(1) ? c.a : c.b).dim == 0;
    EXPECT_EQ(found, below) << size;
  }
}

TEST(DeformingShape, TouchesWithEveryVertexOfAStraightWire) {
  const LmdShape floor = prepare(dilate(make_plate(4, 4), 0.01));
  const auto vertices_that_touch = [&](const LmdShape& wire) {
    int count = 0;
    for (const ContactPoint& c :
         find_contacts({&wire, translation(0, 0, 0.03), 1}, {&floor, {}, 0}, {.threshold = 0.05}).points)
      count += (c.a.body == BodyId(1) ? c.a : c.b).dim == 0;
    return count;
  };
  for (const double sag : {0.0, 1e-9, 1e-7, 1e-4, 1e-2}) {  // of every other vertex [m]
    std::vector<Vec3> line;
    for (int i = 0; i < 9; ++i) line.emplace_back(0.2 * i - 0.8, 0.1, i % 2 ? sag : -sag);
    EXPECT_EQ(vertices_that_touch(soft(make_polyline(line), 0.01)), 9) << sag;
  }
  const SimplicialComplex cross =
      make_complex({{-0.5, 0, 0}, {0, 0, 0}, {0.5, 0, 0}, {0, -0.5, 0}, {0, 0.5, 0}}, {},
                   {{0, 1}, {1, 2}, {1, 3}, {1, 4}});
  EXPECT_EQ(vertices_that_touch(soft(cross, 0.01)), 5);
  const SimplicialComplex branch =
      make_complex({{-0.5, 0, 0}, {0, 0, 0}, {0.5, 0, 0}, {0, 0.5, 0}}, {}, {{0, 1}, {1, 2}, {1, 3}});
  EXPECT_EQ(vertices_that_touch(soft(branch, 0.01)), 4);
  const double up = 0.5 * std::sin(0.6);  // a corner far from straight touches with its tip alone
  EXPECT_EQ(vertices_that_touch(soft(make_polyline({{-0.4, 0, 0}, {0, 0, up}, {0.4, 0, 0}}), 0.01)), 2);
}

// Rigid motion and deformation at once; what is certified is held against dense samples of fresh shapes.
TEST(DeformingShape, IsCertifiedOnlyWhereDenseSamplesKeepApart) {
  Random random(21);
  int certified = 0, broken = 0;
  for (int k = 0; k < 400; ++k) {
    const LmdShape a = soft(some_complex(random.index(4)), 0.01),
                   b = soft(some_complex(random.index(4)), 0.01);
    const double speed = random.uniform(0, 1);
    const std::vector<Vec3> v_a = random_field(a, random, speed), v_b = random_field(b, random, speed);
    const SE3 g_a = random.pose(0.2), g_b{random.rotation(), random.vector_of_length(0.8, 1.4)};
    const double turn = random.uniform(0, 2);
    MovingShape m{.shape = &a,
                  .g_bs = random.pose(0.1),
                  .motion = {g_a, random.vector(0.5), turn * random.vector()},
                  .velocity = v_a};
    MovingShape n{.shape = &b, .motion = {g_b, random.vector(0.5), turn * random.vector()}};
    if (k % 3 > 0) n.velocity = v_b;  // the other is rigid
    const double dt = random.uniform(0.02, 0.3);
    const CertificateOptions options{
        .required = 0.02, .wanted = 0.1, .axis = k % 2 == 0 ? Vec3(g_b.p - g_a.p) : Vec3::Zero()};
    const Certificate proof = certify(m, n, dt, options);
    double nearest = kInf;
    for (int i = 0; i <= 40; ++i) {
      const double s = dt * i / 40;
      const LmdShape a_s = refit(a, moved(a, v_a, s)),
                     b_s = n.velocity.empty() ? b : refit(b, moved(b, v_b, s));
      nearest = std::min(nearest, base_distance({&a_s, m.g_bs, {pose_at(m.motion, s)}},
                                                {&b_s, n.g_bs, {pose_at(n.motion, s)}}, 0.2));
    }
    if (proof.certified) {
      ++certified;
      EXPECT_GE(nearest, proof.min_distance - 1e-12) << k;
      EXPECT_GE(nearest, options.required - 1e-12) << k;
    } else {
      broken += nearest < options.required;
    }
  }
  EXPECT_GT(certified, 80);
  EXPECT_GT(broken, 25);
}

}  // namespace
}  // namespace aussois
