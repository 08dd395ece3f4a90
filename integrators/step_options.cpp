// SPDX-License-Identifier: Apache-2.0
#include "integrators/step_options.hpp"

#include "geometry/settings.hpp"
#include "lmd/shape_levels.hpp"

namespace aussois {

const char* to_string(NormalLaw law) {
  return name_of(law, kNormalLaws);
}

void describe(SettingVisitor& visit, ImpactOptions& o) {
  visit.begin("ImpactOptions");
  visit.choice({.name = "law", .what = "law of impacts", .flag = "--impact-law", .label = "%"}, o.law,
               kImpactLaws);
  visit.choice({.name = "order",
                .what = "order in which several impacts are resolved",
                .flag = "--impact-order",
                .label = "%"},
               o.order, kImpactOrders);
  visit.count({.name = "max_pairs",
               .what = "maximum number of one-contact impacts in a step",
               .unit = "",
               .range = range_from(1),
               .only_for = "order: sequential"},
              o.max_pairs);
}

void describe(SettingVisitor& visit, JointOptions& o) {
  visit.begin("JointOptions");
  visit.toggle({"project", "project joints after each step, so that they hold to rounding"}, o.project);
  visit.number({"stabilisation", "fraction of the joint drift that a step removes", "-", {0, 1}},
               o.stabilisation);
  visit.number(
      {"tolerance", "largest joint error at the start and after each projection", "m, rad", positive_range()},
      o.tolerance);
}

void describe(SettingVisitor& visit, AdvancementOptions& o) {
  visit.begin("AdvancementOptions");
  visit.toggle({"certify", "prove that base complexes stay apart"}, o.certify);
  visit.number({"enlargement", "enlargement factor of the estimated speeds", "-", {1, 4}}, o.enlargement);
  visit.number({"floor", "smallest search distance, relative to the sum of the dilations", "-",
                range_open_below(0, 1)},
               o.floor);
  visit.number({"max_overlap",
                "largest overlap of dilated shapes, relative to the sum of the dilations",
                "-",
                {0, 0.99}},
               o.max_overlap);
  visit.number({.name = "min_h",
                .what = "smallest step; shorter ones are refused; 0: the smaller of 1e-7 s and h / 10000",
                .unit = "s",
                .range = not_negative_range(),
                .flag = "--min-h"},
               o.min_h);
  visit.number({"growth", "largest growth factor of the step after an accepted one", "-", {1, 4}}, o.growth);
  visit.count({"max_attempts", "maximum number of attempts at a step", "", range_from(1)}, o.max_attempts);
}

void describe(SettingVisitor& visit, StepOptions& o) {
  visit.begin("StepOptions");
  visit.number({"h", "largest step", "s", positive_range()}, o.h);
  visit.number({"correction_speed", "largest speed at which overlaps are pushed apart", "m/s", range_from(0)},
               o.correction_speed);
  visit.number({"touching", "largest gap that counts as closed", "m, rad", not_negative_range()}, o.touching);
  visit.group("joints", o.joints);
  visit.group("lmd", o.lmd);
  visit.group("reduction", o.reduction);
  visit.group("persistence", o.persistence);
  visit.group("solver", o.solver);
  visit.group("advancement", o.advancement);
  visit.choice({.name = "update", .what = "update of rotations", .flag = "--update", .label = "%"}, o.update,
               kGroupUpdates);
  visit.count({.name = "levels",
               .what = "number of coarser surfaces that may replace a part where gaps are large compared "
                       "with their error",
               .unit = "",
               .range = {0, kMostLevels},
               .flag = "--detail-levels",
               .label = "levels %"},
              o.levels);
  visit.count({.name = "threads",
               .what = "number of threads of all parts of a step",
               .unit = "",
               .range = range_from(1),
               .changes_nothing = true},
              o.threads);
  visit.toggle(
      {.name = "keep_problem", .what = "keep the solved problem in the report", .changes_nothing = true},
      o.keep_problem);
  visit.toggle({.name = "profile", .what = "take the CPU time of each stage", .changes_nothing = true},
               o.profile);
}

void validate(const AdvancementOptions& options) {
  check_ranges(options);
}

void validate(const StepOptions& o) {
  check_ranges(o);
  require_field(o.advancement.min_h <= o.h, "AdvancementOptions::min_h", o.advancement.min_h,
                "not exceed h [s]");
  validate(o.lmd);
  validate(o.reduction);
  validate(o.persistence);
  require(
      !o.persistence.anchors || o.reduction.friction == FrictionAt::contacts,
      "PersistenceOptions::anchors cannot be combined with ReductionOptions::friction at patches: a patch "
      "has no point to pull back");
  validate(o.solver);
  const LmdOptions usual;
  require_field(o.lmd.threshold == usual.threshold, "StepOptions::lmd.threshold", o.lmd.threshold,
                "not be set: each step searches as far as its bodies may move [m]");
  require_field(o.lmd.threads == usual.threads || o.lmd.threads == o.threads, "StepOptions::lmd.threads",
                o.lmd.threads, "not be set: StepOptions::threads is that of every stage");
  require(!o.solver.for_all,
          "StepOptions::solver.for_all must be empty: StepOptions::threads is that of every stage");
}

}  // namespace aussois
