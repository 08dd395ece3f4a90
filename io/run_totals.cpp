// SPDX-License-Identifier: Apache-2.0
#include "io/run_totals.hpp"

#include <algorithm>
#include <functional>
#include <utility>

namespace aussois {
namespace {

// The members and their names in a checkpoint, listed once for writing and for reading.
template <class Totals, class Numbers, class Counts>
void for_each_field(Totals& t, const Numbers& number, const Counts& count) {
  count("matched_by_key", t.matches.by_key);
  count("matched_by_adjacency", t.matches.by_adjacency);
  count("matched_by_geometry", t.matches.by_geometry);
  count("unmatched", t.matches.unmatched);
  count("inherited", t.matches.inherited);
  number("gain_stored", t.gain.stored);
  number("gain_above", t.gain.above);
  number("gain_largest", t.gain.largest);
  number("gain_kinetic", t.gain.kinetic);
  number("certify_distance", t.audit.min_distance);
  number("certify_slack", t.audit.min_slack);
  count("certify_steps", t.audit.steps);
  count("certify_violations", t.audit.violations);
  count("certify_nested", t.audit.nested);
  count("certify_uncovered", t.audit.uncovered);
  count("passing_pairs", t.uncertified.passing_pairs);
  count("driven_overlaps", t.uncertified.driven_overlaps);
  number("driven_overlap_t", t.uncertified.driven_t);
}

void add(const MatchCounts& counts, MatchTotals& out) {
  out.by_key += counts.by_key;
  out.by_adjacency += counts.by_adjacency;
  out.by_geometry += counts.by_geometry;
  out.unmatched += counts.unmatched;
  out.inherited += counts.inherited;
}

void add(const StepReport& report, UncertifiedPairs& out) {
  out.passing_pairs = std::max(out.passing_pairs, std::int64_t(report.passing_pairs));
  if (report.driven_overlaps.empty()) return;
  if (out.driven_overlaps++ == 0) out.driven_t = report.t - report.h;
}

void set_matches(const MatchTotals& m, Summary& summary) {
  summary.set("matched_by_key", m.by_key);
  summary.set("matched_by_adjacency", m.by_adjacency);
  summary.set("matched_by_geometry", m.by_geometry);
  summary.set("unmatched", m.unmatched);
  summary.set("inherited", m.inherited);
  const std::int64_t matched = m.by_key + m.by_adjacency + m.by_geometry, all = matched + m.unmatched;
  summary.set("match_share", all > 0 ? double(matched) / double(all) : 0.0);
}

}  // namespace

RunTotals run_totals(const Model& model, const State& start, int samples) {
  return {.gain = energy_gain(model, start), .audit = {.samples = samples}};
}

void add_frame(const Frame& frame, int threads, RunTotals& totals) {
  add(frame.report.matches, totals.matches);
  add(frame.report, totals.uncertified);
  add_step(frame.model, frame.state, frame.report, totals.gain);
  audit_path(frame.model, frame.before, frame.state, frame.report, threads, totals.audit);
}

std::vector<std::string> names_of_skipped(const Model& model) {
  std::vector<std::string> out;
  for (const auto& [a, b] : skipped_pairs(model))
    out.push_back(model.bodies[a].name + " and " + model.bodies[b].name);
  return out;
}

void set_totals(const RunTotals& totals, const Model& model, Summary& summary) {
  set_matches(totals.matches, summary);
  summary.set("energy_gain", totals.gain.largest);
  summary.set("passing_pairs", totals.uncertified.passing_pairs);
  summary.set("driven_overlaps", totals.uncertified.driven_overlaps);
  summary.set("driven_overlap_t", totals.uncertified.driven_t);
  if (totals.audit.samples > 0) set_audit(totals.audit, names_of_skipped(model), summary);
}

void set_audit(const PathAudit& audit, const std::vector<std::string>& skipped, Summary& summary) {
  if (audit.samples == 0) return;
  summary.set("certify_samples", std::int64_t(audit.samples));
  summary.set("certify_steps", audit.steps);
  summary.set("certify_violations", audit.violations);
  summary.set("certify_nested", audit.nested);
  summary.set("certify_uncovered", audit.uncovered);
  summary.set("certify_min_distance", audit.min_distance);
  summary.set("certify_skipped", skipped);
}

void keep_totals(const RunTotals& totals, Checkpoint& out) {
  for_each_field(
      totals, [&](const char* name, double value) { out.numbers[name] = value; },
      [&](const char* name, std::int64_t value) { out.counts[name] = value; });
}

RunTotals run_totals_of(const Checkpoint& checkpoint, int samples) {
  RunTotals out{.audit = {.samples = samples}};
  for_each_field(
      out, [&](const char* name, double& value) { value = checkpoint_number(checkpoint, name); },
      [&](const char* name, std::int64_t& value) { value = checkpoint_count(checkpoint, name); });
  return out;
}

}  // namespace aussois
