// SPDX-License-Identifier: Apache-2.0
// Parts that move in each other: chains, spinning disks, linkages, and a line of everything.
#include <algorithm>
#include <cmath>

#include "examples/studies/families/problem_families.hpp"

namespace aussois {
namespace {

/// A pin (b) in a hole (a) with axis y: four points on each of two rings, the nearest touching (FAM-6).
void add_pin(FrictionScene& scene, int a, int b, const Vec3& centre, double radius, double half_width,
             double clearance, double load, const Law& law) {
  double nearest = -1;
  for (int i = 0; i < 4; ++i) nearest = std::max(nearest, std::cos(kPi / 2 * i - load));
  for (const double y : {-half_width, half_width})
    for (int i = 0; i < 4; ++i) {
      const double angle = kPi / 2 * i;
      const Vec3 normal(std::cos(angle), 0, std::sin(angle));
      scene.contacts.push_back(contact(a, b, centre + y * Vec3::UnitY() + radius * normal, normal, law,
                                       clearance * (nearest - std::cos(angle - load))));
    }
}

}  // namespace

FrictionScene chain(int contacts, Random& random) {
  const int links = std::max(2, int(std::lround(contacts / 8.0)) - 2);
  const double pitch = 0.02, a = links * pitch / kPi, b = a / 2;
  const auto joint = [&](int k) {
    const double angle = 2 * kPi * (k % links) / links;
    return Vec3(a * std::cos(angle), 0, b * std::sin(angle));
  };
  const Law law = coulomb(random.uniform(0.05, 0.6));
  const double clearance = random.log_uniform(1e-8, 1e-4);
  FrictionScene scene;
  scene.bodies.emplace_back();  // the two fixed pins
  for (int k = 0; k < links; ++k) {
    const Vec3 from = joint(k), to = joint(k + 1), along = to - from;
    const SE3 pose = translation((from + to).x() / 2, 0, (from + to).z() / 2) *
                     rotation(Vec3::UnitY(), std::atan2(-along.z(), along.x()));
    add_box(scene, Vec3(along.norm() + 0.01, 0.012, 0.01), pose, 7800);
  }
  for (int k = 0; k < links; ++k)
    add_pin(scene, 1 + k, 1 + (k + links - 1) % links, joint(k), 0.003, 0.005, clearance,
            random.uniform(0, 2 * kPi), law);
  for (const int k : {0, links / 2})
    add_pin(scene, 1 + k, 0, joint(k), 0.002, 0.008, clearance, -kPi / 2, law);
  disturb(scene, random);
  return scene;
}

FrictionScene gyroscopic(int contacts, Random& random) {
  const int side = std::max(1, int(std::lround(std::cbrt(contacts / 10.0))));
  const int levels = std::max(1, int(std::lround(contacts / (6.0 * side * side + 4.0 * side * (side - 1)))));
  const double radius = 0.05, height = 0.02, speed = random.log_uniform(10, 3000);
  const Law law = coulomb(random.uniform(0.1, 0.8));
  FrictionScene scene;
  add_ground(scene, 1);
  const auto index = [&](int x, int y, int z) { return 1 + (z * side + y) * side + x; };
  for (int z = 0; z < levels; ++z)
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const Vec3 centre(2 * radius * x, 2 * radius * y, height * (z + 0.5));
        SceneBody& disk = scene.bodies[add_disk(scene, radius, height, centre, 7800)];
        const double sense = (x + y) % 2 == 0 ? 1 : -1;
        disk.twist.tail<3>() = speed * (sense * Vec3::UnitZ() + random.vector(0.05));
        for (int i = 0; i < 6; ++i) {
          const double angle = kPi / 3 * i;
          const Vec3 rim = 0.9 * radius * Vec3(std::cos(angle), std::sin(angle), 0);
          scene.contacts.push_back(contact(index(x, y, z), z == 0 ? 0 : index(x, y, z - 1),
                                           centre + rim - height / 2 * Vec3::UnitZ(), Vec3::UnitZ(), law));
        }
        for (const Vec3& back : {Vec3(-1, 0, 0), Vec3(0, -1, 0)}) {
          if ((back.x() < 0 ? x : y) == 0) continue;
          const int neighbour = back.x() < 0 ? index(x - 1, y, z) : index(x, y - 1, z);
          for (const double end : {-0.5, 0.5})
            scene.contacts.push_back(contact(index(x, y, z), neighbour,
                                             centre + radius * back + end * height * Vec3::UnitZ(), -back,
                                             law));
        }
      }
  disturb(scene, random);
  scene.h = random.log_uniform(0.01, 1) / speed;  // a disk turns by less than a radian
  scene.theta = 1;
  return scene;
}

