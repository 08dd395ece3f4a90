// SPDX-License-Identifier: Apache-2.0
// doc/theory/mechanics.md: what a model accepts.
#include "mechanics/model.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();

RigidBody part() {
  return {.name = "part", .mass = 2, .inertia = Vec3(1, 2, 2.5).asDiagonal()};
}

std::string refusal(const RigidBody& body) {
  Model model;
  add(model, fixed_body("ground", -1));
  std::string message = message_of([&] { add(model, body); });
  EXPECT_EQ(model.bodies.size(), message.empty() ? 2u : 1u);  // a refused body is not added
  return message;
}

std::string refusal(const Model& model) {
  return message_of([&] { validate(model); });
}

TEST(Model, CountsWhatIsAdded) {
  Model model;
  EXPECT_EQ(add(model, prepare(dilate(make_box(1, 1, 1), 1e-3))), ShapeId(0));
  EXPECT_EQ(add(model, prepare(dilate(make_sphere(1, 0), 1e-3))), ShapeId(1));
  EXPECT_EQ(add(model, fixed_body("ground", 1)), BodyId(0));
  EXPECT_EQ(add(model, solid_body("part", 0, {.mass = 1, .inertia = Mat3::Identity()})), BodyId(1));
  EXPECT_EQ(model.shapes[0]->radius, 1e-3);
  EXPECT_EQ(refusal(model), "");
}

TEST(Model, RefusesWhatIsNoBody) {
  EXPECT_EQ(refusal(part()), "");
  RigidBody body = part();
  for (const double mass : {0.0, -1.0, kInf, kNan}) {
    body.mass = mass;
    expect_names(refusal(body), "body 1 (part): mass = ");
  }
  body = part();
  body.shape = 0;
  expect_names(refusal(body), "body 1 (part): shape = 0 must lie in [-1, 0)");
  body.shape = -2;
  expect_names(refusal(body), "body 1 (part): shape = -2");
  body = part();
  body.g_bs.R.coeffs() *= 2;
  expect_names(refusal(body), "body 1 (part): g_bs");
}

TEST(Model, RefusesWhatIsNoInertia) {
  RigidBody body = part();
  body.inertia(0, 1) = 1e-3;
  expect_names(refusal(body), "|inertia - transpose| = 0.001");
  body.inertia = Mat3::Constant(kNan);
  expect_names(refusal(body), "inertia must be finite");
  body.inertia = Vec3(1, -0.5, 1).asDiagonal();
  expect_names(refusal(body), "smallest principal moment of inertia = -0.5");
  body.inertia = Mat3::Zero();
  expect_names(refusal(body), "smallest principal moment of inertia = 0");
  body.inertia = Vec3(1, 1, 2.001).asDiagonal();
  expect_names(refusal(body), "largest principal moment of inertia = 2.00");
  expect_names(refusal(body), "the sum of the others, 2");
}

// A flat plate fulfils the triangle inequality with equality; rounding in any axes must not refuse it.
TEST(Model, AcceptsAFlatPlateInAnyAxes) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Random random(seed);
    const Mat3 R = random.rotation().toRotationMatrix();
    const double a = random.uniform(0.1, 1), b = random.uniform(0.1, 1);
    RigidBody body = part();
    body.inertia = R * Vec3(a, b, a + b).asDiagonal() * R.transpose();
    EXPECT_EQ(refusal(body), "") << "seed " << seed;
  }
}

TEST(Model, NeedsNoMassForWhatIsNotDynamic) {
  EXPECT_EQ(refusal(fixed_body("wall", -1)), "");
  EXPECT_EQ(refusal(prescribed_body("hand", -1, {{0, 1}, {SE3{}, SE3{}}})), "");
  expect_names(refusal(prescribed_body("hand", -1, {{0, 0}, {SE3{}, SE3{}}})),
               "body 1 (hand): path row 1: t = 0");
}

TEST(Model, ChecksBodiesChangedAfterwards) {
  Model model;
  add(model, part());
  model.bodies[0].mass = -3;
  expect_names(refusal(model), "body 0 (part): mass = -3");
}

TEST(Model, RefusesBadLaws) {
  Model model;
  add(model, part());
  add(model, fixed_body("ground", -1));
  Model bad = model;
  bad.contact_law.mu = -0.1;
  expect_names(refusal(bad), "contact_law.mu = -0.1");
  bad = model;
  bad.contact_law.restitution = 1.5;
  expect_names(refusal(bad), "contact_law.restitution = 1.5");
  bad = model;
  bad.pair_laws[{0, 1}].mu = kNan;
  expect_names(refusal(bad), "pair_laws{0, 1}.mu = nan");
  for (const BodyPair& pair : {BodyPair{1, 0}, BodyPair{0, 0}, BodyPair{0, 2}, BodyPair{-1, 0}}) {
    bad = model;
    bad.pair_laws[pair] = {};
    expect_names(refusal(bad), "pair_laws{" + to_string(pair.a));
  }
  bad = model;
  bad.gravity.z() = kInf;
  expect_names(refusal(bad), "gravity");
  bad = model;
  bad.shapes.push_back(nullptr);
  expect_names(refusal(bad), "shape 0");
  EXPECT_THROW(add(model, ForceLaw{.name = "nothing"}), std::invalid_argument);
  bad = model;
  bad.forces.push_back({.name = "nothing"});
  expect_names(refusal(bad), "force law (nothing)");
}

TEST(Model, TheLawOfAPairDoesNotDependOnTheOrder) {
  Model model{.contact_law = {.mu = 0.1}};
  model.pair_laws[{1, 4}] = {.mu = 0.7};
  EXPECT_EQ(contact_law(model, 1, 4).mu, 0.7);
  EXPECT_EQ(contact_law(model, 4, 1).mu, 0.7);
  EXPECT_EQ(contact_law(model, 0, 1).mu, 0.1);
}

TEST(RigidBody, SolidSitsAtItsCentreOfMass) {
  const MassProperties mass{
      .volume = 1, .mass = 3, .centre = {1, 2, 3}, .inertia = Vec3(1, 2, 2).asDiagonal()};
  const RigidBody body = solid_body("part", 5, mass);
  EXPECT_EQ(body.g_bs * mass.centre, Vec3::Zero());
  EXPECT_EQ(body.mass, 3);
  EXPECT_EQ(body.inertia, mass.inertia);
  EXPECT_EQ(body.shape, ShapeId(5));
  EXPECT_TRUE(is_dynamic(body));
  EXPECT_FALSE(is_dynamic(fixed_body("wall", 0)));
  EXPECT_FALSE(is_dynamic(prescribed_body("hand", 0, {})));
}

}  // namespace
}  // namespace aussois
