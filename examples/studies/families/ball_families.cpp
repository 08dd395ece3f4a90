// SPDX-License-Identifier: Apache-2.0
// Balls in a bin, and balls that hit.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "examples/studies/families/problem_families.hpp"

namespace aussois {
namespace {

struct Grain {
  Vec3 centre = Vec3::Zero();
  double radius = 0;
};

/// The sides of a bin [0, width]^2, open above: inward normal n, n . x >= offset inside.
struct Side {
  Vec3 normal;
  double offset;
};
std::array<Side, 5> bin(double width) {
  return {Side{Vec3::UnitZ(), 0}, Side{Vec3::UnitX(), 0}, Side{-Vec3::UnitX(), -width},
          Side{Vec3::UnitY(), 0}, Side{-Vec3::UnitY(), -width}};
}

struct Pair {
  int a, b;  // b < a
};
std::vector<Pair> near_pairs(const std::vector<Grain>& grains, double slack) {
  std::vector<Pair> pairs;
  for (int a = 1; a < int(grains.size()); ++a)
    for (int b = 0; b < a; ++b) {
      const Grain &p = grains[a], &q = grains[b];
      const double reach = p.radius + q.radius + slack;
      if (std::abs(p.centre.z() - q.centre.z()) < reach &&
          (p.centre - q.centre).squaredNorm() < reach * reach)
        pairs.push_back({a, b});
    }
  return pairs;
}

/// Lets them sink in steps that grow smaller and pushes apart what overlaps, until nothing does by more than
/// some thousandths of a radius (FAM-5).
void settle(std::vector<Grain>& grains, double width) {
  constexpr int kRounds = 60, kSweeps = 10;
  double largest = 0;
  for (const Grain& grain : grains) largest = std::max(largest, grain.radius);
  const std::array<Side, 5> sides = bin(width);
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<Pair> pairs = near_pairs(grains, largest);
    const double sink = std::max(0.0, 1 - double(round) / (kRounds - 10)) * 0.1 * largest;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (Grain& grain : grains) grain.centre.z() -= sink;
      for (const Pair& pair : pairs) {
        Grain &p = grains[pair.a], &q = grains[pair.b];
        const Vec3 apart = p.centre - q.centre;
        const double distance = apart.norm(), overlap = p.radius + q.radius - distance;
        if (overlap <= 0 || distance == 0) continue;
        p.centre += overlap / (2 * distance) * apart;
        q.centre -= overlap / (2 * distance) * apart;
      }
      for (Grain& grain : grains)
        for (const Side& side : sides)
          grain.centre +=
              std::max(0.0, side.offset + grain.radius - side.normal.dot(grain.centre)) * side.normal;
    }
  }
}

/// A contact wherever the gap is below `slack` [m].
void touch_grains(FrictionScene& scene, const std::vector<Grain>& grains, double width, double slack,
                  const Law& law) {
  const int base = int(scene.bodies.size()) - int(grains.size());  // the bin is body 0
  for (int i = 0; i < int(grains.size()); ++i)
    for (const Side& side : bin(width)) {
      const Grain& grain = grains[i];
      const double gap = side.normal.dot(grain.centre) - side.offset - grain.radius;
      if (gap < slack)
        scene.contacts.push_back(contact(base + i, 0, grain.centre - (grain.radius + gap / 2) * side.normal,
                                         side.normal, law, std::max(gap, 0.0)));
    }
  for (const Pair& pair : near_pairs(grains, slack)) {
    const Grain &p = grains[pair.a], &q = grains[pair.b];
    const Vec3 normal = (p.centre - q.centre).normalized();
    const double gap = (p.centre - q.centre).norm() - p.radius - q.radius;
    scene.contacts.push_back(contact(base + pair.a, base + pair.b, q.centre + (q.radius + gap / 2) * normal,
                                     normal, law, std::max(gap, 0.0)));
  }
}

/// Contacts of `layers` layers of a square pyramid with n x n balls below: ground, within layers, between
/// layers.
int pyramid_contacts(int n, int layers) {
  int count = n * n;
  for (int m = n; m > n - layers; --m)
    count += 2 * m * (m - 1) + (m > n - layers + 1 ? 4 * (m - 1) * (m - 1) : 0);
  return count;
}

}  // namespace

FrictionScene sphere_pile(int contacts, Random& random) {
  const int count = std::max(3, int(std::lround(contacts / 3.3)));
  std::vector<Grain> grains;
  const double width = 0.023 * std::max(2.0, std::cbrt(double(count)));
  const int row = int(width / 0.029);
  for (int i = 0; i < count; ++i) {
    const double radius = random.uniform(0.006, 0.014);
    const int floor = i / (row * row), line = i / row % row;
    const Vec3 cell(i % row, line, floor);
    grains.push_back(
        {.centre = 0.0145 * Vec3::Ones() + 0.029 * cell + random.vector(5e-4), .radius = radius});
  }
  settle(grains, width);
  FrictionScene scene;
  scene.bodies.emplace_back();  // the bin
  for (const Grain& grain : grains) add_ball(scene, grain.radius, grain.centre, 2500);
  touch_grains(scene, grains, width, 2e-4, coulomb(random.uniform(0.1, 0.9)));
  disturb(scene, random);
  return scene;
}

FrictionScene impacts(int contacts, Random& random) {
  int side = 1, layers = 1;  // the pyramid with the nearest number, at least half as high as it could be
  for (int n = 1; pyramid_contacts(n, (n + 1) / 2) <= 2 * contacts; ++n)
    for (int l = (n + 1) / 2; l <= n; ++l)
      if (std::abs(pyramid_contacts(n, l) - contacts) < std::abs(pyramid_contacts(side, layers) - contacts))
        side = n, layers = l;
  FrictionScene scene;
  scene.bodies.emplace_back();  // the ground
  const double radius = 0.03;
  std::vector<Grain> grains;
  for (int layer = 0; layer < layers; ++layer)
    for (int y = 0; y < side - layer; ++y)
      for (int x = 0; x < side - layer; ++x)
        grains.push_back({.centre = radius * Vec3(2 * x + layer, 2 * y + layer, 1 + std::sqrt(2.0) * layer) +
                                    Vec3(1, 1, 0),  // away from the sides of the bin
                          .radius = radius});
  for (const Grain& grain : grains) {
    const double density = random.log_uniform(1000, 8000);
    add_ball(scene, grain.radius, grain.centre, density);
    scene.bodies.back().twist << random.vector(1), random.vector(1 / radius);
  }
  touch_grains(scene, grains, 1e6, 1e-9, coulomb(random.uniform(0, 0.5)));
  for (Interaction& at : scene.contacts) {
    at.gap = 0;  // touching up to rounding
    at.restitution = random.uniform();
  }
  return scene;
}

}  // namespace aussois
