// SPDX-License-Identifier: Apache-2.0
// What schemes keep, and of which order they lose the rest: momentum and energy from poses and velocities
// alone, and the numerical entries of the ledgers, against theory (doc/theory/ledgers.md).
#include <array>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "integrators/joint_rows.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/outside_judge.hpp"
#include "tests/support/scheme_variants.hpp"
#include "tests/support/springs.hpp"
#include "tests/support/stepping.hpp"
#include "tests/support/tumbling.hpp"

namespace aussois {
namespace {

constexpr double kZero = kInf;  // an order: nothing but rounding

// (LED-2): orders in h of what a run loses or gains.
struct Promise {
  double order = 1;  // of all that is not said otherwise
  double top_momentum = 1, top_energy = 1;
  double pair_momentum = 1, pair_energy = 1;  // of two bodies on a joint
  double spring_energy = 1;                   // linear
  double damping = kZero;                     // numerical_work and numerical.linear on springs
};

Promise promise(const SchemeVariant& v) {
  const SchemeOptions& o = v.options;
  const double p = scheme_traits(v.name, o).smooth;
  Promise out{p, p, p, p, p, p, p};
  const bool midpoint = o.theta == 0.5 && (v.name == "moreau_jean" || v.name == "moreau_jean_projected");
  const bool passive = v.name == "passive_midpoint";
  if (passive || (midpoint && o.newton.max_iterations > 1)) {  // the torque of the mean spin (PMI-3)
    out.top_energy = kZero;
    if (o.update == GroupUpdate::cayley) out.top_momentum = kZero;
  }
  if (passive && o.mean_joints) out.pair_momentum = out.pair_energy = kZero;
  if (passive || midpoint) out.spring_energy = out.damping = kZero;
  if (v.name == "generalised_alpha" && o.spectral_radius == 1) out.damping = kZero;
  return out;
}

/// Largest of a run, in parts of what there is at its start.
struct Lost {
  double linear = 0, angular = 0, energy = 0;
  double numerical_linear = 0, numerical_angular = 0, numerical_work = 0;  // added up, without signs
};

/// Runs that nothing acts on from outside; `potential` of a state [J].
struct Isolated {
  Model model{};
  State start{};
  std::function<double(const State&)> potential = [](const State&) { return 0.0; };
};

Lost lost(const Isolated& scene, const SchemeVariant& variant, double h) {
  SchemeOptions options = variant.options;
  options.h = h;
  options.solver.tolerance = 1e-14;
  const Judged first = judge(scene.model, scene.start);
  const double E = first.kinetic + scene.potential(scene.start), p = first.linear.norm(),
               L = first.angular.norm();
  Lost out;
  State state = scene.start;
  advance(make_scheme(variant.name, scene.model, options), state, 1, [&](const StepReport& report) {
    const Judged now = judge(scene.model, state);
    out.linear = std::max(out.linear, (now.linear - first.linear).norm() / p);
    out.angular = std::max(out.angular, (now.angular - first.angular).norm() / L);
    out.energy = std::max(out.energy, std::abs(now.kinetic + scene.potential(state) - E) / E);
    out.numerical_linear += report.momentum.numerical.linear.norm() / p;
    out.numerical_angular += report.momentum.numerical.angular.norm() / L;
    out.numerical_work += std::abs(report.energy.numerical_work) / E;
  });
  return out;
}

class Conservation : public ::testing::TestWithParam<SchemeVariant> {
 protected:
  // Two halvings: the order between the last two, or rounding at all three.
  struct Series {
    std::array<Lost, 3> lost{};
    void expect(double Lost::*what, double order, const char* name) const {
      const double coarse = lost[1].*what, fine = lost[2].*what;
      if (order == kZero) {
        for (const Lost& l : lost) EXPECT_LT(l.*what, 1e-12) << name;
      } else {
        EXPECT_GT(fine, 1e-11) << name << " says nothing";
        EXPECT_LT(lost[0].*what, 0.5) << name << " is far from its limit";
        EXPECT_GT(std::log2(coarse / fine), order - 0.1) << name;
      }
    }
  };
  Series series(const Isolated& scene) const {
    Series out;
    for (int i = 0; i < 3; ++i) out.lost[std::size_t(i)] = lost(scene, GetParam(), 1e-2 / (1 << i));
    return out;
  }
  const Promise theory = promise(GetParam());
};

Isolated free_top() {
  Isolated top;
  top.model.gravity.setZero();
  add(top.model, RigidBody{.name = "top", .mass = 2, .inertia = Vec3(0.1, 0.2, 0.3).asDiagonal()});
  top.start = rest_state(top.model);
  pose(top.start, 0).p = Vec3(0.3, -0.2, 0.5);
  twist(top.start, 0) << 1, 2, -1, 0.3, 4, 0.2;
  return top;
}

Isolated pair_on(JointKind kind) {
  const Tumbling tumbling(kind);
  return {.model = tumbling.model, .start = tumbling.state};
}

TEST_P(Conservation, OfAFreeTop) {
  const Series s = series(free_top());
  s.expect(&Lost::linear, kZero, "linear momentum");
  s.expect(&Lost::angular, theory.top_momentum, "angular momentum");
  s.expect(&Lost::energy, theory.top_energy, "energy");
  s.expect(&Lost::numerical_linear, kZero, "numerical, linear");
  s.expect(&Lost::numerical_angular, theory.top_momentum, "numerical, angular");
}

TEST_P(Conservation, OfTwoBodiesOnAJoint) {
  for (const JointKind kind : {JointKind::spherical, JointKind::prismatic}) {
    SCOPED_TRACE(to_string(kind));
    const Series s = series(pair_on(kind));
    s.expect(&Lost::linear, kZero, "linear momentum");
    s.expect(&Lost::angular, theory.pair_momentum, "angular momentum");
    s.expect(&Lost::energy, theory.pair_energy, "energy");
    s.expect(&Lost::numerical_angular, 1, "numerical, angular");  // the arms of the start (MJ-13)
  }
}

TEST_P(Conservation, OfASpringsEnergy) {
  Isolated s;
  s.model.gravity.setZero();
  add(s.model, RigidBody{.name = "mass", .mass = 2, .inertia = Mat3::Identity()});
  const Vec3 stiffness(8, 12, 16);
  add(s.model, spring(0, stiffness));
  s.start = rest_state(s.model);
  pose(s.start, 0).p = Vec3(0.3, -0.2, 0.5);
  twist(s.start, 0).head<3>() << 1, 2, -1;
  s.potential = [=](const State& state) { return stiffness.dot(state.g[0].p.cwiseAbs2()) / 2; };
  const Series series_of = series(s);
  series_of.expect(&Lost::energy, theory.spring_energy, "energy");
  series_of.expect(&Lost::numerical_work, theory.damping, "numerical work");
  const bool filters = GetParam().name == "generalised_alpha";  // its accelerations are no forces (GA-2)
  series_of.expect(&Lost::numerical_linear, filters ? theory.damping : kZero, "numerical, linear");
}

TEST(ConservationByTheReference, IsThatOfItsTolerances) {
  for (const Isolated& scene : {free_top(), pair_on(JointKind::spherical), pair_on(JointKind::prismatic)}) {
    const Lost l = lost(scene, {"event_driven", {}}, 1e-2);
    EXPECT_LT(l.linear, 1e-12);
    EXPECT_LT(l.angular, 1e-7);
    EXPECT_LT(l.energy, 1e-7);
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, Conservation, ::testing::ValuesIn([] {
                           std::vector<SchemeVariant> out = variants_with_joints();
                           std::erase_if(out,
                                         [](const SchemeVariant& v) { return v.name == "event_driven"; });
                           return out;
                         }()),
                         [](const auto& v) { return test_name(v.param); });

}  // namespace
}  // namespace aussois
