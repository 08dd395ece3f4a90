// SPDX-License-Identifier: Apache-2.0
// The force of an element against differences of its energy, its tangent against differences of the force
// (BEA-1) to (BEA-7), and what no rigid motion may change.
#include "mechanics/beam.hpp"

#include <gtest/gtest.h>

#include "mechanics/cable.hpp"
#include "mechanics/forces.hpp"
#include "mechanics/motion.hpp"
#include "mechanics/surface.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

using Vec12 = Eigen::Matrix<double, 12, 1>;
using Mat12 = Eigen::Matrix<double, 12, 12>;

struct Element {
  BeamEnds ends{};
  Vec6 stiffness = Vec6::Zero(), damping = Vec6::Zero(), rest = Vec6::Zero();
  double length = 1;

  BeamForces forces(BeamTangent* tangent = nullptr) const {
    return beam_forces(ends, stiffness, damping, length, rest, tangent);
  }
  Vec12 force() const {
    Vec12 out;
    const BeamForces of = forces();
    out << of.on_a, of.on_b;
    return out;
  }
  // After moving along the twist coordinates of both nodes.
  Element moved(const Vec12& d) const {
    Element out = *this;
    out.ends.g_a = retract(ends.g_a, d.head<6>(), 1);
    out.ends.g_b = retract(ends.g_b, d.tail<6>(), 1);
    return out;
  }
};

Vec6 random6(Random& random, double half) {
  Vec6 out;
  out << random.vector(half), random.vector(half);
  return out;
}

// Ends that turn by up to `turn` from each other.
Element random_element(Random& random, double turn, bool damped) {
  Element out;
  out.ends.g_a = random.pose(2);
  out.ends.g_b = out.ends.g_a * SE3{exp_so3(random.vector_of_length(0, turn)), random.vector(1)};
  out.ends.frame_a = {exp_so3(random.vector(0.3)), random.vector(0.2)};
  out.ends.frame_b = {exp_so3(random.vector(0.3)), random.vector(0.2)};
  out.ends.v_a = random6(random, 1), out.ends.v_b = random6(random, 1);
  for (double& x : out.stiffness) x = random.uniform(0.5, 2);
  if (damped)
    for (double& x : out.damping) x = random.uniform(0.1, 1);
  out.rest = random6(random, 0.4);
  out.length = random.uniform(0.5, 2);
  return out;
}

// Of a function of the twist coordinates.
template <class Function>
auto derivative(const Function& f, const Vec12& along) {
  return slope([&](double d) { return f(Vec12(d * along)); });
}

TEST(BeamElement, ForceIsMinusTheGradientOfItsEnergy) {
  Random random(1);
  for (int trial = 0; trial < 50; ++trial) {
    const Element e = random_element(random, 1.8, false);
    for (int i = 0; i < 12; ++i)
      EXPECT_NEAR(derivative([&](const Vec12& d) { return e.moved(d).forces().energy; }, Vec12::Unit(i)),
                  -e.force()[i], 1e-9)
          << "trial " << trial << ", coordinate " << i;
  }
}

TEST(BeamElement, TangentIsTheDerivativeOfTheForce) {
  Random random(2);
  for (const bool damped : {false, true})
    for (int trial = 0; trial < 50; ++trial) {
      const Element e = random_element(random, 1.8, damped);
      BeamTangent tangent;
      e.forces(&tangent);
      for (int i = 0; i < 12; ++i) {
        const Vec12 by_place = derivative([&](const Vec12& d) { return e.moved(d).force(); }, Vec12::Unit(i));
        EXPECT_LT((by_place + tangent.K.col(i)).norm(), 2e-8) << "trial " << trial << ", coordinate " << i;
        Element faster = e;
        (i < 6 ? faster.ends.v_a[i] : faster.ends.v_b[i - 6]) += 1;
        EXPECT_LT((faster.force() - e.force() + tangent.C.col(i)).norm(), 1e-12) << trial;
      }
    }
}

