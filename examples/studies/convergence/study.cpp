// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/convergence/study.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>
#include <tuple>

#include "examples/common/convergence.hpp"
#include "examples/common/driver.hpp"
#include "geometry/named.hpp"
#include "geometry/settings.hpp"
#include "integrators/run.hpp"
#include "io/recording.hpp"

namespace aussois {
namespace {

constexpr std::size_t kFewest = 3;  // step sizes of a fit

// Errors below tell of rounding and of the solver's tolerance, not of the step.
double rounding(double tolerance) {
  return std::max(1e-10, 100 * tolerance);
}

std::vector<double> series(const Study& s, std::size_t measure) {
  std::vector<double> out;
  for (const Errors& e : s.errors) out.push_back(e[measure]);
  return out;
}

std::vector<double> whole_steps(const Study& s) {
  std::vector<double> out;
  for (std::size_t i = 0; i < s.h.size(); ++i)
    if (s.cut[i] == 0) out.push_back(s.h[i]);
  return out;
}

// Slope through the errors that are no rounding, of levels without a shortened step; infinity if fewer than
// three are left, nan if there were fewer.
double order_of(const Study& s, std::size_t measure, double rounding) {
  std::vector<double> steps, errors;
  for (std::size_t i = 0; i < s.h.size(); ++i)
    if (s.cut[i] == 0 && s.errors[i][measure] > rounding)
      steps.push_back(s.h[i]), errors.push_back(s.errors[i][measure]);
  if (whole_steps(s).size() < kFewest) return std::nan("");
  return errors.size() < kFewest ? kInf : fitted_order(steps, errors);
}

std::string reason(std::size_t measure, const Case& c, const SchemeTraits& traits) {
  const double order = c.smooth ? traits.smooth : traits.nonsmooth;
  if (measure == v_graph && c.lands && traits.landing < order)
    return "a landing ends up to a step above the plate, and the second fall lasts sqrt h (CONV-9)";
  if (measure == v_l1 && order > 1)
    return "a step function is off by O(h) where the velocity changes (CONV-2)";
  if (c.hops_out) return "log(T/h) impacts are seen, each timed to a step: h log(T/h) (CONV-8)";
  if (!c.smooth) return "impacts, slip and stick are timed to a step";
  return order > 1 ? "no contact changes its state, and the scheme is of order two between events"
                   : "no contact changes its state, and the scheme is of order one between events";
}

}  // namespace

void describe(SettingVisitor& visit, StudyOptions& o) {
  visit.begin("StudyOptions");
  visit.number(
      {"h", "largest step; 0: that of the case", "s", or_zero(setting_of<StepOptions>("h").range), "--h0"},
      o.h);
  visit.count({"levels", "number of step sizes, each about half the one before", "", {3, 16}, "--levels"},
              o.levels);
  visit.count({"phases",
               "number of lengths of the first step over which errors are averaged",
               "",
               {1, 64},
               "--phases"},
              o.phases);
  Setting tolerance = setting_of<SolverOptions>("tolerance");
  tolerance.what = "tolerance on the scaled residual; 0: that of the case";
  tolerance.range.open_below = false;
  visit.number(tolerance, o.tolerance);
  Setting certify = setting_of<RecordingOptions>("audit_samples");
  certify.name = "certify";
  visit.count(certify, o.certify);
}

void validate(const StudyOptions& options) {
  check_ranges(options);
}

bool applies(const Case& c, const SchemeTraits& traits) {
  return (traits.restitution || !c.bounces) && !(traits.pairwise && c.at_once);
}

void require_applies(const Case& c, const std::string& scheme, const SchemeOptions& options) {
  const SchemeTraits traits = scheme_traits(scheme, options);
  const std::string who = label(scheme, options);
  require(traits.restitution || !c.bounces, c.name + " bounces, but " + who + " has no restitution");
  require(applies(c, traits),
          c.name + " closes several contacts at once, but " + who + " resolves them in turn");
}

std::pair<Errors, Reasons> expected_orders(const Case& c, const SchemeTraits& traits,
                                           const std::vector<double>& h) {
  double order = c.smooth ? traits.smooth : traits.nonsmooth;
  if (c.hops_out) {  // the errors of log(T/h) impacts add up (CONV-8)
    std::vector<double> error;
    for (const double step : h) error.push_back(std::pow(step, order) * std::log(c.t_end / step));
    order = fitted_order(h, error);
  }
  Errors out;
  Reasons why;
  out.fill(order);
  out[v_l1] = std::min(order, 1.0);  // a step function, whatever the scheme (CONV-2)
  if (c.lands) out[v_graph] = std::min(order, traits.landing);
  for (std::size_t m = 0; m < why.size(); ++m) why[m] = reason(m, c, traits);
  return {out, why};
}

constexpr Named<OrderVerdict> kVerdicts[] = {
    {OrderVerdict::met, "met"},
    {OrderVerdict::less, "met, less than order one is promised"},
    {OrderVerdict::missed, "missed"},
    {OrderVerdict::not_judged, "not judged: steps were shortened at too many step sizes"}};

const char* to_string(OrderVerdict verdict) {
  return name_of(verdict, kVerdicts);
}

double shortened_error(const Study& s) {
  const auto whole = std::size_t(std::ranges::find(s.cut, 0) - s.cut.begin());
  double out = 0;
  for (std::size_t i = 0; i < s.h.size() && whole < s.h.size(); ++i)
    for (std::size_t m = 0; m < s.order.size(); ++m)
      if (s.cut[i] > 0 && std::isfinite(s.order[m]))
        out = std::max(out, s.errors[i][m] / (s.errors[whole][m] * std::pow(2 * s.h[i] / s.h[whole],
                                                                            std::max(1.0, s.expected[m]))));
  return out;
}

OrderVerdict order_verdict(const Study& s) {
  if (whole_steps(s).size() < kFewest) return OrderVerdict::not_judged;
  for (std::size_t m = 0; m < s.order.size(); ++m)
    if (!(s.order[m] >= s.expected[m] - kOrderSlack)) return OrderVerdict::missed;
  if (shortened_error(s) > 1) return OrderVerdict::missed;
  const double least = *std::ranges::min_element(s.expected);
  return least < 1 ? OrderVerdict::less : OrderVerdict::met;
}

bool as_expected(const Study& s) {
  const OrderVerdict v = order_verdict(s);
  return v != OrderVerdict::missed && v != OrderVerdict::not_judged;
}

ComputedMotion run_case(const Case& c, const std::string& scheme_name, const SchemeOptions& options,
                        double phase) {
  RunWatch nothing({}, {});
  return run_case(c, scheme_name, options, phase, nothing);
}

ComputedMotion run_case(const Case& c, const std::string& scheme_name, const SchemeOptions& options,
                        double phase, RunWatch& watch) {
  CaseScene scene = c.scene();
  State state = scene.state;
  const Scheme scheme = watch.watched(scene.model, make_scheme(scheme_name, scene.model, options));
  ComputedMotion out{.t = {0}, .node = {c.observe(scene, state)}};
  const Scheme from_a_phase{.name = scheme.name, .step = [&](State& s, double left) {
                              return scheme.step(s, s.t == 0 ? std::min(phase * options.step.h, left) : left);
                            }};
  const StepReport last = run_until(from_a_phase, state, c.t_end, [&](const StepReport& report) {
    if (!report.ok()) return;
    out.t.push_back(state.t);
    out.node.push_back(c.observe(scene, state));
  });
  if (!last.ok())
    throw NumericalFailure(c.name + ", " + label(scheme_name, options) + ", t = " + std::to_string(state.t) +
                           " s: " + (last.reason.empty() ? to_string(last.solve.status) : last.reason));
  return out;
}

Study study(const Case& c, const std::string& scheme, SchemeOptions scheme_options, const StudyOptions& o,
            const std::function<bool(int level)>& level_done, const StudyWatch& watches) {
  validate(o);
  refuse_unread(scheme_options, {"step.h", "step.solver.tolerance"}, "a study");
  const SchemeTraits traits = scheme_traits(scheme, scheme_options);
  require_applies(c, scheme, scheme_options);
  const std::vector<double> sizes = step_sizes(o.h > 0 ? o.h : c.h, o.levels + kMoreLevels);
  Study out{.case_name = c.name, .scheme = label(scheme, scheme_options), .options = o};
  scheme_options.step.solver.tolerance = o.tolerance > 0 ? o.tolerance : c.tolerance;
  const ExactMotion exact = c.exact(c.t_end);
  WatchFlags flags = watches.flags;
  flags.certify = o.certify;
  for (const double h : sizes) {
    if (int(whole_steps(out).size()) == o.levels) break;
    scheme_options.step.h = h;
    Errors mean{};
    long cut = 0;
    for (int k = 0; k < o.phases; ++k) {
      RunWatch watch(flags, watches.name + "_level_" + std::to_string(out.h.size() + 1) + "_phase_" +
                                std::to_string(k + 1));
      watch.set_options(scheme_options.step);
      const ComputedMotion computed = run_case(c, scheme, scheme_options, (k + 0.5) / o.phases, watch);
      add(watch.audit(), out.audit);
      const Errors errors = errors_of(computed, exact);
      for (std::size_t m = 0; m < mean.size(); ++m) mean[m] += errors[m] / o.phases;
      out.steps += long(computed.t.size()) - 1;
      for (std::size_t i = 2; i + 1 < computed.t.size(); ++i)
        cut += computed.t[i] - computed.t[i - 1] < h * (1 - 1e-6);
    }
    out.h.push_back(h);
    out.errors.push_back(mean);
    out.cut.push_back(cut);
    if (level_done && !level_done(int(out.h.size()))) return out;
  }
  const std::vector<double> whole = whole_steps(out);
  std::tie(out.expected, out.why) = expected_orders(c, traits, whole.size() < kFewest ? out.h : whole);
  const double floor = rounding(scheme_options.step.solver.tolerance);
  for (std::size_t m = 0; m < out.order.size(); ++m) out.order[m] = order_of(out, m, floor);
  return out;
}

std::string to_string(const Study& s) {
  std::ostringstream out;
  char cell[40];
  const auto put = [&](const char* format, auto value) {
    std::snprintf(cell, sizeof cell, format, value);
    out << cell;
  };
  put("%12s", "h [s]");
  for (const char* measure : kMeasures) put("%13s  order", measure);
  for (std::size_t i = 0; i < s.h.size(); ++i) {
    put("\n%12.5e", s.h[i]);
    for (std::size_t m = 0; m < kMeasures.size(); ++m) {
      put("%13.5e", s.errors[i][m]);
      i == 0 ? put("%7s", "-") : put("%7.2f", pairwise_order(s.h, series(s, m), i));
    }
  }
  for (const auto& [what, orders] : {std::pair{"fitted", s.order}, std::pair{"expected", s.expected}}) {
    put("\n%12s", what);
    for (const double order : orders) put("%20.3f", order);
  }
  out << "\n";
  for (std::size_t m = 0; m < kMeasures.size(); ++m) out << kMeasures[m] << ": " << s.why[m] << "\n";
  if (whole_steps(s).size() < s.h.size()) {
    out << "steps shortened, by step size:";
    for (const long cut : s.cut) out << ' ' << cut;
    out << " of " << s.steps << " in all; fitted where there are none\n";
  }
  out << to_string(order_verdict(s)) << "\n";
  return out.str();
}

}  // namespace aussois
