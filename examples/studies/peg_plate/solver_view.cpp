// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/peg_plate/solver_view.hpp"

#include <cmath>

#include "geometry/frame.hpp"
#include "geometry/settings.hpp"
#include "reduction/learned_selector.hpp"

namespace aussois {
namespace {

constexpr int kAngles = 7;  // of normals, per direction

// Directions of the contact rows, twists (v in the world, omega in the body): 6 x 3 n.
MatX directions(const PegSample& sample, std::span<const PegContact> contacts) {
  const Mat3 R_bw = sample.g.R.conjugate().toRotationMatrix();
  MatX H(6, 3 * Eigen::Index(contacts.size()));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Mat3 frame = frame_of(contacts[i].normal);
    H.block<3, 3>(0, 3 * Eigen::Index(i)) = frame;
    H.block<3, 3>(3, 3 * Eigen::Index(i)) = R_bw * skew(contacts[i].arm) * frame;
  }
  return H;
}

}  // namespace

void describe(SettingVisitor& visit, SolverView& o) {
  visit.begin("SolverView");
  visit.number({"rho", "regularisation of the solver", "-", {0, 1}, "--rho"}, o.rho);
  visit.number({"mu", "friction coefficient", "-", not_negative_range()}, o.mu);
  visit.number({"e", "restitution coefficient", "-", {0, 1}}, o.e);
  visit.number({"step", "time step of the solver", "s", positive_range()}, o.step);
  visit.choice({.name = "reading", .what = "how the solver treats friction", .flag = "--reading"}, o.reading,
               kFrictionReadings);
}

std::vector<Vec3> contact_forces(const SolverView& view, const PegSample& s,
                                 std::span<const PegContact> contacts) {
  if (contacts.empty()) return {};
  const Peg peg;
  Vec6 inverse_mass, twist, free;
  inverse_mass << Vec3::Constant(1 / peg.mass), peg.inertia.cwiseInverse();
  twist << s.v, s.omega;
  free << s.force, s.torque - s.omega.cross(peg.inertia.cwiseProduct(s.omega));
  free = twist + view.step * inverse_mass.cwiseProduct(free);

  const MatX H = directions(s, contacts);
  LocalProblem problem;
  problem.W = MatX(H.transpose() * inverse_mass.asDiagonal() * H).sparseView();
  problem.laws.assign(contacts.size(), coulomb(view.mu));
  problem.q = with_restitution(H.transpose() * free, H.transpose() * twist, problem.laws, view.e);
  const VecX lambda =
      solve_regularised(problem, regularisation(problem, view.rho), {}, {.reading = view.reading}).lambda;
  std::vector<Vec3> out;
  for (std::size_t i = 0; i < contacts.size(); ++i)
    out.push_back(frame_of(contacts[i].normal) * lambda.segment<3>(3 * Eigen::Index(i)) / view.step);
  return out;
}

Vec3 plate_force(const SolverView& view, const PegSample& sample, std::span<const PegContact> contacts) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& force : contact_forces(view, sample, contacts)) sum += force;
  return sum;
}

std::vector<Vec3> face_places() {
  const Peg peg;
  std::vector<Vec3> out{Vec3(0, 0, -peg.half_length)};
  for (const double r : {peg.radius / 2, peg.radius})
    for (int i = 0; i < 8; ++i)
      out.emplace_back(r * std::cos(i * kPi / 4), r * std::sin(i * kPi / 4), -peg.half_length);
  return out;
}

std::vector<PegContact> peg_contacts(PegScenario scenario, const PegSample& sample) {
  std::vector<PegContact> out;
  if (scenario == PegScenario::surface) {
    for (const Vec3& place : face_places()) out.push_back({.arm = sample.g.R * place});
    return out;
  }
  const Peg peg;
  const Vec3 down = sample.g.R.conjugate() * -Vec3::UnitZ();
  const Vec2 out_of_axis = peg.radius * down.head<2>().stableNormalized();
  const Vec3 lowest = sample.g.R * Vec3(out_of_axis.x(), out_of_axis.y(), -peg.half_length);
  for (int a = 0; a < kAngles; ++a)
    for (int b = 0; b < kAngles; ++b) {
      const auto slope = [](int i) { return std::tan((15 * i - 45) * kPi / 180); };
      out.push_back({.arm = lowest, .normal = Vec3(slope(a), slope(b), 1).normalized()});
    }
  return out;
}

std::vector<PegContact> picked(const std::vector<PegContact>& all, const std::vector<int>& which) {
  std::vector<PegContact> out;
  for (const int i : which) out.push_back(all[i]);
  return out;
}

std::vector<std::vector<int>> peg_choices(PegScenario scenario) {
  std::vector<std::vector<int>> out;
  if (scenario == PegScenario::edge) {
    for (int i = 0; i < kAngles * kAngles; ++i) out.push_back({i});
    return out;
  }
  const std::vector<Vec3> place = face_places();
  for (int i = 0; i < int(place.size()); ++i)
    for (int j = i + 1; j < int(place.size()); ++j)
      for (int k = j + 1; k < int(place.size()); ++k)
        if (!are_collinear(place[i], place[j], place[k])) out.push_back({i, j, k});
  return out;
}

}  // namespace aussois