// Derivatives are taken in frames that turn with the nodes: the rest of the Hessian's symmetry is a torque.
TEST(BeamElement, SkewPartOfTheTangentIsThatOfTheTorques) {
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    const Element e = random_element(random, 2, false);
    BeamTangent tangent;
    const BeamForces of = e.forces(&tangent);
    Mat12 expected = Mat12::Zero();
    expected.block<3, 3>(3, 3) = -skew(of.on_a.tail<3>());
    expected.block<3, 3>(9, 9) = -skew(of.on_b.tail<3>());
    EXPECT_LT((tangent.K - tangent.K.transpose() - expected).norm(), 1e-12 * tangent.K.norm()) << trial;
  }
}

TEST(BeamElement, GivesToOneNodeWhatItTakesFromTheOther) {
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const Element e = random_element(random, 2, true);
    const BeamForces of = e.forces();
    const Vec3 force_a = of.on_a.head<3>(), force_b = of.on_b.head<3>();
    EXPECT_LT((force_a + force_b).norm(), 1e-14 * (1 + of.stress.norm()));
    const Vec3 moment = e.ends.g_a.p.cross(force_a) + e.ends.g_a.R * of.on_a.tail<3>() +
                        e.ends.g_b.p.cross(force_b) + e.ends.g_b.R * of.on_b.tail<3>();
    EXPECT_LT(moment.norm(), 1e-13 * (1 + of.stress.norm()));
  }
}

TEST(BeamElement, IsObjective) {
  Random random(5);
  for (int trial = 0; trial < 50; ++trial) {
    const Element e = random_element(random, 2, true);
    const SE3 g = random.pose(3);
    const Vec3 v = random.vector(2), omega = random.vector(2);  // of the whole space, about the origin
    Element moved = e;
    for (const auto& [pose, rate] :
         {std::pair(&moved.ends.g_a, &moved.ends.v_a), std::pair(&moved.ends.g_b, &moved.ends.v_b)}) {
      *pose = g * *pose;
      const Vec3 linear = rate->head<3>();
      rate->head<3>() = g.R * linear + v + omega.cross(pose->p);
      rate->tail<3>() += pose->R.conjugate() * omega;
    }
    const BeamForces one = e.forces(), other = moved.forces();
    EXPECT_LT((one.strain - other.strain).norm(), 1e-14);
    EXPECT_LT((one.stress - other.stress).norm(), 2e-14 * (1 + one.stress.norm()));
    EXPECT_NEAR(one.energy, other.energy, 1e-14 * (1 + one.energy));
    EXPECT_LT((g.R * one.on_a.head<3>() - other.on_a.head<3>()).norm(), 2e-14 * (1 + one.stress.norm()));
    EXPECT_LT((one.on_b.tail<3>() - other.on_b.tail<3>()).norm(), 5e-14 * (1 + one.stress.norm()));
  }
}

// The closed form of the inverse differentials, against the differentials themselves.
TEST(BeamElement, InvertsTheDifferentialsOfTheExponential) {
  Random random(6);
  for (const double turn : {0.0, 1e-9, 1e-4, 0.1, 1.0, 2.0, 2.5}) {
    Vec6 h;
    h << random.vector(1), turn * random.direction();
    const RelativeMotion motion = relative_motion({}, exp_se3(h));
    EXPECT_LT((motion.h - h).norm(), 1e-14);
    EXPECT_LT((motion.by_a * dexp_left_se3(h) + Mat6::Identity()).norm(), 1e-13) << turn;
    EXPECT_LT((motion.by_b * dexp_right_se3(h) - Mat6::Identity()).norm(), 1e-13) << turn;
  }
}

TEST(BeamElement, IsNotFiniteWhereItTurnsTooFar) {
  Element e;
  e.stiffness.setOnes();
  for (const double turn : {2.49, 2.51, 3.1}) {
    e.ends.g_b = {exp_so3(turn * Vec3::UnitZ()), Vec3::UnitX()};
    EXPECT_EQ(e.force().allFinite(), turn < 2.5) << turn;
  }
}

