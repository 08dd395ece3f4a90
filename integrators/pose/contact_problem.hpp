// SPDX-License-Identifier: Apache-2.0
// Poses the one-step problem of contacts and gap functions: directions, bias, laws (MJ-3), (MJ-6), (GEN-3).
#pragma once

#include <optional>
#include <string>

#include "integrators/pose/free_motion.hpp"
#include "integrators/step_options.hpp"
#include "nsgs/friction_problem.hpp"
#include "reduction/friction_patch.hpp"

namespace aussois {

inline constexpr int kRowsOfAContact = 5;
using RowJacobian = Eigen::Matrix<double, kRowsOfAContact, 6>;
using RowVector = Eigen::Matrix<double, kRowsOfAContact, 1>;

/// One block of rows as the dynamics sees it: a contact, a gap function, or what acts on the axis of a joint.
/// Rows beyond those of its law are ignored.
struct ContactRow {
  BodyId body_a{}, body_b{};              // none: nothing, or the world
  Mat3 frame = Mat3::Identity();          // of a contact: columns n, t1, t2; impulses act on A [world]
  RowJacobian J_a = RowJacobian::Zero();  // u = J_a twist_a + J_b twist_b + others + w
  RowJacobian J_b = RowJacobian::Zero();
  std::vector<Triplet> others{};        // (row of the block, row of the problem, value), beside the twists
  RowVector w = RowVector::Zero();      // bias: normal law and what moves by itself [m/s, rad/s]
  RowVector moved = RowVector::Zero();  // the part of w that moves by itself; for rows with a normal
  double gap = 0;                       // [m, rad]; for a row with a normal
  double restitution = 0;               // for a row with a normal [-]
  Law law{};
  bool active = true;         // false: the normal law leaves the block out of this step
  bool can_open = true;       // false: nothing free changes its gap, so it is in no problem
  std::optional<int> slot{};  // first entry in State::r; of a contact, which the contact memory keeps, none
};

/// The rule of the normal rows of a step: its law, and what StepOptions says of gaps and overlaps.
struct NormalRule {
  NormalLaw law = NormalLaw::combined;
  // The laws of contacts and stops apply to gamma u+ + (1 - gamma) u- [-], in [1/2, 1] (MJ-10)
  double gamma = 1;
  double correction_speed = StepOptions{}.correction_speed;
  double touching = StepOptions{}.touching;
};

/// The largest gap that Moreau's law treats as closed in a step of length `h` (MJ-6) [m].
double closed_gap(const NormalRule& rule, double h);

/// Bias of a normal row (MJ-6) with normal velocity `u_before` at the start of the step, and whether the row
/// takes part at all.
struct NormalBias {
  double w = 0;
  bool active = true;
};
NormalBias normal_bias(double gap, double u_before, double restitution, double h, const NormalRule& rule);

/// Poses at which contacts are evaluated: those that the velocities `v`, indexed as State::v, lead to in
/// `time` [s]. Their gaps count as linearised back to the start of the step (MJ-11).
struct ReachedPlace {
  VecX v{};
  double time = 0;
};

/// Whether a contact with this speed closes within a step, as the normal law sees it.
bool closes(double gap, double speed, double h, NormalLaw law);

/// Both impulses act midway between the two proximal points, which keeps the angular momentum of the pair.
/// `v_prescribed` is that of prescribed_velocity. With `patches`, one per contact, friction acts at the
/// centre of the contact's patch and drills with the patch's radius, or with that of the contact law if it is
/// larger (RED-15).
std::vector<ContactRow> contact_rows(const Model& model, const State& state, const Layout& dofs,
                                     const ContactSet& contacts, const VecX& v_prescribed, double h,
                                     const NormalRule& options, const ReachedPlace& reached = {},
                                     const std::vector<FrictionPatch>& patches = {});

/// The rows of the model's gap functions at the start of the step (GEN-3), in their order, and their gaps.
struct GapFunctionRows {
  std::vector<ContactRow> rows{};
  Table<GapId, double> gap{};  // [m]
};
GapFunctionRows gap_rows(const Model& model, const State& state, const Layout& dofs, const VecX& v_prescribed,
                         double h, const NormalRule& options, const ReachedPlace& reached = {});

/// The problem of the rows `kept`, in order; without joints.
FrictionProblem contact_problem(const FreeMotion& free, const Layout& dofs,
                                const std::vector<ContactRow>& rows, const std::vector<int>& kept);

/// J v of the first row of a block, with v indexed as State::v; without coordinates and bias.
double normal_speed(const ContactRow& row, const VecX& v);
/// The largest component of the free velocities `v` that a row moves with: what is small beside it is noise.
double largest_velocity(const ContactRow& row, const Layout& dofs, const VecX& v);

/// u of a row, bias included, for the velocities v of the dynamic rows [m/s, rad/s].
RowVector relative_velocity(const ContactRow& row, const Layout& dofs, const VecX& v);
/// The same without the bias of the normal law: how fast the two sides really move apart.
RowVector slip_velocity(const ContactRow& row, const Layout& dofs, const VecX& v);
/// The transpose: the momentum that the impulses `r` of the rows give, in rows of the problem [N s, N m s].
VecX momentum_of(const std::vector<ContactRow>& rows, const Layout& dofs, const std::vector<RowVector>& r);

}  // namespace aussois
