// SPDX-License-Identifier: Apache-2.0
// The rows of the verification list, as `verify` prints them: each must hold, and the page must say the same.
#include <algorithm>
#include <fstream>
#include <set>

#include <gtest/gtest.h>

#include "examples/studies/verification/list.hpp"
#include "examples/studies/verification/running.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

class VerificationList : public ::testing::TestWithParam<const VerificationCase*> {};

TEST_P(VerificationList, Holds) {
  const VerificationCase& c = *GetParam();
  const Measured measured = measure(c);
  if (!measured.missing.empty()) GTEST_SKIP() << measured.missing;
  EXPECT_EQ(measured.failure, "");
  for (const Asked& row : c.rows)
    EXPECT_EQ(verdict(row, measured), Verdict::pass)
        << row_name(c, row) << ": " << figure(row, measured) << " is not " << bound_text(row) << " ("
        << row.source << ")";
}

std::vector<const VerificationCase*> cases_that_are(bool slow) {
  std::vector<const VerificationCase*> out;
  for (const VerificationCase& c : verification_cases())
    if (c.slow == slow) out.push_back(&c);
  return out;
}
std::string name_of(const ::testing::TestParamInfo<const VerificationCase*>& info) {
  std::string out = stem_of(*info.param);
  std::ranges::replace_if(
      out, [](char x) { return x == '-' || x == '.'; }, '_');
  return out;
}
INSTANTIATE_TEST_SUITE_P(Quick, VerificationList, ::testing::ValuesIn(cases_that_are(false)), name_of);
INSTANTIATE_TEST_SUITE_P(Slow, VerificationList, ::testing::ValuesIn(cases_that_are(true)), name_of);

// Each row says what it is, in which unit, and where its bound comes from; none hides another.
TEST(VerificationRows, AreCompleteAndDistinct) {
  std::set<std::string> names, stems;
  std::pair<char, int> last;
  for (const VerificationCase& c : verification_cases()) {
    const std::pair<char, int> at(c.name[0], std::stoi(c.name.substr(1)));
    EXPECT_GE(at, last) << c.name << ": groups and numbers in order";
    last = at;
    EXPECT_TRUE(stems.insert(stem_of(c)).second) << stem_of(c);
    EXPECT_FALSE(c.what.empty() || c.rows.empty()) << c.name;
    for (const Asked& row : c.rows) {
      EXPECT_TRUE(names.insert(row_name(c, row)).second) << row_name(c, row);
      EXPECT_FALSE(row.what.empty() || row.unit.empty() || row.source.empty()) << row_name(c, row);
      EXPECT_EQ((row.what + row.source + c.what + row.unit).find('|'), std::string::npos)
          << "a table's border";
    }
  }
}

TEST(VerificationRows, StandOnThePage) {
  List list;
  for (const VerificationCase& c : verification_cases()) list.push_back({&c, {}});
  const std::string page = read_file(AUSSOIS_SOURCE_DIR "/doc/theory/verification_list.md");
  EXPECT_EQ(without_figures(list_in(page)), without_figures(to_markdown(list)))
      << "verify --all --page doc/theory/verification_list.md writes it";
}

VerificationCase of_one_row(Sense sense, double bound, std::function<Figures()> measure) {
  return {.name = "A0.case",
          .setting = "here",
          .what = "set-up",
          .rows = {{"x", "figure", "m", bound, "nowhere", sense}},
          .measure = std::move(measure)};
}

Verdict verdict_of(Sense sense, double bound, double figure) {
  const VerificationCase c = of_one_row(sense, bound, [=] { return Figures{{"x", figure}}; });
  return verdict(c.rows[0], measure(c));
}

TEST(VerificationRows, HoldUpToTheirBoundAndNeverForWhatIsNoNumber) {
  EXPECT_EQ(verdict_of(Sense::at_most, 1, 1), Verdict::pass);
  EXPECT_EQ(verdict_of(Sense::at_most, 1, 1.01), Verdict::fail);
  EXPECT_EQ(verdict_of(Sense::at_least, 1, 1), Verdict::pass);
  EXPECT_EQ(verdict_of(Sense::at_least, 1, 0.99), Verdict::fail);
  EXPECT_EQ(verdict_of(Sense::exactly, 2, 2), Verdict::pass);
  EXPECT_EQ(verdict_of(Sense::exactly, 2, 3), Verdict::fail);
  for (const Sense sense : {Sense::at_most, Sense::at_least, Sense::exactly})
    EXPECT_EQ(verdict_of(sense, 1, std::nan("")), Verdict::fail);
}