TEST(Beam, RoundSectionHasTheStiffnessOfItsCircle) {
  const BeamSection s =
      beam_section({.radius = 0.01, .young = 2e11, .poisson = 0.25, .density = 7800, .damping_time = 1e-3});
  const double area = kPi * 1e-4, second = kPi * 1e-8 / 4, shear = 0.8e11;
  EXPECT_NEAR(s.stiffness[0], 2e11 * area, 1e-3);
  EXPECT_NEAR(s.stiffness[1], 7.5 / 8.5 * shear * area, 1e-3);
  EXPECT_NEAR(s.stiffness[3], 2 * shear * second, 1e-9);
  EXPECT_NEAR(s.stiffness[5], 2e11 * second, 1e-9);
  EXPECT_NEAR(s.damping[5], 1e-3 * s.stiffness[5], 1e-12);
  EXPECT_NEAR(s.mass_per_length, 7800 * area, 1e-12);
  EXPECT_NEAR(s.inertia_per_length.x(), 2 * 7800 * second, 1e-15);
  EXPECT_EQ(
      beam_section({.radius = 0.01, .young = 2e11, .density = 7800, .bending_stiffness = 3}).stiffness[4], 3);
}

constexpr RoundSection kRubber{.radius = 5e-3, .young = 1e7, .poisson = 0.45, .density = 1100};

TEST(Cable, HasTheMassOfItsLengthAndNoStressAsItIsLaid) {
  std::vector<Vec3> ring;
  for (int i = 0; i < 31; ++i)
    ring.emplace_back(std::cos(2 * kPi * i / 31), std::sin(2 * kPi * i / 31),
                      0.1 * std::cos(4 * kPi * i / 31));
  for (const bool closed : {false, true}) {
    Model model;
    const Cable cable = add_cable(
        model,
        {.nodes = frames_along(ring), .section = beam_section(kRubber), .radius = 5e-3, .closed = closed});
    State state = rest_state(model);
    lay(cable, state);
    double mass = 0, length = 0;
    for (const BodyId node : cable.nodes) mass += model.bodies[node].mass;
    for (const BeamElement& element : cable.beam.elements) length += element.length;
    EXPECT_EQ(cable.beam.elements.size(), closed ? 31U : 30U);
    EXPECT_NEAR(mass, 1100 * kPi * 25e-6 * length, 1e-14);
    EXPECT_LT(total_force(model, state, 0).f.norm(), 1e-14 * cable.beam.sections[0].stiffness[0]);
    EXPECT_EQ(model.bodies[cable.surface].name, "cable");
  }
}

// A straight cable laid along an arc of radius R is strained by radius / R in its outermost fibre.
TEST(Cable, ShowsItsLargestStrain) {
  constexpr int kElements = 20;
  constexpr double kArc = 0.2;
  std::vector<Vec3> points;
  for (int i = 0; i <= kElements; ++i)
    points.push_back(kArc * Vec3(std::cos(kPi * i / kElements), std::sin(kPi * i / kElements), 0));
  Model model;
  const Cable cable = add_cable(model, {.nodes = frames_along(points),
                                        .section = beam_section(kRubber),
                                        .radius = kRubber.radius,
                                        .straight = true});
  State state = rest_state(model);
  lay(cable, state);
  const std::vector<double> shown = vertex_field(model, state, cable.surface);
  ASSERT_EQ(shown.size(), std::size_t(kElements + 1));
  for (int i = 2; i + 2 <= kElements; ++i)  // the frames at the ends are along their chords
    EXPECT_NEAR(shown[std::size_t(i)], kRubber.radius / kArc, 1e-12) << i;
}

