// SPDX-License-Identifier: Apache-2.0
// Group J: mechanisms in joint coordinates against the same in maximal ones (doc/theory/trees.md).
#include "examples/scenes/trees.hpp"

#include <algorithm>

#include "examples/studies/verification/running.hpp"
#include "mechanics/mechanism.hpp"

namespace aussois {
namespace {

// The largest distance [m] and angle [rad] between the poses of the same bodies.
double difference(const State& a, const State& b) {
  Worst out;
  for (const BodyId i : a.g.ids()) {
    out.add((a.g[i].p - b.g[i].p).norm());
    out.add(a.g[i].R.angularDistance(b.g[i].R));
  }
  return out;
}

// By the same differential equation, to its tolerance; `off`: of what the joints of the trees lock.
Figures from_event_to_event(const TreeScene& scene, double t_end) {
  SchemeOptions options = exact_options(0.05);
  options.event_driven.ode = {.relative = 1e-12, .absolute = 1e-12};
  Worst off;
  const State tree = run_to(in_joint_coordinates(scene), "event_driven", options, t_end,
                            [&](const State& state, const StepReport&) {
                              for (const std::vector<JointId>& joints : scene.trees)
                                for (const JointId j : joints) {
                                  const JointError error = joint_error(scene.bodies.model, state, j);
                                  off.add(std::max(error.translation, error.rotation));
                                }
                            });
  const State maximal = run_to(scene.bodies, "event_driven", options, t_end);
  return {{"difference", difference(tree, maximal)}, {"drift", off}};
}

VerificationCase same_motion(const std::string& name, const std::string& what, double t_end, bool slow,
                             const std::function<TreeScene()>& scene) {
  return {.name = name,
          .setting = "event_driven",
          .what = what,
          .rows = {{"difference", "largest difference of a pose from maximal coordinates", "m, rad", 1e-9,
                    "the same differential equation, to its tolerance"},
                   {"drift", "what joints of the tree are off", "m, rad", 1e-13, "exact: by construction"}},
          .measure = [scene, t_end] { return from_event_to_event(scene(), t_end); },
          .slow = slow};
}

// With contacts and friction, in any scheme: the difference is that of the steps.
VerificationCase pressed_peg(const std::string& scheme, double theta) {
  return {.name = "J4.pressed_peg",
          .setting = scheme + (scheme == "moreau_jean" ? theta == 1 ? " theta 1" : " theta 0.5" : ""),
          .what =
              "an arm of seven hinges with springs presses a peg on a plate and slides it, mu = 0.3, 0.6 s, "
              "1/2 ms",
          .rows = {{"difference", "distance of the peg from where it is in maximal coordinates", "m", 1e-4,
                    "the need: a tenth of the peg's dilation"},
                   {"drift", "what joints of the tree are off", "m", 1e-13, "exact: by construction"}},
          .measure =
              [scheme, theta] {
                const TreeScene scene = arm_with_peg();
                SchemeOptions options = exact_options(5e-4, NormalLaw::combined, 1e-10);
                options.moreau_jean.theta = theta;
                options.step.advancement.certify = true;
                const State a = run_to(in_joint_coordinates(scene), scheme, options, 0.6),
                            b = run_to(scene.bodies, scheme, options, 0.6);
                Worst drift;
                for (const JointId j : scene.trees[0])
                  drift.add(joint_error(scene.bodies.model, a, j).translation);
                const BodyId peg = scene.bodies.body;
                return Figures{{"difference", (pose(a, peg).p - pose(b, peg).p).norm()}, {"drift", drift}};
              },
          .certified = true};
}

}  // namespace

std::vector<VerificationCase> tree_verification() {
  std::vector<VerificationCase> out{
      same_motion("J1.double_pendulum", "two rods of 1/2 m swing for 2 s", 2, false,
                  [] { return rods_in_a_row(2, 0.3); }),
      same_motion("J2.four_bar", "crank, coupler and rocker fall for a second; one hinge closes the loop", 1,
                  false, four_bar),
      same_motion("J3.chain", "a chain of 20 rods, 1 m long, swings for a second", 1, true,
                  [] { return rods_in_a_row(20, 0.3); }),
      same_motion("J4.pressed_peg",
                  "an arm of seven hinges with springs presses a peg on a plate and slides it, mu = 0.3, for "
                  "a second",
                  1, true, arm_with_peg)};
  for (const char* scheme :
       {"moreau_jean", "moreau_jean_projected", "schatzman_paoli", "d1_minus_linear", "generalised_alpha"})
    out.push_back(pressed_peg(scheme, scheme == std::string("moreau_jean") ? 1 : 0.5));
  out.push_back(pressed_peg("moreau_jean", 0.5));
  return out;
}

}  // namespace aussois
