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

BeamScene legs_scene(const std::vector<Vec3>& corners, int per_leg, const BeamSection& section) {
  BeamScene out;
  out.model.gravity = Vec3::Zero();
  const int elements = per_leg * int(corners.size() - 1);
  for (const Vec3& p : points_along(corners, elements + 1)) {
    out.cable.nodes.push_back(add(out.model, RigidBody{.mass = 1, .inertia = Mat3::Identity()}));
    out.cable.laid.push_back({Quat::Identity(), p});
  }
  Beam& beam = out.cable.beam;
  beam = {.name = "legs", .sections = {section}};
  for (int i = 0; i < elements; ++i) {
    const std::size_t leg = std::size_t(i / per_leg);
    const Vec3 along = corners[leg + 1] - corners[leg];
    const SE3 frame{Quat::FromTwoVectors(Vec3::UnitX(), along)};
    const double length = along.norm() / per_leg;
    beam.elements.push_back({.body_a = out.cable.nodes[std::size_t(i)],
                             .body_b = out.cable.nodes[std::size_t(i) + 1],
                             .frame_a = frame,
                             .frame_b = frame,
                             .length = length,
                             .rest = straight_rest(length)});
  }
  const PerBody<NodeMass> masses = node_masses(beam, out.model.bodies.size());
  for (const BodyId b : out.model.bodies.ids())
    out.model.bodies[b].mass = masses[b].mass, out.model.bodies[b].inertia = masses[b].inertia;
  add(out.model, beam);
  out.state = rest_state(out.model);
  lay(out.cable, out.state);
  return out;
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
  const MatX K = MatX(forces.K), M = MatX(forces.mass), symmetric = (K + K.transpose()) / 2;
  // M x = mu (K + shift M) x: rounding is a part of the largest eigenvalue, and those of beams that hardly
  // shear are 1e14 times those asked for
  double shift = 1;
  while (Eigen::LLT<MatX>(symmetric + shift * M).info() != Eigen::Success) shift *= 10;
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatX> inverse(M, symmetric + shift * M);
  return {.omega2 = (inverse.eigenvalues().cwiseInverse().array() - shift).reverse(),
          .shape = inverse.eigenvectors().rowwise().reverse()};
}

}  // namespace aussois
