// SPDX-License-Identifier: Apache-2.0
// (MJ-14), (MJ-15): what normal impulses add to Newton's matrix is how the momentum that they give turns with
// the bodies.
#include "integrators/pose/gap_hessians.hpp"

#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "integrators/pose/contact_problem.hpp"
#include "lmd/find_contacts.hpp"
#include "mechanics/surface.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

// Two free bodies whose inertia and placing in the body are of no regular kind, near each other.
struct Pair {
  Model model{};
  State state{};
};

Pair pair_of(const SimplicialComplex& a, const SE3& g_a, const SimplicialComplex& b, const SE3& g_b) {
  Pair out;
  out.model.contact_law = {.mu = 0};
  for (const SimplicialComplex* complex : {&a, &b}) {
    const ShapeId shape = add(out.model, prepare(dilate(*complex, 0.02)));
    add(out.model, RigidBody{.name = complex == &a ? "a" : "b",
                             .shape = shape,
                             .g_bs = {exp_so3(Vec3(0.1, 0.2, -0.3)), Vec3(0.01, -0.02, 0.03)},
                             .mass = 1,
                             .inertia = Vec3(1, 2, 2.5).asDiagonal()});
  }
  out.state = rest_state(out.model);
  for (const BodyId body : out.model.bodies.ids())
    pose(out.state, body) = (body == 0 ? g_a : g_b) * inverse(out.model.bodies[body].g_bs);
  return out;
}

ContactSet contacts_of(const Pair& pair, const State& state) {
  return find_contacts(posed_shape(pair.model, state, 0), posed_shape(pair.model, state, 1),
                       {.threshold = 0.1, .alpha = 0.1, .alpha_ee = 0.3});
}

// The momentum that r_N gives to the bodies, by the rows of the step's problem.
VecX momentum_at(const Pair& pair, const State& state, const std::vector<double>& r_N) {
  const std::vector<ContactRow> rows =
      contact_rows(pair.model, state, layout(pair.model), contacts_of(pair, state),
                   VecX::Zero(state.v.size()), 1e-3, NormalRule{});
  EXPECT_EQ(rows.size(), r_N.size());
  std::vector<RowVector> r(rows.size(), RowVector::Zero());
  for (std::size_t i = 0; i < r.size(); ++i) r[i][0] = r_N[i];
  return momentum_of(rows, layout(pair.model), r);
}

// The largest difference between D xi and a central difference of fourth order, over random twists xi.
double error_of(const Pair& pair, const ContactSet& contacts, Random& random) {
  std::vector<double> r_N;
  for (std::size_t i = 0; i < contacts.points.size(); ++i) r_N.push_back(0.5 + random.uniform());
  const double time = 0.7, step = 1e-4;
  const MatX D(gap_hessians(pair.model, pair.state, contacts, r_N, layout(pair.model), time));
  double worst = 0;
  for (int sample = 0; sample < 10; ++sample) {
    VecX xi(12);
    xi << random.vector(), random.vector(), random.vector(), random.vector();
    const auto there = [&](double s) {
      State state = pair.state;
      state.g = moved_poses(pair.model, pair.state, xi, s);
      return momentum_at(pair, state, r_N);
    };
    const VecX rate = (8 * (there(step) - there(-step)) - (there(2 * step) - there(-2 * step))) / (12 * step);
    worst = std::max(worst, (D * xi + time * rate).norm() / (1 + rate.norm()));
  }
  return worst;
}

struct Meeting {
  const char* name;
  int dim_a, dim_b;
  SimplicialComplex a, b;
  SE3 g_b;
};

TEST(GapHessians, AreTheDerivativeOfTheMomentumThatNormalImpulsesGive) {
  const SimplicialComplex point = make_point(), line = make_segment(1), plate = make_plate(1, 1);
  const auto above = [](const Vec3& phi) { return SE3{exp_so3(phi), Vec3(0.02, 0.05, 0.06)}; };
  Random random(20);
  for (const Meeting& m : {Meeting{"vertex, vertex", 0, 0, point, point, above(Vec3::Zero())},
                           Meeting{"edge, vertex", 1, 0, line, point, above(Vec3::Zero())},
                           Meeting{"edge, edge", 1, 1, line, line, above(Vec3(0, 0.1, 1))},
                           Meeting{"face, vertex", 2, 0, plate, line, above(Vec3(0, 0.9, 0.2))}}) {
    const double up = m.dim_a == 2 ? 0.5 * std::sin(0.9) : 0;  // the lower end of the line touches
    SE3 g_b = m.g_b;
    g_b.p.z() += up;
    const SE3 whole{exp_so3(Vec3(0.3, -0.5, 0.7)), Vec3(0.4, 0.1, -0.2)};
    const Pair pair = pair_of(m.a, whole, m.b, whole * g_b);
    const ContactSet contacts = contacts_of(pair, pair.state);
    ASSERT_EQ(contacts.points.size(), 1u) << m.name;
    EXPECT_EQ(contacts.points[0].a.dim, m.dim_a) << m.name;
    EXPECT_EQ(contacts.points[0].b.dim, m.dim_b) << m.name;
    EXPECT_LT(error_of(pair, contacts, random), 1e-8) << m.name;  // curvature 1 / d^4 = 1e6 times step^4
  }
}

TEST(GapHessians, LeaveOutWhatDoesNotMoveAndWhatIsNotPressed) {
  Pair pair = pair_of(make_point(), {}, make_point(), translation(0, 0, 0.06));
  const ContactSet contacts = contacts_of(pair, pair.state);
  ASSERT_EQ(contacts.points.size(), 1u);
  EXPECT_EQ(gap_hessians(pair.model, pair.state, contacts, {0}, layout(pair.model), 1).nonZeros(), 0);
  const SparseMatrix both = gap_hessians(pair.model, pair.state, contacts, {1}, layout(pair.model), 1);
  pair.model.bodies[0].motion = FixedMotion{};
  const SparseMatrix one = gap_hessians(pair.model, pair.state, contacts, {1}, layout(pair.model), 1);
  ASSERT_EQ(one.rows(), 6);
  EXPECT_EQ((MatX(one) - MatX(both).bottomRightCorner<6, 6>()).norm(), 0);
  EXPECT_NEAR(one.coeff(0, 0), -1 / 0.06, 1e-12);  // a ball on a ball: -r_N / d across the normal
  EXPECT_NEAR(one.coeff(2, 2), 0, 1e-12);
}

TEST(GapHessians, AreTakenAsFarAsTheyLeaveAMass) {
  SparseMatrix M(2, 2);
  M.setIdentity();
  M *= 4;
  const auto kept = [&](double d) {
    SparseMatrix D(2, 2);
    D.insert(0, 0) = d;
    D.insert(0, 1) = 1;  // what is not symmetric does no work
    D.insert(1, 0) = -1;
    return MatX(kept_positive(M, D));
  };
  EXPECT_EQ(kept(100)(0, 0), 100);
  EXPECT_EQ(kept(-1.9)(0, 0), -1.9);
  EXPECT_EQ(kept(-2.1)(0, 0), -1.05);
  EXPECT_EQ(kept(-2.1)(0, 1), 0.5);
  EXPECT_EQ(kept(-15)(0, 0), -15.0 / 8);
  EXPECT_EQ(kept(-17).norm(), 0);
}

}  // namespace
}  // namespace aussois
