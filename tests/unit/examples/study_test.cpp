// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/convergence/study.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "examples/common/convergence.hpp"
#include "examples/common/driver.hpp"
#include "examples/studies/convergence/study_files.hpp"
#include "tests/support/altered.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

SchemeOptions moreau(double theta) {
  return {.moreau_jean = {.theta = theta, .law = NormalLaw::moreau},
          .passive_midpoint = {.law = NormalLaw::moreau}};
}

Study made_up(double order) {
  Study s{.case_name = "ball", .scheme = "euler theta 0.5", .options = {.levels = 3, .phases = 1}};
  for (const double h : {0.1, 0.05, 0.02}) {
    s.h.push_back(h);
    s.errors.push_back({std::pow(h, order), 2 * h, 0.3 * h * h, 1e-13});
    s.cut.push_back(0);
  }
  s.order = {order, 1, 2, kInf};
  s.expected = {1, 1, 1, 1};
  return s;
}

TEST(FittedOrder, IsTheExponentOfAPower) {
  const std::vector<double> h = {0.1, 0.03, 0.02, 0.001};
  std::vector<double> error;
  for (const double x : h) error.push_back(7 * std::pow(x, 1.7));
  EXPECT_NEAR(fitted_order(h, error), 1.7, 1e-13);
  EXPECT_NEAR(pairwise_order(h, error, 2), 1.7, 1e-13);
  EXPECT_NE(message_of([&] { fitted_order({1, 0.5, 0.2}, {1, 0, 1}); }).find("error"), std::string::npos);
  EXPECT_THROW(fitted_order({1, 0.5}, {1, 1}), std::invalid_argument);
}

TEST(StepSizes, AreNoPowersOfTwoOfEachOther) {
  const std::vector<double> h = step_sizes(1, 8);
  for (std::size_t i = 0; i < h.size(); ++i)
    for (std::size_t j = i + 1; j < h.size(); ++j) {
      const double halvings = std::log2(h[i] / h[j]);
      EXPECT_GT(std::abs(halvings - std::round(halvings)), 1e-3) << i << ", " << j;
      EXPECT_NEAR(halvings, double(j - i), 0.11);  // a step is turned by up to 7 %
    }
}

// A run covers the case exactly, whatever its first step.
TEST(RunCase, EndsAtTheEndOfTheCase) {
  const Case& c = case_named("bowling");
  SchemeOptions options = moreau(0.5);
  options.step.h = 0.0213;
  for (const double phase : {0.1, 0.5, 1.0}) {
    const ComputedMotion run = run_case(c, "moreau_jean", options, phase);
    EXPECT_EQ(run.t.front(), 0);
    EXPECT_NEAR(run.t[1], phase * options.step.h, 1e-15);
    EXPECT_NEAR(run.t[2] - run.t[1], options.step.h, 1e-15);
    EXPECT_NEAR(run.t.back(), c.t_end, 1e-12);
    EXPECT_EQ(run.t.size(), run.node.size());
  }
}

// A scheme that refuses to step ends the study with a message and no table.
TEST(RunCase, TellsWhereAStepFails) {
  SchemeOptions options = moreau(0.5);
  options.step.h = 0.1;  // the ball would sink in by more than its dilation
  options.step.advancement = {.min_h = 0.05};
  const std::string message =
      message_of<NumericalFailure>([&] { run_case(case_named("ball_e05"), "moreau_jean", options, 1); });
  EXPECT_NE(message.find("ball_e05, moreau_jean theta 0.5 moreau, t = "), std::string::npos) << message;
}

TEST(Study, FindsTheOrdersOfASmoothMotion) {
  const StudyOptions options{.h = 0.05, .levels = 4, .phases = 1};
  const Study midpoint = study(case_named("free_top"), "moreau_jean", moreau(0.5), options);
  EXPECT_NEAR(midpoint.order[q_max], 2, 0.05);
  EXPECT_NEAR(midpoint.order[v_nodes], 2, 0.05);
  EXPECT_NEAR(midpoint.order[v_l1], 1, 0.05);  // a step function
  EXPECT_EQ(midpoint.expected, (Errors{2, 1, 2, 2}));
  EXPECT_TRUE(as_expected(midpoint));
  const Study euler = study(case_named("free_top"), "moreau_jean", moreau(1), options);
  EXPECT_EQ(euler.expected, (Errors{1, 1, 1, 1}));
  for (const double order : euler.order) EXPECT_NEAR(order, 1, 0.1);
}

