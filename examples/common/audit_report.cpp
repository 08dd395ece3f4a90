// SPDX-License-Identifier: Apache-2.0
#include "examples/common/audit_report.hpp"

#include <algorithm>
#include <cstdio>

#include "examples/common/checkpoint_fields.hpp"
#include "geometry/number_text.hpp"

namespace aussois {
namespace {

constexpr CheckpointField<PathAudit, double> kAuditNumbers[] = {
    {"certify_distance", &PathAudit::min_distance}, {"certify_slack", &PathAudit::min_slack}};
constexpr CheckpointField<PathAudit, std::int64_t> kAuditCounts[] = {
    {"certify_steps", &PathAudit::steps},
    {"certify_violations", &PathAudit::violations},
    {"certify_nested", &PathAudit::nested},
    {"certify_uncovered", &PathAudit::uncovered}};
constexpr CheckpointField<Uncertified, std::int64_t> kUncertifiedCounts[] = {
    {"passing_pairs", &Uncertified::passing_pairs}, {"driven_overlaps", &Uncertified::driven_overlaps}};
constexpr CheckpointField<Uncertified, double> kUncertifiedNumbers[] = {
    {"driven_overlap_t", &Uncertified::driven_t}};

std::vector<std::string> names_of_skipped(const Model& model) {
  std::vector<std::string> out;
  for (const auto& [a, b] : skipped_pairs(model))
    out.push_back(model.bodies[std::size_t(a)].name + " and " + model.bodies[std::size_t(b)].name);
  return out;
}

std::string nearest_of(const PathAudit& audit) {
  if (!(audit.min_distance < kInf)) return "no two bodies came within twice their dilations";
  char text[100];
  std::snprintf(text, sizeof text, "base distance at least %.4g um, %.4g um above the certificate",
                1e6 * audit.min_distance, 1e6 * audit.min_slack);
  return text;
}

}  // namespace

void set_audit(Summary& summary, const PathAudit& audit, const Model& model) {
  if (audit.samples == 0) return;
  summary.set("certify_samples", std::int64_t(audit.samples));
  summary.set("certify_steps", audit.steps);
  summary.set("certify_violations", audit.violations);
  summary.set("certify_nested", audit.nested);
  summary.set("certify_uncovered", audit.uncovered);
  summary.set("certify_min_distance", audit.min_distance);
  summary.set("certify_skipped", names_of_skipped(model));
}

bool tell(const PathAudit& audit, const Model& model) {
  if (audit.samples == 0) return true;
  if (audit.steps == 0)
    std::printf("certify: nothing to look at, no two bodies that can touch\n");
  else
    std::printf("certify: %s, %s and the end of each, %s, %s\n", counted(audit.steps, "step").c_str(),
                counted(audit.samples, "place").c_str(), nearest_of(audit).c_str(),
                counted(audit.violations, "violation").c_str());
  if (audit.nested > 0)
    std::printf("certify: a body was inside another in %s\n", counted(audit.nested, "step").c_str());
  if (audit.uncovered > 0)
    std::printf("certify: contacts and base distances disagree at the end of %s\n",
                counted(audit.uncovered, "step").c_str());
  const std::vector<std::string> skipped = names_of_skipped(model);
  if (!skipped.empty())
    std::printf("certify: not looked at, because they pass through each other: %s%s\n",
                skipped.front().c_str(),
                skipped.size() > 1 ? (", and " + std::to_string(skipped.size() - 1) + " more").c_str() : "");
  return audit.violations == 0;
}

void keep(const PathAudit& audit, Checkpoint& checkpoint) {
  keep(kAuditNumbers, audit, checkpoint);
  keep(kAuditCounts, audit, checkpoint);
}

PathAudit path_audit_of(const Checkpoint& checkpoint) {
  PathAudit out;
  take(kAuditNumbers, checkpoint, out);
  take(kAuditCounts, checkpoint, out);
  return out;
}

void add(Uncertified& run, const StepReport& report) {
  run.passing_pairs = std::max(run.passing_pairs, std::int64_t(report.passing_pairs));
  if (report.driven_overlaps.empty()) return;
  if (run.driven_overlaps++ == 0) run.driven_t = report.t - report.h;
}

void set_uncertified(Summary& summary, const Uncertified& run) {
  summary.set("passing_pairs", run.passing_pairs);
  summary.set("driven_overlaps", run.driven_overlaps);
  summary.set("driven_overlap_t", run.driven_t);
}

void tell(const Uncertified& run) {
  if (run.driven_overlaps > 0)
    std::fprintf(stderr, "moved and fixed bodies overlapped in %s, first from t = %.6g s on\n",
                 counted(run.driven_overlaps, "step").c_str(), run.driven_t);
}

void keep(const Uncertified& run, Checkpoint& checkpoint) {
  keep(kUncertifiedCounts, run, checkpoint);
  keep(kUncertifiedNumbers, run, checkpoint);
}

Uncertified uncertified_of(const Checkpoint& checkpoint) {
  Uncertified out;
  take(kUncertifiedCounts, checkpoint, out);
  take(kUncertifiedNumbers, checkpoint, out);
  return out;
}

}  // namespace aussois
