// SPDX-License-Identifier: Apache-2.0
#include "examples/scenes/study.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "examples/common/convergence.hpp"
#include "examples/common/driver.hpp"
#include "geometry/check.hpp"

namespace aussois {
namespace {

constexpr double kRounding =
    1e-10;  // errors below tell of rounding and of the solver's tolerance, not of the step

std::vector<double> series(const Study& s, std::size_t measure) {
  std::vector<double> out;
  for (const Errors& e : s.errors) out.push_back(e[measure]);
  return out;
}

// Slope through the errors that are no rounding; infinity if fewer than three are left.
double order_above_rounding(const std::vector<double>& h, const std::vector<double>& error) {
  std::vector<double> steps, errors;
  for (std::size_t i = 0; i < h.size(); ++i)
    if (error[i] > kRounding) steps.push_back(h[i]), errors.push_back(error[i]);
  return errors.size() < 3 ? kInf : fitted_order(steps, errors);
}

}  // namespace

void validate(const StudyOptions& o) {
  require_field(std::isfinite(o.h) && o.h >= 0, "StudyOptions::h", o.h, "not be negative [s]");
  require_field(o.levels >= 3 && o.levels <= 16, "StudyOptions::levels", o.levels, "lie in [3, 16]");
  require_field(o.phases >= 1 && o.phases <= 64, "StudyOptions::phases", o.phases, "lie in [1, 64]");
  require_field(o.tolerance >= 0 && o.tolerance < 1, "StudyOptions::tolerance", o.tolerance, "lie in [0, 1)");
}

bool applies(const Case& c, const SchemeTraits& traits) {
  return (traits.restitution || !c.bounces) && !(traits.pairwise && c.at_once);
}

void require_applies(const Case& c, const std::string& scheme, const SchemeOptions& options) {
  const SchemeTraits traits = scheme_traits(scheme, options);
  const std::string who = label(scheme, options);
  require(traits.restitution || !c.bounces, c.name + " bounces, " + who + " has no restitution");
  require(applies(c, traits), c.name + " closes several contacts at once, " + who + " strikes them in turn");
}

Errors expected_orders(const Case& c, const SchemeTraits& traits, const std::vector<double>& h) {
  double order = c.smooth ? traits.smooth : traits.nonsmooth;
  if (c.hops_out) {  // the errors of log(T/h) impacts add up (CONV-8)
    std::vector<double> error;
    for (const double step : h) error.push_back(std::pow(step, order) * std::log(c.t_end / step));
    order = fitted_order(h, error);
  }
  Errors out;
  out.fill(order);
  out[v_l1] = std::min(order, 1.0);  // a step function, whatever the scheme (CONV-2)
  if (c.lands) out[v_graph] = std::min(order, traits.landing);
  return out;
}

bool as_expected(const Study& s) {
  for (std::size_t m = 0; m < s.order.size(); ++m)
    if (!(s.order[m] >= s.expected[m] - kOrderSlack)) return false;
  return true;
}

ComputedMotion run_case(const Case& c, const std::string& scheme_name, const SchemeOptions& options,
                        double phase) {
  CaseScene scene = c.scene();
  State state = scene.state;
  const Scheme scheme = make_scheme(scheme_name, scene.model, options);
  ComputedMotion out{.t = {0}, .node = {c.observe(scene, state)}};
  while (state.t < c.t_end * (1 - 1e-12)) {
    const double left = c.t_end - state.t;
    const StepReport report = scheme.step(state, state.t == 0 ? std::min(phase * options.h, left) : left);
    if (!report.ok())
      throw NumericalFailure(
          c.name + ", " + label(scheme_name, options) + ", t = " + std::to_string(state.t) +
          " s: " + (report.reason.empty() ? to_string(report.solve.status) : report.reason));
    out.t.push_back(state.t);
    out.node.push_back(c.observe(scene, state));
  }
  return out;
}

Study study(const Case& c, const std::string& scheme, SchemeOptions scheme_options, const StudyOptions& o,
            const std::function<bool(int level)>& level_done) {
  validate(o);
  const SchemeTraits traits = scheme_traits(scheme, scheme_options);
  require_applies(c, scheme, scheme_options);
  Study out{.case_name = c.name,
            .scheme = label(scheme, scheme_options),
            .options = o,
            .expected = expected_orders(c, traits, step_sizes(o.h > 0 ? o.h : c.h, o.levels))};
  scheme_options.solver.tolerance = o.tolerance > 0 ? o.tolerance : c.tolerance;
  scheme_options.advancement.certify = false;
  const ExactMotion exact = c.exact(c.t_end);
  for (const double h : step_sizes(o.h > 0 ? o.h : c.h, o.levels)) {
    scheme_options.h = h;
    Errors mean{};
    for (int k = 0; k < o.phases; ++k) {
      const ComputedMotion computed = run_case(c, scheme, scheme_options, (k + 0.5) / o.phases);
      const Errors errors = errors_of(computed, exact);
      for (std::size_t m = 0; m < mean.size(); ++m) mean[m] += errors[m] / o.phases;
      out.steps += long(computed.t.size()) - 1;
      for (std::size_t i = 2; i + 1 < computed.t.size(); ++i)
        out.cut += computed.t[i] - computed.t[i - 1] < h * (1 - 1e-6);
    }
    out.h.push_back(h);
    out.errors.push_back(mean);
    if (level_done && !level_done(int(out.h.size()))) return out;
  }
  for (std::size_t m = 0; m < out.order.size(); ++m)
    out.order[m] = order_above_rounding(out.h, series(out, m));
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
  return out.str();
}

}  // namespace aussois
