// SPDX-License-Identifier: Apache-2.0
#include "integrators/scheme.hpp"

#include <algorithm>

#include "integrators/events/event_driven.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/scheme_variants.hpp"

namespace aussois {
namespace {

// The registry adds nothing: step by step the same bits as the class it names.
TEST(Scheme, IsTheClassItNames) {
  for (const SchemeVariant& variant : scheme_variants()) {
    if (variant.name != "moreau_jean") continue;
    Scene s = block_on_plate(0.3, 0.5, 0.2, 0.01);
    drop_refused_restitution(s.model, variant);
    State by_name = s.state, by_class = s.state;
    SchemeOptions options = variant.options;
    options.step.h = 2e-3;
    const Scheme scheme = make_scheme(variant.name, s.model, options);
    const MoreauJean direct(s.model, {.h = 2e-3, .update = options.step.update}, options.moreau_jean);
    for (int k = 0; k < 40; ++k) {
      ASSERT_TRUE(scheme.step(by_name, kInf).ok());
      ASSERT_TRUE(direct.step(by_class).ok());
      ASSERT_EQ(hash(by_name), hash(by_class)) << label(variant.name, options) << ", step " << k;
    }
  }
}

// What passes far away at 100 m/s changes no bit of a block that comes to rest.
TEST(Scheme, GivesABlockTheBitsThatItHasAloneBesideAFastBody) {
  for (const SchemeVariant& variant : scheme_variants()) {
    const Scene alone = block_on_plate(0.5, 0, 0.2, 1e-3);
    Scene beside = alone;
    const BodyId fast = add(beside.model, RigidBody{.name = "fast", .mass = 1, .inertia = Mat3::Identity()});
    beside.state = rest_state(beside.model);
    for (const BodyId b : alone.state.g.ids()) {
      pose(beside.state, b) = pose(alone.state, b);
      twist(beside.state, b) = twist(alone.state, b);
    }
    pose(beside.state, fast).p.y() = 1000;
    twist(beside.state, fast)[0] = 100;
    SchemeOptions options = variant.options;
    options.step.h = 2e-3;
    State state = alone.state;
    const Scheme one = make_scheme(variant.name, alone.model, options),
                 two = make_scheme(variant.name, beside.model, options);
    for (int k = 0; k < 25; ++k) {
      ASSERT_TRUE(one.step(state, kInf).ok());
      ASSERT_TRUE(two.step(beside.state, kInf).ok());
      const SE3 &g = pose(state, alone.block), &with = pose(beside.state, alone.block);
      ASSERT_TRUE(g.p == with.p && g.R.coeffs() == with.R.coeffs() &&
                  twist(state, alone.block) == twist(beside.state, alone.block))
          << label(variant.name, options) << ", step " << k;
    }
  }
}

// A belt that moves on and turns: what rests on it goes with it, wherever on the step a scheme looks at
// contacts.
TEST(Scheme, LeavesABlockAtRestOnABeltThatMoves) {
  std::vector<SchemeVariant> variants = scheme_variants();
  variants.push_back({"moreau_jean", rolling_options({})});
  variants.push_back({"event_driven", {}});
  for (const SchemeVariant& variant : variants) {
    Scene s = block_on_plate(0.5, 0, 0);
    const double speed = 0.3;
    s.model.bodies[s.ground].motion =
        PrescribedMotion{{.t = {0, 1}, .pose = {SE3{}, {Quat::Identity(), Vec3(speed, 0, 0)}}}};
    twist(s.state, s.ground)[0] = twist(s.state, s.block)[0] = speed;
    SchemeOptions options = variant.options;
    options.step.h = 2e-3;
    const Scheme scheme = make_scheme(variant.name, s.model, options);
    for (int k = 0; k < 25; ++k) ASSERT_TRUE(scheme.step(s.state, kInf).ok());
    const std::string name = label(variant.name, options);
    EXPECT_NEAR(twist(s.state, s.block)[0], speed, 1e-8) << name;  // the solver's tolerance
    EXPECT_NEAR(pose(s.state, s.block).p.x(), speed * s.state.t, 1e-9) << name;
  }
}

// A ball on a spring falls on a plate: settings that no comparison goes through arrive, and say something.
TEST(Scheme, HandsOnTheSettingsOfEachClass) {
  Scene s = block_on_plate(0.3, 1, 0, 0.01);
  twist(s.state, s.block) << 0.5, 0, -1, 3, 2, 1;
  s.model.forces.push_back(
      {.name = "spring", .add_to = [](const Model&, const State& state, double, GeneralisedForce& force) {
         force.f[6] -= 1e3 * pose(state, 1).p.x();
         force.K.emplace_back(6, 6, 1e3);
       }});
  const auto compare = [&](const char* name, const SchemeOptions& options, auto&& direct) {
    State by_name = s.state, by_class = s.state, by_default = s.state;
    const Scheme scheme = make_scheme(name, s.model, options),
                 plain = make_scheme(name, s.model, {.step = {.h = 2e-3}});
    for (int k = 0; k < 20; ++k) {
      ASSERT_TRUE(scheme.step(by_name, kInf).ok());
      ASSERT_TRUE(direct.step(by_class).ok());
      ASSERT_TRUE(plain.step(by_default, kInf).ok());
    }
    EXPECT_EQ(hash(by_name), hash(by_class)) << name;
    EXPECT_NE(hash(by_name), hash(by_default)) << name;
    EXPECT_NE(label(name, options), label(name, {})) << name;
  };
  compare("schatzman_paoli", {.step = {.h = 2e-3}, .schatzman_paoli = {.force_theta = 1}},
          SchatzmanPaoli(s.model, {.h = 2e-3}, {.force_theta = 1}));
  compare("passive_midpoint", {.step = {.h = 2e-3}, .passive_midpoint = {.passive = false}},
          PassiveMidpoint(s.model, {.h = 2e-3}, {.passive = false}));
  const EventDrivenOptions coarse{.ode = {.relative = 1e-6, .absolute = 1e-8}};
  compare("event_driven", {.step = {.h = 2e-3}, .event_driven = coarse},
          EventDriven(s.model, {.h = 2e-3}, coarse));
}

// The reference is made by its name, and stands in no comparison of orders in h.
TEST(Scheme, KnowsTheEventDrivenReference) {
  Scene s = block_on_plate(0, 1, 0, 0.01);
  twist(s.state, s.block)[2] = -1;
  const StepReport report = make_scheme("event_driven", s.model, {.step = {.h = 0.03}}).step(s.state, kInf);
  ASSERT_TRUE(report.ok()) << report.reason;
  EXPECT_FALSE(report.events.empty());
  EXPECT_GT(twist(s.state, s.block)[2], 0.5);
  EXPECT_EQ(label("event_driven", {}), "event_driven");
  for (const SchemeVariant& variant : scheme_variants()) EXPECT_NE(variant.name, "event_driven");
}

TEST(Scheme, HasALabelOfItsOwnForEachVariant) {
  std::vector<std::string> labels;
  for (const SchemeVariant& variant : scheme_variants())
    labels.push_back(label(variant.name, variant.options));
  std::sort(labels.begin(), labels.end());
  EXPECT_EQ(std::adjacent_find(labels.begin(), labels.end()), labels.end());
  EXPECT_GE(labels.size(), 6u);  // Moreau-Jean: two theta, three normal laws
  EXPECT_EQ(label("schatzman_paoli", {.schatzman_paoli = {.force_theta = 0.5}}),
            "schatzman_paoli force theta 0.5");  // not the theta of Moreau-Jean
}

TEST(Scheme, PromisesOrderTwoAtTheMidpointOnly) {
  EXPECT_EQ(scheme_traits("moreau_jean", {}).smooth, 2);
  EXPECT_EQ(scheme_traits("moreau_jean", {.moreau_jean = {.theta = 0.6}}).smooth, 1);
  EXPECT_EQ(scheme_traits("moreau_jean", {}).nonsmooth, 1);
  EXPECT_EQ(scheme_traits("moreau_jean_projected", {}).smooth, 2);
  EXPECT_EQ(scheme_traits("schatzman_paoli", {}).smooth, 1);
}

// A block that falls on a plate comes back, or the scheme refuses its restitution: nothing is plastic in
// silence.
TEST(Scheme, BouncesOrRefusesTheRestitutionAsItsTraitsSay) {
  int plastic = 0;
  for (const SchemeVariant& variant : scheme_variants()) {
    SCOPED_TRACE(label(variant.name, variant.options));
    Scene s = block_on_plate(0, 1, 0, 0.01);
    twist(s.state, s.block)[2] = -1;
    const auto make = [&] { return make_scheme(variant.name, s.model, variant.options); };
    if (!scheme_traits(variant.name, variant.options).restitution) {
      ++plastic;
      EXPECT_NE(message_of(make).find("restitution = 1 must be 0"), std::string::npos);
      drop_refused_restitution(s.model, variant);
    }
    const double e = s.model.contact_law.restitution;
    const Scheme scheme = make();
    for (int k = 0; k < 30; ++k) ASSERT_TRUE(scheme.step(s.state, kInf).ok());
    EXPECT_EQ(twist(s.state, s.block)[2] > 0.5, e > 0);
  }
  EXPECT_GT(plastic, 0);
}

// Of pairs, of stops, and by the other scheme that has the law; what gamma bounces with is its own.
TEST(Scheme, OfAPlasticLawRefusesARestitutionWhereverItIs) {
  const SchemeOptions plastic{.moreau_jean = {.law = NormalLaw::gap_over_step},
                              .passive_midpoint = {.law = NormalLaw::gap_over_step}};
  Scene pair = block_on_plate(0, 0, 0), stop = pair;
  pair.model.pair_laws[{pair.ground, pair.block}] = {.restitution = 0.3};
  Joint slide = joint_at(JointKind::prismatic, "slide", stop.block, stop.ground, stop.state.g, SE3{});
  slide.axis[0] = {.lower = -1, .upper = 1, .restitution = 0.4};
  add(stop.model, slide);
  for (const char* name : {"moreau_jean", "passive_midpoint"}) {
    const auto refusal = [&](const Model& model) {
      return message_of([&] { make_scheme(name, model, plastic); });
    };
    EXPECT_NE(refusal(pair.model).find("ContactLaw::restitution = 0.3 must be 0"), std::string::npos);
    EXPECT_NE(refusal(stop.model).find("joint slide: restitution = 0.4 must be 0"), std::string::npos);
  }
  SchemeOptions mean = plastic;
  mean.moreau_jean.gamma = 0.5;
  EXPECT_NO_THROW(make_scheme("moreau_jean", pair.model, mean));
}

TEST(Scheme, IsRefusedByAnUnknownNameOrABadOption) {
  const Scene s = block_on_plate(0, 0, 0);
  EXPECT_NE(message_of([&] { make_scheme("euler", s.model, {}); }).find("moreau_jean"), std::string::npos);
  EXPECT_NE(message_of([&] { scheme_traits("euler", {}); }).find("euler"), std::string::npos);
  EXPECT_NE(
      message_of([&] { make_scheme("moreau_jean", s.model, {.moreau_jean = {.theta = 2}}); }).find("theta"),
      std::string::npos);
}

}  // namespace
}  // namespace aussois
