// SPDX-License-Identifier: Apache-2.0
#include "examples/common/run_watch.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "examples/common/kept_json.hpp"
#include "geometry/check.hpp"
#include "geometry/number_text.hpp"
#include "io/recording.hpp"
#include "io/run_totals.hpp"

namespace aussois {

using Json = nlohmann::ordered_json;

namespace {

std::string nearest_of(const PathAudit& audit) {
  if (!(audit.min_distance < kInf)) return "no two bodies came within twice their dilations";
  char text[100];
  std::snprintf(text, sizeof text, "base distance at least %.4g um, %.4g um above the certificate",
                1e6 * audit.min_distance, 1e6 * audit.min_slack);
  return text;
}

void add(const std::vector<std::string>& names, std::vector<std::string>& all) {
  for (const std::string& name : names)
    if (std::ranges::find(all, name) == all.end()) all.push_back(name);
}

}  // namespace

void add_certify(Cli& cli, int& samples, const std::string& runs) {
  cli.option("--certify", samples,
             "audit every step" + (runs.empty() ? "" : " of all " + runs) +
                 " at this many places along its path; 0: no audit",
             "", setting_of<RecordingOptions>("audit_samples").range);
}

void add_profile(Cli& cli, bool& profile, const std::string& runs) {
  cli.flag("--profile", profile,
           "print and record how long each stage of a step" + (runs.empty() ? "" : " of all " + runs) +
               " takes: median, 99th percentile, largest, mean" +
               (runs.empty() ? "" : "; CPU times are those of the process, so use --threads 1"));
}

void add_options(Cli& cli, WatchFlags& flags, const std::string& runs) {
  cli.group("run");
  add_certify(cli, flags.certify, runs);
  add_profile(cli, flags.profile, runs);
  add_options(cli, flags.dump);
}

void check(const Cli& cli, const DumpOptions& dump, const std::string& scheme) {
  if (dump.folder.empty()) refuse_given(cli, {"--dump-steps"}, "--dump-problem");
  step_choice(dump.steps);
  const std::vector<std::string> unread = unread_by(scheme);
  require(dump.folder.empty() || std::ranges::find(unread, "step.keep_problem") == unread.end(),
          "--dump-problem: " + scheme + " solves no one-step problem");
}

void add(const RunAudit& one, RunAudit& all) {
  const PathAudit& from = one.path;
  PathAudit& to = all.path;
  to.samples = std::max(to.samples, from.samples);
  to.min_distance = std::min(to.min_distance, from.min_distance);
  to.min_slack = std::min(to.min_slack, from.min_slack);
  to.steps += from.steps;
  to.violations += from.violations;
  to.nested += from.nested;
  to.uncovered += from.uncovered;
  add(one.skipped, all.skipped);
}

bool print_findings(const RunAudit& found) {
  const PathAudit& audit = found.path;
  if (audit.samples == 0) return true;
  if (audit.steps == 0)
    std::printf("certify: nothing to check, no two bodies can touch\n");
  else
    std::printf("certify: %s, each at %s and at its end, %s, %s\n", counted_noun(audit.steps, "step").c_str(),
                counted_noun(audit.samples, "place").c_str(), nearest_of(audit).c_str(),
                counted_noun(audit.violations, "violation").c_str());
  if (audit.nested > 0)
    std::printf("certify: one body was inside another in %s\n", counted_noun(audit.nested, "step").c_str());
  if (audit.uncovered > 0)
    std::printf("certify: contacts and base distances disagree at the start or the end of %s\n",
                counted_noun(audit.uncovered, "step").c_str());
  const std::vector<std::string>& skipped = found.skipped;
  if (!skipped.empty())
    std::printf("certify: not checked, because they may pass through each other: %s%s\n",
                skipped.front().c_str(),
                skipped.size() > 1 ? (", and " + std::to_string(skipped.size() - 1) + " more").c_str() : "");
  return audit.violations == 0;
}

void set_audit(const RunAudit& audit, Summary& summary) {
  set_audit(audit.path, audit.skipped, summary);
}

Json json_of(const RunAudit& audit) {
  const PathAudit& path = audit.path;
  return {{"samples", path.samples},
          {"steps", path.steps},
          {"violations", path.violations},
          {"nested", path.nested},
          {"uncovered", path.uncovered},
          {"min_distance_m", number_json(path.min_distance)},
          {"min_slack_m", number_json(path.min_slack)},
          {"skipped", Json(audit.skipped)}};
}

RunAudit audit_in(const Json& json) {
  return {.path = {.samples = json.at("samples"),
                   .min_distance = number_in(json.at("min_distance_m")),
                   .min_slack = number_in(json.at("min_slack_m")),
                   .steps = json.at("steps"),
                   .violations = json.at("violations"),
                   .nested = json.at("nested"),
                   .uncovered = json.at("uncovered")},
          .skipped = json.at("skipped")};
}

void print_profile(const WatchFlags& flags) {
  const StepProfile all = flags.times->all();
  if (all.steps() > 0)
    std::printf("%s taken\n%s", counted_noun(std::int64_t(all.steps()), "step").c_str(),
                table_of(all).c_str());
}

void set_profile(const WatchFlags& flags, Summary& summary) {
  set_profile(flags.times->all(), summary);
}

RunWatch::RunWatch(const WatchFlags& flags, const std::string& name, int threads)
    : dump_(flags.dump, name), threads_(threads), audit_{.path = {.samples = flags.certify}} {
  if (flags.profile) times_ = flags.times;
}

void RunWatch::set_options(StepOptions& options) const {
  options.keep_problem = dump_.wants_problems();
  options.profile = times_ != nullptr;
}

Scheme RunWatch::watched(const Model& model, Scheme scheme) {
  if (audit_.path.samples == 0 && !dump_.wants_problems() && !times_) return scheme;
  if (audit_.path.samples > 0) add(names_of_skipped(model), audit_.skipped);
  const std::string name = scheme.name;
  return {.name = name, .step = [this, &model, inner = std::move(scheme)](State& state, double h_limit) {
            const State before = state;
            StepReport report = inner.step(state, h_limit);
            if (times_) times_->add(report);
            steps_ += report.moved();
            if (report.moved()) audit_path(model, before, state, report, threads_, audit_.path);
            dump_.step(steps_ + !report.moved(), report);
            return report;
          }};
}

}  // namespace aussois
