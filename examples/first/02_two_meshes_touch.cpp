// SPDX-License-Identifier: Apache-2.0
// Where a box touches another one that is turned and hangs 0.1 mm above it: every local minimum of their
// distance, with its two points, its normal and its gap.
#include <cstdio>

#include "geometry/primitives.hpp"
#include "lmd/find_contacts.hpp"

namespace au = aussois;

int main() {
  const au::LmdShape lower = prepare(dilate(au::make_box(0.2, 0.2, 0.1), 1e-3));
  const au::LmdShape upper = prepare(dilate(au::make_box(0.1, 0.1, 0.1), 1e-3));
  const double gap = 1e-4;  // between the dilated shapes [m]
  const au::SE3 place{au::exp_so3(au::Vec3(0, 0, 0.5)), au::Vec3(0, 0, 0.1 + 2e-3 + gap)};

  const au::ContactSet found =
      au::find_contacts({&upper, place, 1}, {&lower, au::SE3{}, 0}, {.threshold = 1e-3});
  for (const au::ContactPoint& c : found.points)
    std::printf("gap %.4g mm at (%.2f, %.2f, %.2f) mm, normal (%.2g, %.2g, %.2g)\n", 1e3 * c.gap,
                1e3 * c.x_a.x(), 1e3 * c.x_a.y(), 1e3 * c.x_a.z(), c.normal.x(), c.normal.y(), c.normal.z());
  std::printf("%zu contacts\n", found.points.size());
  return found.points.size() == 4 ? 0 : 1;  // the corners of the upper box
}
