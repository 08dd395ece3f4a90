// SPDX-License-Identifier: Apache-2.0
// What the tests of io write and read: a made-up run.
#pragma once

#include <cmath>

#include "io/run_file.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {

/// A tube of `sides` around z between two radii; with inner = 0 a solid cylinder [m].
inline RunMesh tube_mesh(double inner, double outer, double bottom, double top, int sides) {
  RunMesh mesh;
  for (int i = 0; i < sides; ++i) {
    const double angle = 2 * kPi * i / sides;
    for (const double radius : {inner, outer})
      for (const double z : {bottom, top})
        mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  const auto quad = [&mesh](int a, int b, int c, int d) {
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({a, c, d});
  };
  for (int i = 0; i < sides; ++i) {
    const int here = 4 * i,
              next = 4 * ((i + 1) % sides);  // +0 inner bottom, +1 inner top, +2 outer bottom, +3 outer top
    quad(here + 2, next + 2, next + 3, here + 3);
    quad(here + 1, here + 3, next + 3, next + 1);
    quad(here + 0, next + 0, next + 2, here + 2);
    if (inner > 0) quad(here + 0, here + 1, next + 1, next + 0);
  }
  return mesh;
}

/// A peg of 10 mm goes into a bush, tilting a little; up to five contacts, none in the first row.
inline RunHeader peg_header() {
  RunHeader header;
  header.title = "peg in a bush, made up";
  header.command_line = "test_io --peg \"10 mm\"";
  header.build = "a test";
  header.notes = {{"seed", "7"}, {"path", "made up \xC2\xB5m"}};
  header.meshes["bush"] = tube_mesh(0.00515, 0.011, -0.03, 0, 64);
  header.meshes["peg"] = tube_mesh(0, 0.005, 0, 0.03, 64);
  RunBody bush{"bush", "bush", {}, true, 5e-5, 0, Mat3::Zero()};
  RunBody peg{"peg", "peg", translation(0, 0, -0.015), false, 5e-5, 0.0185, Mat3::Identity() * 1.5e-6};
  header.bodies = {bush, peg};
  header.joints = {{"guide", "cylindrical", {1, -1}}, {"clamp", "fixed", {1, 0}}};
  header.blocks = {{"spring", 2}, {"rotor", 1}};
  header.gauges = {"displacement", "work:mu 0.3 e 0 R_e 0"};
  return header;
}

inline RunStep peg_step(int k, int last) {
  const double s = double(k) / last, tilt = 0.05 * std::sin(9 * s), h = 1e-3;
  RunStep step;
  step.step = k;
  step.time = h * k;
  step.pose = {SE3{},
               translation(0.0001 * std::sin(12 * s), 0, 0.022 - 0.034 * s) * rotation(Vec3::UnitY(), tilt)};
  step.velocity = VecX::LinSpaced(12, -s, 1 + s);
  step.q = VecX::LinSpaced(3, s, 2 + s);
  step.q_speed = VecX::LinSpaced(3, -s, 5 * s);
  step.gauges = k == 0 ? Vec2(NAN, NAN) : Vec2(s, -1e-3 * k);
  for (int i = 0; i < 2; ++i) {
    RunJoint joint;
    joint.coordinate = Vec3(0.01 * k + i, 7 * s, 0);
    joint.speed = Vec3(10 - i, 7, s);
    joint.force = Vec3(1 + k, 2, 3 + i);
    joint.torque = Vec3(0.1, 0.2 * i, 0.3 * k);
    joint.effort = Vec3(-s, -i, 0.5);
    joint.translation_error = 1e-15 * (k + 2 * i);
    joint.rotation_error = 1e-14 * (3 * k + i);
    int part = 0;
    for (double* work : {&joint.work_locked, &joint.work_couplings, &joint.work_stops, &joint.work_friction,
                         &joint.work_motors, &joint.work_springs, &joint.work_supports})
      *work = 1e-3 * k + i - 0.1 * part++;
    step.joints.push_back(joint);
  }
  for (int i = 0; i < k % 6; ++i) {
    const double angle = 1.3 * i + 2 * s;
    RunContact contact;
    contact.pair = {0, 1};
    contact.feature = {{{2, 3 * i, 1}, {1, 4 + i, k % 3}}};
    contact.normal = Vec3(std::cos(angle), std::sin(angle), 0);
    contact.gap = 1e-6 * (i - 1);
    contact.point = 0.00508 * contact.normal - Vec3(0, 0, 0.004 * i);
    contact.point_b = contact.point - contact.gap * contact.normal;
    contact.impulse = h * (4.0 + 3 * std::sin(40 * s + i)) * contact.normal + Vec3(0, 0, -1e-3 * h * i);
    step.contacts.push_back(contact);
  }
  step.h = k == 0 ? 0 : h;
  step.contacts_found = 3 * (k % 6);
  step.contacts_kept = k % 6;
  step.contacts_matched = k % 4;
  step.matched_by_key = k % 3;
  step.matched_by_adjacency = k % 5;
  step.matched_by_geometry = k % 7;
  step.unmatched = k % 8;
  step.inherited = k % 9;
  step.attempts = 1 + k % 2;
  step.certificate_rounds = k % 5;
  step.threshold = 1e-4 * (1 + s);
  step.min_gap = step.contacts.empty() ? kInf : -1e-6 - 1e-7 * s;
  step.min_base_distance = 1e-4 - 2e-5 * s;
  step.status = k % 7 == 6 ? 1 : 0;
  step.solver_status = k % 11 == 10 ? 2 : 0;
  step.iterations = 10 + k % 20;
  step.local_failures = k % 2;
  step.local_fail_safes = k % 3;
  step.residual = std::pow(10.0, -6 - 5 * s);
  step.kinetic = 1e-6 * (1 + std::sin(20 * s) * std::sin(20 * s));
  step.gravity = 0.0185 * 9.81 * (0.022 - 0.034 * s);
  step.laws = 1e-4 * s;
  step.gravity_work = 1e-7 * k;
  step.law_work = 2e-7 * k;
  step.contact_work = -3e-7 * k;
  step.gyroscopic_work = 1e-12 * k;
  step.joint_work = 4e-7 * k;
  step.joint_time = step.time - h / 2;
  step.numerical_work = -5e-8 * k;
  step.energy_residual = 1e-18 * k;
  step.coupling_force = Vec3(0.1 * s, 0, -5 - 20 * s + 3 * std::sin(30 * s));
  step.coupling_torque = Vec3(0, 0.01 * s, 0);
  step.seconds_contact = 1e-4 * k;
  step.seconds_solve = 2e-4 * k;
  step.seconds_certificate = 3e-4 * k;
  step.seconds_total = 7e-4 * k;
  return step;
}

inline RunData peg_run(int steps) {
  RunData run{peg_header(), {}};
  for (int k = 0; k < steps; ++k) run.steps.push_back(peg_step(k, steps - 1));
  return run;
}

}  // namespace aussois
