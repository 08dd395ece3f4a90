// SPDX-License-Identifier: Apache-2.0
#include "io/run_totals.hpp"

#include <algorithm>

namespace aussois {
namespace {

// The totals by name, listed once: visit(name, value, where). A summary tells some, a checkpoint keeps all.
enum class In { both, checkpoint };

template <class Audit, class Visit>
void for_each_of_audit(Audit& a, const Visit& visit) {
  visit("certify_steps", a.steps, In::both);
  visit("certify_violations", a.violations, In::both);
  visit("certify_nested", a.nested, In::both);
  visit("certify_uncovered", a.uncovered, In::both);
  visit("certify_min_distance", a.min_distance, In::both);
  visit("certify_min_slack", a.min_slack, In::checkpoint);
}

template <class Totals, class Visit>
void for_each_but_audit(Totals& t, const Visit& visit) {
  visit("matched_by_key", t.matches.by_key, In::both);
  visit("matched_by_adjacency", t.matches.by_adjacency, In::both);
  visit("matched_by_geometry", t.matches.by_geometry, In::both);
  visit("unmatched", t.matches.unmatched, In::both);
  visit("inherited", t.matches.inherited, In::both);
  visit("energy_gain", t.gain.largest, In::both);
  visit("energy_gain_stored", t.gain.stored, In::checkpoint);
  visit("energy_gain_above", t.gain.above, In::checkpoint);
  visit("energy_gain_kinetic", t.gain.kinetic, In::checkpoint);
  visit("passing_pairs", t.uncertified.passing_pairs, In::both);
  visit("driven_overlaps", t.uncertified.driven_overlaps, In::both);
  visit("driven_overlap_t", t.uncertified.driven_t, In::both);
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

// A visitor that sets what a summary tells.
auto into(Summary& summary) {
  return [&summary](const char* name, auto value, In where) {
    if (where != In::checkpoint) summary.set(name, value);
  };
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
  for_each_but_audit(totals, into(summary));
  const MatchTotals& m = totals.matches;
  const std::int64_t matched = m.by_key + m.by_adjacency + m.by_geometry, all = matched + m.unmatched;
  summary.set("match_share", all > 0 ? double(matched) / double(all) : 0.0);
  if (totals.audit.samples > 0) set_audit(totals.audit, names_of_skipped(model), summary);
}

void set_audit(const PathAudit& audit, const std::vector<std::string>& skipped, Summary& summary) {
  if (audit.samples == 0) return;
  summary.set("certify_samples", std::int64_t(audit.samples));
  for_each_of_audit(audit, into(summary));
  summary.set("certify_skipped", skipped);
}

void keep_totals(const RunTotals& totals, Checkpoint& out) {
  struct Keep {
    void operator()(const char* name, double value, In) const { out.numbers[name] = value; }
    void operator()(const char* name, std::int64_t value, In) const { out.counts[name] = value; }
    Checkpoint& out;
  };
  for_each_but_audit(totals, Keep{out});
  for_each_of_audit(totals.audit, Keep{out});
}

RunTotals run_totals_of(const Checkpoint& checkpoint, int samples) {
  struct Take {
    void operator()(const char* name, double& value, In) const { value = checkpoint_number(from, name); }
    void operator()(const char* name, std::int64_t& value, In) const { value = checkpoint_count(from, name); }
    const Checkpoint& from;
  };
  RunTotals out{.audit = {.samples = samples}};
  for_each_but_audit(out, Take{checkpoint});
  for_each_of_audit(out.audit, Take{checkpoint});
  return out;
}

}  // namespace aussois
