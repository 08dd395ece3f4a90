// SPDX-License-Identifier: Apache-2.0
#include "integrators/pose/find_ahead.hpp"

#include <algorithm>
#include <iterator>

#include "mechanics/surface.hpp"

namespace aussois {
namespace {

constexpr double kClosed = 1e-5;  // of the dilations: pairs that near touch already

// Both are sorted by bodies.
void mark_pairs(std::vector<StepPair>& pairs, const ContactSet& contacts) {
  auto pair = pairs.begin();
  for (const ContactPoint& c : contacts.points) {
    while (pair->a != c.a.body || pair->b != c.b.body) ++pair;
    pair->has_contacts = true;
  }
}

// Velocity of the bodies against each other at a contact, for velocities of all bodies.
Vec3 relative_velocity_at(const Model& model, const State& at, const ContactPoint& c, const VecX& v) {
  return point_velocity(model, at, c.a, c.x_a, v) - point_velocity(model, at, c.b, c.x_b, v);
}

// Pairs that are fast, neither pushed in the last step nor touch already, and are not known to meet are left
// out (CA-16).
void leave_apart(const StepSetting& setting, const State& state, const Estimate& estimate,
                 FoundContacts& found) {
  const AdvancementOptions& o = setting.options.advancement;
  std::vector<BodyPair> asked = estimate.meeting;
  for (const RememberedContact& c : state.memory.contacts)
    if (!c.impulse.isZero(0)) asked.push_back({c.key.body_a, c.key.body_b});
  const std::vector<double> dilation = contact_dilations(found.pairs, found.contacts);
  for (std::size_t i = 0; i < dilation.size(); ++i)
    if (const ContactPoint& c = found.contacts.points[i]; c.gap <= kClosed * dilation[i])
      asked.push_back({c.a.body, c.b.body});
  for (const ContactPoint& c : found.guards.points)  // cheaper than a proof that must fail
    if (gap_ahead(setting.model, state, c, estimate.v, found.h) < 0) asked.push_back({c.a.body, c.b.body});
  std::ranges::sort(asked);
  const auto is_apart = [&](const StepPair& pair) {
    const double linear = 2 * o.max_overlap * pair.dilation * pair.dilation;
    return pair.threshold * pair.threshold > linear && !std::ranges::binary_search(asked, bodies_of(pair));
  };
  std::ranges::copy_if(found.pairs, std::back_inserter(found.apart), is_apart);
  if (found.apart.empty()) return;
  std::erase_if(found.pairs, is_apart);
  for (ContactSet* contacts : {&found.contacts, &found.guards})
    std::erase_if(contacts->points, [&](const ContactPoint& c) {
      return std::ranges::binary_search(found.apart, BodyPair{c.a.body, c.b.body}, {}, bodies_of);
    });
}

// What a reducer may look at. Only a selector needs the bodies, whose forces cost as much as a free motion.
ReductionInput reduction_input(const StepSetting& setting, const State& state, const FoundContacts& found) {
  ReductionInput input{.contacts = found.contacts,
                       .kept_before = found.warm.remembered,
                       .impulse = found.warm.impulse,
                       .h = found.h,
                       .g = found.g};
  input.mu.reserve(found.contacts.points.size());
  for (const ContactPoint& c : found.contacts.points)
    input.mu.push_back(contact_law(setting.model, c.a.body, c.b.body).mu);
  if (setting.options.reduction.reducer != Reducer::selector) return input;
  const VecX wrench =
      all_velocities(setting.dofs, forces_at(setting.model, state, setting.dofs).sum(), 0 * state.v);
  for (const BodyId b : state.g.ids())
    input.bodies.push_back({pose(state, b), twist(state, b), body_part(wrench, b)});
  return input;
}

std::vector<std::array<Vec3, 2>> material_places(const Model& model, const State& at,
                                                 const ContactSet& contacts) {
  std::vector<std::array<Vec3, 2>> out;
  if (std::ranges::none_of(model.bodies, deforms)) return out;
  for (const ContactPoint& c : contacts.points)
    out.push_back({material_place(model, at, c.a, c.x_a), material_place(model, at, c.b, c.x_b)});
  return out;
}

// Every contact of a surface that deforms loads other points: none stands for others.
void keep_soft_contacts(const Model& model, FoundContacts& found) {
  if (std::ranges::none_of(model.bodies, deforms)) return;
  std::vector<int>& kept = found.selection.kept;
  for (int i = 0; i < std::ssize(found.contacts.points); ++i) {
    const ContactPoint& c = found.contacts.points[std::size_t(i)];
    if (deforms(model.bodies[c.a.body]) || deforms(model.bodies[c.b.body])) kept.push_back(i);
  }
  std::ranges::sort(kept);
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
}

// Which of the contacts there are the last step's (PER-2), which ones the problem begins with (RED-1), and
// what they start with (PER-7).
void match_and_reduce(const StepSetting& setting, const State& state, const State& at, FoundContacts& found) {
  const StepOptions& o = setting.options;
  found.g = at.g;
  found.places = material_places(setting.model, at, found.contacts);
  MatchInput since{.scale = found.scale, .g = found.g, .shapes = setting.shapes, .places = found.places};
  since.moved.reserve(found.contacts.points.size());
  for (const ContactPoint& c : found.contacts.points)
    since.moved.push_back(found.h * relative_velocity_at(setting.model, at, c, found.v_estimate).norm());
  found.warm = warm_start(state.memory, found.contacts, since, o.persistence);
  const ReductionInput input = reduction_input(setting, at, found);
  found.selection = reduce(input, o.reduction);
  keep_soft_contacts(setting.model, found);
  found.start = o.persistence.redistribute
                    ? redistribute(found.contacts, found.selection, found.warm.impulse, input.mu)
                    : found.warm.impulse;
}

}  // namespace

double gap_ahead(const Model& model, const State& at, const ContactPoint& c, const VecX& v, double h) {
  return c.gap + h * c.normal.dot(relative_velocity_at(model, at, c, v));
}

std::vector<double> contact_dilations(const std::vector<StepPair>& pairs, const ContactSet& contacts) {
  std::vector<double> out;
  out.reserve(contacts.points.size());
  auto pair = pairs.begin();
  for (const ContactPoint& c : contacts.points) {
    while (pair->a != c.a.body || pair->b != c.b.body) ++pair;
    out.push_back(pair->dilation);
  }
  return out;
}

FoundContacts find_ahead(const StepSetting& setting, const State& state, const Estimate& estimate, double h) {
  const StepOptions& o = setting.options;
  StageClock clock(Stage::broad_phase, o.profile);
  FoundContacts found{.v_estimate = estimate.v, .h = h, .scale = state.h > 0 ? h / state.h : 1};
  NearPairs near = step_pairs({setting.model, state, estimate.v, h}, setting.bounds, o.advancement, o.threads,
                              setting.scratch.get());  // (CA-4)
  found.pairs = std::move(near.pairs);
  found.reach = std::move(near.reach);
  found.passing = near.passing;
  if (!estimate.fine_to.empty())
    for (StepPair& pair : found.pairs)
      if (const auto gap = estimate.fine_to.find(bodies_of(pair)); gap != estimate.fine_to.end())
        pair.fine_to = gap->second;
  clock.enter(Stage::search);
  LevelContacts all = contacts_of(setting.model, state, found.pairs, o.lmd, {.levels = o.levels},
                                  *setting.scratch);  // (LMD-3)
  found.contacts = std::move(all.fine);
  found.guards = std::move(all.coarse);
  for (StepPair& pair : found.pairs) pair.has_contacts = false;
  mark_pairs(found.pairs, found.contacts);
  mark_pairs(found.pairs, found.guards);
  found.coarse_count = int(found.guards.points.size());
  found.count = int(found.contacts.points.size()) + found.coarse_count;
  found.min_gap = std::min(smallest_gap(found.contacts), smallest_gap(found.guards));
  if (o.advancement.certify) leave_apart(setting, state, estimate, found);  // (CA-16)
  clock.enter(Stage::reduction);
  match_and_reduce(setting, state, state, found);  // (RED-1), (PER-2)
  clock.add_to(found.times);
  return found;
}

FoundContacts found_at(const StepSetting& setting, const State& state, const FoundContacts& found,
                       const State& at) {
  const StepOptions& o = setting.options;
  StageClock clock(Stage::search, o.profile);
  FoundContacts out = found;
  const LevelUse use{.levels = o.levels, .fine_alone = true};
  out.contacts = contacts_of(setting.model, at, found.pairs, o.lmd, use, *setting.scratch).fine;
  clock.enter(Stage::reduction);
  match_and_reduce(setting, state, at, out);
  clock.add_to(out.times);
  return out;
}

}  // namespace aussois
