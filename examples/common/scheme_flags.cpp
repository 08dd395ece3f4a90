// SPDX-License-Identifier: Apache-2.0
#include "examples/common/scheme_flags.hpp"

#include "io/network_file.hpp"

namespace aussois {

void add_options(Cli& cli, SchemeFlags& f) {
  cli.choice("--scheme", f.scheme, "by its name", scheme_names());
  cli.option("--theta", f.options.theta, "of moreau_jean and moreau_jean_projected", "-", {0.5, 1});
  cli.choice("--normal-law", f.normal, "of schemes that leave the choice",
             {"moreau", "combined", "gap_over_step"});
  cli.option("--gamma", f.options.normal.gamma, "mean velocity in the law, of moreau_jean", "-", {0.5, 1});
  cli.choice("--contacts", f.contacts, "where moreau_jean looks at them", {"start", "midpoint", "end"});
  cli.option("--newton-iterations", f.options.newton.max_iterations,
             "of moreau_jean; 1 is linearly implicit, more is fully implicit", "", {1, 1000});
  cli.flag("--gap-hessians", f.options.newton.gap_hessians, "in the Newton matrix of moreau_jean");
  cli.choice("--impact-law", f.impact, "of moreau_jean", {"newton", "poisson"});
  cli.choice("--impact-order", f.impact_order, "of several impacts, of moreau_jean",
             {"simultaneous", "sequential"});
  cli.choice("--projection", f.projection, "of moreau_jean_projected", {"direct", "combined"});
  cli.choice("--update", f.update, "of rotations, of all schemes but event_driven",
             {"exponential", "cayley", "screw"});
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
  cli.flag("--mean-joints", f.options.mean_joints, "of passive_midpoint; exact, with --update cayley");
  cli.option("--spectral-radius", f.options.spectral_radius, "of generalised_alpha", "-", {0, 1});
}

SchemeOptions scheme_options(const SchemeFlags& f) {
  SchemeOptions out = f.options;
  out.contacts = contacts_at(f.contacts);
  out.impact.law = impact_law(f.impact);
  out.impact.order = impact_order(f.impact_order);
  out.projection = projection_order(f.projection);
  out.normal.law = normal_law(f.normal);
  out.update = group_update(f.update);
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
