// SPDX-License-Identifier: Apache-2.0
// The contact set is a function of the relative pose and of nothing else.
#include <algorithm>
#include <bit>
#include <cstdint>

#include <gtest/gtest.h>

#include "tests/support/random_pair.hpp"

namespace aussois {
namespace {

const LmdOptions kOptions{.threshold = 0.2};

// Contacts on the border of a criterion may fall on either side of it by rounding.
bool is_clear(const ContactPoint& c) {
  return c.angle_margin > 1e-9 && kOptions.threshold - c.gap > 1e-9;
}

const ContactPoint* partner(const ContactSet& set, const ContactKey& key) {
  for (const ContactPoint& c : set.points)
    if (key_of(c) == key) return &c;
  return nullptr;
}

ContactKey swapped(const ContactKey& key) {
  return {
      .body_a = key.body_b, .body_b = key.body_a, .feature = feature_word(feature_b(key), feature_a(key))};
}

class Objectivity : public ::testing::TestWithParam<unsigned> {
 protected:
  const RandomPair pair = random_pair(GetParam(), 0.05);
  const ContactSet here = find_contacts(pair.posed_a(), pair.posed_b(), kOptions);
  const double size = 2 * std::max(pair.a.bounding_radius, pair.b.bounding_radius);
};

TEST_P(Objectivity, MovingThePairMovesItsContacts) {
  Random random(GetParam() + 40000);
  const SE3 g = random.pose(1);
  const ContactSet there = find_contacts({&pair.a, g * pair.g_a, 0}, {&pair.b, g * pair.g_b, 1}, kOptions);
  for (const ContactPoint& c : here.points) {
    if (!is_clear(c)) continue;
    const ContactPoint* d = partner(there, key_of(c));
    ASSERT_TRUE(d);
    EXPECT_NEAR(c.gap, d->gap, 1e-12 * (size + 3));  // rounding of poses up to three metres from the origin
    // feet slide by rounding over the sine of the crossing angle, normals turn by rounding over the distance
    EXPECT_LT((g * c.x_a - d->x_a).norm(), 1e-7);
    EXPECT_LT((g.R * c.normal - d->normal).norm(), 1e-7);
    EXPECT_NEAR(c.angle_margin, d->angle_margin, 1e-7);
  }
  EXPECT_EQ(std::ranges::count_if(here.points, is_clear), std::ranges::count_if(there.points, is_clear));
}

TEST_P(Objectivity, SwappingTheBodiesSwapsTheSides) {
  const ContactSet other = find_contacts(pair.posed_b(), pair.posed_a(), kOptions);
  for (const ContactPoint& c : here.points) {
    if (!is_clear(c)) continue;
    const ContactPoint* d = partner(other, swapped(key_of(c)));
    ASSERT_TRUE(d);
    EXPECT_NEAR(c.gap, d->gap, 1e-12 * (size + 3));
    EXPECT_LT((c.x_a - d->x_b).norm() + (c.x_b - d->x_a).norm(), 1e-7);
    EXPECT_LT((c.normal + d->normal).norm(), 1e-7);
    EXPECT_NEAR(c.angle_margin, d->angle_margin, 1e-7);
  }
  EXPECT_EQ(std::ranges::count_if(here.points, is_clear), std::ranges::count_if(other.points, is_clear));
}

// Seen in the mirror x -> -x: vertices reflected, triangles turned round, poses conjugated.
SimplicialComplex mirrored(const SimplicialComplex& k) {
  std::vector<Vec3> vertices = k.vertices.to_vector();
  for (Vec3& x : vertices) x.x() = -x.x();
  std::vector<std::array<int, 3>> triangles = k.triangles.to_vector();
  for (auto& t : triangles) std::swap(t[1], t[2]);
  std::vector<std::array<int, 2>> wires;
  for (std::size_t i = 0; i < k.edges.size(); ++i)
    if (k.edge_triangles[int(i)].empty()) wires.push_back(k.edges[i]);
  return make_complex(vertices, triangles, wires, k.solid);
}
SE3 mirrored(const SE3& g) {
  return {Quat(g.R.w(), g.R.x(), -g.R.y(), -g.R.z()), Vec3(-g.p.x(), g.p.y(), g.p.z())};
}

TEST_P(Objectivity, TheMirroredPairHasTheMirroredContacts) {
  const LmdShape a = prepare(dilate(mirrored(pair.a.complex), pair.a.radius)),
                 b = prepare(dilate(mirrored(pair.b.complex), pair.b.radius));
  const ContactSet there = find_contacts({&a, mirrored(pair.g_a), 0}, {&b, mirrored(pair.g_b), 1}, kOptions);
  for (const ContactPoint& c : here.points) {
    if (!is_clear(c)) continue;
    const Vec3 x(-c.x_a.x(), c.x_a.y(), c.x_a.z()), n(-c.normal.x(), c.normal.y(), c.normal.z());
    const bool found = std::ranges::any_of(there.points, [&](const ContactPoint& d) {
      return std::abs(c.gap - d.gap) < 1e-12 * (size + 3) && (x - d.x_a).norm() < 1e-7 &&
             (n - d.normal).norm() < 1e-7 && c.a.dim == d.a.dim && c.b.dim == d.b.dim;
    });
    EXPECT_TRUE(found) << "seed " << GetParam();
  }
  EXPECT_EQ(std::ranges::count_if(here.points, is_clear), std::ranges::count_if(there.points, is_clear));
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
bool same_bits(const Vec3& a, const Vec3& b) {
  return same_bits(a.x(), b.x()) && same_bits(a.y(), b.y()) && same_bits(a.z(), b.z());
}
bool same_bits(const Feature& a, const Feature& b) {
  return a.body == b.body && a.dim == b.dim && a.simplex == b.simplex && a.region == b.region &&
         std::ranges::equal(a.bary, b.bary, [](double x, double y) { return same_bits(x, y); });
}
bool same_bits(const ContactSet& a, const ContactSet& b) {
  return std::ranges::equal(a.points, b.points, [](const ContactPoint& c, const ContactPoint& d) {
    return same_bits(c.a, d.a) && same_bits(c.b, d.b) && same_bits(c.x_a, d.x_a) && same_bits(c.x_b, d.x_b) &&
           same_bits(c.normal, d.normal) && same_bits(c.gap, d.gap) &&
           same_bits(c.angle_margin, d.angle_margin);
  });
}

// Whatever was asked before, on whatever number of threads: the same bits.
TEST_P(Objectivity, HistoryAndThreadsLeaveNoTrace) {
  Random random(GetParam() + 50000);
  SE3 g = pair.g_a;
  for (int i = 0; i < 5; ++i) {  // a path, its contacts asked at each pose with other options
    g = exp_se3(0.05 * (Vec6() << random.vector(), random.vector()).finished()) * g;
    LmdOptions options = kOptions;
    options.threads = 1 + i;
    options.threshold = 0.05 * i;
    (void)find_contacts({&pair.a, g, 0}, pair.posed_b(), options);
  }
  const ContactSet at_end = find_contacts({&pair.a, g, 0}, pair.posed_b(), kOptions);
  const LmdShape a = prepare(dilate(pair.a.complex, pair.a.radius)),
                 b = prepare(dilate(pair.b.complex, pair.b.radius));
  for (const int threads : {1, 2, 3, 5}) {
    LmdOptions options = kOptions;
    options.threads = threads;
    EXPECT_TRUE(same_bits(at_end, find_contacts({&a, g, 0}, {&b, pair.g_b, 1}, options)))
        << threads << " threads";
  }
}
INSTANTIATE_TEST_SUITE_P(Seeds, Objectivity, ::testing::Range(0U, 200U));

TEST(ObjectivitySample, IsRepresentative) {
  int clear = 0, border = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    const RandomPair pair = random_pair(seed, 0.05);
    for (const ContactPoint& c : find_contacts(pair.posed_a(), pair.posed_b(), kOptions).points)
      ++(is_clear(c) ? clear : border);
  }
  EXPECT_GT(clear, 300);
  EXPECT_LT(border, 5);
}

}  // namespace
}  // namespace aussois