// Of an arc as many elements as it says do, and one less do not.
TEST(Cable, SaysHowManyElementsItNeeds) {
  const auto arc = [](int elements) {
    std::vector<Vec3> points;
    for (int i = 0; i <= elements; ++i)
      points.emplace_back(std::cos(kPi * i / elements), std::sin(kPi * i / elements), 0);
    Model model;
    return too_coarse(
        add_cable(model, {.name = "lead", .nodes = frames_along(points), .section = beam_section(kRubber)}));
  };
  EXPECT_EQ(arc(5),
            "lead turns by 0.63 rad at node 1: above 0.3 it does not touch on all sides there; use at "
            "least 11 elements");
  EXPECT_FALSE(arc(10).empty());
  EXPECT_EQ(arc(11), "");
}

TEST(Cable, PointsAlongALineAreAtEqualDistances) {
  const std::vector<Vec3> points = points_along({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 2}}, 9);
  ASSERT_EQ(points.size(), 9U);
  for (const auto& [k, place] :
       {std::pair(0, Vec3(0, 0, 0)), {1, Vec3(0.5, 0, 0)}, {3, Vec3(1, 0.5, 0)}, {8, Vec3(1, 1, 2)}})
    EXPECT_LT((points[std::size_t(k)] - place).norm(), 1e-15) << k;
}

TEST(Cable, LinesWithoutALengthAreRefused) {
  const Vec3 here(1, 2, 3);
  EXPECT_EQ(message_of([&] { points_along({here}, 3); }), "points of the polyline = 1 must be at least 2");
  EXPECT_EQ(message_of([&] {
              points_along({here, 2 * here}, 1);
            }),
            "points along the polyline = 1 must be at least 2");
  EXPECT_NE(message_of([&] {
              points_along({here, here}, 3);
            }).find("length of the polyline = 0"),
            std::string::npos);
  EXPECT_EQ(message_of([&] { frames_along({here}); }), "points of the line = 1 must be at least 2");
  EXPECT_EQ(message_of([&] {
              frames_along({here, here});
            }),
            "point 1 of the line must be finite and differ from the one before");
}

TEST(Beam, RefusesElementsThatAreNone) {
  Model model;
  const Cable cable = add_cable(
      model, {.nodes = frames_along({Vec3::Zero(), Vec3::UnitX()}), .section = beam_section(kRubber)});
  const auto refusal = [&](auto&& change) {
    Beam beam = cable.beam;
    change(beam.elements[0]);
    return message_of([&] { validate(beam, model.bodies); });
  };
  EXPECT_EQ(refusal([](BeamElement&) {}), "");
  const std::string who = "beam (cable): element 0: ";
  const struct {
    void (*change)(BeamElement&);
    std::string message;
  } table[] = {{[](BeamElement& e) { e.body_a = 2; }, "body_a = 2 must be one of the 2 bodies"},
               {[](BeamElement& e) { e.body_b = {}; }, "body_b = -1 must be one of the 2 bodies"},
               {[](BeamElement& e) { e.body_b = 0; }, "body_b = 0 must differ from body_a"},
               {[](BeamElement& e) { e.section = 1; }, "section = 1 must lie in [0, 1)"},
               {[](BeamElement& e) { e.length = -1; }, "length = -1 must be positive"},
               {[](BeamElement& e) { e.frame_b.p.x() = kInf; }, "frame_b"},
               {[](BeamElement& e) { e.rest[0] = kInf; }, "rest must be finite"},
               {[](BeamElement& e) { e.rest[4] = 2.5; }, "turn of rest = 2.5 must be below 2.5 rad"}};
  for (const auto& [change, message] : table)
    EXPECT_EQ(refusal(change).substr(0, (who + message).size()), who + message);
  for (RigidBody& body : model.bodies) body.motion = FixedMotion{};
  EXPECT_EQ(refusal([](BeamElement&) {}), who + "one of its nodes must be dynamic or carried");
}

