// SPDX-License-Identifier: Apache-2.0
#include "examples/common/step_dump.hpp"

#include "io/fclib_file.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

std::string chosen_of_ten(const std::string& text, bool solved = true) {
  std::string steps;
  for (int i = 1; i <= 10; ++i)
    if (chosen(step_choice(text), i, solved)) steps += std::to_string(i) + " ";
  return steps;
}

/// A point of 2 kg on a plane, as a step would report it.
StepReport resting_point(SolveStatus status) {
  SparseMatrix M(3, 3), H(3, 3);
  M.setIdentity();
  M *= 2;
  H.setIdentity();
  StepReport report{.t = 0.25, .h = 0.125};
  report.solve.status = status;
  report.problem = StepProblem{
      .problem = {.M = M, .H = H, .f = Vec3(-1, 0, 0), .w = VecX::Zero(3), .laws = {coulomb(0.5)}},
      .start = Vec3(0.5, 0, 0)};
  report.problem->solution.v = report.problem->solution.u = VecX::Zero(3);
  report.problem->solution.r = Vec3(1, 0, 0);
  report.problem->solution.report.status = status;
  return report;
}

}  // namespace

TEST(StepDump, ChoosesSteps) {
  EXPECT_EQ(chosen_of_ten("all"), "1 2 3 4 5 6 7 8 9 10 ");
  EXPECT_EQ(chosen_of_ten("every 3"), "3 6 9 ");
  EXPECT_EQ(chosen_of_ten("2,4-6,9,100-200"), "2 4 5 6 9 ");
  EXPECT_EQ(chosen_of_ten("unsolved"), "");
  EXPECT_EQ(chosen_of_ten("unsolved", false), "1 2 3 4 5 6 7 8 9 10 ");
}

TEST(StepDump, NamesAChoiceThatIsNone) {
  for (const char* text : {"", "some", "every", "every 0", "3,", "0", "4-", "-4", "3-1", "every 2.5", "1 2"})
    EXPECT_EQ(message_of([&] { step_choice(text); }),
              std::string("--dump-steps '") + text +
                  "' must be all, unsolved, 'every N', or a list of steps and ranges such as 3,17,40-45");
}

TEST(StepDump, WritesTheProblemWithItsStartAndItsAnswer) {
  const std::filesystem::path folder = fresh_folder() / "new";
  StepDump dump({.folder = folder, .steps = "every 2"}, "point");
  EXPECT_TRUE(dump.wants_problems());
  const StepReport report = resting_point(SolveStatus::converged);
  dump.step(1, report);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
  dump.step(2, report);
  const FclibFile file = read_fclib(folder / "point_000002.hdf5");
  EXPECT_EQ(MatX(std::get<FrictionProblem>(file.problem).M), MatX(report.problem->problem.M));
  EXPECT_EQ(file.title, "point_000002");
  EXPECT_EQ(file.description.rfind("step 2 of point, to t = 0.25 s with h = 0.125 s; converged", 0), 0u)
      << file.description;
  ASSERT_EQ(file.guesses.size(), 1u);
  EXPECT_EQ(file.guesses[0].r, report.problem->start);
  ASSERT_TRUE(file.solution.has_value());
  EXPECT_EQ(file.solution->r, report.problem->solution.r);
  EXPECT_EQ(file.solution->v, report.problem->solution.v);
  EXPECT_EQ(dump.written(), 1);
}

TEST(StepDump, CallsNoSolutionWhatDidNotConverge) {
  const std::filesystem::path folder = fresh_folder();
  StepDump dump({.folder = folder, .steps = "unsolved"}, "point");
  dump.step(7, resting_point(SolveStatus::stagnated));
  const FclibFile file = read_fclib(folder / "point_000007.hdf5");
  EXPECT_FALSE(file.solution.has_value());
  ASSERT_EQ(file.guesses.size(), 2u);
  EXPECT_EQ(file.guesses[1].r, VecX(Vec3(1, 0, 0)));
  EXPECT_NE(file.description.find("stagnated"), std::string::npos);
}

TEST(StepDump, DoesNothingWithoutAFolderOrContacts) {
  const std::filesystem::path folder = fresh_folder();
  StepDump none({}, "point");
  EXPECT_FALSE(none.wants_problems());
  StepDump dump({.folder = folder}, "point");
  dump.step(1, {});  // nothing was kept
  StepReport flight = resting_point(SolveStatus::converged);
  flight.problem->problem.laws.clear();
  dump.step(2, flight);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
  EXPECT_EQ(dump.written(), 0);
}

}  // namespace aussois
