// SPDX-License-Identifier: Apache-2.0
#include "examples/common/scheme_flags.hpp"

#include <algorithm>
#include <stdexcept>

#include "io/network_file.hpp"

namespace aussois {
namespace {

// Settings that some schemes read; the others are read by all.
struct Reader {
  const char* flag = nullptr;
  std::vector<std::string> schemes{};
};
const std::vector<Reader>& readers() {
  static const std::vector<Reader> all = {
      {"--theta", {"moreau_jean", "moreau_jean_projected"}},
      {"--normal-law", {"moreau_jean", "passive_midpoint"}},
      {"--gamma", {"moreau_jean"}},
      {"--contacts", {"moreau_jean"}},
      {"--newton-iterations", {"moreau_jean"}},
      {"--gap-hessians", {"moreau_jean"}},
      {"--impact-law", {"moreau_jean"}},
      {"--impact-order", {"moreau_jean"}},
      {"--projection", {"moreau_jean_projected"}},
      {"--update",
       {"moreau_jean", "moreau_jean_projected", "passive_midpoint", "generalised_alpha", "d1_minus_linear"}},
      {"--gyroscopic", {"passive_midpoint"}},
      {"--mean-joints", {"passive_midpoint"}},
      {"--not-passive", {"passive_midpoint"}},
      {"--force-theta", {"schatzman_paoli"}},
      {"--ode-relative", {"event_driven"}},
      {"--ode-absolute", {"event_driven"}},
      {"--spectral-radius", {"generalised_alpha"}},
      {"--min-h",
       {"moreau_jean", "moreau_jean_projected", "schatzman_paoli", "passive_midpoint", "generalised_alpha",
        "d1_minus_linear"}},
  };
  return all;
}

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

// "of moreau_jean, passive_midpoint"
std::string of(const std::string& flag) {
  return "of " + listed(std::ranges::find(readers(), flag, &Reader::flag)->schemes);
}

}  // namespace

void add_options(Cli& cli, SchemeFlags& f) {
  cli.group("scheme");
  cli.choice("--scheme", f.scheme, "by its name", f.schemes, f.not_offered);
  cli.option("--theta", f.options.theta, "where in the step forces act, " + of("--theta"), "-", {0.5, 1});
  cli.choice("--normal-law", f.normal, of("--normal-law") + "; the others have their own",
             {"moreau", "combined", "gap_over_step"});
  cli.option("--gamma", f.options.normal.gamma, "mean velocity in the law, " + of("--gamma"), "-", {0.5, 1});
  cli.choice("--contacts", f.contacts, "where they are looked at, " + of("--contacts"),
             {"start", "midpoint", "end"});
  cli.option("--newton-iterations", f.options.newton.max_iterations,
             of("--newton-iterations") + "; 1 is linearly implicit, more is fully implicit", "", {1, 1000});
  cli.flag("--gap-hessians", f.options.newton.gap_hessians, "in the Newton matrix, " + of("--gap-hessians"));
  cli.choice("--impact-law", f.impact, of("--impact-law"), {"newton", "poisson"});
  cli.choice("--impact-order", f.impact_order, "of several impacts, " + of("--impact-order"),
             {"simultaneous", "sequential"});
  cli.choice("--projection", f.projection, of("--projection"), {"direct", "combined"});
  cli.choice("--update", f.update, "of rotations, " + of("--update"), {"exponential", "cayley", "screw"});
  cli.choice("--gyroscopic", f.gyroscopic, "torque of the mean or the first attitude, " + of("--gyroscopic"),
             {"midpoint", "start"});
  cli.flag("--mean-joints", f.options.mean_joints, of("--mean-joints") + "; exact, with --update cayley");
  cli.flag("--not-passive", f.not_passive, of("--not-passive") + "; its contacts may give energy");
  cli.option("--force-theta", f.options.force_theta,
             "where in the step force laws act, " + of("--force-theta"), "-", {0, 1});
  if (std::ranges::find(f.schemes, "event_driven") != f.schemes.end()) {
    cli.option("--ode-relative", f.options.ode.relative, "tolerance, " + of("--ode-relative"), "-",
               {1e-14, 1e-2});
    cli.option("--ode-absolute", f.options.ode.absolute, "tolerance, " + of("--ode-absolute"), "m, m/s, rad",
               {1e-16, 1e-2});
  }
  cli.option("--spectral-radius", f.options.spectral_radius, of("--spectral-radius"), "-", {0, 1});
  cli.option(
      "--min-h", f.min_h,
      "a step that needs less is refused, " + of("--min-h") + "; 0: 1e-7, less for short steps of run_scene",
      "s", {0, 1});
  std::vector<std::string> reducers = reducer_names();
  std::erase(reducers, to_string(Reducer::selector));
  cli.choice("--reducer", f.reducer, "which contacts of a patch the solver begins with", reducers);
  cli.input("--selector", f.selector,
            "instead: a learned selector, as peg_plate train writes them (mlc_*.txt of the surface)");
  cli.option("--selector-body", f.selector_body, "number of the body that it was taught, from 0", "",
             {0, 1e6});
  cli.choice("--clustering", f.clustering, "how a patch is told from others", clustering_names());
  cli.option("--clusters", f.options.reduction.clustering.k, "of a body pair, of clusterings by k-means", "",
             {1, 1000});
  cli.option("--min-margin", f.options.reduction.min_margin, "of every patch's support", "-", {0, 1});
  cli.flag("--patch-friction", f.patch_friction,
           "friction at the centre of a patch, with its drilling torque");
}

void refuse_unread(const Cli& cli, const SchemeFlags& f) {
  for (const std::string& flag : cli.given("scheme")) {
    const auto reader = std::ranges::find(readers(), flag, &Reader::flag);
    if (reader != readers().end() && std::ranges::find(reader->schemes, f.scheme) == reader->schemes.end())
      throw std::invalid_argument(flag + " is not read by " + f.scheme + ", but by " +
                                  listed(reader->schemes));
  }
}

SchemeOptions scheme_options(const SchemeFlags& f) {
  SchemeOptions out = f.options;
  if (f.min_h > 0) out.advancement.min_h = f.min_h;
  out.contacts = contacts_at(f.contacts);
  out.impact.law = impact_law(f.impact);
  out.impact.order = impact_order(f.impact_order);
  out.projection = projection_order(f.projection);
  out.normal.law = normal_law(f.normal);
  out.update = group_update(f.update);
  out.gyroscopic = f.gyroscopic == "start" ? GyroscopicTerm::start : GyroscopicTerm::midpoint;
  out.passive = !f.not_passive;
  out.reduction.reducer = reducer(f.reducer);
  if (!f.selector.empty()) {
    out.reduction.reducer = Reducer::selector;
    out.reduction.selector = contact_selector(read_selector(f.selector), f.selector_body);
  }
  out.reduction.clustering.rule = clustering(f.clustering);
  out.reduction.friction = f.patch_friction ? FrictionAt::patches : FrictionAt::contacts;
  return out;
}

}  // namespace aussois
