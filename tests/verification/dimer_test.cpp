// SPDX-License-Identifier: Apache-2.0
// C5: what is found between the balls of a dimer when a rod comes there, whatever is remembered of steps
// before; the rest of C4 and C5 are rows of the driver `verify`.

#include <gtest/gtest.h>

#include "examples/scenes/toys.hpp"
#include "integrators/pose/find_ahead.hpp"

namespace aussois {
namespace {

void expect_same(const ContactSet& a, const ContactSet& b) {
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(key_of(a.points[i]), key_of(b.points[i]));
    EXPECT_NEAR(a.points[i].gap, b.points[i].gap, 1e-12);
    EXPECT_LT((a.points[i].normal - b.points[i].normal).norm(), 1e-12);
  }
}

// One pose after the other, forward and backward, with what is kept from pose to pose: the candidates of the
// last query, and in a step the impulses of the last one.
TEST(DimerC5, ContactSetIsAFunctionOfThePose) {
  const CaseScene s = dimer_and_rod(0, 1e-3, 0);
  const StepOptions o{.h = 1e-3, .advancement = {.certify = false}};
  const StepSetting keeps = step_setting(s.model, o);
  std::vector<std::pair<double, double>> path;
  for (int k = -60; k <= 60; ++k) path.emplace_back(1e-3 * k, 0.012);  // above the balls
  for (int k = 0; k <= 40; ++k) path.emplace_back(0, 1e-3 * (12 - 0.3 * k));
  const std::size_t count = path.size();
  for (std::size_t k = count; k-- > 0;) path.push_back(path[k]);
  Estimate ahead{.v = VecX::Zero(s.state.v.size()), .meeting = {}};
  linear_part(ahead.v, s.body).z() = -40;  // 50 mm in a step, enlarged
  ContactMemory memory;
  std::vector<ContactSet> forward;
  std::size_t found = 0;
  for (std::size_t k = 0; k < path.size(); ++k) {
    SCOPED_TRACE(k);
    State state = s.state;
    pose(state, s.body).p += Vec3(path[k].first, 0, path[k].second);
    const StepSetting begins = step_setting(s.model, o);
    const ContactSet fresh = contacts_within(begins, state, 0.05);
    if (k < count)
      forward.push_back(fresh);
    else
      expect_same(fresh, forward[2 * count - 1 - k]);
    const FoundContacts alone = find_ahead(begins, state, ahead, o.h);
    state.memory = memory;
    const FoundContacts there = find_ahead(keeps, state, ahead, o.h);
    expect_same(there.contacts, alone.contacts);
    std::vector<StepPair> pairs = there.pairs;
    for (StepPair& pair : pairs) pair.threshold = 0.05, pair.rotation = 0;
    expect_same(contacts_of(s.model, state, pairs, keeps.options.lmd, {}, *keeps.scratch).fine, fresh);
    memory = remember(there.contacts, std::vector<Vec3>(there.contacts.points.size(), Vec3(0, 0.1, 1)),
                      {.g = there.g});
    found += there.contacts.points.size();
  }
  EXPECT_GT(found, 600U);
}

}  // namespace
}  // namespace aussois
