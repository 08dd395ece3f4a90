// SPDX-License-Identifier: Apache-2.0
#include "lmd/contact_kinematics.hpp"

#include <map>
#include <optional>

#include <gtest/gtest.h>

#include "lmd/gap_fade.hpp"
#include "lmd/motion_bound.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random_pair.hpp"

namespace aussois {
namespace {

// A pair whose bodies move at constant twists; shapes stand at g_bs in their bodies.
struct Motion {
  const LmdShape *a, *b;
  RigidMotion body_a{}, body_b{};
  SE3 g_bs_a{}, g_bs_b{};
  double threshold = 1;

  PosedShape posed_a(double t) const { return {a, pose_at(body_a, t) * g_bs_a, 0}; }
  PosedShape posed_b(double t) const { return {b, pose_at(body_b, t) * g_bs_b, 1}; }
  ContactSet contacts(double t) const {
    return find_contacts(posed_a(t), posed_b(t), {.threshold = threshold, .alpha = 0.3, .alpha_ee = 0.6});
  }
  std::optional<ContactPoint> contact(const ContactKey& key, double t) const {
    for (const ContactPoint& c : contacts(t).points)
      if (key_of(c) == key) return c;
    return std::nullopt;
  }
  ContactKinematics kinematics(const ContactPoint& c, double t) const {
    return contact_kinematics(c, posed_a(t), pose_at(body_a, t), posed_b(t), pose_at(body_b, t));
  }
  Vec12 twists() const {
    Vec12 xi;
    xi << body_a.v, body_a.omega, body_b.v, body_b.omega;
    return xi;
  }
};

RigidMotion random_motion(Random& random, const SE3& g) {
  return {.g = g, .v = random.vector(), .omega = random.vector()};
}

Motion random_motion_of(const RandomPair& pair, Random& random) {
  Motion m{.a = &pair.a, .b = &pair.b, .g_bs_a = random.pose(0.3), .g_bs_b = random.pose(0.3)};
  m.body_a = random_motion(random, pair.g_a * inverse(m.g_bs_a));
  m.body_b = random_motion(random, pair.g_b * inverse(m.g_bs_b));
  return m;
}

// Values at -2h ... 2h; first and second central differences of fourth order. With h = 2e-4 and motions of
// order one, truncation is h^4 = 2e-15 times the fifth derivative, rounding 1e-16 / h and 1e-16 / h^2.
constexpr double kH = 2e-4;
constexpr double kRounding = 1e-9;  // of first differences, with a thousand operations before
template <class Value>
Value first_difference(const std::array<Value, 5>& f) {
  return (8 * (f[3] - f[1]) - (f[4] - f[0])) / (12 * kH);
}
double second_difference(const std::array<double, 5>& f) {
  return (16 * (f[3] + f[1]) - (f[4] + f[0]) - 30 * f[2]) / (12 * kH * kH);
}

struct Stencil {
  std::array<ContactPoint, 5> contact{};
  std::array<ContactKinematics, 5> kinematics{};
  template <class Get>
  auto values(Get&& get) const {
    std::array<std::decay_t<decltype(get(contact[0], kinematics[0]))>, 5> out;
    for (std::size_t i = 0; i < 5; ++i) out[i] = get(contact[i], kinematics[i]);
    return out;
  }
};

// Empty if the contact is not there all along.
std::optional<Stencil> stencil_of(const Motion& motion, const ContactKey& key) {
  Stencil s;
  for (int i = 0; i < 5; ++i) {
    const double t = (i - 2) * kH;
    const auto c = motion.contact(key, t);
    if (!c) return std::nullopt;
    s.contact[i] = *c;
    s.kinematics[i] = motion.kinematics(*c, t);
  }
  return s;
}

// Errors relative to the size of the terms of which the derivative is the sum. Twists are of order one,
// lengths too; 1 / d and 1 / sin^2 psi are what curvature and crossing edges bring in.
struct Errors {
  int samples = 0;
  double gap_rate = 0, gap_second = 0, normal_rate = 0, foot_rate = 0, jacobian_rate = 0;
};

void compare(const Motion& motion, const Stencil& s, Errors& errors) {
  const ContactKinematics& k = s.kinematics[2];
  const Vec12 xi = motion.twists();
  // What turns as fast as |xi| / (d sin psi) has a fifth derivative of 5! times the fifth power of that.
  const double speed = xi.norm(), truncation = 4 * speed * std::pow(kH * speed / (k.distance * k.sin_psi), 4);
  const double size = (1 + 1 / k.distance) / (k.sin_psi * k.sin_psi) * (1 + truncation / kRounding);
  const auto worse = [](double& worst, double error) { worst = std::max(worst, error); };

  const auto gaps = s.values([](const ContactPoint& c, const ContactKinematics&) { return c.gap; });
  worse(errors.gap_rate, std::abs(first_difference(gaps) - k.gap_rate * xi));
  worse(errors.gap_second, std::abs(second_difference(gaps) - xi.dot(k.gap_hessian * xi)) / size);

  const auto normals = s.values([](const ContactPoint& c, const ContactKinematics&) { return c.normal; });
  worse(errors.normal_rate, (first_difference(normals) - k.normal_rate * xi).norm() / size);

  const auto feet_a = s.values([](const ContactPoint&, const ContactKinematics& l) { return l.foot_a; });
  const auto feet_b = s.values([](const ContactPoint&, const ContactKinematics& l) { return l.foot_b; });
  const auto material = [](const RigidMotion& m, const Vec3& x) {
    return Vec3(m.v + (m.g.R * m.omega).cross(x - m.g.p));
  };
  worse(errors.foot_rate,
        (first_difference(feet_a) - material(motion.body_a, k.foot_a) - k.slide_a * xi).norm() / size);
  worse(errors.foot_rate,
        (first_difference(feet_b) - material(motion.body_b, k.foot_b) - k.slide_b * xi).norm() / size);

  const auto rows = s.values([](const ContactPoint&, const ContactKinematics& l) { return l.gap_rate; });
  worse(errors.jacobian_rate,
        (first_difference(rows) - xi.transpose() * jacobian_derivative(k)).norm() / size);

  const ContactPoint& c = s.contact[2];
  const Vec3 past = material(motion.body_a, c.x_a) - material(motion.body_b, c.x_b);
  EXPECT_LT((k.slip * xi - past + c.normal.dot(past) * c.normal).norm(), 1e-12);
  EXPECT_EQ(k.status, KinematicsStatus::ok);
  EXPECT_LT((k.gap_hessian - k.gap_hessian.transpose()).norm(), 1e-12 * size);
  ++errors.samples;
}

// All six orders of types against central differences of the contacts found afresh at five poses.
TEST(ContactKinematics, IsTheDerivativeOfWhatIsFound) {
  std::map<std::pair<int, int>, Errors> by_type;
  int lost = 0, kept = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const RandomPair pair = random_pair(seed, 0.15);
    Random random(seed + 7000);
    const Motion motion = random_motion_of(pair, random);
    for (const ContactPoint& c : motion.contacts(0).points) {
      if (motion.kinematics(c, 0).sin_psi < 0.1 || motion.kinematics(c, 0).distance < 0.1) continue;
      const auto stencil = stencil_of(motion, key_of(c));
      ++(stencil ? kept : lost);
      if (stencil) compare(motion, *stencil, by_type[{c.a.dim, c.b.dim}]);
    }
  }
  EXPECT_GT(kept, 20 * lost);
  for (const auto& [a, b] :
       std::vector<std::pair<int, int>>{{0, 0}, {0, 1}, {1, 0}, {0, 2}, {2, 0}, {1, 1}}) {
    const Errors& e = by_type[{a, b}];
    const std::string type = std::to_string(a) + std::to_string(b);
    EXPECT_GT(e.samples, a + b == 0 ? 30 : 100) << type;  // corners face corners more rarely
    EXPECT_LT(e.gap_rate, kRounding) << type;
    EXPECT_LT(e.gap_second, 1e-7) << type;
    EXPECT_LT(e.normal_rate, kRounding) << type;
    EXPECT_LT(e.foot_rate, kRounding) << type;
    EXPECT_LT(e.jacobian_rate, kRounding) << type;
    std::printf("%s: %d samples, gap' %.1e gap'' %.1e n' %.1e feet' %.1e J' %.1e\n", type.c_str(), e.samples,
                e.gap_rate, e.gap_second, e.normal_rate, e.foot_rate, e.jacobian_rate);
  }
}

// Two bodies that move as one: nothing happens to the contact.
TEST(ContactKinematics, DoesNotSeeAMotionOfTheWholePair) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const RandomPair pair = random_pair(seed, 0.15);
    Random random(seed + 8000);
    Motion motion = random_motion_of(pair, random);
    const Vec3 v = random.vector(), w = random.vector();
    for (RigidMotion* m : {&motion.body_a, &motion.body_b}) {
      m->v = v + w.cross(m->g.p);
      m->omega = m->g.R.conjugate() * w;
    }
    const Vec12 xi = motion.twists();
    for (const ContactPoint& c : motion.contacts(0).points) {
      const ContactKinematics k = motion.kinematics(c, 0);
      const double size = (1 + 1 / k.distance) / (k.sin_psi * k.sin_psi);
      EXPECT_NEAR(k.gap_rate * xi, 0, 1e-9) << "seed " << seed;
      EXPECT_LT((k.normal_rate * xi - w.cross(c.normal)).norm(), 1e-8 * size) << "seed " << seed;
      EXPECT_LT((k.slide_a * xi).norm() + (k.slide_b * xi).norm(), 1e-8 * size) << "seed " << seed;
    }
  }
}

