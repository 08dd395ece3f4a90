// SPDX-License-Identifier: Apache-2.0
// A network by hand, and the choice of contacts that rests on it.
#include "reduction/network.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "reduction/learned_selector.hpp"
#include "reduction/reduce.hpp"
#include "tests/support/flat_contacts.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

// 2 - 1 - 3, small enough for paper.
Network small_network() {
  Network n;
  n.mean = Vec2(1, -2);
  n.scale = Vec2(2, 0.5);
  n.W1 = (MatX(1, 2) << 0.3, -0.4).finished();
  n.b1 = VecX::Constant(1, 0.1);
  n.W2 = (MatX(3, 1) << 1, 0, -2).finished();
  n.b2 = Vec3(0, 0.5, 0);
  return n;
}

// Says the same probabilities for every load.
Network constant_network(const VecX& probability) {
  Network n;
  n.mean = VecX::Zero(kLoadInputs);
  n.scale = VecX::Ones(kLoadInputs);
  n.W1 = MatX::Zero(2, kLoadInputs);
  n.b1 = VecX::Zero(2);
  n.W2 = MatX::Zero(probability.size(), 2);
  n.b2 = probability.array().log();
  return n;
}

TEST(Network, SaysWhatOneFindsByHand) {
  const double h = std::tanh(0.3 * (3 - 1) / 2.0 - 0.4 * (-1 + 2) / 0.5 + 0.1);
  const double a = std::exp(h), b = std::exp(0.5), c = std::exp(-2 * h), sum = a + b + c;
  const VecX p = network_output(small_network(), Vec2(3, -1));
  ASSERT_EQ(p.size(), 3);
  EXPECT_NEAR(p[0], a / sum, 1e-15);
  EXPECT_NEAR(p[1], b / sum, 1e-15);
  EXPECT_NEAR(p[2], c / sum, 1e-15);
}

TEST(Network, SumsToOneForScoresThatOverflow) {
  Network n = small_network();
  n.W2.setZero();
  n.b2 = Vec3(1000, -1000, 999);
  const VecX p = network_output(n, Vec2(0, 0));
  EXPECT_NEAR(p.sum(), 1, 1e-15);
  EXPECT_NEAR(p[0], 1 / (1 + std::exp(-1)), 1e-15);
  EXPECT_LT(p[1], 1e-300);
}

TEST(Network, IsRefusedWithItsField) {
  const auto message = [](auto&& spoil) {
    Network n = small_network();
    spoil(n);
    return message_of([&] { validate(n); });
  };
  EXPECT_EQ(message([](Network&) {}), "");
  EXPECT_NE(message([](Network& n) { n.mean.resize(3); }).find("Network::mean has 3"), std::string::npos);
  EXPECT_NE(message([](Network& n) { n.W2.resize(3, 2); }).find("Network::W2 has 6"), std::string::npos);
  EXPECT_NE(message([](Network& n) { n.scale[1] = 0; }).find("Network::scale = 0"), std::string::npos);
  EXPECT_NE(message([](Network& n) { n.b1[0] = NAN; }).find("finite"), std::string::npos);
  EXPECT_NE(message_of([] { network_output(small_network(), Vec3(0, 0, 0)); }).find("x has 3"),
            std::string::npos);
}

