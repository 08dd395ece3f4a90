// SPDX-License-Identifier: Apache-2.0
#include "mechanics/state.hpp"

#include <algorithm>
#include <bit>

#include "geometry/check.hpp"
#include "geometry/digest.hpp"
#include "lmd/feature_incidence.hpp"
#include "mechanics/mechanism.hpp"
#include "mechanics/tree.hpp"

namespace aussois {
namespace {

bool sorted_by_key(const ContactMemory& memory) {
  return std::is_sorted(memory.contacts.begin(), memory.contacts.end(),
                        [](const RememberedContact& a, const RememberedContact& b) { return a.key < b.key; });
}

bool has_feature(const Model& model, BodyId body, const KeyFeature& f) {
  if (!model.bodies.contains(body)) return false;
  const ShapeId shape = model.bodies[body].shape;
  return shape && std::size_t(f.region) < feature_count(*model.shapes[shape], f.dim);
}

// Carried bodies must be where the coordinates put them.
void check_carried(const Model& model, const State& state) {
  constexpr double kRounding = 1e-9;  // [rad], and of lengths [m] beside one metre
  PerBody<SE3> g = state.g;
  carry_poses(model, state.q, g);
  for (const BodyId b : g.ids())
    if (is_carried(model.bodies[b]) && ((g[b].p - state.g[b].p).norm() > kRounding * (1 + g[b].p.norm()) ||
                                        g[b].R.angularDistance(state.g[b].R) > kRounding * 10))
      require(false, "State, body " + to_string(b) + " (" + model.bodies[b].name +
                         "): pose must be that of the coordinates that carry it: call carry()");
}

// Nothing is put together unless it is wrong: every step comes here.
void check_feature(const Model& model, std::size_t contact, BodyId body, const KeyFeature& f) {
  if (has_feature(model, body, f)) return;
  const std::string who = "State::memory, contact " + std::to_string(contact) + ": ";
  require(model.bodies.contains(body), who + "its bodies must exist");
  const ShapeId shape = model.bodies[body].shape;
  const std::string name = "body " + to_string(body) + " (" + model.bodies[body].name + ")";
  require(bool(shape), who + name + " must have a shape: clear a memory of other shapes");
  require_field(f.dim <= 2, (who + "dimension of the feature of " + name).c_str(), f.dim, "lie in [0, 2]");
  constexpr const char* kFeatures[] = {"vertex", "chain", "region"};
  const std::string count = std::to_string(feature_count(*model.shapes[shape], f.dim));
  require_field(false, (who + kFeatures[f.dim] + " of " + name).c_str(), f.region,
                ("lie in [0, " + count + "), as in its shape: clear a memory of other shapes").c_str());
}

}  // namespace

void validate(const Model& model, const ContactMemory& memory) {
  for (std::size_t i = 0; i < memory.contacts.size(); ++i) {
    const ContactKey& key = memory.contacts[i].key;
    check_feature(model, i, key.body_a, feature_a(key));
    check_feature(model, i, key.body_b, feature_b(key));
  }
}

State rest_state(const Model& model) {
  State state;
  state.g.resize(model.bodies.size());
  state.v = VecX::Zero(velocity_count(model));
  state.q = VecX::Zero(first_coordinate(model, model.coordinates.next()));
  state.u = VecX::Zero(model.inputs);
  for (const BodyId i : model.bodies.ids())
    if (const PrescribedMotion* prescribed = std::get_if<PrescribedMotion>(&model.bodies[i].motion))
      state.g[i] = trajectory_point(prescribed->path, prescribed->path.t.front()).pose;
  carry_poses(model, state.q, state.g);
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
  const auto check_size = [](auto size, std::size_t wanted, const char* field, const char* what) {
    require_field(std::size_t(size) == wanted, field, size,
                  ("be " + std::string(what) + ", " + std::to_string(wanted)).c_str());
  };
  const std::size_t speeds = std::size_t(velocity_count(model)),
                    of_bodies = std::size_t(first_velocity(model.bodies.next()));
  check_size(
      state.v.size(), speeds, "size of State::v",
      speeds == of_bodies ? "six times the number of bodies" : "that of six per body and the coordinates");
  check_size(state.q.size(), speeds - of_bodies, "size of State::q", "the number of coordinates");
  if (!state.turns.empty())
    check_size(state.turns.size(), 3 * model.joints.size(), "size of State::turns",
               "three times the number of joints, or 0");
  if (state.r.size() > 0)
    check_size(state.r.size(), std::size_t(row_count(model)), "size of State::r",
               "that of the rows of axes and gap functions, or 0");
  if (state.a.size() > 0)
    check_size(state.a.size(), 2 * speeds, "size of State::a", "twice that of State::v, or 0");
  require(state.a.allFinite(), "State::a must be finite");
  check_size(state.u.size(), std::size_t(model.inputs), "size of State::u", "the number of inputs");
  require(state.u.allFinite(), "State::u must be finite");
  require(state.q.allFinite(), "State::q must be finite");
  require(state.v.tail(state.q.size()).allFinite(), "State::v: the speeds of q must be finite");
  require(state.r.allFinite(), "State::r must be finite");
  for (const BodyId i : model.bodies.ids()) {
    const std::string who = "State, body " + to_string(i) + " (" + model.bodies[i].name + "): ";
    checked_pose(state.g[i], (who + "pose").c_str());
    require(body_part(state.v, i).allFinite(), who + "twist must be finite");
  }
  check_carried(model, state);
  for (std::size_t i = 0; i < state.memory.contacts.size(); ++i) {
    const RememberedContact& c = state.memory.contacts[i];
    require(c.normal.allFinite() && c.point_a.allFinite() && c.point_b.allFinite() && c.impulse.allFinite() &&
                std::isfinite(c.drilling) && c.anchor_b.allFinite(),
            "State::memory, contact " + std::to_string(i) + ": normal, points and impulse must be finite");
  }
  validate(model, state.memory);
  require(sorted_by_key(state.memory), "State::memory must be sorted by key");
}

SE3& pose(State& state, BodyId body) {
  return state.g.at(body);
}
const SE3& pose(const State& state, BodyId body) {
  return state.g.at(body);
}

Eigen::Ref<Vec6> twist(State& state, BodyId body) {
  AUSSOIS_ASSERT(body && first_velocity(body) + 6 <= state.v.size());
  return body_part(state.v, body);
}
Vec6 twist(const State& state, BodyId body) {
  AUSSOIS_ASSERT(body && first_velocity(body) + 6 <= state.v.size());
  return body_part(state.v, body);
}

VecX coordinates(const Model& model, const State& state, BlockId block) {
  return state.q.segment(first_coordinate(model, block), model.coordinates[block].size);
}
VecX speeds(const Model& model, const State& state, BlockId block) {
  return state.v.segment(first_speed(model, block), model.coordinates[block].size);
}

namespace {

void check_size(const MatX& A, Eigen::Index rows, Eigen::Index columns, const std::string& who) {
  if (A.rows() == rows && A.cols() == columns) return;
  const auto text = [](Eigen::Index m, Eigen::Index n) {
    return std::to_string(m) + " x " + std::to_string(n);
  };
  require_field(false, who.c_str(), text(A.rows(), A.cols()), ("be " + text(rows, columns)).c_str());
}

}  // namespace

Vec3 without_held(const PointMass& point, Vec3 along) {
  for (int axis = 0; axis < 3; ++axis)
    if (point.held[axis]) along[axis] = 0;
  return along;
}

Vec3 point_place(const Coordinates& block, const VecX& q, std::size_t point) {
  return block.points[point].place + q.segment<3>(3 * Eigen::Index(point));
}

VecX block_weight(const Model& model, BlockId block) {
  const Coordinates& c = model.coordinates[block];
  VecX out = VecX::Zero(c.size);
  for (std::size_t i = 0; i < c.points.size(); ++i)
    out.segment<3>(3 * Eigen::Index(i)) = c.points[i].mass * without_held(c.points[i], model.gravity);
  return out;
}

SparseMatrix block_mass(const Model& model, BlockId block, const VecX& q) {
  const Coordinates& c = model.coordinates[block];
  if (c.points.empty()) {
    const MatX M = c.mass(q);
    check_size(M, c.size, c.size, "coordinates " + to_string(block) + " (" + c.name + "): mass");
    return M.sparseView();
  }
  SparseMatrix M(c.size, c.size);
  M.reserve(c.size);
  for (int i = 0; i < c.size; ++i) {
    const PointMass& point = c.points[std::size_t(i) / 3];
    M.startVec(i);
    M.insertBack(i, i) = point.held[i % 3] ? 1 : point.mass;  // any: what is held keeps its speed
  }
  M.finalize();
  return M;
}

CoordinateForce block_force(const Model& model, BlockId block, double t, const VecX& q, const VecX& v) {
  const Coordinates& c = model.coordinates[block];
  if (!c.force) return {.f = VecX::Zero(c.size), .K = {}, .C = {}};
  CoordinateForce out = c.force(t, q, v);
  const std::string who = "coordinates " + to_string(block) + " (" + c.name + "): force.";
  check_size(out.f, c.size, 1, who + "f");
  if (out.K.size() > 0) check_size(out.K, c.size, c.size, who + "K");
  if (out.C.size() > 0) check_size(out.C, c.size, c.size, who + "C");
  return out;
}

GapRows gap_function(const Model& model, const State& state, GapId gap, double t) {
  const GapFunction& g = model.gaps[gap];
  GapRows out = g.evaluate(model, state, t);
  const std::string who = "gap function " + to_string(gap) + " (" + g.name + "): ";
  require_field(out.J.rows() >= 1 && out.J.rows() <= 3, (who + "rows of J").c_str(), out.J.rows(),
                "lie in [1, 3]");
  check_size(out.J, out.J.rows(), gap_columns(model, g), who + "J");
  if (out.rate.size() > 0) check_size(out.rate, out.J.rows(), 1, who + "rate");
  return out;
}

namespace {

constexpr int kRowsOfAnAxis = 4, kRowsOfAJoint = 3 * kRowsOfAnAxis, kRowsOfAGap = 3;

int first_gap_row(const Model& model) {
  return kRowsOfAJoint * int(model.joints.size());
}

}  // namespace

int slot_of(const AxisSlot& of) {
  return kRowsOfAJoint * of.joint.index() + kRowsOfAnAxis * of.axis + int(of.row);
}
int slot_of(const Model& model, GapId gap) {
  return first_gap_row(model) + kRowsOfAGap * gap.index();
}
int row_count(const Model& model) {
  return first_gap_row(model) + kRowsOfAGap * int(model.gaps.size());
}
bool is_of_axis(const Model& model, std::optional<int> slot) {
  return slot && *slot < first_gap_row(model);
}
AxisSlot axis_slot(int slot) {
  return {.joint = JointId::at(slot / kRowsOfAJoint),
          .axis = slot % kRowsOfAJoint / kRowsOfAnAxis,
          .row = AxisRow(slot % kRowsOfAnAxis)};
}
GapId gap_of(const Model& model, std::optional<int> slot) {
  const int row = slot.value_or(-1) - first_gap_row(model);
  return row < 0 ? GapId() : GapId::at(row / kRowsOfAGap);
}

std::uint64_t placement(const Model& model, const State& state) {
  std::uint64_t digest = 1;
  const auto add = [&](std::uint64_t word) {  // few instructions: every step does it for all bodies
    digest = std::rotl(digest ^ word, 25) * 0x9e3779b97f4a7c15u;
  };
  const auto add_number = [&](double x) { add(std::bit_cast<std::uint64_t>(x)); };
  for (const SE3& g : state.g) {
    for (const double component : g.R.coeffs()) add_number(component);
    for (const double component : g.p) add_number(component);
  }
  for (const double component : state.q) add_number(component);
  for (const auto& [a, b] : model.passing)
    add(std::uint64_t(std::uint32_t(a.index())) << 32 | std::uint32_t(b.index()));
  return digest == 0 ? 1 : digest;
}
bool is_proven_apart(const Model& model, const State& state) {
  return state.h > 0 && state.apart != 0 && state.apart == placement(model, state);
}

std::uint64_t hash(const State& state) {
  Digest digest;
  digest.add(state.t);
  digest.add(state.h);
  digest.add(state.h_next);
  digest.add(state.apart);
  digest.add(std::uint64_t(state.g.size()));
  for (const SE3& g : state.g) {
    for (const double component : g.R.coeffs()) digest.add(component);
    digest.add(g.p);
  }
  digest.add(std::uint64_t(state.v.size()));
  for (const double component : state.v) digest.add(component);
  digest.add(std::uint64_t(state.q.size()));
  for (const double component : state.q) digest.add(component);
  digest.add(std::uint64_t(state.turns.size()));
  for (const int turn : state.turns) digest.add(std::uint64_t(std::int64_t(turn)));
  digest.add(std::uint64_t(state.r.size()));
  for (const double component : state.r) digest.add(component);
  digest.add(std::uint64_t(state.a.size()));
  for (const double component : state.a) digest.add(component);
  if (state.u.size() > 0) digest.add(std::uint64_t(state.u.size()));
  for (const double component : state.u) digest.add(component);
  digest.add(std::uint64_t(state.memory.contacts.size()));
  for (const RememberedContact& c : state.memory.contacts) {
    digest.add(std::uint64_t(std::uint32_t(c.key.body_a.index())));
    digest.add(std::uint64_t(std::uint32_t(c.key.body_b.index())));
    digest.add(c.key.feature);
    digest.add(c.normal);
    digest.add(c.point_a);
    digest.add(c.point_b);
    digest.add(c.impulse);
    digest.add(c.drilling);
    digest.add(c.anchor_b);
    digest.add(std::uint64_t(c.held));
    digest.add(std::uint64_t(c.solved));
  }
  return digest.value;
}

Energy energy(const Model& model, const State& state) {  // (MEC-4)
  Energy energy;
  for (const BodyId i : model.bodies.ids()) {
    const RigidBody& body = model.bodies[i];
    if (!has_inertia(body)) continue;
    const Vec6 v = twist(state, i);
    const Vec3 v_G = v.head<3>(), omega = v.tail<3>();
    energy.kinetic += 0.5 * body.mass * v_G.squaredNorm() + 0.5 * omega.dot(body.inertia * omega);
    energy.gravity -= body.mass * model.gravity.dot(state.g[i].p);
  }
  for (const ForceLaw& law : model.forces)
    if (law.potential) energy.laws += law.potential(model, state, state.t);
  energy.laws += spring_energy(model, state);
  for (const BlockId i : model.coordinates.ids()) {
    const Coordinates& block = model.coordinates[i];
    const VecX q = coordinates(model, state, i), v = speeds(model, state, i);
    if (block.mass) energy.kinetic += 0.5 * v.dot(block_mass(model, i, q) * v);
    for (std::size_t k = 0; k < block.points.size(); ++k) {
      const PointMass& point = block.points[k];
      const Vec3 free = without_held(point, v.segment<3>(3 * Eigen::Index(k)));
      energy.kinetic += 0.5 * point.mass * free.squaredNorm();
      energy.gravity -= point.mass * without_held(point, model.gravity).dot(point_place(block, q, k));
    }
    if (block.potential) energy.laws += block.potential(q);
  }
  return energy;
}

Momentum momentum(const Model& model, const State& state) {  // (MEC-6)
  Momentum sum;
  for (const BodyId i : model.bodies.ids()) {
    const RigidBody& body = model.bodies[i];
    if (!has_inertia(body)) continue;
    const Vec6 v = twist(state, i);
    const Vec3 p = body.mass * v.head<3>();
    sum.linear += p;
    sum.angular += state.g[i].p.cross(p) + state.g[i].R * Vec3(body.inertia * v.tail<3>());
  }
  for (const BlockId i : model.coordinates.ids()) {
    const Coordinates& block = model.coordinates[i];
    if (block.points.empty()) continue;
    const VecX q = coordinates(model, state, i), v = speeds(model, state, i);
    for (std::size_t k = 0; k < block.points.size(); ++k) {
      const Vec3 p = block.points[k].mass * without_held(block.points[k], v.segment<3>(3 * Eigen::Index(k)));
      sum.linear += p;
      sum.angular += point_place(block, q, k).cross(p);
    }
  }
  return sum;
}

}  // namespace aussois