TEST(Study, CallsRoundingExact) {
  const Study s = study(case_named("incline_30"), "moreau_jean", {.moreau_jean = {.theta = 0.5}},
                        {.levels = 3, .phases = 1});
  EXPECT_TRUE(std::isinf(s.order[q_max]));  // uniform acceleration
  EXPECT_NEAR(s.order[v_l1], 1, 0.05);
  EXPECT_TRUE(as_expected(s));
}

TEST(Study, RefusesAPlasticSchemeWhereThingsBounce) {
  SchemeOptions options = moreau(1);
  options.moreau_jean.law = NormalLaw::gap_over_step;
  EXPECT_NE(
      message_of([&] { study(case_named("ball_e05"), "moreau_jean", options, {}); }).find("no restitution"),
      std::string::npos);
  EXPECT_NE(message_of([] { validate(StudyOptions{.levels = 2}); }).find("StudyOptions::levels = 2"),
            std::string::npos);
  EXPECT_NE(message_of([] { validate(StudyOptions{.phases = 0}); }).find("StudyOptions::phases = 0"),
            std::string::npos);
  EXPECT_NE(message_of([] { validate(StudyOptions{.tolerance = 1}); }).find("StudyOptions::tolerance = 1"),
            std::string::npos);
}

// Steps and tolerance have one place each.
TEST(Study, RefusesStepsAndToleranceAmongTheOptionsOfTheScheme) {
  const auto refusal = [](const StepOptions& step) {
    return message_of([&] { study(case_named("incline_30"), "moreau_jean", {.step = step}, {}); });
  };
  EXPECT_EQ(refusal({.h = 0.1}), "step.h = 0.1 is not read by a study");
  EXPECT_EQ(refusal({.solver = {.tolerance = 1e-6}}), "step.solver.tolerance = 1e-06 is not read by a study");
}

TEST(Study, RefusesPairwiseImpactsWhereContactsCloseAtOnce) {
  SchemeOptions options = moreau(0.5);
  options.moreau_jean.impact.order = ImpactOrder::sequential;
  EXPECT_NE(
      message_of([&] { study(case_named("slider_crank"), "moreau_jean", options, {}); }).find("in turn"),
      std::string::npos);
}

TEST(Study, MissesItsOrderByMoreThanTheSlackOnly) {
  EXPECT_TRUE(as_expected(made_up(0.95)));
  EXPECT_FALSE(as_expected(made_up(0.85)));
  EXPECT_FALSE(as_expected(made_up(std::nan(""))));
}

// What theory promises less of than order one is not counted as met, however it comes out.
TEST(Study, TellsWhatIsMetFromWhatIsNotPromised) {
  Study s = made_up(1);
  EXPECT_EQ(order_verdict(s), OrderVerdict::met);
  s.expected[v_graph] = 0.5;
  EXPECT_EQ(order_verdict(s), OrderVerdict::less);
  EXPECT_TRUE(as_expected(s));
  s.order[q_max] = 0.8;
  EXPECT_EQ(order_verdict(s), OrderVerdict::missed);
}

// A step that was shortened has a smaller error, never one larger than a whole step of twice its length.
TEST(Study, JudgesShortenedStepsByABoundAndNotBySlopes) {
  Study s = made_up(1);
  s.h.insert(s.h.begin(), 0.2), s.cut.insert(s.cut.begin(), 3);
  s.errors.insert(s.errors.begin(), Errors{0.1, 0.2, 0.001, 1e-13});  // flatter than order one
  EXPECT_EQ(order_verdict(s), OrderVerdict::met);
  s.errors[0][q_max] = 0.41;
  EXPECT_EQ(order_verdict(s), OrderVerdict::missed);
  s = made_up(1);
  s.cut[1] = 1;
  EXPECT_EQ(order_verdict(s), OrderVerdict::not_judged);
  EXPECT_FALSE(as_expected(s));
}

// The certificate shortens the long steps of an impact that would end too deep; shorter ones are added until
// three are whole, and the order is theirs.
TEST(Study, TakesSchemesAsTheyAreDelivered) {
  const Study s = study(case_named("ball_e0"), "moreau_jean", moreau(0.5), {.levels = 3, .phases = 4});
  EXPECT_GT(s.cut[0], 0) << to_string(s);
  ASSERT_EQ(s.h.size(), 6U) << to_string(s);
  for (const std::size_t i : {3U, 4U, 5U}) EXPECT_EQ(s.cut[i], 0);
  EXPECT_EQ(order_verdict(s), OrderVerdict::met) << to_string(s);
  EXPECT_NE(to_string(s).find("steps shortened"), std::string::npos);
}

