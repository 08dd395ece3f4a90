// SPDX-License-Identifier: Apache-2.0
// A steel cube of 10 cm on an incline of 0.2 rad, and the impulse that holds it for a millisecond: with mu =
// 0.3 > tan 0.2 it sticks, so the impulse is the weight times the step, seen in the frame of the contact.
#include <cmath>
#include <cstdio>

#include "geometry/mass_properties.hpp"
#include "geometry/parallel.hpp"
#include "geometry/primitives.hpp"
#include "nsgs/one_contact.hpp"

namespace au = aussois;

int main() {
  const au::SimplicialComplex cube = au::make_box(0.1, 0.1, 0.1);
  const double mass = au::mass_properties(cube, 7800.0).mass;  // [kg]

  const double h = 1e-3, slope = 0.2;  // [s], [rad]
  const au::Vec3 free(-9.81 * h * std::cos(slope), 9.81 * h * std::sin(slope),
                      0.0);  // velocity without contact [m/s]
  const au::LocalSolution contact =
      au::solve_one_contact(au::Mat3::Identity() / mass, free, 0.3, au::Vec3::Zero());

  double error[2] = {0, 0};  // on two threads: the thread library is linked, too
  au::parallel_for(
      2, 2, [&](int i) { error[i] = i == 0 ? std::abs(mass - 7.8) : (contact.r + mass * free).norm(); });
  std::printf("mass %.6f kg, impulse %.6f N s along the normal, %.6f N s along the incline\n", mass,
              contact.r[0], contact.r[1]);
  return contact.solved && error[0] < 1e-12 && error[1] < 1e-12 ? 0 : 1;
}
