// SPDX-License-Identifier: Apache-2.0
#include "integrators/tell/ledgers.hpp"

#include <algorithm>
#include <utility>

#include "geometry/check.hpp"
#include "mechanics/forces.hpp"
#include "mechanics/tree.hpp"

namespace aussois {
namespace {

// Of the kinetic energy: above what the solver's tolerance of 1e-8 gives to a body at rest
constexpr double kGain = 1e-5;

// Kinetic energy of the coordinates beyond that by the mass of the step (GEN-4).
double change_of_mass(const Model& model, const State& state, const State& next, const FreeMotion& free,
                      const Layout& dofs, const VecX& v) {
  if (carries_bodies(model))  // base and coordinates share their masses
    return energy(model, next).kinetic - energy(model, state).kinetic -
           0.5 * (v + free.v).dot(free.mass * (v - free.v));
  double work = 0;
  VecX change = VecX::Zero(dofs.rows);
  for (const BlockId i : model.coordinates.ids()) {
    const Coordinates& block = model.coordinates[i];
    if (!block.points.empty()) continue;  // their masses stay
    const VecX before = speeds(model, state, i), after = speeds(model, next, i);
    work += 0.5 * after.dot(block_mass(model, i, coordinates(model, next, i)) * after) -
            0.5 * before.dot(block_mass(model, i, coordinates(model, state, i)) * before);
    const int row = dofs.coordinates + first_coordinate(model, i);
    change.segment(row, block.size) = (v - free.v).segment(row, block.size);
  }
  return change.isZero(0) ? 0 : work - 0.5 * (v + free.v).dot(free.mass * change);
}

// What changed the velocities in a step beside gravity, rows of the problem [N s, N m s]; with gravity their
// sum is mass * (v_end - v). Empty: nothing.
struct Acting {
  VecX laws{}, gyroscopic{}, contacts{}, joints{}, numerical{};
};

VecX less(const VecX& a, const SparseMatrix& D, const VecX& change) {
  return D.nonZeros() > 0 ? VecX(a - D * change) : a;
}
void add(VecX& sum, const VecX& more) {
  if (sum.size() == 0)
    sum = more;
  else if (more.size() > 0)
    sum += more;
}
double work(const VecX& v, const VecX& impulse) {
  return impulse.size() > 0 ? v.dot(impulse) : 0;
}

// `change` of the velocities by the impulses of the step, `projected` by what came after.
Acting acting(const FreeMotion& free, const VecX& contact_impulse, const VecX& joint_impulse,
              const VecX& change, const VecX& projected) {
  Acting out{.laws = less(free.laws, free.law_D, change),
             .gyroscopic = less(free.gyroscopic, free.gyroscopic_D, change),
             .contacts = contact_impulse,
             .joints = {},
             .numerical = free.numerical};
  if (free.turning.size() > 0) add(out.contacts, free.turning - free.turning_D * change);
  if (joint_impulse.size() > 0) out.joints = joint_impulse + free.mass * projected;
  add(out.joints, free.joints);
  return out;
}

// Work on the mean of both ends' velocities, of gravity and force laws on the path's (MJ-9); `gained` is
// mass * (v_end - v).
EnergyLedger energy_ledger(const FreeMotion& free, const Acting& by, const VecX& gained, const VecX& v_end,
                           const VecX& v_path) {
  const VecX middle = (v_end + free.v) / 2;
  return {.kinetic_change = middle.dot(gained),
          .gravity_work = v_path.dot(free.gravity),
          .law_work = v_path.dot(by.laws),
          .contact_work = work(middle, by.contacts),
          .gyroscopic_work = middle.dot(by.gyroscopic),
          .joint_work = work(middle, by.joints),
          .numerical_work = work(middle, by.numerical) + (middle - v_path).dot(free.gravity + by.laws)};
}

// `impact`: of an impact that `state` has behind it; `gained`: of the step with it. What the angular momentum
// of the states did beside `gained` is the scheme's: it turns with the start (MJ-13).
MomentumLedger momentum_ledger(const StepSetting& setting, const State& state, const State& next,
                               const SparseMatrix& mass, const VecX& gained, const VecX& impact,
                               const VecX& gravity, const Acting& by) {
  const bool carries = carries_bodies(setting.model);
  const std::optional<MassInverse> inverse = carries ? invert_mass(mass) : std::nullopt;
  const auto sum = [&](const VecX& impulse) {
    return carries ? momentum_given(setting, state, impulse, inverse)
                   : momentum_given(setting, state, impulse);
  };
  MomentumLedger out{.change = momentum(setting.model, next) - momentum(setting.model, state),
                     .forces = sum(gravity + by.laws),
                     .contacts = sum(by.contacts),
                     .joints = sum(by.joints),
                     .numerical = sum(by.numerical)};
  out.change += sum(impact);
  const Momentum turned = sum(by.gyroscopic), all = sum(gained);
  out.numerical.angular += turned.angular + out.change.angular - all.angular;
  if (carries) {  // what speeds alone change: the bases of trees take it (TREE-7)
    out.joints.linear += turned.linear + out.change.linear - all.linear;
    out.joints.angular += std::exchange(out.numerical.angular, Vec3::Zero());
  }
  return out;
}

// What contacts and gap functions gave on relative velocities, each and together (IMP-6), and whether that is
// more than rounding.
void tell_work(const StepSetting& setting, const ImpulseStep& step, const VecX& r, const VecX& v_end,
               StepReport& report) {
  const Layout& dofs = setting.dofs;
  report.law_work.assign(setting.laws.size(), 0);
  double sum = 0;
  for (std::size_t k = 0; k < step.solved.kept.size(); ++k) {
    const auto i = std::size_t(step.solved.kept[k]);
    const ContactRow& row = step.rows[i];
    if (is_of_axis(setting.model, row.slot)) continue;
    const VecX::ConstSegmentReturnType r_k = r.segment(step.solved.first_row[k], row.law.rows);
    double work = step.impact ? step.impact->work[i] : 0;
    if (!r_k.isZero(0)) {  // most contacts of a pile have none
      const RowVector u = slip_velocity(row, dofs, step.free->v) + slip_velocity(row, dofs, v_end);
      for (int d = 0; d < row.law.rows; ++d) work += u[d] / 2 * r_k[d];
    }
    if (!row.slot) {
      report.contacts[k].work = work;
      add_law_work(setting, contact_law(setting.model, row.body_a, row.body_b), work, report);
    }
    for (StepGap& gap : report.gaps)
      if (gap.id == gap_of(setting.model, row.slot)) {
        gap.work = work;
        add_law_work(setting, setting.model.gaps[gap.id].law, work, report);
      }
    sum += work;
  }
  const auto kinetic = [&](const VecX& v) { return v.dot(step.free->mass * v) / 2; };
  report.impulse_gain = std::max(0.0, sum);
  report.energy_rises =
      sum > 0 && sum > kGain * std::max({kinetic(step.free->v), kinetic(step.free->v_free), kinetic(v_end)});
}

}  // namespace

Momentum momentum_given(const StepSetting& setting, const State& state, const VecX& impulse,
                        const std::optional<MassInverse>& inverse) {
  if (impulse.isZero(0) || !inverse) return {};
  State moved = state;
  moved.v = all_velocities(setting.dofs, *inverse * impulse, VecX::Zero(state.v.size()));
  carry_twists(setting.model, moved.g, moved.v);
  return momentum(setting.model, moved);
}

Momentum momentum_given(const StepSetting& setting, const State& state, const VecX& impulse) {
  Momentum out;
  if (impulse.isZero(0)) return out;  // none at all, or of bodies that do not spin
  if (carries_bodies(setting.model))
    return momentum_given(setting, state, impulse,
                          invert_mass(mass_matrix(setting.model, state, setting.dofs)));
  for (const BodyId b : state.g.ids()) {
    const int at = setting.dofs.first[b];
    if (at < 0) continue;
    const Vec3 p = impulse.segment<3>(at);
    out.linear += p;
    out.angular += state.g[b].p.cross(p) + state.g[b].R * Vec3(impulse.segment<3>(at + 3));
  }
  for (const BlockId i : setting.model.coordinates.ids()) {
    const Coordinates& block = setting.model.coordinates[i];
    if (block.points.empty()) continue;
    const VecX q = coordinates(setting.model, state, i);
    const int row = setting.dofs.coordinates + first_coordinate(setting.model, i);
    for (std::size_t k = 0; k < block.points.size(); ++k) {
      const Vec3 p = impulse.segment<3>(row + 3 * int(k));
      out.linear += p;
      out.angular += point_place(block, q, k).cross(p);
    }
  }
  return out;
}

void add_law_work(const StepSetting& setting, const ContactLaw& law, double work, StepReport& report) {
  const auto known = std::ranges::find(setting.laws, law);
  require(known != setting.laws.end(), "model: a contact law has changed since the scheme was made");
  report.law_work[known - setting.laws.begin()] += work;
}

void tell_ledgers(const StepSetting& setting, const State& state, const State& next, const ImpulseStep& step,
                  const StepBalance& balance, StepReport& report) {
  const Model& model = setting.model;
  const VecX &v = step.free->v, &v_solved = step.solved.solution.v, &v_end = balance.v_end;
  VecX gained = step.free->mass * (v_end - v), impact;
  Acting by = acting(*step.free, balance.by_contacts, balance.by_joints, v_solved - v, v_end - v_solved);
  report.energy = energy_ledger(*step.free, by, gained, v_end, balance.v_path);  // (MJ-9)
  const double by_mass = change_of_mass(model, state, next, *step.free, setting.dofs, v_end);
  report.energy.kinetic_change += by_mass;
  report.energy.gyroscopic_work += by_mass;
  if (step.impact) {
    report.energy.kinetic_change += step.impact->kinetic_change;
    report.energy.contact_work += step.impact->contact_work;
    report.energy.joint_work += step.impact->joint_work;
    add(by.contacts, step.impact->of_contacts);
    add(by.joints, step.impact->of_joints);
    impact = step.impact->of_contacts + step.impact->of_joints;
    gained += impact;
  }
  report.momentum = momentum_ledger(setting, state, next, step.free->mass, gained, impact, step.free->gravity,
                                    by);  // (MJ-13)
  tell_work(setting, step, balance.r, v_end, report);
}

Table<JointId, StepJoint> step_joints(const StepSetting& setting, const ImpulseStep& step, const Move& move,
                                      double h, const VecX& r, const VecX& lambda, const ProjectedState& held,
                                      const State& next) {
  const Model& model = setting.model;
  const Layout& dofs = setting.dofs;
  const VecX &v = step.free->v, &v_solved = step.solved.solution.v, &moved = step.v_prescribed;
  const VecX middle = (v + free_velocities(dofs, next.v)) / 2;
  const WorkVelocities mean{all_velocities(dofs, middle, moved), moved};
  const double time = move.lasts * h;
  Table<JointId, StepJoint> out(model.joints.size());
  if (step.impact) {
    add_forces(model, step.impact->columns, step.impact->lambda, step.impact->middle, h, out);
    add_column_work(model, step.impact->columns, step.impact->lambda,
                    {all_velocities(dofs, step.impact->v_mean, moved), moved}, out);
  }
  add_forces(model, step.joints.columns, lambda, step.joints.middle, time, out);
  if (step.between.empty()) {
    add_column_work(model, step.joints.columns, lambda, mean, out);
    add_forces(model, held.columns, held.lambda, next.g, time, out);
  } else {
    add_column_work(model, step.joints.columns, step.solved.solution.lambda, mean, out);
    for (const JointImpulses& p : step.between) add_column_work(model, p.columns, p.lambda, mean, out);
  }
  add_column_work(model, held.columns, held.lambda, mean, out);
  for (std::size_t k = 0; k < step.solved.kept.size(); ++k) {
    const ContactRow& row = step.rows[step.solved.kept[k]];
    if (!is_of_axis(model, row.slot)) continue;
    const double p = r[step.solved.first_row[k]];
    add_effort(axis_slot(*row.slot), p, time, out);
    double of_others = 0;
    for (const Triplet& e : row.others) of_others += e.value() * middle[e.col()];
    add_axis_work(axis_slot(*row.slot), p, normal_speed(row, mean.v) + of_others, normal_speed(row, moved),
                  out);
  }
  const VecX path = all_velocities(dofs, move.v_path, moved);
  add_spring_and_motor_work(model, step.free->axes, all_velocities(dofs, v_solved - v, 0 * moved),
                            {path, moved}, out);
  return out;
}

}  // namespace aussois
