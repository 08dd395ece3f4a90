// SPDX-License-Identifier: Apache-2.0
// Solids, sheets and cables that touch others and themselves (doc/theory/solids.md, deforming_shapes.md):
// each step audited, balanced, and the same on more threads and after a restart.
#include <array>

#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "geometry/volume_primitives.hpp"
#include "integrators/prove/path_audit.hpp"
#include "integrators/run.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "io/checkpoint.hpp"
#include "mechanics/cable.hpp"
#include "mechanics/sheet.hpp"
#include "mechanics/solid.hpp"
#include "tests/support/files.hpp"

namespace aussois {
namespace {

struct SoftScene {
  const char* name = "";
  Model model{};
  State state{};
  double h = 1e-3;
  int steps = 0;
  int contacts = 0;  // at least so many at some time
  bool touches_itself = false;
};

void add_floor(Model& model, double z) {
  add(model, RigidBody{.name = "floor",
                       .shape = add(model, prepare(dilate(make_plate(2, 2), 1e-3))),
                       .g_bs = translation(0, 0, z),
                       .motion = FixedMotion{}});
}

SoftScene dropped_cubes() {
  SoftScene s{.name = "cubes", .steps = 120, .contacts = 20};
  s.model.contact_law.mu = 0.4;
  add_floor(s.model, 0);
  for (int k = 0; k < 2; ++k)
    add_solid(s.model, make_box_mesh(Vec3::Constant(0.1), {2, 2, 2}),
              {.name = "cube",
               .materials = {{.young = 5e4, .poisson = 0.4, .density = 1000, .viscosity = 50}},
               .place = SE3{exp_so3(Vec3(0.05 * k, 0.1, 0)), Vec3(0.01 * k, 0, 0.065 + 0.12 * k)},
               .radius = 1e-3});
  s.state = rest_state(s.model);
  return s;
}

SoftScene folded_cloth() {
  SoftScene s{.name = "cloth", .h = 2e-3, .steps = 250, .contacts = 10, .touches_itself = true};
  s.model.contact_law.mu = 0.3;
  add_floor(s.model, -0.35);
  add(s.model, RigidBody{.name = "rod",
                         .shape = add(s.model, prepare(dilate(make_segment(1), 0.01))),
                         .g_bs = {exp_so3(kPi / 2 * Vec3::UnitZ()), Vec3::Zero()},
                         .motion = FixedMotion{}});
  add_sheet(s.model, make_plate(0.5, 0.2, 10, 4),
            {.material = {.young = 1e5, .poisson = 0.3, .density = 800},
             .thickness = 1e-3,
             .place = translation(0.02, 0, 0.02),
             .radius = 4e-3,
             .touches_itself = true});
  s.state = rest_state(s.model);
  return s;
}

SoftScene coiled_rope() {
  constexpr double kRadius = 5e-3;
  SoftScene s{.name = "rope", .h = 2e-3, .steps = 250, .contacts = 10, .touches_itself = true};
  s.model.contact_law.mu = 0.4;
  add_floor(s.model, 0);
  std::vector<Vec3> line;  // a helix whose turns fall onto each other
  for (int i = 0; i <= 60; ++i) {
    const double angle = 2 * kPi * 2.5 * i / 60;
    line.emplace_back(0.04 * std::cos(angle), 0.04 * std::sin(angle), 0.012 + 0.06 * i / 60);
  }
  const Cable rope = add_cable(s.model, {.name = "rope",
                                         .nodes = frames_along(line),
                                         .section = beam_section({.radius = kRadius,
                                                                  .young = 2e6,
                                                                  .density = 1100,
                                                                  .bending_stiffness = 1e-4,
                                                                  .damping_time = 2e-2}),
                                         .radius = kRadius,
                                         .touches_itself = true});
  s.state = rest_state(s.model);
  lay(rope, s.state);
  return s;
}

class SoftBodies : public ::testing::TestWithParam<int> {};

TEST_P(SoftBodies, TouchCertifiedAndBalancedOnAnyThreadsAndAfterARestart) {
  const SoftScene scene = std::array{dropped_cubes, folded_cloth, coiled_rope}[std::size_t(GetParam())]();
  const auto run_it = [&](int threads, int every, PathAudit* audit) {
    State state = scene.state;
    const auto scheme = [&] {
      return MoreauJean(scene.model, {.h = scene.h, .threads = threads}, {.theta = 1});
    };
    MoreauJean steps = scheme();
    int most = 0, own = 0;
    EnergyGain gain = energy_gain(scene.model, state);
    for (int k = 0; k < scene.steps; ++k) {
      if (every > 0 && k % every == every - 1) {
        const auto path = fresh_folder() / "checkpoint.h5";
        write_checkpoint(path, {.fingerprint = 1, .step = k, .state = state});
        state = read_checkpoint(path, 1).state;
        steps = scheme();
      }
      const State before = state;
      const StepReport report = steps.step(state);
      EXPECT_TRUE(report.ok()) << scene.name << " at step " << k << ": " << report.reason;
      if (!report.ok()) break;
      most = std::max(most, int(report.contacts.size()));
      for (const StepContact& c : report.contacts)
        own += c.point.a.body == c.point.b.body && c.impulse.norm() > 0;
      if (!audit) continue;
      audit_path(scene.model, before, state, report, 1, *audit);
      add_step(scene.model, state, report, gain);
      const Momentum off = report.momentum.residual();
      EXPECT_LT(off.linear.norm(), 1e-12) << k;
      EXPECT_LT(std::abs(report.energy.residual()), 1e-12) << k;
    }
    EXPECT_GE(most, scene.contacts) << scene.name;
    EXPECT_EQ(own > 0, scene.touches_itself) << scene.name;
    if (audit) {
      EXPECT_FALSE(energy_rises(gain)) << gain.largest;
    }
    return hash(state);
  };
  PathAudit audit{.samples = 3};
  const std::uint64_t once = run_it(1, 0, &audit);
  EXPECT_EQ(audit.violations, 0) << audit.uncovered << " uncovered";
  EXPECT_EQ(run_it(2, 0, nullptr), once);
  EXPECT_EQ(run_it(8, 0, nullptr), once);
  EXPECT_EQ(run_it(1, 7, nullptr), once);
}
INSTANTIATE_TEST_SUITE_P(Scenes, SoftBodies, ::testing::Values(0, 1, 2));

// The report of the last step of a run in which the points with `moves` are pressed down at 1 m/s, the others
// held.
template <class Place>
StepReport pressed(const Model& model, BlockId points, const Place& moves) {
  State state = rest_state(model);
  const std::vector<PointMass>& all = model.coordinates[points].points;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (moves(all[i].place)) state.v.segment<3>(first_speed(model, points) + 3 * Eigen::Index(i)) << 0, -1, 0;
  const MoreauJean scheme(model, {.h = 1e-2}, {.theta = 1});
  StepReport report;
  for (int k = 0; k < 1000 && report.moved(); ++k) report = scheme.step(state);
  EXPECT_NEAR(state.t, 0.95, 1e-2);
  return report;
}

TEST(SoftBody, IsRefusedByNameWhereACellIsCrushed) {
  const std::vector<std::array<bool, 3>> held(8, {true, true, true});
  const auto above = [](const Vec3& x) { return x.y() > 0; };
  Model model;
  const Solid cube = add_solid(model, make_box_mesh(Vec3::Ones(), {1, 1, 1}, CellKind::hexes),
                               {.materials = {{.young = 1, .density = 1}}, .held = held});
  const StepReport solid = pressed(model, cube.points, above);
  EXPECT_EQ(solid.status, StepStatus::refused);
  EXPECT_NE(solid.reason.find("force law (solid): cell 0 is left with"), std::string::npos) << solid.reason;
  Model flat;
  const Sheet cloth = add_sheet(
      flat, make_plate(1, 1),
      {.material = {.young = 1, .density = 1}, .thickness = 0.1, .held = {held.begin(), held.begin() + 4}});
  const StepReport sheet = pressed(flat, cloth.points, above);
  EXPECT_EQ(sheet.status, StepStatus::refused);
  EXPECT_NE(sheet.reason.find("force law (sheet): triangle 0 is left with"), std::string::npos)
      << sheet.reason;
}

}  // namespace
}  // namespace aussois