// Of all frames with x along the line, those that turn least.
TEST(Cable, FramesDoNotTurnAboutTheirLine) {
  std::vector<Vec3> helix;
  for (int i = 0; i < 200; ++i) helix.emplace_back(std::cos(0.05 * i), std::sin(0.05 * i), 0.01 * i);
  const std::vector<SE3> frames = frames_along(helix);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const Vec3 turn = log_so3(frames[i - 1].R.conjugate() * frames[i].R);
    EXPECT_LT(std::abs(turn.x()), 1e-15) << i;
    EXPECT_GT(turn.norm(), 0.01) << i;
  }
}

TEST(Cable, RefusesWhatIsNone) {
  const auto refusal = [](auto&& change) {
    CableOptions options{.nodes = frames_along({Vec3::Zero(), Vec3::UnitX(), 2 * Vec3::UnitX()}),
                         .section = beam_section(kRubber)};
    change(options);
    Model model;
    std::string text = message_of([&] { add_cable(model, options); });
    EXPECT_TRUE(text.empty() || (model.bodies.empty() && model.forces.empty())) << "half built";
    return text;
  };
  EXPECT_EQ(refusal([](CableOptions&) {}), "");
  EXPECT_EQ(refusal([](CableOptions& o) { o.nodes.resize(1); }),
            "CableOptions::nodes = 1 must be at least 2");
  EXPECT_NE(refusal([](CableOptions& o) {
              o.section.stiffness[3] = 0;
            }).find("beam (cable): section 0: stiffness = 0 must be positive"),
            std::string::npos);
  EXPECT_NE(refusal([](CableOptions& o) {
              o.section.inertia_per_length.y() = -1;
            }).find("section 0: inertia_per_length = -1 must be positive"),
            std::string::npos);
  EXPECT_NE(refusal([](CableOptions& o) { o.nodes[1] = o.nodes[0]; }).find("element 0: length = 0 must be"),
            std::string::npos);
  EXPECT_NE(refusal([](CableOptions& o) { o.section.damping[2] = -1; }).find("section 0: damping = -1"),
            std::string::npos);
  EXPECT_NE(
      refusal([](CableOptions& o) { o.section.mass_per_length = 0; }).find("section 0: mass_per_length = 0"),
      std::string::npos);
  EXPECT_NE(refusal([](CableOptions& o) {
              o.section.inertia_per_length.x() *= 2;
            }).find("section 0: largest inertia_per_length"),
            std::string::npos);
  EXPECT_EQ(refusal([](CableOptions& o) { o.closed = true, o.nodes.resize(2); }),
            "CableOptions::nodes = 2 must be at least 3 of a closed cable");
  for (const bool straight : {false, true})
    EXPECT_EQ(refusal([=](CableOptions& o) {
                o.straight = straight;
                o.nodes[1].R = exp_so3(2.6 * Vec3::UnitY());
              }).substr(0, 31),
              "cable: nodes 0 and 1 are laid 2");
  EXPECT_NE(refusal([](CableOptions& o) {
              for (SE3& g : o.nodes) g.R = exp_so3(kPi / 2 * Vec3::UnitY());
            }).find("nodes 0 and 1: x must lead along the cable"),
            std::string::npos);
  EXPECT_EQ(refusal([](CableOptions& o) { o.radius = -1; }),
            "CableOptions::radius = -1 must be finite and not negative [m]");
  for (const auto& [change, field] :
       {std::pair<void (*)(RoundSection&), std::string>{[](RoundSection& s) { s.young = 0; }, "young = 0"},
        {[](RoundSection& s) { s.density = -1; }, "density = -1"},
        {[](RoundSection& s) { s.radius = 0; }, "radius = 0"},
        {[](RoundSection& s) { s.bending_stiffness = -1; }, "bending_stiffness = -1"},
        {[](RoundSection& s) { s.damping_time = -1; }, "damping_time = -1"},
        {[](RoundSection& s) { s.poisson = 0.5; }, "poisson = 0.5"}}) {
    RoundSection bad = kRubber;
    change(bad);
    EXPECT_NE(message_of([&] { beam_section(bad); }).find("RoundSection::" + field), std::string::npos);
  }
}

}  // namespace
}  // namespace aussois
