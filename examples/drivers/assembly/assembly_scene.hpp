// SPDX-License-Identifier: Apache-2.0
// From an assembly's input to a model: dilations that fit the clearance, a path in time, bodies and the
// coupling.
#pragma once

#include <functional>

#include "examples/drivers/assembly/assembly_input.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "mechanics/cable.hpp"
#include "mechanics/virtual_coupling.hpp"

namespace aussois {

/// Of the part's radius, beside the misalignment: a part that ends farther from the end of its path is stuck.
inline constexpr double kArrival = 0.1;

/// Zero means: derived from the parts and their path; what was chosen stands in AssemblyScene. The table has
/// the ranges.
struct AssemblyOptions {
  double dilation = 0;     // of each part [m]; 0: three tenths of the smallest clearance along the path
  double mu = 0.2;         // friction [-]
  double restitution = 0;  // [-]
  double density = 7850;   // steel [kg/m^3]
  double mass = 0;         // of the moving part [kg]; 0: from density and volume
  double speed = 0.05;     // of the farthest point of the moving part along the path [m/s]
  double stride = 4;       // largest motion per step, in sums of the dilations [-]
  double h = 0;            // largest step [s]; 0: from stride and speed
  // Of the part on its coupling alone [Hz]; 0: 20, or more if its weight would pull it more than half of what
  // counts as arrived off its path (VC-7)
  double frequency = 0;
  double damping_ratio = VirtualCouplingOptions{}.damping_ratio;  // of the coupling [-]
  double force_limit = VirtualCouplingOptions{}.force_limit;      // [N]
  double torque_limit = VirtualCouplingOptions{}.torque_limit;    // [N m]
  double hold = 0.1;  // time at the end of the path, for the part to arrive [s]
  // In the frame of the fixed part [m/s^2]: oblique, so that the part leans on it
  Vec3 gravity = {-5.66, -5.66, -5.66};
  // The coupling pulls towards the path displaced along (1, 1, 1), in clearances [-]
  double misalignment = 1;
  bool clearance_at_start = false;  // of the first pose alone; the others may have the parts in contact
  int levels = 0;                   // of the shapes, LmdShapeOptions::levels
  std::filesystem::path cache{};    // folder of prepared shapes, see prepare_cached; empty: none
};
void describe(SettingVisitor& visit, AssemblyOptions& options);  // its numbers

struct AssemblyScene {
  Model model{};
  BodyId fixed = 0, moving = 1;
  Trajectory path{};         // recorded, of the moving body's frame (its centre of mass)
  Trajectory target{};       // what the coupling pulls towards: the path, misaligned
  std::vector<SE3> poses{};  // the recorded poses, of that frame
  VirtualCouplingOptions coupling{};
  double frequency = 0;     // of the part on its coupling [Hz]
  double sag = 0;           // how far its weight pulls it off its path where it hangs free (VC-7) [m]
  double radius = 0;        // of the moving part about its centre of mass [m]
  double clearance = 0;     // smallest distance of the base complexes at the recorded poses [m]
  double misalignment = 0;  // of the coupling's target [m]
  double dilation = 0;      // of each part [m]
  double h = 0;             // largest step [s]
  std::string mass_source{};
  std::vector<Cable> cables{};                  // between the parts
  std::vector<std::pair<BodyId, SE3>> clips{};  // of cables, on the moving part: where they are at the start
  std::vector<std::string> cache{};             // a line per shape on what the cache did; empty without one
  std::vector<std::string> warnings{};          // what a user should know
};

/// `progress(i, n)` is called while the clearance is measured. Throws std::runtime_error if recorded poses
/// have the parts in contact or one inside the other (naming line and place of the first, and how many more),
/// std::invalid_argument if the dilations do not fit the clearance, or for an option out of range.
AssemblyScene make_assembly_scene(const AssemblyInput& input, const AssemblyOptions& options, int threads,
                                  const std::function<void(int, int)>& progress = {});

/// The moving body at the start of its path, cables as they are laid, at rest.
State start_of(const AssemblyScene& scene);

}  // namespace aussois