// B seen from A is A seen from B.
TEST(ContactKinematics, IsTheSameFromBothSides) {
  int compared = 0;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const RandomPair pair = random_pair(seed, 0.15);
    Random random(seed + 9000);
    const Motion motion = random_motion_of(pair, random);
    Eigen::PermutationMatrix<12> swap;
    swap.indices() << 6, 7, 8, 9, 10, 11, 0, 1, 2, 3, 4, 5;
    for (const ContactPoint& c : motion.contacts(0).points) {
      ContactPoint mirrored = c;
      std::swap(mirrored.a, mirrored.b);
      std::swap(mirrored.x_a, mirrored.x_b);
      mirrored.normal = -c.normal;
      const ContactKinematics k = motion.kinematics(c, 0),
                              l = contact_kinematics(mirrored, motion.posed_b(0), motion.body_b.g,
                                                     motion.posed_a(0), motion.body_a.g);
      const double size = (1 + 1 / k.distance) / (k.sin_psi * k.sin_psi);
      EXPECT_LT((l.gap_rate - k.gap_rate * swap).norm(), 1e-12 * size);
      EXPECT_LT((l.gap_hessian - swap.transpose() * k.gap_hessian * swap).norm(), 1e-12 * size * size);
      EXPECT_LT((l.slide_b - k.slide_a * swap).norm(), 1e-12 * size * size);
      EXPECT_LT((l.slip + k.slip * swap).norm(), 1e-12);
      ++compared;
    }
  }
  EXPECT_GT(compared, 200);
}

