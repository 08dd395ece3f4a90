// SPDX-License-Identifier: Apache-2.0
// (LOD-6), (LOD-7): steps with levels against steps without, fast and slow, and what a wrong setting is told.
#include <gtest/gtest.h>

#include "geometry/mass_properties.hpp"
#include "geometry/primitives.hpp"
#include "geometry/surface_tree.hpp"
#include "integrators/events/event_driven.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "lmd/shape_levels.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

constexpr int kLevels = 3;

LmdShape levelled(const SimplicialComplex& complex) {
  return prepare(dilate(complex, 1e-4), {.levels = kLevels});
}

// A ring flies into the rim of a wheel, which it meets 0.06 m above the plane of the wheel.
struct Flight {
  Model model{};
  BodyId ring{};
  explicit Flight(int levels) {
    model.gravity = Vec3::Zero();
    static const LmdShape wheel = levelled(make_torus(0.3, 0.05, 200, 50)),
                          small = levelled(make_torus(0.02, 0.01, 120, 60));
    const auto shape = [&](LmdShape of) {
      if (levels == 0) of.levels = nullptr;
      return add(model, std::move(of));
    };
    add(model, fixed_body("wheel", shape(wheel)));
    ring = add(model, solid_body("ring", shape(small), mass_properties(small.complex, 7850)));
  }
  State start(double speed) const {
    State state = rest_state(model);
    pose(state, ring).p = Vec3(0.32, 0.02, 0.1);
    linear_part(state.v, ring) = speed * Vec3(0.05, 0.1, -1);
    angular_part(state.v, ring) = Vec3(3, 2, 1);
    return state;
  }
};

TEST(StepsWithLevels, AreTheSameBitsWhereNoneAnswers) {
  const Flight with(kLevels), without(0);
  const MoreauJean levels(with.model, {.levels = kLevels}, {.theta = 1}),
      none(without.model, {}, {.theta = 1});
  State a = with.start(0.2), b = without.start(0.2);
  pose(a, with.ring).p.z() = pose(b, without.ring).p.z() = 0.0625;
  int contacts = 0;
  for (int i = 0; i < 60; ++i) {
    const StepReport report = levels.step(a);
    ASSERT_TRUE(report.ok()) << report.reason;
    ASSERT_TRUE(none.step(b).ok());
    ASSERT_EQ(report.contacts_coarse, 0);
    contacts += report.contacts_kept;
    ASSERT_EQ(hash(a), hash(b)) << i;
  }
  EXPECT_GT(contacts, 0);
}

// Contacts of levels only watch: what a step that is taken solved is the problem of the shapes themselves,
// without contacts that stay open.
TEST(StepsWithLevels, LeadWhereStepsWithoutLead) {
  const Flight with(kLevels), without(0);
  const MoreauJean levels(with.model, {.levels = kLevels}, {.theta = 1}),
      none(without.model, {}, {.theta = 1});
  State a = with.start(10), b = without.start(10);
  int coarse = 0, kept = 0;
  for (int i = 0; i < 12; ++i) {
    const StepReport report = levels.step(a), other = none.step(b);
    ASSERT_TRUE(report.ok()) << report.reason;
    ASSERT_EQ(report.h, other.h) << i;
    coarse += report.contacts_coarse;
    kept += report.contacts_kept;
    EXPECT_LE((a.v - b.v).norm(), 10 * SolverOptions{}.tolerance * 10) << i;  // of its speed
  }
  EXPECT_GT(coarse, 0);
  EXPECT_GT(kept, 0);
}

TEST(StepsWithLevels, AreShortenedRatherThanBlindWherePartsAreFast) {
  const Flight with(kLevels);
  const MoreauJean levels(with.model, {.levels = kLevels}, {.theta = 1});
  State a = with.start(100);
  int coarse = 0, shortened = 0;
  while (a.t < 3e-3 * (1 - 1e-9)) {
    const StepReport report = levels.step(a, 3e-3 - a.t);
    ASSERT_TRUE(report.ok()) << report.reason;
    coarse += report.contacts_coarse;
    shortened += report.h < 1e-3;
  }
  EXPECT_GT(coarse, 0);
  EXPECT_GT(shortened, 0);
  EXPECT_GT(linear_part(a.v, with.ring).z(), -99) << "it hits the wheel";
}