TEST(ChosenPlaces, AreTheMostProbableThatAreNoLine) {
  const std::vector<Vec3> places{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  VecX p(5);
  p << 0.3, 0.25, 0.2, 0.1, 0.15;
  EXPECT_EQ(chosen_places(p, places), (std::vector<int>{0, 1, 4}));  // 2 lies on the line of 0 and 1
  p << 0.1, 0.2, 0.2, 0.2, 0.3;
  EXPECT_EQ(chosen_places(p, places), (std::vector<int>{4, 1, 2}));  // ties by index
  EXPECT_EQ(chosen_places(p, places, 1), (std::vector<int>{4}));
  EXPECT_EQ(chosen_places(p.head(3), {places.begin(), places.begin() + 3}), (std::vector<int>{1, 2}));
  p[2] = NAN;
  EXPECT_EQ(chosen_places(p, places), (std::vector<int>{4, 1, 3}));
}

TEST(OnALine, IsATriangleOfNoHeight) {
  EXPECT_TRUE(are_collinear({0, 0, 0}, {1, 2, 3}, {-2, -4, -6}));
  EXPECT_TRUE(are_collinear({1, 1, 1}, {1, 1, 1}, {2, 0, 0}));
  EXPECT_FALSE(are_collinear({0, 0, 0}, {1, 0, 0}, {0, 1e-3, 0}));
  EXPECT_FALSE(are_collinear({0, 0, 0}, {1e-6, 0, 0}, {0, 1e-6, 0}));  // small is not flat
}

TEST(ContactSelector, KeepsTheContactsNearestToThePlacesOfTheBody) {
  const ContactSet set = flat(grid(6, 4, 0.3, 0.1));
  VecX p(4);
  p << 0.4, 0.3, 0.2, 0.1;
  // in the frame of a body that is moved and turned by a right angle
  const SE3 g{Quat(Eigen::AngleAxisd(kPi / 2, Vec3::UnitZ())), Vec3(1, 2, 0)};
  LearnedSelector selector{.network = constant_network(p)};
  for (const Vec2& corner : {Vec2(0, 0), Vec2(0.3, 0), Vec2(0.3, 0.1), Vec2(0, 0.1)})
    selector.places.push_back(inverse(g) * Vec3(corner.x() + 0.004, corner.y() - 0.003, 0));
  ReductionInput input{.contacts = set};
  input.bodies.resize(2);
  input.bodies[0].g_wb = g;
  ReductionOptions options{.reducer = Reducer::selector, .selector = contact_selector(selector, 0)};
  EXPECT_EQ(reduce(input, options).kept, (std::vector<int>{0, 5, 23}));  // the deepest, 0, is one of them
  options.selector = contact_selector(selector, 7);
  EXPECT_THROW(reduce(input, options), std::invalid_argument);  // no load of that body
  input.bodies.resize(8);
  EXPECT_EQ(reduce(input, options).kept.size(), 24u);  // it touches nothing: everything stays
}

TEST(ContactSelector, AsksTheNetworkForTheLoadOfTheBody) {
  BodyLoad load;
  load.g_wb = {Quat(Eigen::AngleAxisd(kPi / 2, Vec3::UnitZ())), Vec3(1, 2, 3)};
  load.twist << 4, 5, 6, 7, 8, 9;
  load.wrench << 10, 11, 12, 13, 14, 15;
  VecX wanted(kLoadInputs);
  wanted << 1, 2, 3, 0, 1, 0, -1, 0, 0, 0, 0, 1, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15;
  EXPECT_LT((input_of(load) - wanted).norm(), 1e-15);

  // one that looks at the pull along x only, and chooses the places on that side
  VecX p = VecX::Constant(4, 0.25);
  LearnedSelector selector{.network = constant_network(p), .keep = 2};
  selector.places = {{0, 0, 0}, {0.3, 0, 0}, {0.3, 0.1, 0}, {0, 0.1, 0}};
  selector.network.W1(0, 18) = 1;
  selector.network.W2.col(0) << -1, 1, 1, -1;
  const ContactSet set = flat(grid(6, 4, 0.3, 0.1));
  ReductionInput input{.contacts = set};
  input.bodies.resize(2);
  const ContactSelector select = contact_selector(selector, 0);
  for (const double pull : {1.0, -1.0}) {
    input.bodies[0].wrench[0] = pull;
    const std::vector<int> kept = select(input, clusters_by_angle(set, 0.1));
    EXPECT_EQ(kept, pull > 0 ? (std::vector<int>{5, 23}) : (std::vector<int>{0, 18})) << pull;
  }
}

TEST(ContactSelector, IsRefusedUnlessItFits) {
  LearnedSelector selector{.network = constant_network(VecX::Constant(4, 0.25))};
  EXPECT_NE(message_of([&] { contact_selector(selector, 0); }).find("places has 0"), std::string::npos);
  selector.places.assign(4, Vec3::Zero());
  selector.keep = 0;
  EXPECT_NE(message_of([&] { contact_selector(selector, 0); }).find("keep = 0"), std::string::npos);
  selector.keep = 3;
  selector.network.mean = Vec3::Zero();
  selector.network.scale = Vec3::Ones();
  selector.network.W1 = MatX::Zero(2, 3);
  EXPECT_NE(message_of([&] { contact_selector(selector, 0); }).find("inputs() = 3"), std::string::npos);
}

}  // namespace
}  // namespace aussois