// By hand: balls passing each other at a right angle to their connection part at v^2 / d.
TEST(ContactKinematics, OfPassingBallsHasTheCurvatureOfTheirDistance) {
  const LmdShape ball = prepare(dilate(make_point(), 0.1));
  const PosedShape a{&ball, translation(0, 0, 0.5), 0}, b{&ball, {}, 1};
  const ContactSet found = find_contacts(a, b, {.threshold = 1});
  ASSERT_EQ(found.points.size(), 1U);
  const ContactKinematics k = contact_kinematics(found.points[0], a, a.g_ws, b, b.g_ws);
  Vec12 xi = Vec12::Zero();
  xi.head<3>() = Vec3(3, 0, 0);
  EXPECT_NEAR(k.gap_rate * xi, 0, 1e-15);
  EXPECT_NEAR(xi.dot(k.gap_hessian * xi), 9 / 0.5, 1e-12);
  EXPECT_LT((k.normal_rate * xi - Vec3(6, 0, 0)).norm(), 1e-12);
  EXPECT_LT((k.slip * xi - Vec3(3, 0, 0)).norm(), 1e-15);
  xi.segment<3>(3) = Vec3(0, 2, 0);  // turning changes nothing but the slip: the lowest point lags by 2 * 0.1
  EXPECT_NEAR(xi.dot(k.gap_hessian * xi), 9 / 0.5, 1e-12);
  EXPECT_LT((k.slip * xi - Vec3(2.8, 0, 0)).norm(), 1e-15);
}

