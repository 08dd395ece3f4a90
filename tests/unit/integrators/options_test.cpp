// SPDX-License-Identifier: Apache-2.0
// What no scheme takes: every option out of its range, named with its value; a start in overlap.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "geometry/number_text.hpp"
#include "integrators/run.hpp"
#include "integrators/scheme.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();

struct Bad {
  std::string field{};  // as the message begins
  std::vector<double> values{};
  void (*set)(SchemeOptions&, double) = nullptr;
  std::vector<std::string> schemes{};  // that read it; empty: all
};

const std::vector<Bad>& table() {
  static const std::vector<Bad> all = {
      {"StepOptions::h", {0, -1e-3, kInf, kNan}, [](SchemeOptions& o, double x) { o.h = x; }, {}},
      {"StepOptions::threads", {0, -1}, [](SchemeOptions& o, double x) { o.threads = int(x); }, {}},
      {"MoreauJeanOptions::theta",
       {0.49, 1.01, kNan},
       [](SchemeOptions& o, double x) { o.theta = x; },
       {"moreau_jean"}},
      {"MoreauJeanProjectedOptions::theta",
       {0.49, 1.01, kNan},
       [](SchemeOptions& o, double x) { o.theta = x; },
       {"moreau_jean_projected"}},
      {"SchatzmanPaoliOptions::theta",
       {-0.01, 1.01, kNan},
       [](SchemeOptions& o, double x) { o.force_theta = x; },
       {"schatzman_paoli"}},
      {"GeneralisedAlphaOptions::spectral_radius",
       {-0.01, 1.01, kNan},
       [](SchemeOptions& o, double x) { o.spectral_radius = x; },
       {"generalised_alpha"}},
      {"NewtonOptions::max_iterations",
       {0, -1},
       [](SchemeOptions& o, double x) { o.newton.max_iterations = int(x); },
       {"moreau_jean"}},
      {"NewtonOptions::tolerance",
       {0, -1, kNan},
       [](SchemeOptions& o, double x) { o.newton.tolerance = x; },
       {"moreau_jean"}},
      {"ImpactOptions::max_pairs",
       {0, -1},
       [](SchemeOptions& o, double x) { o.impact.max_pairs = int(x); },
       {"moreau_jean"}},
      {"NormalLawOptions::correction_speed",
       {-1e-9, kNan},
       [](SchemeOptions& o, double x) { o.normal.correction_speed = x; },
       {}},
      {"NormalLawOptions::touching",
       {-1e-9, kInf, kNan},
       [](SchemeOptions& o, double x) { o.normal.touching = x; },
       {}},
      {"NormalLawOptions::gamma",
       {0.49, 1.01, kNan},
       [](SchemeOptions& o, double x) { o.normal.gamma = x; },
       {}},
      {"JointOptions::stabilisation",
       {-0.01, 1.01, kNan},
       [](SchemeOptions& o, double x) { o.joints.stabilisation = x; },
       {}},
      {"LmdOptions::threads", {0, -1}, [](SchemeOptions& o, double x) { o.lmd.threads = int(x); }, {}},
      {"PersistenceOptions::reach",
       {-1e-9, kInf, kNan},
       [](SchemeOptions& o, double x) { o.persistence.reach = x; },
       {}},
      {"PersistenceOptions::max_reach",
       {-1e-9, kInf, kNan},
       [](SchemeOptions& o, double x) { o.persistence.max_reach = x; },
       {}},
      {"PersistenceOptions::max_turn",
       {-0.1, 1.6, kNan},
       [](SchemeOptions& o, double x) { o.persistence.max_turn = x; },
       {}},
      {"PersistenceOptions::anchor_rate",
       {0, 1.1, kNan},
       [](SchemeOptions& o, double x) { o.persistence.anchor_rate = x; },
       {}},
      {"PersistenceOptions::anchor_speed",
       {0, -1, kNan},
       [](SchemeOptions& o, double x) { o.persistence.anchor_speed = x; },
       {}},
      {"PersistenceOptions::slip_speed",
       {0, -1, kNan},
       [](SchemeOptions& o, double x) { o.persistence.slip_speed = x; },
       {}},
      {"LmdOptions::alpha", {-0.1, 0.51, kNan}, [](SchemeOptions& o, double x) { o.lmd.alpha = x; }, {}},
      {"LmdOptions::alpha_ee",
       {-0.1, 1.01, kNan},
       [](SchemeOptions& o, double x) { o.lmd.alpha_ee = x; },
       {}},
      {"ClusteringOptions::angle",
       {0, 1.6, kNan},
       [](SchemeOptions& o, double x) { o.reduction.clustering.angle = x; },
       {}},
      {"ReductionOptions::min_per_cluster",
       {0, -1},
       [](SchemeOptions& o, double x) { o.reduction.min_per_cluster = int(x); },
       {}},
      {"ReductionOptions::tie",
       {-0.1, 0.2, kNan},
       [](SchemeOptions& o, double x) { o.reduction.tie = x; },
       {}},
      {"ReductionOptions::min_margin",
       {-0.1, 1.1, kNan},
       [](SchemeOptions& o, double x) { o.reduction.min_margin = x; },
       {}},
      {"ReductionOptions::hysteresis",
       {-0.1, 1, kNan},
       [](SchemeOptions& o, double x) { o.reduction.hysteresis = x; },
       {}},
      {"HullMargin::margin",
       {0, 1.1, kNan},
       [](SchemeOptions& o, double x) { o.reduction.hull_margin.margin = x; },
       {}},
      {"HullMargin::min_corners",
       {2, -1},
       [](SchemeOptions& o, double x) { o.reduction.hull_margin.min_corners = int(x); },
       {}},
      {"HullMargin::max_corners",
       {3, -1},
       [](SchemeOptions& o, double x) { o.reduction.hull_margin.max_corners = int(x); },
       {}},
      {"ReductionOptions::corners",
       {2, -1},
       [](SchemeOptions& o, double x) { o.reduction.corners = int(x); },
       {}},
      {"ReductionOptions::directions",
       {2, -1},
       [](SchemeOptions& o, double x) { o.reduction.directions = int(x); },
       {}},
      {"ReductionOptions::wrench_loss",
       {-0.1, 1, kNan},
       [](SchemeOptions& o, double x) { o.reduction.wrench_loss = x; },
       {}},
      {"ReductionOptions::layer",
       {-1e-9, kNan},
       [](SchemeOptions& o, double x) { o.reduction.layer = x; },
       {}},
      {"SolverOptions::tolerance",
       {0, -1, kNan},
       [](SchemeOptions& o, double x) { o.solver.tolerance = x; },
       {}},
      {"SolverOptions::max_iterations",
       {0, -1},
       [](SchemeOptions& o, double x) { o.solver.max_iterations = int(x); },
       {}},
      {"SolverOptions::relaxation",
       {0, 2, kNan},
       [](SchemeOptions& o, double x) { o.solver.relaxation = x; },
       {}},
      {"SolverOptions::anderson",
       {-1, 21},
       [](SchemeOptions& o, double x) { o.solver.anderson = int(x); },
       {}},
      {"AdvancementOptions::enlargement",
       {0.99, 4.01, kNan},
       [](SchemeOptions& o, double x) { o.advancement.enlargement = x; },
       {}},
      {"AdvancementOptions::floor",
       {0, 1.01, kNan},
       [](SchemeOptions& o, double x) { o.advancement.floor = x; },
       {}},
      {"AdvancementOptions::max_overlap",
       {-0.01, 1, kNan},
       [](SchemeOptions& o, double x) { o.advancement.max_overlap = x; },
       {}},
      {"AdvancementOptions::min_h",
       {0, -1, 1, kNan},  // 1 s is more than h
       [](SchemeOptions& o, double x) { o.advancement.min_h = x; },
       {}},
      {"AdvancementOptions::growth",
       {0.99, 4.01, kNan},
       [](SchemeOptions& o, double x) { o.advancement.growth = x; },
       {}},
      {"AdvancementOptions::max_attempts",
       {0, -1},
       [](SchemeOptions& o, double x) { o.advancement.max_attempts = int(x); },
       {}},
  };
  return all;
}

