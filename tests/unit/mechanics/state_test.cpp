// SPDX-License-Identifier: Apache-2.0
// doc/theory/mechanics.md: state and energy.
#include "mechanics/state.hpp"

#include <functional>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

Model two_bodies() {
  Model model;
  const auto box = add(model, prepare(dilate(make_box(1, 1, 1), 0.01)));  // 8 vertices, 12 chains, 6 regions
  add(model, {.name = "part", .shape = box, .mass = 2, .inertia = Vec3(0.5, 0.25, 0.5).asDiagonal()});
  add(model, prescribed_body("hand", box, {{3, 4}, {translation(1, 2, 3), translation(1, 2, 4)}}));
  return model;
}

State some_state(const Model& model) {
  State state = rest_state(model);
  state.h = 1e-3;
  state.h_next = 2e-3;
  state.memory.contacts.resize(2);
  state.memory.contacts[0].key = {.body_a = 0, .body_b = 1, .feature = 3};
  state.memory.contacts[1].key = {.body_a = 0, .body_b = 1, .feature = 7};
  return state;
}

TEST(State, RestsAtTheOriginAndWherePathsBegin) {
  const Model model = two_bodies();
  const State state = rest_state(model);
  EXPECT_EQ(state.t, 0);
  EXPECT_EQ(state.h, 0);
  EXPECT_EQ(pose(state, 0).p, Vec3::Zero());
  EXPECT_EQ(pose(state, 1).p, Vec3(1, 2, 3));
  EXPECT_EQ(state.v, VecX::Zero(12));
  EXPECT_NO_THROW(validate(model, state));
}

TEST(State, PoseAndTwistAreViews) {
  State state = rest_state(two_bodies());
  pose(state, 1).p.x() = 5;
  twist(state, 1)[5] = 6;
  EXPECT_EQ(state.g[1].p.x(), 5);
  EXPECT_EQ(state.v[11], 6);
  const State& constant = state;
  EXPECT_EQ(twist(constant, 1)[5], 6);
  EXPECT_EQ(twist(constant, 0), Vec6::Zero());
}

// Every number the state holds, changed by one bit each.
TEST(State, HashSeesEveryNumber) {
  const Model model = two_bodies();
  const State state = some_state(model);
  EXPECT_EQ(hash(State(state)), hash(state));

  const auto bump = [](double& x) { x = std::nextafter(x, kInf); };
  std::vector<std::function<void(State&)>> changes = {
      [&](State& s) { bump(s.t); }, [&](State& s) { bump(s.h); }, [&](State& s) { bump(s.h_next); }};
  for (std::size_t i = 0; i < 2; ++i) {
    for (int k = 0; k < 4; ++k) changes.push_back([=](State& s) { bump(s.g[BodyId::at(i)].R.coeffs()[k]); });
    for (int k = 0; k < 3; ++k) {
      changes.push_back([=](State& s) { bump(s.g[BodyId::at(i)].p[k]); });
      changes.push_back([=](State& s) { bump(s.memory.contacts[i].normal[k]); });
      changes.push_back([=](State& s) { bump(s.memory.contacts[i].point_a[k]); });
      changes.push_back([=](State& s) { bump(s.memory.contacts[i].point_b[k]); });
      changes.push_back([=](State& s) { bump(s.memory.contacts[i].anchor_b[k]); });
      changes.push_back([=](State& s) { bump(s.memory.contacts[i].impulse[k]); });
    }
    changes.push_back([=](State& s) { bump(s.memory.contacts[i].drilling); });
    changes.push_back([=](State& s) { s.memory.contacts[i].held = true; });
    changes.push_back([=](State& s) { s.memory.contacts[i].solved = false; });
    changes.push_back([=](State& s) { ++s.memory.contacts[i].key.body_a; });
    changes.push_back([=](State& s) { ++s.memory.contacts[i].key.body_b; });
    changes.push_back([=](State& s) { ++s.memory.contacts[i].key.feature; });
  }
  for (int k = 0; k < 12; ++k) changes.push_back([=](State& s) { bump(s.v[k]); });
  changes.push_back([](State& s) { s.t = -0.0; });
  changes.push_back([](State& s) { s.q = VecX::Zero(1); });
  changes.push_back([](State& s) { s.q = VecX::Ones(1); });
  changes.push_back([](State& s) { s.r = VecX::Zero(1); });
  changes.push_back([](State& s) { s.r = VecX::Ones(1); });
  changes.push_back([](State& s) { s.a = VecX::Zero(1); });
  changes.push_back([](State& s) { s.a = VecX::Ones(1); });
  changes.push_back([](State& s) { s.u = VecX::Zero(1); });
  changes.push_back([](State& s) { s.u = VecX::Ones(1); });
  changes.push_back([](State& s) { s.turns = {0}; });
  changes.push_back([](State& s) { s.turns = {-1}; });
  changes.push_back([](State& s) { s.memory.contacts.pop_back(); });
  changes.push_back([](State& s) { s.g.pop_back(); });
  changes.push_back([](State& s) { s.v.conservativeResize(6); });
  changes.push_back([](State& s) { std::swap(s.g[0], s.g[1]); });
  changes.push_back([](State& s) { std::swap(s.memory.contacts[0], s.memory.contacts[1]); });

  std::set<std::uint64_t> hashes = {hash(state)};
  for (const auto& change : changes) {
    State other = state;
    change(other);
    hashes.insert(hash(other));
  }
  EXPECT_EQ(hashes.size(), changes.size() + 1);
}

std::string refusal(const Model& model, const State& state) {
  return message_of([&] { validate(model, state); });
}