// By hand: a ball on a plate that turns about an axis a lever away sees w x (w x r) and the twist of the
// normal; the plate's curvature is none, so nothing divides by the distance.
TEST(ContactKinematics, OfABallOnAPlateIsRegularWhereTheBasesNearlyTouch) {
  const LmdShape point = prepare(dilate(make_point(), 0)), plate = prepare(dilate(make_plate(4, 4), 0));
  const SE3 axis = translation(-1, 0, 0);  // of the plate's body
  for (const double d : {1e-1, 1e-4, 1e-7}) {
    const PosedShape a{&point, translation(0.3, 0.2, d), 0}, b{&plate, {}, 1};
    const ContactSet found = find_contacts(a, b, {.threshold = 1});
    ASSERT_EQ(found.points.size(), 1U);
    const ContactKinematics k = contact_kinematics(found.points[0], a, a.g_ws, b, axis);
    Vec12 xi = Vec12::Zero();
    xi[10] =
        2;  // the plate turns about y: its far side goes down at 2 * 1.3, the gap is 1.3 sin 2t + d cos 2t
    EXPECT_NEAR(k.gap_rate * xi, 2.6, 1e-12);
    EXPECT_NEAR(xi.dot(k.gap_hessian * xi), -4 * d, 1e-11);
    EXPECT_LT(k.gap_hessian.norm(), 20);
  }
}

TEST(ContactKinematics, SaysWhereItCannotBeComputed) {
  const LmdShape ball = prepare(dilate(make_point(), 0.1)), rod = prepare(dilate(make_segment(1), 0.1));
  const auto status = [](const ContactPoint& c, const LmdShape& s) {
    const PosedShape posed{&s, {}, 0};
    const ContactKinematics k = contact_kinematics(c, posed, {}, posed, {});
    EXPECT_TRUE(k.gap_rate.allFinite());
    EXPECT_EQ(k.gap_rate[2], 1);  // the first order stays: the normal is what the contact says
    EXPECT_EQ(k.gap_hessian.norm() == 0, k.status != KinematicsStatus::ok);
    return k.status;
  };
  ContactPoint c{.gap = 2.1e-4 - 0.2};
  EXPECT_EQ(status(c, ball), KinematicsStatus::ok);
  c.gap = 1.9e-4 - 0.2;
  EXPECT_EQ(status(c, ball), KinematicsStatus::bases_too_near);
  c.gap = 0.01;
  c.a.dim = c.b.dim = 1;
  EXPECT_EQ(status(c, rod), KinematicsStatus::parallel_edges);
  EXPECT_STREQ(to_string(KinematicsStatus::parallel_edges), "parallel_edges");
}

// ---- gap fade

ContactPoint with_margin(double gap, double margin) {
  return {.gap = gap, .angle_margin = margin};
}

