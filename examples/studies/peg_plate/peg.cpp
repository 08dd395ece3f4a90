// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/peg_plate/peg.hpp"

namespace aussois {

BodyLoad load_of(const PegSample& s) {
  BodyLoad load{.g_wb = s.g};
  load.twist << s.v, s.omega;
  load.wrench << s.force, s.torque - s.omega.cross(Peg().inertia.cwiseProduct(s.omega));
  return load;
}

Vec2 centre_of_pressure(const PegSample& s) {
  const Vec3 F = s.g.R.conjugate() * s.plate_force, torque = -s.torque;  // of the plate, body
  const double z = -Peg().half_length;
  return Vec2(z * F.x() - torque.y(), z * F.y() + torque.x()) / F.z();
}

const char* to_string(PegScenario scenario) {
  return name_of(scenario, kPegScenarios);
}

std::vector<PegCase> peg_cases(PegScenario scenario, int count, int leans) {
  const auto between = [](double a, double b, int i, int n) { return n > 1 ? a + (b - a) * i / (n - 1) : a; };
  const bool edge = scenario == PegScenario::edge;
  std::vector<PegCase> out;
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < count; ++j)
      for (int k = 0; k < (edge ? leans : 1); ++k)
        out.push_back({.incidence = between(kPi / 4, 3 * kPi / 4, i, count),
                       .speed = between(0.02, 0.07, j, count),
                       .lean = edge ? between(43, 5, k, leans) * kPi / 180 : 0});
  return out;
}

}  // namespace aussois
