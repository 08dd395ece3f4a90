// SPDX-License-Identifier: Apache-2.0
#include "io/network_file.hpp"

#include <cstring>

#include <gtest/gtest.h>

#include "integrators/schemes/moreau_jean.hpp"
#include "tests/support/block_scene.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

LearnedSelector random_selector(Random& random) {
  const auto fill = [&](auto& m, Eigen::Index rows, Eigen::Index columns) {
    m.resize(rows, columns);
    for (double& x : m.reshaped()) {
      x = random.uniform(-1, 1);
      x *= random.log_uniform(1e-300, 1e300);
    }
  };
  LearnedSelector s{.keep = 2};
  Network& n = s.network;
  fill(n.mean, 24, 1);
  n.scale = VecX::Constant(24, random.log_uniform(1e-9, 1e9));
  fill(n.W1, 40, 24);
  fill(n.b1, 40, 1);
  fill(n.W2, 17, 40);
  fill(n.b2, 17, 1);
  n.W1(3, 4) = -0.0;
  n.W1(0, 0) = 5e-324;  // the smallest number
  for (int i = 0; i < 17; ++i) s.places.push_back(random.vector());
  return s;
}

template <class A, class B>
bool same_bits(const A& a, const B& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         std::memcmp(a.data(), b.data(), sizeof(double) * std::size_t(a.size())) == 0;
}

TEST(NetworkFile, T9_1_GivesBackEveryBit) {
  const std::filesystem::path path = fresh_folder() / "selector.txt";
  for (unsigned seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const LearnedSelector s = random_selector(random);
    write_selector(path, s);
    const LearnedSelector r = read_selector(path);
    const Network &a = s.network, &b = r.network;
    EXPECT_TRUE(same_bits(a.mean, b.mean) && same_bits(a.scale, b.scale) && same_bits(a.W1, b.W1) &&
                same_bits(a.b1, b.b1) && same_bits(a.W2, b.W2) && same_bits(a.b2, b.b2))
        << "seed " << seed;
    EXPECT_EQ(r.keep, 2);
    ASSERT_EQ(r.places.size(), s.places.size());
    for (std::size_t i = 0; i < s.places.size(); ++i) EXPECT_TRUE(same_bits(s.places[i], r.places[i]));
    const std::string once = content_of(path);
    write_selector(path, r);
    EXPECT_EQ(content_of(path), once);
    EXPECT_TRUE(same_bits(read_network(path).W2, a.W2));  // a selector's file is one of its network
  }
}

TEST(NetworkFile, HoldsANetworkWithoutPlaces) {
  const std::filesystem::path path = fresh_folder() / "network.txt";
  Random random(1);
  const Network n = random_selector(random).network;
  write_network(path, n);
  EXPECT_TRUE(same_bits(read_network(path).W1, n.W1));
  EXPECT_NE(message_of<std::runtime_error>([&] { read_selector(path); }).find("ends before keep and places"),
            std::string::npos);
}

TEST(NetworkFile, NamesTheLineOfWhatIsBroken) {
  const std::filesystem::path folder = fresh_folder(), good = folder / "good.txt";
  Random random(2);
  write_selector(good, random_selector(random));
  const std::string text = content_of(good);
  const auto message = [&](const std::string& bytes) {
    const std::filesystem::path path = write_bytes(folder / "broken.txt", bytes);
    return message_of<std::runtime_error>([&] { read_selector(path); });
  };
  const auto with = [&](const std::string& old, const std::string& put) {
    std::string out = text;
    return out.replace(out.find(old), old.size(), put);
  };
  EXPECT_EQ(message(text), "");
  EXPECT_NE(message("peg 1\n").find("broken.txt:1: "), std::string::npos);
  EXPECT_NE(message(with("aussois_network 1", "aussois_network 2")).find("must be 1"), std::string::npos);
  EXPECT_NE(message(with("hidden 40", "hidden 0")).find("broken.txt:3: hidden = 0"), std::string::npos);
  EXPECT_NE(message(with("outputs 17", "outputs 999999")).find("outputs = 999999"), std::string::npos);
  EXPECT_NE(message("aussois_network 1\ninputs 10000\nhidden 10000\noutputs 1\nmean 0")
                .find("broken.txt:5: mean needs 10000 numbers, 2 bytes follow"),
            std::string::npos);
  EXPECT_NE(message(with("mean ", "mean inf ")).find("mean = "), std::string::npos);
  EXPECT_NE(message(with("W1 ", "W3 ")).find("must be W1"), std::string::npos);
  EXPECT_NE(message(text.substr(0, text.size() / 2)), "");
  EXPECT_NE(message(text + "1\n").find("follows the last place"), std::string::npos);
  EXPECT_NE(message(""), "");
  EXPECT_NE(message_of<std::runtime_error>([&] { read_network(folder / "none.txt"); }), "");
}

// The whole way: a selector from a file in a simulation, one body of which it knows.
TEST(NetworkFile, CarriesABlockThroughASimulation) {
  const std::filesystem::path path = fresh_folder() / "selector.txt";
  LearnedSelector made{.keep = 4};
  Network& n = made.network;
  n.mean = VecX::Zero(kLoadInputs);
  n.scale = VecX::Ones(kLoadInputs);
  n.W1 = MatX::Zero(1, kLoadInputs);
  n.b1 = VecX::Zero(1);
  n.W2 = MatX::Zero(5, 1);
  n.b2 = (VecX(5) << 1, 2, 3, 4, -9).finished();
  for (const double x : {-0.5, 0.5})
    for (const double y : {-0.5, 0.5}) made.places.emplace_back(kSide * x, kSide * y, -kSide / 2);
  made.places.emplace_back(0, 0, -kSide / 2);
  write_selector(path, made);

  std::vector<State> ends;
  for (const LearnedSelector& selector : {made, read_selector(path)}) {
    Scene scene = block_on_plate(0.5, 0, 10 * kPi / 180);
    StepOptions options{.h = 1e-3};
    options.reduction = {.reducer = Reducer::selector, .selector = contact_selector(selector, scene.block)};
    const SE3 before = pose(scene.state, scene.block);
    int steps = 0;
    std::size_t most = 0;
    const MoreauJean scheme(scene.model, options, {.theta = 1});
    while (scene.state.t < 0.05 - 1e-12) {
      const StepReport report = scheme.step(scene.state, 0.05 - scene.state.t);
      ASSERT_TRUE(report.ok()) << report.reason;
      most = std::max(most, scene.state.memory.contacts.size());
      ++steps;
    }
    EXPECT_GE(steps, 50);
    EXPECT_GE(most, 4u);
    EXPECT_LE(most, 5u);  // four places, and the deepest
    EXPECT_LT((pose(scene.state, scene.block).p - before.p).norm(), 1e-6);
    ends.push_back(scene.state);
  }
  EXPECT_EQ(hash(ends[0]), hash(ends[1]));
}

}  // namespace
}  // namespace aussois
