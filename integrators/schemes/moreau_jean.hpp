// SPDX-License-Identifier: Apache-2.0
// The Moreau-Jean theta scheme with conservative advancement: one step, in the order of
// doc/theory/moreau_jean.md. Sources: Moreau 1988, Jean 1999, Acary and Brogliato 2008, ch. 10; (MJ-1) to
// (MJ-12), (IMP-1) to (IMP-6), (CA-1) to (CA-8).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "integrators/step_options.hpp"
#include "integrators/step_report.hpp"

namespace aussois {

struct StepSetting;

/// Where a step evaluates normals, arms and gaps of its contacts: at the start, or at the middle or the end
/// of the path given by the velocities found so far (MJ-11).
enum class ContactsAt { start, midpoint, end };
inline constexpr Named<ContactsAt> kContactsAt[] = {
    {ContactsAt::start, "start"}, {ContactsAt::midpoint, "midpoint"}, {ContactsAt::end, "end"}};

/// The Newton loop of the fully implicit step (MJ-12). The default of one iteration makes the step linearly
/// implicit.
/// `describe` gives the ranges.
struct NewtonOptions {
  int max_iterations = 1;    // contacts at the midpoint or the end need one more solve, their predictor
  double tolerance = 1e-10;  // largest change of a velocity [m/s, rad/s]; if the loop misses it, or
                             // diverges (MJ-16), the step is halved
  // Adds gap Hessians to its matrix (MJ-14): curved contacts under a load take fewer iterations, but the
  // matrix then couples bodies that touch, which costs time in large stacks. No effect at max_iterations = 1
  // or with contacts at the start.
  bool gap_hessians = false;
};
void describe(SettingVisitor& visit, NewtonOptions& options);

/// `describe` gives the ranges.
struct MoreauJeanOptions {
  double theta = 0.5;  // of the smooth forces and of the position update [-]
  NormalLaw law = NormalLaw::combined;
  // The laws of contacts and stops apply to gamma u+ + (1 - gamma) u- [-]; this implies a
  // restitution of (1 - gamma) / gamma (MJ-10); with gap_over_step it replaces that of the contact law
  double gamma = 1;
  ContactsAt contacts = ContactsAt::start;
  NewtonOptions newton{};
  ImpactOptions impact{};  // values other than the defaults exclude NormalLaw::gap_over_step
};
void validate(const MoreauJeanOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, MoreauJeanOptions& options);

class MoreauJean {
 public:
  /// Throws std::invalid_argument for a bad option or model, or if two bodies that can touch have no dilation
  /// at all.
  explicit MoreauJean(const Model& model, const StepOptions& step = {}, const MoreauJeanOptions& own = {});
  explicit MoreauJean(Model&&, const StepOptions& = {},
                      const MoreauJeanOptions& = {}) = delete;  // the model must outlive the scheme

  /// Advances by at most min(StepOptions::h, h_limit); less if the advancement needs it. The state is
  /// unchanged unless the report says moved(). Throws for arguments that do not fit (check_fits), not for
  /// numerical trouble.
  [[nodiscard]] StepReport step(State& state, double h_limit = kInf) const;

  /// Contacts of all pairs of bodies at the state with gap <= threshold [m], as a step would find them.
  ContactSet contacts(const State& state, double threshold) const;

  /// Options of a step that the scheme does not read; they are refused if they are set.
  static std::vector<std::string> unread() { return {}; }

 private:
  std::shared_ptr<const StepSetting> setting_;
  MoreauJeanOptions own_;
};

}  // namespace aussois
