// SPDX-License-Identifier: Apache-2.0
// What all schemes share: the options of a step, and a model made ready for it.
#pragma once

#include "integrators/pose/free_motion.hpp"
#include "integrators/pose/step_pairs.hpp"

namespace aussois {

/// How much of everything a model has: what schemes copy sizes of.
struct ModelSize {
  std::size_t bodies = 0, shapes = 0, joints = 0, couplings = 0, coordinates = 0, gaps = 0;
};

/// The model must outlive it, and stay as it is.
struct StepSetting {
  const Model& model;
  ModelSize size{};
  StepOptions options{};
  Layout dofs{};
  std::vector<BodyBounds> bounds{};
  std::vector<Pieces> pieces{};           // of every shape
  std::vector<const LmdShape*> shapes{};  // of every body; null: none
  std::vector<ContactLaw> laws{};         // contact_laws(model)
  std::shared_ptr<ContactScratch> scratch = std::make_shared<ContactScratch>();
  std::shared_ptr<MassScratch> mass_scratch = std::make_shared<MassScratch>();
};

/// Throws std::invalid_argument for a bad option or model, or if two bodies that can touch have no dilation
/// at all.
StepSetting step_setting(const Model& model, const StepOptions& options);

/// For what asks where a rigid body's contacts are going: throws std::invalid_argument naming the first body
/// that deforms.
void refuse_deforming(const Model& model, const char* who);

/// The door of every step, in release builds too: throws std::invalid_argument if the model has grown or
/// shrunk since the scheme was made, or the state does not fit it, has an orientation that is none, or no
/// positive `h_limit` [s]. Numbers that are not finite are left to the status.
void check_fits(const StepSetting& setting, const State& state, double h_limit = kInf);

/// Which joint is off by more than JointOptions::tolerance before the first step, and by how much; empty:
/// none, or joints are not projected, and pulled together in their own time.
std::string joint_that_is_off(const StepSetting& setting, const State& state);

/// Contacts of all pairs of bodies at the state with gap <= threshold [m], as a step would find them.
ContactSet contacts_within(const StepSetting& setting, const State& state, double threshold);

/// Time since some moment [s], for the reports. The CPU time of the process costs a system call of 1 us, ten
/// times a step, and is counted in ticks of some ms on machines that limit it.
double step_clock();

}  // namespace aussois