TEST(SchemeOptions, AreRefusedOutOfTheirRangesByEverySchemeThatReadsThem) {
  const Scene s = block_on_plate(0.3, 0, 0);
  int refusals = 0;
  for (const Bad& bad : table())
    for (const double value : bad.values)
      for (const std::string& name : bad.schemes.empty() ? scheme_names() : bad.schemes) {
        SchemeOptions options;
        bad.set(options, value);
        const std::string message = message_of([&] { make_scheme(name, s.model, options); });
        EXPECT_EQ(message.find(bad.field + " = " + number_text(value) + " must "), 0u)
            << name << ", " << bad.field << " = " << value << ": " << message;
        ++refusals;
      }
  EXPECT_GT(refusals, 400);
}

// Choices that do not go together.
TEST(SchemeOptions, AreRefusedWhereTheyContradictEachOther) {
  const Scene s = block_on_plate(0.3, 0, 0);
  const ContactSelector all = [](const ReductionInput&, const Clusters&) { return std::vector<int>{}; };
  for (const std::string& name : scheme_names())
    for (const ReductionOptions& bad :
         {ReductionOptions{.reducer = Reducer::hull_margin, .paper_exact = true},
          ReductionOptions{.reducer = Reducer::selector},
          ReductionOptions{.reducer = Reducer::hull_margin, .selector = all}})
      EXPECT_THROW(make_scheme(name, s.model, {.reduction = bad}), std::invalid_argument) << name;
  SchemeOptions pulled{.reduction = {.friction = FrictionAt::patches}};
  pulled.persistence.anchors = true;
  EXPECT_NE(message_of([&] { make_scheme("moreau_jean", s.model, pulled); }).find("anchors"),
            std::string::npos);
  EXPECT_NE(message_of([&] {
              make_scheme("event_driven", s.model, {.reduction = {.friction = FrictionAt::patches}});
            }).find("event_driven"),
            std::string::npos);
}