TEST(VerificationRows, FailWithTheRunAndAreSkippedWithoutData) {
  const VerificationCase broken =
      of_one_row(Sense::at_least, 0, []() -> Figures { throw NumericalFailure("refused"); });
  EXPECT_EQ(verdict(broken.rows[0], measure(broken)), Verdict::fail);
  EXPECT_EQ(measure(broken).failure, "refused");
  const VerificationCase bare =
      of_one_row(Sense::at_most, 0, []() -> Figures { throw MissingData("no file"); });
  EXPECT_EQ(verdict(bare.rows[0], measure(bare)), Verdict::skipped);
  EXPECT_THROW(measure(of_one_row(Sense::at_most, 1, [] { return Figures{{"y", 0}}; })), std::logic_error);
}

TEST(VerificationRows, KeepTheWorstOfManyAndANumberThatIsNone) {
  Worst worst;
  Least least;
  for (const double x : {1.0, 3.0, 2.0}) worst.add(x), least.add(x);
  EXPECT_EQ(worst, 3);
  EXPECT_EQ(least, 1);
  worst.add(std::nan("")), least.add(std::nan(""));
  worst.add(4), least.add(0);
  EXPECT_TRUE(std::isnan(worst) && std::isnan(least));
}

TEST(VerificationRows, GoOnThePageWithTheWorstOfTheirSettings) {
  VerificationCase one = of_one_row(Sense::at_most, 1, {}), two = one;
  two.setting = "there";
  const std::string markdown =
      to_markdown({{&one, Measured{.figures = {{"x", 0.25}}}}, {&two, Measured{.figures = {{"x", 0.5}}}}});
  EXPECT_NE(markdown.find("| `A0.case.x` | set-up: figure | here; there | <= 1 m | nowhere | 0.5 |\n"),
            std::string::npos)
      << markdown;
  const auto shown = [&](double first, double second, Sense sense) {
    one.rows[0].sense = two.rows[0].sense = sense;
    const std::string text = to_markdown(
        {{&one, Measured{.figures = {{"x", first}}}}, {&two, Measured{.figures = {{"x", second}}}}});
    const std::size_t cell = text.find("nowhere | ") + 10;
    return text.substr(cell, text.find(' ', cell) - cell);
  };
  EXPECT_EQ(shown(0.5, 0.25, Sense::at_most), "0.5");
  EXPECT_EQ(shown(0.5, 0.25, Sense::at_least), "0.25");
  EXPECT_EQ(shown(1, 0.25, Sense::exactly), "0.25");  // off 1 by 0.75
  EXPECT_EQ(shown(1.5, 1, Sense::exactly), "1.5");
  for (const Sense sense : {Sense::at_most, Sense::at_least, Sense::exactly}) {
    EXPECT_EQ(shown(std::nan(""), 0.5, sense), "nan");
    EXPECT_EQ(shown(0.5, std::nan(""), sense), "nan");
  }
  one.rows[0].sense = two.rows[0].sense = Sense::at_most;
  two.rows[0].bound = 2;
  EXPECT_NE(to_markdown({{&one, {}}, {&two, {}}}).find("| there | <= 2 m | nowhere | - |\n"),
            std::string::npos);
  const std::string page = "<!-- verify --page writes from here -->\nold\n<!-- to here -->\nend\n";
  ASSERT_TRUE(has_list(page));
  EXPECT_EQ(list_in(with_list(page, markdown)), markdown);
  EXPECT_EQ(with_list(with_list(page, markdown), "old\n"), page);
  EXPECT_FALSE(has_list("<!-- to here -->\n"));
}

TEST(VerificationResults, ReadBackAsTheSameBitsForTheSameProgramAndCase) {
  const VerificationCase c = of_one_row(Sense::at_most, 1, {});
  VerificationCase other = c;
  other.setting = "there";
  const std::filesystem::path path = ::testing::TempDir() + "/verification_result.json";
  const auto write = [&](const Measured& m) { write_measured(path, c, m, 7); };
  for (const double figure : {1.0 / 3, 5e-324, HUGE_VAL, -HUGE_VAL}) {
    write({.figures = {{"x", figure}}});
    EXPECT_EQ(read_measured(path, c, 7).value().figures.at("x"), figure);
  }
  EXPECT_FALSE(read_measured(path, c, 8) || read_measured(path, other, 7) ||
               read_measured(path.string() + "_", c, 7));
  write({.failure = "refused"});
  EXPECT_EQ(read_measured(path, c, 7).value().failure, "refused");
  std::ofstream(path) << "{";
  EXPECT_FALSE(read_measured(path, c, 7));
}

}  // namespace
}  // namespace aussois
