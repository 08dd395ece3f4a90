// SPDX-License-Identifier: Apache-2.0
// Stones that hold each other up: half circle arches and flat ones.
#include <algorithm>
#include <cmath>

#include "examples/studies/families/problem_families.hpp"

namespace aussois {
namespace {

/// A profile in x, z, extruded along y around `y`.
int add_stone(FrictionScene& scene, const std::vector<Vec2>& profile, double y, double width,
              double density) {
  return add_prism(scene, profile, translation(0, y, 0) * rotation(Vec3::UnitX(), kPi / 2), width, density);
}

constexpr double kStone = 2200;  // [kg/m^3]
constexpr double kCourse = 0.2;  // width of a course [m]

}  // namespace

FrictionScene vault(const Vault& spec) {
  FrictionScene scene;
  const double step = kPi / spec.voussoirs, width = kCourse * spec.courses;
  const auto wedge = [&](double from, double to) -> std::vector<Vec2> {  // angles from the right springing
    const double in = 1 - spec.thickness / 2, out = 1 + spec.thickness / 2;
    const Vec2 a(std::cos(from), std::sin(from)), b(std::cos(to), std::sin(to));
    return {in * a, out * a, out * b, in * b};
  };
  add_stone(scene, wedge(-step, 0), (width - kCourse) / 2, width, 0);
  add_stone(scene, wedge(kPi, kPi + step), (width - kCourse) / 2, width, 0);
  for (int i = 0; i < spec.voussoirs; ++i)
    for (int j = 0; j < spec.courses; ++j)
      add_stone(scene, wedge(i * step, (i + 1) * step), kCourse * j, kCourse, kStone);
  touch_faces(scene, 1e-9, coulomb(spec.mu));
  return scene;
}

FrictionScene arch(int contacts, Random& random) {
  const int courses = contacts < 200 ? 1 : std::max(2, int(std::lround(std::sqrt(contacts / 40.0))));
  const int voussoirs = std::max(2, int(std::lround((contacts / 4.0 - courses) / (2 * courses - 1))));
  FrictionScene scene = vault({.voussoirs = voussoirs,
                               .courses = courses,
                               .thickness = random.uniform(0.09, 0.16),
                               .mu = random.uniform(0.25, 0.8)});
  disturb(scene, random);
  scene.gravity.head<2>() *= 0.2;  // more would topple all of them
  return scene;
}

FrictionScene bridge(int contacts, Random& random) {
  const int courses = contacts < 150 ? 1 : std::max(2, int(std::lround(std::sqrt(contacts / 100.0))));
  const int stones = std::max(1, int(std::lround(contacts / (16.0 * courses))));
  const double span = 2, rise = random.uniform(0.3, 0.5), centre = random.uniform(0.8, 2.0);  // of the joints
  const double width = kCourse * courses, middle = (width - kCourse) / 2, spread = (centre + rise) / centre;
  FrictionScene scene;
  const auto soffit = [&](int i) { return span * (double(i) / stones - 0.5); };
  const auto stone = [&](double from, double to) -> std::vector<Vec2> {
    return {{from, 0}, {to, 0}, {spread * to, rise}, {spread * from, rise}};
  };
  add_stone(scene, stone(soffit(0) - 0.5, soffit(0)), middle, width, 0);
  add_stone(scene, stone(soffit(stones), soffit(stones) + 0.5), middle, width, 0);
  for (int i = 0; i < stones; ++i)
    for (int j = 0; j < courses; ++j)
      add_stone(scene, stone(soffit(i), soffit(i + 1)), kCourse * j, kCourse, kStone);
  // slabs across all courses, over the joints; the load stands on one or two of them
  const double top = spread * span / 2, slab = spread * span / stones, joint = random.log_uniform(1e-7, 1e-4);
  for (int i = 0; i <= stones; ++i) {
    const double from = std::max(-top, -top + (i - 0.5) * slab), to = std::min(top, -top + (i + 0.5) * slab);
    add_box(scene, Vec3(to - from - joint, width, 0.1), translation((from + to) / 2, middle, rise + 0.05),
            kStone);
  }
  const double density = random.log_uniform(kStone, 100 * kStone), place = random.uniform(-0.8, 0.8) * top;
  add_box(scene, Vec3(0.3, width / 2, 0.3), translation(place, middle, rise + 0.25), density);
  touch_faces(scene, 2e-4, coulomb(random.uniform(0.2, 0.8)));
  disturb(scene, random);
  return scene;
}

}  // namespace aussois
