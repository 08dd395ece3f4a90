// SPDX-License-Identifier: Apache-2.0
// Boxes, planks and bricks on top of each other.
#include <algorithm>
#include <cmath>

#include "examples/studies/families/problem_families.hpp"

namespace aussois {

FrictionScene cube_grid(int side, int levels, double play, const Law& law, Random& random) {
  FrictionScene scene;
  const double pitch = 0.1 + play / 2;
  add_ground(scene, side * pitch + 1);
  for (int z = 0; z < levels; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double off_x = random.uniform(-play / 4, play / 4), off_y = random.uniform(-play / 4, play / 4);
        add_box(scene, Vec3(0.1, 0.1, 0.1), translation(x * pitch + off_x, y * pitch + off_y, 0.1 * z + 0.05),
                1000);
      }
  touch_faces(scene, 1.01 * play + 1e-9, law);
  return scene;
}

FrictionScene box_stack(int contacts, Random& random) {
  const int side = std::max(1, int(std::lround(std::cbrt(contacts / 12.0))));
  const int per_level = 4 * side * side + 8 * side * (side - 1);
  const int levels = std::max(1, (contacts + per_level / 2) / per_level);
  const double play = random.index(2) == 0 ? 0 : random.log_uniform(1e-7, 1e-4);
  FrictionScene scene = cube_grid(side, levels, play, coulomb(random.uniform(0.1, 0.9)), random);
  disturb(scene, random);
  return scene;
}

FrictionScene kapla_tower(int contacts, Random& random) {
  const int planks = contacts < 600 ? 2 : contacts < 3000 ? 3 : 4;
  const int layers = 1 + std::max(0, int(std::lround(double(contacts - 4 * planks) / (4 * planks * planks))));
  FrictionScene scene;
  add_ground(scene, 1);
  for (int layer = 0; layer < layers; ++layer)
    for (int i = 0; i < planks; ++i) {
      const double along = random.uniform(-1e-3, 1e-3), turn = random.uniform(-0.02, 0.02);
      const bool missing = random.uniform() < 0.2 && i > 0 && i < planks - 1;
      if (missing) continue;
      const double across = 0.048 * (2.0 * i / (planks - 1) - 1);
      const SE3 place = rotation(Vec3::UnitZ(), layer % 2 == 0 ? 0 : kPi / 2) *
                        translation(along, across, 0) * rotation(Vec3::UnitZ(), turn);
      add_box(scene, Vec3(0.12, 0.024, 0.008), translation(0, 0, 0.008 * layer + 0.004) * place, 600);
    }
  touch_faces(scene, 1e-9, coulomb(random.uniform(0.2, 0.8)));
  disturb(scene, random);
  return scene;
}

FrictionScene masonry_wall(int contacts, Random& random) {
  const double length = 0.25, depth = 0.12, height = 0.065;
  const int rows = std::max(1, int(std::lround(std::sqrt(contacts / 4.0))));
  const int columns = std::max(1, int(std::lround(contacts / 12.0 / rows)));
  FrictionScene scene;
  add_ground(scene, columns * length + 1);
  for (int row = 0; row < rows; ++row)
    for (int i = 0; i <= columns; ++i) {
      const double shift = row % 2 == 0 ? 0.5 : 0;  // odd rows begin and end with half a brick
      const double from = std::max(0.0, i - 0.5 + shift), to = std::min(double(columns), i + 0.5 + shift);
      const double joint = random.log_uniform(1e-7, 1e-4);
      const bool missing = random.uniform() < 0.05 && row > 0;
      if (to <= from || missing) continue;
      add_box(scene, Vec3((to - from) * length - joint, depth, height),
              translation((from + to) / 2 * length, 0, (row + 0.5) * height), 1800);
    }
  touch_faces(scene, 2e-4, coulomb(random.uniform(0.3, 0.9)));
  disturb(scene, random);
  return scene;
}

FrictionScene mass_ratio(int contacts, Random& random) {
  const int side = contacts < 60 ? 1 : std::max(2, int(std::lround(std::cbrt(contacts / 8.0))));
  const int levels = std::max(2, contacts / (4 * side * side) - 1);
  const int kind = random.index(3);  // 0 the heavier the higher, 1 alternating, 2 any
  const double light = 10, ratio = random.log_uniform(1e2, 1e6);
  FrictionScene scene;
  add_ground(scene, 0.15 * side + 1);
  for (int z = 0; z < levels; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double any = random.uniform();
        const double exponent = kind == 0 ? double(z) / (levels - 1) : kind == 1 ? z % 2 : any;
        add_box(scene, Vec3(0.1, 0.1, 0.1), translation(0.15 * x, 0.15 * y, 0.1 * z + 0.05),
                light * std::pow(ratio, exponent));
      }
  const double width = 0.15 * side;
  add_box(scene, Vec3(width, width, 0.05),
          translation((width - 0.15) / 2, (width - 0.15) / 2, 0.1 * levels + 0.025),
          kind == 1 ? light : light * ratio);
  touch_faces(scene, 1e-9, coulomb(random.uniform(0.2, 0.8)));
  disturb(scene, random);
  return scene;
}

}  // namespace aussois
