// SPDX-License-Identifier: Apache-2.0
// (CA-23): a nut that turns far on its bolt in a step, along the thread and off it.
#include "integrators/prove/certify_step.hpp"

#include <gtest/gtest.h>

#include "geometry/fastener.hpp"
#include "geometry/mass_properties.hpp"

namespace aussois {
namespace {

TEST(CertifyStep, ProvesAPathThatTurnsFarPieceByPiece) {
  const FastenerOptions thread{.clearance = 5e-4};
  Model model;
  add(model, fixed_body("bolt", add(model, prepare(dilate(make_bolt(thread), 1e-4)))));
  const SimplicialComplex nut = make_nut(thread);
  const BodyId turning =
      add(model, solid_body("nut", add(model, prepare(dilate(nut, 1e-4))), mass_properties(nut, 7850)));
  State state = rest_state(model);
  pose(state, turning).p = Vec3(0, 0, thread.pitch) - model.bodies[turning].g_bs.p;
  state.h = 1e-3;
  const double angle = 0.6;  // [rad] in the step
  const auto certified = [&](double rise) {
    VecX v = VecX::Zero(state.v.size());
    v[first_velocity(turning) + 2] = rise / state.h;
    v[first_velocity(turning) + 5] = angle / state.h;
    StepPath path = step_path({model, state, v, state.h}, body_bounds(model));
    path.starts_apart = true;
    return certify_step(path, {{.a = BodyId(0), .b = turning, .dilation = 2e-4, .threshold = 1}},
                        body_bounds(model), {}, {}, 1);
  };
  const double along = thread.pitch * angle / (2 * kPi);
  const StepCertificate proof = certified(along);
  EXPECT_EQ(proof.failure, "");
  EXPECT_LT(proof.rounds, 10000);  // in one piece it takes millions
  // Flanks that stand 30 degrees off the plane across the axis meet tan 30 of the clearance off the thread.
  for (const double off : {0.7, 1.2})
    for (const double sign : {-1, 1})
      EXPECT_NE(certified(along + sign * off * thread.clearance).failure, "") << sign * off;
}

}  // namespace
}  // namespace aussois
