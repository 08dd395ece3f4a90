// SPDX-License-Identifier: Apache-2.0
// From contacts to the one-step problem: directions, bias, friction (MJ-3), (MJ-6).
#pragma once

#include <string>

#include "integrators/free_motion.hpp"
#include "nsgs/friction_problem.hpp"

namespace aussois {

/// What the normal rows of a step say (decision record 0006).
enum class NormalLaw {
  moreau,         // impact law u+ >= -e u-, active once the gap predicted half a step ahead closes
  gap_over_step,  // u+ + g / h >= 0: the gap at the end of the step stays open; plastic
  combined,       // impact law where a contact with e > 0 closes within the step, gap over step elsewhere
};
const char* to_string(NormalLaw law);
/// By its name; throws std::invalid_argument naming the three.
NormalLaw normal_law(const std::string& name);

/// One contact as the dynamics sees it.
struct ContactRow {
  int body_a = -1, body_b = -1;
  Mat3 frame = Mat3::Identity();  // columns n, t1, t2; impulses act on A [world]
  Eigen::Matrix<double, 3, 6> J_a = Eigen::Matrix<double, 3, 6>::Zero();  // u = J_a twist_a + J_b twist_b
  Eigen::Matrix<double, 3, 6> J_b = Eigen::Matrix<double, 3, 6>::Zero();
  Vec3 w = Vec3::Zero();  // bias: normal law and moved bodies [m/s]
  double mu = 0;
  bool active = true;  // false: the normal law leaves the contact out of this step
};

struct NormalLawOptions {
  NormalLaw law = NormalLaw::combined;
  double correction_speed = 0.01;  // overlaps are pushed apart no faster than this [m/s]
};

/// Both impulses act at the middle between the two proximal points, so that the pair's angular momentum is
/// kept. `v_prescribed` as of prescribed_velocity.
std::vector<ContactRow> contact_rows(const Model& model, const State& state, const ContactSet& contacts,
                                     const VecX& v_prescribed, double h, const NormalLawOptions& options);

/// The problem of the rows `kept`, in order.
FrictionProblem contact_problem(const FreeMotion& free, const DofMap& dofs,
                                const std::vector<ContactRow>& rows, const std::vector<int>& kept);

/// u of a row, bias included, for the velocities v of the dynamic rows [m/s].
Vec3 relative_velocity(const ContactRow& row, const DofMap& dofs, const VecX& v);

}  // namespace aussois
