// SPDX-License-Identifier: Apache-2.0
// Turns models, states and step reports of the kernel into the header and the rows of run.h5.
#pragma once

#include <string>

#include "integrators/step_report.hpp"
#include "io/run_file.hpp"
#include "mechanics/state.hpp"
#include "mechanics/virtual_coupling.hpp"

namespace aussois {

/// Bodies and shapes of the model; shapes that bodies share become one mesh. Body names must be unique and
/// without '/': meshes are named after the first body that carries them. Title, command line, build and notes
/// are left to the driver.
RunHeader run_header(const Model& model);

/// The row of a state without a step: the first row of a run.
RunStep run_step(std::int64_t step, const Model& model, const State& state,
                 const CouplingWrench& coupling = {});

/// The row of a step that led to `state`; `coupling` is the pull at its end.
RunStep run_step(std::int64_t step, const Model& model, const State& state, const StepReport& report,
                 const CouplingWrench& coupling = {});

/// A contact without a solve: for runs that only find contacts.
RunContact run_contact(const ContactPoint& contact, const Vec3& impulse = Vec3::Zero());

}  // namespace aussois
