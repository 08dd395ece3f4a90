// SPDX-License-Identifier: Apache-2.0
// Contacts along motions. The long audit is contact_continuity_slow_test.cpp.
#include "tests/support/continuity_audit.hpp"

namespace aussois {
namespace {

TEST(ContactContinuity, EveryComingAndGoingIsExplained) {
  const ContinuityAudit audit = audit_continuity(0, 40, 300);
  EXPECT_EQ(audit.unexplained, 0);
  EXPECT_GT(audit.at_threshold + audit.at_angle, 50);  // the sample is not hollow
  EXPECT_GT(audit.handovers, 30);
  EXPECT_LT(audit.handover_gap, 1e-7);
  EXPECT_LT(audit.handover_rate, 1e-5);
}

}  // namespace
}  // namespace aussois