// The door of a step tells the least distance of the bodies that overlap most, as the door of a run does: not
// that of the first pair, nor that of simplices on which the certificate stumbled. An edge of the second
// block is 0.4 mm above the plate.
TEST(EveryScheme, RefusesToBeginInOverlapAndKeepsTheState) {
  Scene s = block_on_plate(0.3, 0, 0);
  const int tilted = add(s.model, s.model.bodies[std::size_t(s.block)]);
  const SE3 plain = pose(s.state, s.block);
  s.state = rest_state(s.model);
  pose(s.state, s.block) = translation(0, 0, -0.3 * kRadius) * plain;
  pose(s.state, tilted) =
      translation(0.5, 0, kSide / 2 * (std::cos(0.3) + std::sin(0.3)) + 4e-4) * rotation(Vec3::UnitY(), 0.3);
  const std::string begin = "bodies 0 (ground) and 2 (block): base distance = ";
  const std::uint64_t before = hash(s.state);
  std::vector<std::string> told{message_of([&] { validate_start(s.model, s.state); })};
  for (const std::string& name : scheme_names()) {
    const StepReport report = make_scheme(name, s.model, {}).step(s.state, kInf);
    EXPECT_EQ(report.status, StepStatus::refused) << name;
    EXPECT_EQ(hash(s.state), before) << name;
    told.push_back(report.reason);
  }
  for (const std::string& text : told) {
    const std::size_t at = text.find(begin);
    ASSERT_NE(at, std::string::npos) << text;
    EXPECT_NEAR(std::stod(text.substr(at + begin.size())), 4e-4, 1e-12) << text;
    EXPECT_NE(text.find(" must be at least 0.00192 [m]"), std::string::npos) << text;
  }
}

TEST(EveryScheme, RefusesStepsOfNoLength) {
  const Scene s = block_on_plate(0.3, 0, 0);
  for (const std::string& name : scheme_names())
    for (const double limit : {0.0, -1.0, kNan}) {
      State state = s.state;
      const Scheme scheme = make_scheme(name, s.model, {});
      EXPECT_EQ(message_of([&] { scheme.step(state, limit); }),
                "h_limit = " + number_text(limit) + " must be positive [s]")
          << name;
    }
}

// What `add` would not have taken is not taken by a scheme either.
TEST(EveryScheme, RefusesABadModel) {
  for (const std::string& name : scheme_names()) {
    Model massless = block_on_plate(0.3, 0, 0).model;
    massless.bodies[1].mass = -1;
    EXPECT_NE(message_of([&] { make_scheme(name, massless, {}); }).find("mass = -1 must be positive"),
              std::string::npos)
        << name;
    Model flat = block_on_plate(0.3, 0, 0).model;
    flat.bodies[1].inertia = -Mat3::Identity();
    EXPECT_NE(message_of([&] { make_scheme(name, flat, {}); }).find("inertia"), std::string::npos) << name;
    Model loose = block_on_plate(0.3, 0, 0).model;
    loose.joints.push_back({.name = "nowhere", .kind = JointKind::revolute, .body_a = 1, .body_b = 7});
    EXPECT_NE(message_of([&] { make_scheme(name, loose, {}); }).find("body_b = 7 must "), std::string::npos)
        << name;
    Model drilled = block_on_plate(0.3, 0, 0).model;
    drilled.contact_law.contensou_radius = -1e-3;
    EXPECT_NE(message_of([&] {
                make_scheme(name, drilled, {});
              }).find("contact_law.contensou_radius = -0.001 must be at least 0"),
              std::string::npos)
        << name;
  }
}

}  // namespace
}  // namespace aussois