FrictionScene redundant_joints(int contacts, Random& random) {
  const int levels = contacts < 20 ? 1 : 2;
  const int units = std::max(1, int(std::lround((contacts + 4) / (levels == 1 ? 16.0 : 28.0))));
  const double lean = random.uniform(-0.5, 0.5), swing = random.uniform(-2, 2), length = 0.2;
  const Vec3 crank = length * Vec3(std::sin(lean), 0, std::cos(lean));
  const Vec3 omega = swing * Vec3::UnitY(), speed = omega.cross(crank);
  FrictionScene scene;
  scene.bodies.emplace_back();  // the base
  const auto move = [&](int body, const Vec3& v, const Vec3& spin) { scene.bodies[body].twist << v, spin; };
  const auto doubled_hinge = [&](int a, int b, const Vec3& point) {
    for (const double y : {-0.02, 0.02})
      scene.joints.push_back(hinge(a, b, point + y * Vec3::UnitY(), Vec3::UnitY()));
  };
  for (int unit = 0; unit < units; ++unit) {
    const Vec3 origin(0.5 * unit, 0, 0);
    const Vec3 plate = origin + crank + Vec3(0, 0, 0.02);
    const int table = add_box(scene, Vec3(0.5, 0.4, 0.04), {.R = Quat::Identity(), .p = plate}, 2700);
    move(table, speed, Vec3::Zero());
    for (const double x : {-0.2, 0.2})
      for (const double y : {-0.15, 0.15}) {
        const Vec3 low = origin + Vec3(x, y, 0);
        const SE3 pose{.R = rotation(Vec3::UnitY(), lean).R, .p = low + crank / 2};
        const int rod = add_box(scene, Vec3(0.02, 0.04, length), pose, 7800);
        move(rod, speed / 2, omega);
        doubled_hinge(rod, 0, low);
        doubled_hinge(table, rod, low + crank);
      }
    for (int level = 0; level < levels; ++level)
      for (const double x : {-0.1, 0.1}) {
        const SE3 pose{.R = Quat::Identity(), .p = plate + Vec3(x, 0, 0.02 + 0.1 + 0.2 * level)};
        move(add_box(scene, Vec3(0.2, 0.2, 0.2), pose, 1000), speed, Vec3::Zero());
      }
  }
  touch_faces(scene, 1e-9, coulomb(random.uniform(0.1, 0.8)));
  scene.h = random.log_uniform(1e-4, 1e-2);
  return scene;
}

FrictionScene mixed_laws(int contacts, Random& random) {
  const int units = std::max(1, int(std::lround((contacts + 4) / 20.0)));
  const double mu = random.uniform(0.1, 0.8), radius = 0.02, length = 0.3;
  const Law rolls = rolling(mu, random.log_uniform(1e-5, 1e-3));
  FrictionScene scene;
  const int ground = add_ground(scene, units * length + 1);
  for (int unit = 0; unit < units; ++unit) {
    const Vec3 origin(length * unit, 0, 0);
    const int plank = add_box(scene, Vec3(length, 0.16, 0.02),
                              {.R = Quat::Identity(), .p = origin + Vec3(0, 0, 0.05)}, 700);
    scene.bodies.back().twist.head<3>() = random.vector(0.05);
    for (const double x : {-0.1, 0.1})
      for (const double y : {-0.05, 0.05}) {
        const Vec3 centre = origin + Vec3(x, y, radius);
        const int ball = add_ball(scene, radius, centre, 7800);
        scene.contacts.push_back(
            contact(ball, ground, centre - radius * Vec3::UnitZ(), Vec3::UnitZ(), rolls));
        scene.contacts.push_back(contact(plank, ball, centre + radius * Vec3::UnitZ(), Vec3::UnitZ(), rolls));
      }
    add_box(scene, Vec3(0.05, 0.05, 0.05), {.R = Quat::Identity(), .p = origin + Vec3(0.08, 0, 0.085)}, 2000);
    // the arm: a hinge with friction and a stop, and a flat tip that presses on the plank
    const Vec3 tip = origin + Vec3(-0.05, 0, 0.06), pivot = tip + Vec3(0, 0.4, 0.1), along = pivot - tip;
    const SE3 pose{.R = rotation(Vec3::UnitX(), std::atan2(along.z(), along.y())).R, .p = (tip + pivot) / 2};
    const int arm = add_box(scene, Vec3(0.02, along.norm(), 0.02), pose, 7800);
    const Vec3 turn = random.uniform(-0.5, 0.5) * Vec3::UnitX();
    scene.bodies.back().twist << turn.cross(Vec3(pose.p - pivot)), turn;
    scene.contacts.push_back(
        contact(arm, plank, tip, Vec3::UnitZ(),
                {.kind = LawKind::contensou, .rows = 4, .mu = mu, .radius = random.log_uniform(1e-3, 1e-2)}));
    scene.contacts.push_back(hinge(arm, ground, pivot, Vec3::UnitX()));
    scene.contacts.push_back(
        about_axis(arm, ground, Vec3::UnitX(), dry_friction(random.log_uniform(1e-5, 1e-2))));
    Interaction stop = about_axis(arm, ground, -Vec3::UnitX(), unilateral());
    stop.gap = random.index(2) == 0 ? 0 : random.log_uniform(1e-6, 1e-3);  // [rad]
    scene.contacts.push_back(stop);
  }
  touch_faces(scene, 1e-9, coulomb(mu));
  scene.h = random.log_uniform(1e-4, 1e-2);
  return scene;
}

}  // namespace aussois
