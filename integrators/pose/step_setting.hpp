// SPDX-License-Identifier: Apache-2.0
// The setting that all schemes share: the options of a step, and a model made ready for it.
#pragma once

#include "integrators/pose/contact_problem.hpp"
#include "integrators/pose/step_pairs.hpp"

namespace aussois {

/// The sizes of a model, which schemes copy.
struct ModelSize {
  std::size_t bodies = 0, shapes = 0, joints = 0, couplings = 0, coordinates = 0, gaps = 0;
};

/// The shape of a body as it was when the setting was made, kept alive.
struct BodyShape {
  ShapeId id{};
  std::shared_ptr<const LmdShape> shape{};  // null: none
  SE3 g_bs{};
};

/// The model must outlive it, and must not change.
struct StepSetting {
  const Model& model;
  ModelSize size{};
  StepOptions options{};  // AdvancementOptions::min_h resolved
  NormalRule normal{};
  Layout dofs{};
  PerBody<BodyBounds> bounds{};
  Table<ShapeId, Pieces> pieces{};  // of every shape
  PerBody<BodyShape> body_shapes{};
  std::vector<const LmdShape*> shapes{};  // those of the bodies, for MatchInput; null: none
  std::vector<ContactLaw> laws{};         // contact_laws(model)
  std::shared_ptr<ContactScratch> scratch = std::make_shared<ContactScratch>();
  std::shared_ptr<MassScratch> mass_scratch = std::make_shared<MassScratch>();
};

/// Throws std::invalid_argument for a bad option or model, or if two bodies that can touch have no dilation
/// at all.
StepSetting step_setting(const Model& model, const StepOptions& options, NormalLaw law = NormalLaw::combined,
                         double gamma = 1);

/// Throws std::invalid_argument naming the option of a step that is not the default, and that the rows of
/// this law do not read (MJ-6).
void refuse_unread_by(NormalLaw law, const StepOptions& options);

/// For laws under which everything is plastic: throws std::invalid_argument naming the first contact law or
/// stop of a joint that has a restitution.
void refuse_restitution(const Model& model);

/// For code that follows the contacts of a rigid body: throws std::invalid_argument naming the first
/// body that deforms.
void refuse_deforming(const Model& model, const char* who);
/// For code that has rows on the twists of bodies: the same for the first body that is carried.
void refuse_carrying(const Model& model, const char* who);

/// Checks the input of every step, in release builds too. Throws std::invalid_argument if the model has grown
/// or shrunk since the scheme was made or bodies have other shapes, if the state does not fit it, has an
/// orientation that is not of unit length or remembers features that the shapes do not have, or if `h_limit`
/// [s] is not positive. Numbers that are not finite are left to the status.
void check_fits(const StepSetting& setting, const State& state, double h_limit = kInf);

/// Names the joint or coupling that is off by more than JointOptions::tolerance before the first step, and by
/// how much, whether or not steps project. Empty if none is.
std::string joint_that_is_off(const StepSetting& setting, const State& state);

/// Contacts of all pairs of bodies at the state with gap <= threshold [m], as a step would find them.
ContactSet contacts_within(const StepSetting& setting, const State& state, double threshold);

}  // namespace aussois
