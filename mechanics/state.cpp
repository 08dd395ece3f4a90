// SPDX-License-Identifier: Apache-2.0
#include "mechanics/state.hpp"

#include <algorithm>

#include "geometry/check.hpp"
#include "geometry/digest.hpp"

namespace aussois {
namespace {

bool sorted_by_key(const ContactMemory& memory) {
  return std::is_sorted(memory.contacts.begin(), memory.contacts.end(),
                        [](const RememberedContact& a, const RememberedContact& b) { return a.key < b.key; });
}

}  // namespace

State rest_state(const Model& model) {
  State state;
  state.g.resize(model.bodies.size());
  state.v = VecX::Zero(6 * Eigen::Index(model.bodies.size()));
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    if (const Prescribed* prescribed = std::get_if<Prescribed>(&model.bodies[i].motion))
      state.g[i] = evaluate(prescribed->path, prescribed->path.t.front()).pose;
  return state;
}

void validate(const Model& model, const State& state) {
  const std::size_t count = model.bodies.size();
  require_field(std::isfinite(state.t), "State::t", state.t, "be finite [s]");
  require_field(state.h >= 0 && std::isfinite(state.h), "State::h", state.h, "be at least 0 and finite [s]");
  require_field(state.h_next >= 0 && std::isfinite(state.h_next), "State::h_next", state.h_next,
                "be at least 0 and finite [s]");
  require_field(state.g.size() == count, "size of State::g", state.g.size(),
                ("be the number of bodies, " + std::to_string(count)).c_str());
  require_field(state.v.size() == Eigen::Index(6 * count), "size of State::v", state.v.size(),
                ("be six times the number of bodies, " + std::to_string(6 * count)).c_str());
  for (std::size_t i = 0; i < count; ++i) {
    const std::string who = "State, body " + std::to_string(i) + " (" + model.bodies[i].name + "): ";
    checked_pose(state.g[i], (who + "pose").c_str());
    require(state.v.segment<6>(6 * Eigen::Index(i)).allFinite(), who + "twist must be finite");
  }
  for (std::size_t i = 0; i < state.memory.contacts.size(); ++i) {
    const RememberedContact& c = state.memory.contacts[i];
    require(c.normal.allFinite() && c.point_a.allFinite() && c.impulse.allFinite(),
            "State::memory, contact " + std::to_string(i) + ": normal, point and impulse must be finite");
  }
  require(sorted_by_key(state.memory), "State::memory must be sorted by key");
}

SE3& pose(State& state, int body) {
  return state.g.at(std::size_t(body));
}
const SE3& pose(const State& state, int body) {
  return state.g.at(std::size_t(body));
}

Eigen::Ref<Vec6> twist(State& state, int body) {
  AUSSOIS_ASSERT(body >= 0 && 6 * (body + 1) <= state.v.size());
  return state.v.segment<6>(6 * body);
}
Vec6 twist(const State& state, int body) {
  AUSSOIS_ASSERT(body >= 0 && 6 * (body + 1) <= state.v.size());
  return state.v.segment<6>(6 * body);
}

std::uint64_t hash(const State& state) {
  Digest digest;
  digest.add(state.t);
  digest.add(state.h);
  digest.add(state.h_next);
  digest.add(std::uint64_t(state.g.size()));
  for (const SE3& g : state.g) {
    for (const double component : g.R.coeffs()) digest.add(component);
    digest.add(g.p);
  }
  digest.add(std::uint64_t(state.v.size()));
  for (const double component : state.v) digest.add(component);
  digest.add(std::uint64_t(state.memory.contacts.size()));
  for (const RememberedContact& c : state.memory.contacts) {
    for (const std::int32_t part : c.key.value) digest.add(std::uint64_t(std::uint32_t(part)));
    digest.add(c.normal);
    digest.add(c.point_a);
    digest.add(c.impulse);
  }
  return digest.value;
}

Energy energy(const Model& model, const State& state) {  // (MEC-4)
  Energy energy;
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const RigidBody& body = model.bodies[i];
    if (!is_dynamic(body)) continue;
    const Vec6 v = twist(state, int(i));
    const Vec3 v_G = v.head<3>(), omega = v.tail<3>();
    energy.kinetic += 0.5 * body.mass * v_G.squaredNorm() + 0.5 * omega.dot(body.inertia * omega);
    energy.gravity -= body.mass * model.gravity.dot(state.g[i].p);
  }
  for (const ForceLaw& law : model.forces)
    if (law.potential) energy.laws += law.potential(model, state, state.t);
  return energy;
}

}  // namespace aussois
