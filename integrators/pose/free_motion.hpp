// SPDX-License-Identifier: Apache-2.0
// Motion over one step of the theta scheme without contacts and joints, linearly implicit (MJ-4), (MJ-5).
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "mechanics/forces.hpp"
#include "mechanics/motion.hpp"
#include "nsgs/mass_inverse.hpp"

namespace aussois {

/// In rows of the dynamic bodies and of the coordinates: M^ (v+ - v) = gravity + gyroscopic + laws + H r,
/// where M^ contains all that depends on v+.
struct FreeMotion {
  SparseMatrix M{};  // M^ = mass + gyroscopic_D + law_D
  VecX f{};          // momentum: M^ v_free = f [N s, N m s]
  VecX v{};          // velocity at the start of the step
  VecX v_free{};     // velocity at its end without contact; not finite if M is singular
  // M^-1; null if M is singular, or if it was not formed
  std::shared_ptr<const MassInverse> inverse{};
  SparseMatrix mass{};
  VecX gravity{};                   // impulse over the step [N s]
  VecX gyroscopic{};                // h (-omega x J omega) at the start
  SparseMatrix gyroscopic_D{};      // h theta d(omega x J omega)/d omega
  VecX laws{};                      // h F - h^2 theta K v, forces of joint axes and coordinates included
  SparseMatrix law_D{};             // h theta C + h^2 theta^2 K
  std::vector<AxisImpulse> axes{};  // part of `laws` and `law_D`
  // How contact impulses turn while a fully implicit step converges (MJ-14); empty: they do not
  VecX turning{};
  SparseMatrix turning_D{};  // also contained in M^
  // For schemes that compute the motion between contacts before they solve for impulses; otherwise empty
  VecX joints{};     // impulse of the joints in that motion, besides that of the solve
  VecX numerical{};  // what the scheme adds of its own
};

/// Made once and read by all attempts of a step. Made in place, since Eigen copies sparse matrices where
/// other types are moved.
using SharedMotion = std::shared_ptr<const FreeMotion>;

/// The last M^ of a scheme and its inverse. Where bodies do not turn, or are as round as balls and cubes, M^
/// does not change from step to step; elsewhere some of its blocks do not. Reusing it saves time and changes
/// no result; a thread that finds it in use by another goes without.
struct MassScratch {
  std::mutex in_use{};
  SparseMatrix M{};
  std::shared_ptr<const MassInverse> inverse{};
};

/// Computes M, f, v_free and the inverse from the velocity and from the impulses and matrices that they sum.
void sum_up(FreeMotion& free, MassScratch* scratch = nullptr);
/// Computes f and v_free only: M and its inverse stay as they are.
void sum_up_impulses(FreeMotion& free);

/// `theta` in [1/2, 1].
FreeMotion free_motion(const Model& model, const State& state, const Layout& dofs, double h, double theta,
                       MassScratch* scratch = nullptr);

}  // namespace aussois
