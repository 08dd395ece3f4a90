// SPDX-License-Identifier: Apache-2.0
#include "examples/scenes/beams.hpp"

#include <Eigen/Eigenvalues>

#include "mechanics/forces.hpp"

namespace aussois {

BeamSection section_of(const BeamNumbers& n) {
  BeamSection out;
  out.stiffness << n.EA, n.GA, n.GA, n.GJ, n.EI, n.EI;
  out.mass_per_length = n.mass;
  out.inertia_per_length = {n.about_x, n.across, n.across};
  return out;
}

BeamScene beam_scene(const std::vector<SE3>& nodes, const BeamNumbers& numbers, bool clamped,
                     CableOptions options) {
  BeamScene out;
  out.model.gravity = Vec3::Zero();
  options.name = "beam", options.nodes = nodes, options.section = section_of(numbers);
  out.cable = add_cable(out.model, options);
  if (clamped) out.model.bodies[out.first()].motion = FixedMotion{};
  out.state = rest_state(out.model);
  lay(out.cable, out.state);
  return out;
}

std::vector<SE3> straight_nodes(const Vec3& from, const Vec3& to, int elements) {
  return frames_along(points_along({from, to}, elements + 1));
}

void add(Model& model, const DeadLoad& load) {
  const auto factor_at = [load](double t) { return *load.factor * (load.course ? load.course(t) : 1); };
  add(model, ForceLaw{.name = "dead load",
                      .add_to = [=](const Model&, const State& state, double t, GeneralisedForce& force) {
                        const double factor = factor_at(t);
                        const Vec3 moment = factor * (pose(state, load.body).R.conjugate() * load.moment);
                        linear_part(force.f, load.body) += factor * load.force;
                        angular_part(force.f, load.body) += moment;
                        const int at = first_velocity(load.body) + 3;
                        if (!load.moment.isZero(0)) add_block(force.K, at, at, -skew(moment));
                      }});
}

Modes small_modes(const Model& model, const State& state) {
  State still = state;
  still.v.setZero();
  const Forces forces = forces_at(model, still, layout(model));
  const MatX K = MatX(forces.K), M = MatX(forces.mass);
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> modes(MatX((K + K.transpose()) / 2), M);
  return {modes.eigenvalues(), modes.eigenvectors()};
}

}  // namespace aussois