TEST(GapFade, LeavesContactsInsideAloneAndLiftsEnteringOnesByDelta) {
  const GapFade fade{.alpha0 = 0.03, .alpha_query = 0.05, .delta = 0.002};
  const auto faded = faded_gaps({.points = {with_margin(-0.001, 0.03), with_margin(0.001, 0.02),
                                            with_margin(0.001, 0.01), with_margin(0.001, 0)}},
                                fade);
  EXPECT_EQ(faded[0].gap, -0.001);
  EXPECT_NEAR(faded[1].gap, 0.001, 1e-15);
  EXPECT_NEAR(faded[2].gap, 0.002, 1e-15);  // half way through the band
  EXPECT_NEAR(faded[3].gap, 0.003, 1e-15);
  EXPECT_NEAR(faded[2].margin_slope, -1.5 * 0.002 / 0.02, 1e-12);
  for (const std::size_t i : {0UL, 3UL}) EXPECT_EQ(faded[i].margin_slope, 0);
  for (double margin = -0.001; margin < 0.03; margin += 0.00097) {  // the slope is the derivative
    const double e = 1e-7;
    const auto f = faded_gaps(
        {.points = {with_margin(0, margin - e), with_margin(0, margin), with_margin(0, margin + e)}}, fade);
    EXPECT_NEAR((f[2].gap - f[0].gap) / (2 * e), f[1].margin_slope, 1e-6);
  }
}

TEST(GapFade, OptionsOutOfRangeAreNamed) {
  EXPECT_EQ(message_of([] { validate(GapFade{.alpha0 = 0.1, .alpha_query = 0.05}); }),
            "GapFade::alpha_query = 0.05 must be more than alpha0 = 0.1 rad");
  EXPECT_EQ(message_of([] { validate(GapFade{.alpha_query = 0.6}); }),
            "GapFade::alpha_query = 0.6 must lie in [0, 0.5] rad");
  EXPECT_THROW(validate(GapFade{.delta = -1}), std::invalid_argument);
  EXPECT_THROW(validate(GapFade{.alpha0 = std::nan("")}), std::invalid_argument);
}

// A box tilts up from its plate: the two raised corners leave at alpha_query with a gap raised by delta, and
// up to there their gaps are C1 in time.
TEST(GapFade, TakesACornerOutAsGentlyAsTheThresholdDoes) {
  const GapFade fade{.alpha0 = 0.03, .alpha_query = 0.045, .delta = 0.002};
  const LmdShape box = prepare(dilate(make_box(0.1, 0.1, 0.1), 1e-3)),
                 plate = prepare(dilate(make_plate(1, 1), 1e-3));
  const auto at = [&](double tilt) {
    const SE3 g = SE3{exp_so3(Vec3(tilt, 0, 0)), Vec3(0.013, 0.007, 0.06)};
    return find_contacts({&box, g, 0}, {&plate, {}, 1}, {.threshold = 0.02, .alpha = fade.alpha_query});
  };
  std::map<ContactKey, std::vector<double>> tracks;
  const double step = 1e-5;
  int count = 0;
  for (double tilt = 0; tilt < 0.05; tilt += step, ++count) {
    const ContactSet found = at(tilt);
    const auto faded = faded_gaps(found, fade);
    for (std::size_t i = 0; i < faded.size(); ++i) tracks[key_of(found.points[i])].push_back(faded[i].gap);
  }
  ASSERT_EQ(tracks.size(), 4U);
  int left = 0;
  for (const auto& [key, gaps] : tracks) {
    for (std::size_t i = 2; i < gaps.size(); ++i)  // no corner of the curve: second differences are O(step^2)
      EXPECT_LT(std::abs(gaps[i] - 2 * gaps[i - 1] + gaps[i - 2]),
                1.1 * step * step * (6 * fade.delta / (0.015 * 0.015) + 0.1));
    if (int(gaps.size()) == count) continue;
    ++left;
    EXPECT_NEAR(double(gaps.size()) * step, fade.alpha_query, 2 * step);
    const double lowest = smallest_gap(at(fade.alpha_query - step));
    EXPECT_GE(gaps.back(), lowest + fade.delta);
  }
  EXPECT_EQ(left, 2);
}

}  // namespace
}  // namespace aussois
