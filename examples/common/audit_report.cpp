// SPDX-License-Identifier: Apache-2.0
#include "examples/common/audit_report.hpp"

#include <cstdio>

namespace aussois {

void set_audit(Summary& summary, const PathAudit& audit) {
  if (audit.samples == 0) return;
  summary.set("certify_samples", std::int64_t(audit.samples));
  summary.set("certify_steps", audit.steps);
  summary.set("certify_violations", audit.violations);
  summary.set("certify_min_distance", audit.min_distance);
}

bool tell(const PathAudit& audit) {
  if (audit.samples > 0 && audit.steps == 0)
    std::printf("certify: nothing to look at, no two bodies that can touch\n");
  else if (audit.samples > 0)
    std::printf(
        "certify: %d places of each of %lld steps, base distance at least %.4g um, %.4g um above the "
        "certificate, %lld violations\n",
        audit.samples, static_cast<long long>(audit.steps), 1e6 * audit.min_distance, 1e6 * audit.min_slack,
        static_cast<long long>(audit.violations));
  return audit.violations == 0;
}

}  // namespace aussois