// Each scheme and scene says why: a landing, a smooth motion, impacts, ever smaller hops.
TEST(Study, SaysWhyAnOrderIsExpected) {
  const auto why = [](const char* name, const SchemeOptions& options, Measure m) {
    const char* scheme =
        options.passive_midpoint.law == NormalLaw::combined ? "passive_midpoint" : "moreau_jean";
    const auto [order, reasons] =
        expected_orders(case_named(name), scheme_traits(scheme, options), {0.1, 0.05, 0.02});
    return std::to_string(order[m]).substr(0, 3) + " " + reasons[m];
  };
  const SchemeOptions combined{.passive_midpoint = {.law = NormalLaw::combined}};
  EXPECT_TRUE(why("ball_e0", combined, v_graph).starts_with("1.0 impacts, slip and stick"));
  EXPECT_TRUE(why("ball_e0", moreau(1), v_graph).starts_with("0.5 a landing ends"));
  EXPECT_TRUE(why("ball_e0", moreau(0.5), v_graph).starts_with("1.0 impacts, slip and stick"));
  EXPECT_TRUE(why("ball_e05", moreau(0.5), q_max).find("log(T/h)") != std::string::npos);
  EXPECT_TRUE(why("free_top", moreau(0.5), v_l1).starts_with("1.0 a step function"));
  EXPECT_TRUE(why("free_top", moreau(0.5), q_max).starts_with("2.0 no contact"));
  EXPECT_TRUE(why("free_top", moreau(1), q_max).starts_with("1.0 no contact"));
}

TEST(StudyFile, ReadsBackWhatItHoldsForThisProgramOnly) {
  const std::filesystem::path file = fresh_folder() / "s.json";
  Study s = made_up(1.25);
  s.why = {"a", "b", "c", "d"}, s.cut[1] = 7;
  write_study(file, s, 42);
  EXPECT_EQ(content_of(file), to_json(s, 42));
  const std::optional<Study> back = read_study(file, s, 42);
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->h, s.h);
  EXPECT_EQ(back->errors, s.errors);
  EXPECT_EQ(back->order, s.order);
  EXPECT_EQ(back->expected, s.expected);
  EXPECT_EQ(back->cut, s.cut);
  EXPECT_EQ(back->why, s.why);
  EXPECT_FALSE(read_study(file, s, 43).has_value());
  Study other = s;
  other.scheme = "euler theta 1";
  EXPECT_FALSE(read_study(file, other, 42).has_value());
  const auto others = altered(s.options);
  EXPECT_EQ(others.size(), 5U);
  for (const auto& [path, options] : others) {
    other = s, other.options = options;
    EXPECT_FALSE(read_study(file, other, 42).has_value()) << path;
  }
  EXPECT_FALSE(read_study(file.parent_path() / "none.json", s, 42).has_value());
  write_bytes(file, to_json(s, 42).substr(0, 100));
  EXPECT_FALSE(read_study(file, s, 42).has_value());
  s.h.pop_back(), s.errors.pop_back(), s.cut.pop_back();
  write_study(file, s, 42);
  EXPECT_FALSE(read_study(file, s, 42).has_value()) << "fewer step sizes than asked for";
}

TEST(OrderTable, MarksWhatIsMissedExactShortenedLessPromisedOrNotThere) {
  Study late = made_up(0.5);
  late.case_name = "block", late.scheme = "euler theta 1";
  Study other = made_up(1);
  other.scheme = "heun", other.expected[v_graph] = 0.5;
  other.h.insert(other.h.begin(), 0.2), other.cut.insert(other.cut.begin(), 1);
  other.errors.insert(other.errors.begin(), other.errors[0]);
  EXPECT_EQ(order_table({made_up(1), other, late}),
            "## euler\n\n"
            "| case | theta 0.5 | theta 1 |\n|---|---|---|\n"
            "| `ball` | 1.00 1.00 2.00 exact | - |\n"
            "| `block` | - | **0.50** 1.00 2.00 exact |\n"
            "\n## heun\n\n"
            "| case | defaults |\n|---|---|\n"
            "| `ball` | 1.00 1.00 (2.00) exact c |\n");
}

}  // namespace
}  // namespace aussois
