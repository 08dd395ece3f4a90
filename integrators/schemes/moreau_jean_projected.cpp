// SPDX-License-Identifier: Apache-2.0
#include "integrators/schemes/moreau_jean_projected.hpp"

#include <algorithm>

#include "geometry/settings.hpp"
#include "integrators/pose/projection.hpp"
#include "integrators/schemes/advance_step.hpp"
#include "integrators/schemes/shared_settings.hpp"

namespace aussois {
namespace {

// Adds to the velocity law the contacts that moved positions; false: all took part already (PRJ-5).
bool activate(const Projection& projection, FoundContacts& found, ContactBlocks& blocks) {
  bool any = false;
  for (std::size_t i = 0; i < blocks.rows.size(); ++i) {
    const std::size_t contacts = found.contacts.points.size();
    const bool wanted =
        i < contacts ? std::ranges::binary_search(projection.contacts, key_of(found.contacts.points[i]))
                     : std::ranges::binary_search(projection.gaps, int(i - contacts));
    if (!wanted || blocks.rows[i].active) continue;
    blocks.rows[i].active = any = true;
    std::vector<int>& kept = found.selection.kept;
    if (const auto at = std::ranges::lower_bound(kept, int(i));
        i < contacts && (at == kept.end() || *at != int(i)))
      kept.insert(at, int(i));
  }
  return any;
}

// Directions of the end do not hold for bodies that would have to move farther than contacts are searched for
// at rest (PRJ-6).
bool too_far(const Projection& projection, const FoundContacts& found, const AdvancementOptions& o) {
  double dilation = kInf;
  for (const StepPair& pair : found.pairs) dilation = std::min(dilation, pair.dilation);
  return o.certify && projection.moved > o.floor * dilation;
}

}  // namespace

void describe(SettingVisitor& visit, MoreauJeanProjectedOptions& o) {
  visit.begin("MoreauJeanProjectedOptions");
  visit.number(theta_setting(), o.theta);
  visit.choice({.name = "order",
                .what = "order in which velocities and positions are solved",
                .flag = "--projection",
                .label = "%",
                .in_every_label = true},
               o.order, kProjectionOrders);
}

void validate(const MoreauJeanProjectedOptions& options) {
  check_ranges(options);
}

MoreauJeanProjected::MoreauJeanProjected(const Model& model, const StepOptions& step,
                                         const MoreauJeanProjectedOptions& own)
    : setting_(std::make_shared<const StepSetting>(step_setting(model, step, NormalLaw::moreau))), own_(own) {
  validate(own);
  refuse_unread(step, unread(), "moreau_jean_projected");
}

StepReport MoreauJeanProjected::step(State& state, double h_limit) const {
  const StepSetting& setting = *setting_;
  const double theta = own_.theta;
  const auto free = [&](const State& start, double h) {
    return SharedMotion(new FreeMotion(free_motion(setting.model, start, setting.dofs, h, theta,
                                                   setting.mass_scratch.get())));  // (MJ-4), (MJ-5)
  };
  const auto estimate = [&](const State& start, double h) {
    return estimate_without_contacts(setting, start, *free(start, h), h, theta);
  };
  const auto attempt = [&](const State& start, const Estimate& ahead, double h) {
    FoundContacts found = find_ahead(setting, start, ahead, h);
    ContactBlocks blocks = contact_blocks(setting, start, found.contacts, h, setting.normal);
    SolveReport beside;
    for (;;) {  // each round activates at least one contact more
      ImpulseStep step = solve_step(setting, start, found, free(start, h), theta, blocks);
      blocks.times = {};
      step.beside = beside;
      const VecX& v = step.solved.solution.v;
      Move move{.v_path = theta * v + (1 - theta) * step.free->v, .v_end = v, .end = {}};  // (MJ-7)
      if (!v.allFinite()) return Trial{.found = found, .impulses = step, .move = move};
      const VecX v_path = path_velocity(setting.options.update, setting.model, start,
                                        all_velocities(setting.dofs, move.v_path, step.v_prescribed), h);
      State plain = state_after(setting.model, start, v_path, start.v, h);
      if (setting.options.joints.project) plain = projected_state(setting.model, plain).state;
      const Projection projection =
          without_overlap(setting, plain, found.pairs, *step.free, step.joints.equations.G, h);  // (PRJ-1)
      if (own_.order == ProjectionOrder::combined && activate(projection, found, blocks)) {
        add_counts(step.solved.solution.report, beside);
        add_counts(projection.solve, beside);
        continue;
      }
      add_part(projection.solve, step.beside);
      if (projection.moved > 0) move.end = projection.end;
      Trial trial{.move = std::move(move),
                  .figures = {.projection = projection.moved, .overlap_left = projection.overlap}};
      if (too_far(projection, found, setting.options.advancement))
        trial.afterwards = {
            Outcome::not_certified,
            "projection would move bodies beyond the distance within which contacts were searched"};
      trial.found = std::move(found);
      trial.impulses = std::move(step);
      return trial;
    }
  };
  return advance_step(setting, state, h_limit, {estimate, attempt});
}

}  // namespace aussois