// Balls of 1 cm from all sides at up to 2000 m/s, 200 of their diameters a step, at a dented sheet of 2 x 2 m
// that consists of 2 cells^2 triangles.
void expect_no_bullet_through(int bullets, int cells) {
  const SimplicialComplex flat = make_plate(2, 2, cells, cells);
  std::vector<Vec3> vertices = flat.vertices.to_vector();
  for (Vec3& x : vertices) x.z() = 0.02 * std::sin(9 * x.x()) * std::cos(7 * x.y());
  const SimplicialComplex sheet = make_complex(std::move(vertices), flat.triangles),
                          ball = make_sphere(5e-3, 2);
  const SurfaceTree surface(sheet);
  Model model;
  model.gravity = Vec3::Zero();
  add(model, fixed_body("sheet", add(model, levelled(sheet))));
  const BodyId flying =
      add(model, solid_body("ball", add(model, levelled(ball)), mass_properties(ball, 7850)));
  ASSERT_GE(level_count(*model.shapes[model.bodies[BodyId(0)].shape]), 1);
  const MoreauJean scheme(model, {.levels = kLevels}, {.theta = 1});
  Random random(11);
  int hits = 0, coarse = 0;
  for (int i = 0; i < bullets; ++i) {
    State state = rest_state(model);
    const double side = random.uniform(0, 1) < 0.5 ? -1 : 1;
    const Vec3 aim(random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3), 0),
        from(random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6), side * random.uniform(0.1, 0.4));
    const Vec3 v = std::pow(10, random.uniform(1, 3.3)) * (aim - from).normalized();
    pose(state, flying).p = from;
    linear_part(state.v, flying) = v;
    const double flight = 1.3 * (aim - from).norm() / v.norm();
    while (state.t < flight * (1 - 1e-9)) {
      const StepReport report = scheme.step(state, flight - state.t);
      ASSERT_TRUE(report.moved()) << i << ": " << report.reason;
      coarse += report.contacts_coarse;
    }
    const Vec3 x = pose(state, flying).p;
    EXPECT_GT(side * surface.signed_distance(x), 0) << i;
    hits += (linear_part(state.v, flying) - v).norm() > 1e-3;
  }
  EXPECT_GT(hits, 0.93 * bullets);
  EXPECT_GT(coarse, 0);
}
TEST(StepsWithLevels, LetNoBulletThrough) {
  expect_no_bullet_through(150, 60);
}
TEST(StepsWithLevels, LetNoneOfTenThousandBulletsThroughAMillionTriangles) {
  expect_no_bullet_through(10000, 708);
}

// Where a step may not be halved the shapes answer farther, as far as it takes.
TEST(StepsWithLevels, AskTheShapesWhereTheyMayNotBeShortened) {
  const Flight with(kLevels), without(0);
  const AdvancementOptions whole{.min_h = 1e-3};
  const MoreauJean levels(with.model, {.advancement = whole, .levels = kLevels}, {.theta = 1}),
      none(without.model, {.advancement = whole}, {.theta = 1});
  State a = with.start(100), b = without.start(100);
  const StepReport report = levels.step(a), other = none.step(b);
  EXPECT_EQ(report.status, other.status) << report.reason;
  EXPECT_LE((a.v - b.v).norm(), 10 * SolverOptions{}.tolerance * 100);
  EXPECT_GT(report.contacts_kept, 0);
}

TEST(StepsWithLevels, AreRefusedWhereTheyCannotBe) {
  const Flight with(kLevels), without(0);
  EXPECT_NE(message_of([&] { MoreauJean(without.model, {.levels = 1}); }).find("LmdShapeOptions::levels"),
            std::string::npos);
  EXPECT_NE(message_of([&] {
              MoreauJean(with.model, {.advancement = {.certify = false}, .levels = 1});
            }).find("AdvancementOptions::certify"),
            std::string::npos);
  EXPECT_NE(message_of([&] { EventDriven(with.model, {.levels = 1}); }).find("levels"), std::string::npos);
  EXPECT_NE(message_of([&] { MoreauJean(with.model, {.levels = -1}); }).find("StepOptions::levels"),
            std::string::npos);
}

}  // namespace
}  // namespace aussois
