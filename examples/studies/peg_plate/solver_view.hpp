// SPDX-License-Identifier: Apache-2.0
// What the solver knows: the nominal cylinder, the flat plate, one step, and from it the force of the plate
// at any given contacts (PEG-7). "Force of X" in [Kim2019]: one solve from what was measured, not a roll-out.
#pragma once

#include <span>

#include "examples/studies/peg_plate/peg.hpp"
#include "nsgs/regularised.hpp"

namespace aussois {

/// `describe` gives the ranges.
struct SolverView {
  double rho = 1e-3;   // regularisation (REG-4)
  double mu = 0.15;    // friction [-]
  double e = 0.01;     // restitution [-]
  double step = 1e-3;  // [s]
  FrictionReading reading = RegularisedOptions{}.reading;
};
void describe(SettingVisitor& visit, SolverView& view);

struct PegContact {
  Vec3 arm = Vec3::Zero();      // from the peg's centre of mass, world [m]
  Vec3 normal = Vec3::UnitZ();  // towards the peg, world
};

/// Of the plate on the peg, world [N]; zero without contacts.
Vec3 plate_force(const SolverView& view, const PegSample& sample, std::span<const PegContact> contacts);
/// The same contact by contact.
std::vector<Vec3> contact_forces(const SolverView& view, const PegSample& sample,
                                 std::span<const PegContact> contacts);

/// What the outputs of a network stand for: 17 places of the nominal bottom face, normals up; or the lowest
/// point of its rim with 49 normals, tan of both angles to the vertical in {-45, -30, .., 45} degrees
/// (PEG-8).
std::vector<PegContact> peg_contacts(PegScenario scenario, const PegSample& sample);
inline constexpr int kUprightNormal = 24;  // of the 49
std::vector<PegContact> picked(const std::vector<PegContact>& all, const std::vector<int>& which);
/// The 17 places in the body's frame: the centre, eight at half the radius, eight at the radius [m].
std::vector<Vec3> face_places();

/// The choices to learn from, each a set of outputs: all 640 triples of places that are no line, or one
/// normal.
std::vector<std::vector<int>> peg_choices(PegScenario scenario);

}  // namespace aussois