TEST(State, IsRefusedUnlessItFitsTheModel) {
  const Model model = two_bodies();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(refusal(model, some_state(model)), "");
  const std::vector<std::pair<std::function<void(State&)>, std::string>> cases = {
      {[&](State& s) { s.t = nan; }, "State::t = nan"},
      {[](State& s) { s.h = -1; }, "State::h = -1"},
      {[](State& s) { s.h_next = -1; }, "State::h_next = -1"},
      {[](State& s) { s.g.pop_back(); }, "State::g = 1 must be the number of bodies, 2"},
      {[](State& s) { s.v.conservativeResize(6); },
       "State::v = 6 must be six times the number of bodies, 12"},
      {[](State& s) { s.g[1].R.coeffs() *= 1.1; }, "body 1 (hand): pose"},
      {[&](State& s) { s.v[7] = nan; }, "body 1 (hand): twist"},
      {[&](State& s) { s.memory.contacts[1].impulse.x() = nan; }, "State::memory, contact 1"},
      {[](State& s) { s.memory.contacts[1].key.body_b = 2; }, "contact 1: its bodies must exist"},
      {[](State& s) {
         s.memory.contacts[1].key.feature = feature_word({0, 0}, {0, 8});
       },
       "contact 1: vertex of body 1 (hand) = 8 must lie in [0, 8), as in its shape"},
      {[](State& s) {
         s.memory.contacts[1].key.feature = feature_word({1, 12}, {0, 0});
       },
       "contact 1: chain of body 0 (part) = 12 must lie in [0, 12)"},
      {[](State& s) {
         s.memory.contacts[1].key.feature = feature_word({0, 0}, {2, 6});
       },
       "contact 1: region of body 1 (hand) = 6 must lie in [0, 6)"},
      {[](State& s) { std::swap(s.memory.contacts[0], s.memory.contacts[1]); }, "sorted by key"}};
  for (const auto& [change, message] : cases) {
    State state = some_state(model);
    change(state);
    EXPECT_NE(refusal(model, state).find(message), std::string::npos) << refusal(model, state);
  }
}

// Two joints of three axes with four rows each, then two gap functions of three rows.
TEST(State, HasTheInputsThatLawsAskFor) {
  Model model;
  add(model, RigidBody{.mass = 1, .inertia = Mat3::Identity()});
  EXPECT_EQ(add_inputs(model, 3), 0);
  EXPECT_EQ(add_inputs(model, 2), 3);
  State state = rest_state(model);
  EXPECT_EQ(state.u, VecX::Zero(5));
  EXPECT_NO_THROW(validate(model, state));
  state.u.resize(0);
  expect_names(refusal(model, state), "size of State::u = 0 must be the number of inputs, 5");
  expect_names(message_of([&] { (void)add_inputs(model, 0); }), "count = 0 must be positive");
}

TEST(State, HasASlotForEachRowOfAnAxisAndOfAGapFunction) {
  Model model;
  model.joints.resize(2);
  model.gaps.resize(2);
  EXPECT_EQ(row_count(model), 2 * 3 * 4 + 2 * 3);
  int next = 0;
  for (const JointId joint : model.joints.ids())
    for (int axis = 0; axis < 3; ++axis)
      for (const AxisRow row :
           {AxisRow::lower_stop, AxisRow::upper_stop, AxisRow::friction, AxisRow::motor}) {
        const int slot = slot_of({.joint = joint, .axis = axis, .row = row});
        EXPECT_EQ(slot, next++);
        const AxisSlot back = axis_slot(slot);
        EXPECT_TRUE(back.joint == joint && back.axis == axis && back.row == row) << slot;
        EXPECT_TRUE(is_of_axis(model, slot) && !gap_of(model, slot)) << slot;
      }
  for (const GapId gap : model.gaps.ids()) {
    EXPECT_EQ(slot_of(model, gap), next);
    for (int row = 0; row < 3; ++row, ++next) {
      EXPECT_EQ(gap_of(model, next), gap);
      EXPECT_FALSE(is_of_axis(model, next));
    }
  }
  EXPECT_EQ(next, row_count(model));
  EXPECT_TRUE(!is_of_axis(model, {}) && !gap_of(model, {}));  // a contact
}

TEST(State, EnergyIsThatByHand) {
  Model model = two_bodies();
  model.gravity = {0, 0, -10};
  add(model, ForceLaw{.name = "constant",
                      .add_to = [](const Model&, const State&, double, GeneralisedForce&) {},
                      .potential = [](const Model&, const State&, double t) { return 100 * t; }});
  add(model, ForceLaw{.name = "dissipative",
                      .add_to = [](const Model&, const State&, double, GeneralisedForce&) {}});
  State state = rest_state(model);
  state.t = 0.5;
  pose(state, 0) = rotation({1, 1, 1}, 2) * translation(0, 0, 0);
  pose(state, 0).p = {7, 7, 3};
  twist(state, 0) << 1, 2, 2, 0, 4, 2;
  twist(state, 1) << 9, 9, 9, 9, 9, 9;  // prescribed: not counted
  const Energy e = energy(model, state);
  EXPECT_DOUBLE_EQ(e.kinetic, 0.5 * 2 * 9 + 0.5 * (0.25 * 16 + 0.5 * 4));
  EXPECT_DOUBLE_EQ(e.gravity, 2 * 10 * 3);
  EXPECT_DOUBLE_EQ(e.laws, 50);
  EXPECT_DOUBLE_EQ(e.total(), e.kinetic + e.gravity + e.laws);
}

}  // namespace
}  // namespace aussois
