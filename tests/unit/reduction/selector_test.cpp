// SPDX-License-Identifier: Apache-2.0
// A reducer of one's own: what it sees, what is added to its word, what is refused.
#include <gtest/gtest.h>

#include "reduction/reduce.hpp"
#include "tests/support/flat_contacts.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

ReductionOptions chooses(const ContactSelector& selector) {
  return {.reducer = Reducer::selector, .selector = selector};
}

TEST(Selector, IsTakenAtItsWordAndKeepsTheDeepestBesides) {
  ContactSet set = flat(grid(6, 4, 0.3, 0.1));
  set.points[7].gap = -1e-6;
  const Selection selection = reduce(set, chooses([](const ReductionInput&, const Clusters&) {
                                       return std::vector<int>{23, 3, 3};
                                     }));
  EXPECT_EQ(selection.kept, (std::vector<int>{3, 7, 23}));
  EXPECT_LT(selection.loss.margin, 0.5);
}

TEST(Selector, SeesWhatIsKnown) {
  ContactSet set = flat(grid(6, 4, 0.3, 0.1));
  set.points[4].normal = Vec3::UnitX();
  ReductionInput input{.contacts = set};
  input.impulse.assign(24, Vec3(0, 0, 2));
  input.bodies.resize(2);
  input.bodies[1].wrench[2] = -9.81;
  bool seen = false;
  reduce(input, chooses([&](const ReductionInput& given, const Clusters& clusters) {
           seen = given.impulse.size() == 24 && given.bodies[1].wrench[2] == -9.81 && clusters.size() == 2;
           return std::vector<int>{};
         }));
  EXPECT_TRUE(seen);
}

TEST(Selector, IsCompletedToTheMarginDemanded) {
  const ContactSet set = flat(grid(6, 4, 0.3, 0.1));
  ReductionOptions options = chooses([](const ReductionInput&, const Clusters&) {
    return std::vector<int>{8, 9};
  });
  EXPECT_LT(reduce(set, options).loss.margin, 0.5);
  for (const double margin : {0.3, 0.9, 1.0}) {
    options.min_margin = margin;
    const Selection selection = reduce(set, options);
    EXPECT_GE(selection.loss.margin, margin - 1e-9);
    EXPECT_LE(selection.kept.size(), 7u);  // two chosen, the deepest, and no more than the four corners
  }
}

TEST(Selector, IsRefusedWhenItNamesWhatIsNotThere) {
  const ContactSet set = flat(grid(6, 4, 0.3, 0.1));
  const auto names = [&](int i) {
    return message_of([&] {
      reduce(set, chooses([i](const ReductionInput&, const Clusters&) { return std::vector<int>{i}; }));
    });
  };
  EXPECT_NE(names(24).find("contact 24 must lie in [0, 24)"), std::string::npos);
  EXPECT_NE(names(-1).find("contact -1"), std::string::npos);
}

TEST(Selector, IsGivenExactlyWhenItIsTheReducer) {
  EXPECT_THROW(validate(ReductionOptions{.reducer = Reducer::selector}), std::invalid_argument);
  ReductionOptions options =
      chooses([](const ReductionInput&, const Clusters&) { return std::vector<int>{}; });
  EXPECT_NO_THROW(validate(options));
  options.reducer = Reducer::extreme_points;
  EXPECT_THROW(validate(options), std::invalid_argument);
  options = chooses(options.selector);
  options.paper_exact = true;
  EXPECT_THROW(validate(options), std::invalid_argument);
}

TEST(ReductionInput, HasOneEntryPerContactOrNone) {
  const ContactSet set = flat(grid(6, 4, 0.3, 0.1));
  ReductionInput input{.contacts = set};
  input.mu.assign(23, 0.3);
  EXPECT_NE(message_of([&] { reduce(input); }).find("ReductionInput::mu: 23 entries for 24"),
            std::string::npos);
}

TEST(Reducer, IsKnownByItsName) {
  for (const std::string& name : reducer_names()) EXPECT_EQ(to_string(reducer(name)), name);
  EXPECT_NE(message_of([] { reducer("magic"); }).find("extreme_points"), std::string::npos);
}

}  // namespace
}  // namespace aussois
