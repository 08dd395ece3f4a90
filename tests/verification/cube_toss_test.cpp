// SPDX-License-Identifier: Apache-2.0
// Recorded tosses are rolled out as well as by published simulators, and persistence and reduction change
// them little (doc/theory/cube_toss.md).
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "examples/studies/toss/toss_fit.hpp"
#include "examples/studies/toss/toss_report.hpp"
#include "geometry/so3.hpp"

namespace aussois {
namespace {

std::vector<Toss> recorded() {
  const char* data = std::getenv("AUSSOIS_DATA_DIR");
  const std::filesystem::path folder = std::filesystem::path(data ? data : "") / "cube_toss";
  return data && std::filesystem::exists(folder) ? read_tosses(folder) : std::vector<Toss>{};
}

// As the driver has them.
TossWorld world() {
  TossWorld out;
  out.options.moreau_jean.theta = 1;
  out.options.moreau_jean.law = NormalLaw::combined;
  return out;
}

struct Means {
  double position = 0, rotation = 0;  // [% of the edge], [deg]
};
Means means(const std::vector<Toss>& tosses, const TossWorld& w, int* reduced_steps = nullptr) {
  Means out;
  for (const Toss& toss : tosses) {
    const TossRun run = roll_out(toss, w);
    EXPECT_EQ(run.failure, "") << toss.name;
    if (reduced_steps) *reduced_steps += run.reduced_steps;
    out.position += 100 * run.errors.position / kTossEdge / double(tosses.size());
    out.rotation += 180 / kPi * run.errors.rotation / double(tosses.size());
  }
  return out;
}

TEST(CubeToss, IsRolledOutAsWellAsByTheBestPublishedSimulator) {
  const std::vector<Toss> tosses = recorded();
  if (tosses.empty()) GTEST_SKIP() << "no cube_toss in AUSSOIS_DATA_DIR";
  const Means ten = means(tosses, world());
  EXPECT_LE(ten.position, 14.0);  // Drake 13.5, MuJoCo 25.1
  EXPECT_LE(ten.rotation, 17.0);  // Drake 16.5, MuJoCo 21.7
  TossWorld coarse = world();
  coarse.substeps = 1;
  const Means one = means(tosses, coarse);
  EXPECT_LE(one.position, 1.1 * ten.position);
  EXPECT_LE(one.rotation, 1.1 * ten.rotation);
  std::printf("position %.2f %%, rotation %.2f deg; in one substep %.2f %% and %.2f deg\n", ten.position,
              ten.rotation, one.position, one.rotation);
}

// Tosses of the kernel stand in where there are none.
std::vector<Toss> some() {
  std::vector<Toss> tosses = recorded();
  if (tosses.empty())
    for (unsigned seed = 1; seed <= 40; ++seed) tosses.push_back(synthetic_toss(seed, world(), 5e-4));
  tosses.resize(40);
  return tosses;
}

// A face has four corners, and every reducer keeps sets of four whole.
TEST(CubeToss, KeepsSetsOfFourWholeInEveryReducer) {
  std::vector<Toss> tosses = some();
  tosses.resize(12);
  int flat = 0;
  for (const Toss& toss : tosses) {
    TossWorld all = world();
    all.options.step.reduction.reducer = Reducer::none;
    const TossRun a = roll_out(toss, all);
    flat += a.most_contacts >= 4;
    for (const std::string& name : reducer_names()) {
      if (name == "none" || name == "selector") continue;
      TossWorld reduced = world();
      reduced.options.step.reduction.reducer = reducer(name);
      const TossRun b = roll_out(toss, reduced);
      ASSERT_EQ(a.pose.size(), b.pose.size()) << name;
      for (std::size_t k = 0; k < a.pose.size(); ++k) {
        ASSERT_EQ(a.pose[k].p, b.pose[k].p) << name << ", " << toss.name << " row " << k;
        ASSERT_EQ(a.pose[k].R.coeffs(), b.pose[k].R.coeffs()) << name << ", " << toss.name << " row " << k;
      }
    }
  }
  EXPECT_GT(flat, 6);  // they come to lie on a face
}

// Beyond two contacts normal impulses share a load in more than one way, and friction with them.
TEST(CubeToss, DoesNotDependOnPersistenceWhileItsContactsAreFew) {
  TossWorld precise = world();
  precise.options.step.solver.tolerance = 1e-12;
  TossWorld forgets = precise;
  forgets.options.step.persistence.matching = Matching::none;
  int compared = 0;
  for (const Toss& toss : some()) {
    const TossRun a = roll_out(toss, precise), b = roll_out(toss, forgets);
    for (std::size_t k = 0; k < a.pose.size() && a.contacts[k] <= 2; ++k) {
      if (a.contacts[k] > 0) ++compared;
      ASSERT_LT((a.pose[k].p - b.pose[k].p).norm(), 1e-8) << toss.name << " row " << k;
      ASSERT_LT(log_so3((a.pose[k].R.conjugate() * b.pose[k].R).normalized()).norm(), 1e-6)
          << toss.name << " row " << k;
    }
  }
  EXPECT_GT(compared, 200);
}

// Beyond two it does, by little: three unknowns of a flat landing are shared by four normal impulses, and
// friction depends on how. Means are known to 0.65 % of the edge; 0.1 is a guard below that.
TEST(CubeToss, DependsOnPersistenceByAThousandthOfTheEdgeAtMost) {
  const std::vector<Toss> tosses = recorded();
  if (tosses.empty()) GTEST_SKIP() << "no cube_toss in AUSSOIS_DATA_DIR";
  for (const auto& [substeps, every] : {std::pair{1, 1}, std::pair{10, 8}}) {
    TossWorld remembers = world();
    remembers.substeps = substeps;
    TossWorld forgets = remembers;
    forgets.options.step.persistence.matching = Matching::none;
    double largest = 0;
    int compared = 0, changed = 0;
    for (std::size_t i = 0; i < tosses.size(); i += std::size_t(every)) {
      const double change = 100 / kTossEdge *
                            std::abs(roll_out(tosses[i], remembers).errors.position -
                                     roll_out(tosses[i], forgets).errors.position);
      largest = std::max(largest, change);
      changed += change > 1e-3;
      ++compared;
    }
    EXPECT_LE(largest, 0.1) << substeps << " substeps";
    EXPECT_GT(changed, 0) << "it changes nothing: then say so";
    std::printf("persistence at %d substeps: %d of %d errors change by more than 0.001 %%, at most %.3f %%\n",
                substeps, changed, compared, largest);
  }
}

// With its corners cut off by 2 mm the cube lies on octagons: reducers do remove contacts, and what that
// changes is a tenth of what means over all tosses are known to (0.65 % of the edge, 1.5 degrees). Faces lie
// on their eight corners, so hull_exact has nothing to remove.
TEST(CubeToss, IsNearlyTheSameByReducersThatRemoveContacts) {
  const std::vector<Toss> tosses = recorded();
  if (tosses.empty()) GTEST_SKIP() << "no cube_toss in AUSSOIS_DATA_DIR";
  TossWorld w = world();
  w.substeps = 3, w.cut = 2e-3;
  const auto rolled = [&](const std::string& name) {
    w.options.step.reduction.reducer = reducer(name);
    int reduced = 0;
    const Means errors = means(tosses, w, &reduced);
    return std::pair(errors, reduced);
  };
  const auto [all, left_out] = rolled("none");  // contacts that stay open are left out of any problem
  for (const std::string& name : reducer_names()) {
    if (name == "none" || name == "selector") continue;
    const auto [errors, reduced] = rolled(name);
    if (name == "hull_exact")
      EXPECT_EQ(reduced, left_out);
    else
      EXPECT_GT(reduced, left_out + 50000) << name;
    EXPECT_NEAR(errors.position, all.position, 0.065) << name;
    EXPECT_NEAR(errors.rotation, all.rotation, 0.15) << name;
  }
}

// --fit --measure-board from far off its end. On the odd half it meets what was asked for; the even one is
// harder, and held to that and two standard errors of a mean of 173. With the board at 0 the odd half misses
// it, too (doc/measured/cube_toss.md).
TEST(CubeToss, FitOnOneHalfMeetsItsBoundsOnTheOddHalfOnly) {
  const std::vector<Toss> tosses = recorded();
  if (tosses.empty()) GTEST_SKIP() << "no cube_toss in AUSSOIS_DATA_DIR";
  std::vector<Toss> even, odd;
  for (std::size_t i = 0; i < tosses.size(); ++i) (i % 2 ? odd : even).push_back(tosses[i]);
  const auto judged = [](const std::vector<Toss>& seen, const std::vector<Toss>& unseen, bool measures) {
    TossWorld w = world();
    if (measures) w.board = board_of(seen);
    w.law.mu = 0.3, w.law.restitution = 0.3;  // as --fit
    const TossFit found = fit(seen, w, 2, [](const TossFit&) { return true; });
    EXPECT_NEAR(found.mu, 0.18, 0.01);
    w.law.mu = found.mu, w.law.restitution = found.restitution;
    const Means errors = means(unseen, w);
    std::printf("mu = %.4f, e = %.4f after %d points and %.2g million steps: %.2f %%, %.2f deg unseen\n",
                found.mu, found.restitution, found.points, 1e-6 * double(found.steps), errors.position,
                errors.rotation);
    return errors;
  };
  const Means of_odd = judged(even, odd, true), of_even = judged(odd, even, true),
              of_odd_at_zero = judged(even, odd, false);
  EXPECT_LE(of_odd.position, 13.0);
  EXPECT_LE(of_odd.rotation, 16.5);
  EXPECT_LT(of_odd.rotation, of_odd_at_zero.rotation);  // what measuring the board is for
  EXPECT_LE(of_even.position, 13.0 + 2 * 0.65);
  EXPECT_LE(of_even.rotation, 16.5 + 2 * 1.5);
}

}  // namespace
}  // namespace aussois
