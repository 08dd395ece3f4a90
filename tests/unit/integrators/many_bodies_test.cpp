// SPDX-License-Identifier: Apache-2.0
// Scenes of many pairs: the same bits for any number of threads, and nothing that one pair does to another.
#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "integrators/pose/step_pairs.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

constexpr double kEdge = 0.1, kEps = 1e-3;

// A heap of boxes, three layers of five by five on a plate, each a little off its place; falling.
struct Heap {
  Model model{};
  State state{};
};

Heap heap() {
  Heap s;
  const SimplicialComplex box = make_box(kEdge, kEdge, kEdge);
  const auto plate = add(s.model, prepare(dilate(make_plate(3, 3), kEps)));
  const auto cube = add(s.model, prepare(dilate(box, kEps)));
  add(s.model, fixed_body("plate", plate));
  for (int i = 0; i < 75; ++i) add(s.model, solid_body("box", cube, mass_properties(box, 1000)));
  s.state = rest_state(s.model);
  Random random(41);
  const double pitch = kEdge + 2 * kEps + 1e-3;
  for (int i = 0; i < 75; ++i) {
    SE3& g = pose(s.state, BodyId::at(1 + i));
    const int along = i % 5, across = i / 5 % 5, above = i / 25;
    g.p = pitch * Vec3(along, across, above) + Vec3(0, 0, kEdge / 2 + 2 * kEps + 1e-4) + random.vector(5e-5);
    g.R = exp_so3(random.vector(1e-3));
    twist(s.state, BodyId::at(1 + i))[2] = -0.2;
  }
  return s;
}

TEST(ManyBodies, StepIsTheSameForAnyNumberOfThreads) {
  std::vector<std::uint64_t> hashes;
  for (const int threads : {1, 2, 3, 5}) {
    Heap s = heap();
    const MoreauJean scheme(s.model, {.h = 2e-3, .threads = threads}, {.theta = 1});
    int contacts = 0;
    for (int i = 0; i < 3; ++i) {
      const StepReport report = scheme.step(s.state);
      ASSERT_TRUE(report.ok()) << report.reason;
      contacts = std::max(contacts, report.contacts_found);
    }
    EXPECT_GT(contacts, 200);
    hashes.push_back(hash(s.state));
  }
  for (const std::uint64_t h : hashes) EXPECT_EQ(h, hashes.front());
}

TEST(ManyBodies, ContactsOfAllPairsAreThoseOfEachPair) {
  const Heap s = heap();
  const MoreauJean scheme(s.model, {}, {.theta = 1});
  const ContactSet all = scheme.contacts(s.state, 2e-3);
  std::vector<ContactKey> keys, one_by_one;
  for (const ContactPoint& c : all.points) keys.push_back(key_of(c));
  for (const BodyId a : s.model.bodies.ids())
    for (BodyId b = a + 1; s.model.bodies.contains(b); ++b) {
      const auto posed = [&](BodyId body) {
        const RigidBody& r = s.model.bodies[body];
        return PosedShape{s.model.shapes[r.shape].get(), pose(s.state, body) * r.g_bs, body};
      };
      for (const ContactPoint& c : find_contacts(posed(a), posed(b), {.threshold = 2e-3}).points)
        one_by_one.push_back(key_of(c));
    }
  EXPECT_GT(keys.size(), 200U);
  EXPECT_EQ(keys, one_by_one);
}

TEST(ManyBodies, ReductionOfAllPairsIsThatOfEachPair) {
  const Heap s = heap();
  const ContactSet all = MoreauJean(s.model, {}, {.theta = 1}).contacts(s.state, 2e-3);
  const Selection together = reduce(all);
  std::vector<int> kept;
  int clusters = 0;
  for (std::size_t begin = 0, end = 0; begin < all.points.size(); begin = end) {
    ContactSet pair;
    while (end < all.points.size() && all.points[end].a.body == all.points[begin].a.body &&
           all.points[end].b.body == all.points[begin].b.body)
      pair.points.push_back(all.points[end++]);
    const Selection alone = reduce(pair);
    for (const int i : alone.kept) kept.push_back(int(begin) + i);
    clusters += alone.cluster_count;
  }
  EXPECT_EQ(together.kept, kept);
  EXPECT_EQ(together.cluster_count, clusters);
  EXPECT_GT(clusters, 75);
}

TEST(ManyBodies, PairsNeedABodyThatMoves) {
  Model model;
  const auto plate = add(model, prepare(dilate(make_plate(1, 1), kEps)));
  for (int i = 0; i < 3; ++i) add(model, fixed_body("plate", plate));
  add(model, RigidBody{.name = "free", .shape = plate, .mass = 1, .inertia = Mat3::Identity()});
  const State state = rest_state(model);
  const std::vector<StepPair> pairs = pairs_within(model, state, body_bounds(model), {0, 0, 0, 0}, 1);
  ASSERT_EQ(pairs.size(), 3U);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(pairs[i].a, BodyId::at(i));
    EXPECT_EQ(pairs[i].b, BodyId(3));
    EXPECT_EQ(pairs[i].dilation, 2 * kEps);
  }
}

}  // namespace
}  // namespace aussois
