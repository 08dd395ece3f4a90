// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "examples/studies/toss/toss_fit.hpp"
#include "examples/studies/toss/toss_kept.hpp"
#include "examples/studies/toss/toss_report.hpp"
#include "geometry/so3.hpp"
#include "tests/support/altered.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

const std::string kHeader =
    "t_s,px_m,py_m,pz_m,qw,qx,qy,qz,vx_mps,vy_mps,vz_mps,wx_radps,wy_radps,wz_radps\n";

// A cube in free flight, with the velocities left out.
Toss flight(std::size_t rows) {
  Toss toss{.name = "toss_000"};
  for (std::size_t k = 0; k < rows; ++k) {
    const double t = double(k) / 148;
    toss.t.push_back(t);
    toss.pose.push_back({exp_so3(t * Vec3(1, 2, 3)), Vec3(0.5 * t, -t, 0.2 + 0.3 * t - 4.905 * t * t)});
    toss.twist.emplace_back(Vec6::Zero());
  }
  return toss;
}

TEST(Toss, IsRefusedByFileAndRowIfItIsDamaged) {
  const std::filesystem::path folder = fresh_folder();
  const auto message = [&](const std::string& text) {
    write_bytes(folder / "toss_001.csv", text);
    return message_of<std::runtime_error>([&] { read_toss(folder / "toss_001.csv"); });
  };
  const std::string row = ",0,0,0.1,1,0,0,0,0,0,0,0,0,0\n";
  EXPECT_NE(message("t_s,px_m\n0,0\n").find("column 'py_m' is missing"), std::string::npos);
  EXPECT_NE(message(kHeader + "0" + row).find("rows = 1 must be at least 2"), std::string::npos);
  EXPECT_NE(message(kHeader + "0" + row + "0" + row).find("row 2: t_s"), std::string::npos);
  EXPECT_NE(
      message(kHeader + "0,0,0,0.1,2,0,0,0,0,0,0,0,0,0\n").find("row 1: |pose.R| = 2 must be 1 within 1e-6"),
      std::string::npos);
  EXPECT_NE(message(kHeader + "0" + row + "nan" + row).find("toss_001.csv:3: t_s"), std::string::npos);
  EXPECT_NE(message(kHeader + "0,0\n").find("fields = 2 must be 14"), std::string::npos);
  EXPECT_NE(message_of<std::runtime_error>([&] { read_tosses(folder / "none"); }).find("toss_*.csv"),
            std::string::npos);
}

TEST(Toss, ReadsBackWhatItWrote) {
  const std::filesystem::path folder = fresh_folder();
  const Toss toss = flight(5);
  write_toss(folder, toss);
  const Toss read = read_toss(folder / "toss_000.csv");
  ASSERT_EQ(read.t, toss.t);
  for (std::size_t k = 0; k < toss.t.size(); ++k) {
    EXPECT_EQ(read.pose[k].p, toss.pose[k].p);
    EXPECT_LT((read.pose[k].R.coeffs() - toss.pose[k].R.coeffs()).norm(), 1e-15);
  }
}

// (TOSS-1): three rows before the centre is as low as a corner can reach, with the velocities of the flight.
TEST(Toss, StartsWithTheVelocitiesOfItsFlight) {
  const Toss toss = flight(40);
  const TossStart start = start_of(toss);
  ASSERT_GE(start.row, 4U);
  EXPECT_GT(toss.pose[start.row + 2].p.z(), std::sqrt(3.0) / 2 * kTossEdge);
  EXPECT_LE(toss.pose[start.row + 3].p.z(), std::sqrt(3.0) / 2 * kTossEdge);
  const Vec3 v(0.5, -1, 0.3 - kTossGravity * toss.t[start.row - 1]);
  EXPECT_LT((start.twist.head<3>() - v).norm(), 1e-12);
  EXPECT_LT((start.twist.tail<3>() - Vec3(1, 2, 3)).norm(), 1e-12);
}

TEST(Toss, OfTheKernelItselfIsRolledOutWithoutError) {
  const TossWorld world;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Toss toss = synthetic_toss(seed, world, 0);
    const TossRun run = roll_out(toss, {.row = 0, .pose = toss.pose[0], .twist = toss.twist[0]}, world);
    ASSERT_EQ(run.failure, "") << seed;
    EXPECT_GE(run.most_contacts, 4) << seed;  // it came to rest on a face
    EXPECT_LT(run.errors.position, 1e-9) << seed;
    EXPECT_LT(run.errors.rotation, 1e-9) << seed;
    EXPECT_NEAR(toss.pose.back().p.z(), kTossEdge / 2, 1e-5) << seed;
  }
}

TEST(Toss, ErrorsAreMeansOverTime) {
  const TossWorld world;
  Toss toss = synthetic_toss(3, world, 0);
  const TossStart start{.row = 0, .pose = toss.pose[0], .twist = toss.twist[0]};
  for (SE3& g : toss.pose) {
    g.p.x() += 0.01;
    g.R = (exp_so3(Vec3(0, 0, 0.1)) * g.R).normalized();
  }
  const TossRun run = roll_out(toss, start, world);
  EXPECT_NEAR(run.errors.position, 0.01, 1e-8);
  EXPECT_NEAR(run.errors.rotation, 0.1, 1e-8);
  EXPECT_NEAR(run.errors.loss, 0.01 * 0.01 / (kTossEdge / 2) + 0.01, 1e-8);
}

