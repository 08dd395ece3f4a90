// SPDX-License-Identifier: Apache-2.0
#include "tests/support/continuity_audit.hpp"

namespace aussois {
namespace {

TEST(ContactContinuity, EveryComingAndGoingOfALongAuditIsExplained) {
  const ContinuityAudit audit = audit_continuity(1000, 320, 300);
  EXPECT_EQ(audit.unexplained, 0);
  EXPECT_GT(audit.handovers, 400);
  EXPECT_LT(audit.handover_gap, 1e-7);
  EXPECT_LT(audit.handover_rate, 1e-5);
}

}  // namespace
}  // namespace aussois