// (TOSS-5), where the answer is known: tosses of the kernel with another friction.
TEST(Toss, FitFindsTheFrictionThatTossesWereMadeWith) {
  TossWorld made, guess;
  made.law.mu = 0.25;
  made.law.restitution = 0.1;
  guess.substeps = made.substeps = 3;
  guess.options.moreau_jean.theta = made.options.moreau_jean.theta = 1;  // as cube_toss
  std::vector<Toss> tosses;
  for (unsigned seed = 1; seed <= 16; ++seed) {
    Toss toss = synthetic_toss(seed, made, 0);
    toss.pose.resize(60), toss.twist.resize(60), toss.t.resize(60);
    tosses.push_back(std::move(toss));
  }
  int asked = 0;
  const TossFit found = fit(tosses, guess, 2, [&](const TossFit&) { return ++asked > 0; });
  EXPECT_EQ(asked, found.points);
  EXPECT_NEAR(found.mu, 0.25, 0.03);
  EXPECT_NEAR(found.restitution, 0.1, 0.05);
  EXPECT_NEAR(board_of(tosses), 0, 0.02);  // not all had come to rest
  TossWorld there = guess;
  there.law.mu = found.mu, there.law.restitution = found.restitution;
  double mean = 0;
  for (const Toss& toss : tosses) {
    const TossRun run = roll_out(toss, there);
    const double way = run.errors.position + kTossEdge / 2 * run.errors.rotation;
    mean += (run.failure.empty() ? way : kTossEdge) / double(tosses.size());  // one of them is refused
  }
  EXPECT_NEAR(found.error, mean, 1e-15);
}

TEST(Toss, FitHasTheSameBitsForAnyThreadsAndStopsWhenTold) {
  TossWorld world;
  world.substeps = 2;
  std::vector<Toss> tosses;
  for (unsigned seed = 1; seed <= 3; ++seed) {
    Toss toss = synthetic_toss(seed, world, 1e-3);
    toss.pose.resize(40), toss.twist.resize(40), toss.t.resize(40);
    tosses.push_back(std::move(toss));
  }
  world.law.mu = 0.2;
  const auto always = [](const TossFit&) { return true; };
  const TossFit one = fit(tosses, world, 1, always), three = fit(tosses, world, 3, always);
  EXPECT_EQ(one.mu, three.mu);
  EXPECT_EQ(one.restitution, three.restitution);
  EXPECT_EQ(one.error, three.error);
  EXPECT_EQ(one.steps, three.steps);
  const TossFit stopped = fit(tosses, world, 1, [](const TossFit& at) { return at.points < 3; });
  EXPECT_EQ(stopped.points, 3);
  EXPECT_LT(stopped.steps, one.steps);
}

TEST(Toss, IsRolledOutAgainInAnotherWorld) {
  TossWorld world;
  world.substeps = 2;
  Toss toss = synthetic_toss(1, world, 0);
  toss.pose.resize(20), toss.twist.resize(20), toss.t.resize(20);
  const TossKeep keep{.folder = fresh_folder()};
  const auto known_in = [&](const TossWorld& other, int certify = 0) {
    return roll_out_all({toss}, other, {.certify = certify}, keep, "all", 1, [](int) { return true; }).known;
  };
  EXPECT_EQ(known_in(world), 0);
  EXPECT_EQ(known_in(world), 1);
  const auto others = altered(world);
  EXPECT_EQ(others.size(), 6U);
  for (const auto& [path, other] : others) {
    EXPECT_EQ(known_in(other), 0) << path;
    EXPECT_EQ(known_in(world), 0) << "written over";
  }
  EXPECT_EQ(known_in(world, 1), 0);
  for (const char* damage : {"-1", "\"nan\"", "\"-inf\""}) {
    auto json = nlohmann::ordered_json::parse(content_of(keep.folder / "all_001.json"));
    json["runs"][0]["position_m"] = nlohmann::ordered_json::parse(damage);
    write_bytes(keep.folder / "all_001.json", json.dump());
    EXPECT_EQ(known_in(world, 1), 0) << damage;
  }
}

TEST(Toss, LastBinHoldsWhatIsBeyond) {
  EXPECT_EQ(bin_counts({0, 0.9, 1, 2, 1e12, kInf, -1, std::nan("")}, 1, 3), (std::vector{3, 1, 4}));
}

TEST(Toss, SpreadIsThatOfASample) {
  const Spread s = spread_of({1, 2, 3, 6});
  EXPECT_DOUBLE_EQ(s.mean, 3);
  EXPECT_DOUBLE_EQ(s.median, 2.5);
  EXPECT_DOUBLE_EQ(s.sd, std::sqrt(14.0 / 3));
}

}  // namespace
}  // namespace aussois
