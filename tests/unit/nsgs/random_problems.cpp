// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/nsgs/random_problems.hpp"

#include <cmath>

#include <Eigen/Geometry>

namespace aussois {

VecX uniform_vector(Random& random, int size, double low, double high) {
  VecX x(size);
  for (int i = 0; i < size; ++i) x[i] = random.uniform(low, high);
  return x;
}

Mat3 random_rotation(Random& random) {
  const Vec3 axis = Vec3(uniform_vector(random, 3, -1, 1)).normalized();
  return Eigen::AngleAxisd(random.uniform(-kPi, kPi), axis).toRotationMatrix();
}

SparseMatrix contact_directions(int bodies, const std::vector<ContactSpec>& contacts) {
  std::vector<Triplet> entries;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const ContactSpec& contact = contacts[c];
    const Vec3 t1 = contact.normal.unitOrthogonal(), t2 = contact.normal.cross(t1);
    const Vec3 axes[3] = {contact.normal, t1, t2};
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        const int column = 3 * int(c) + j;
        entries.emplace_back(6 * contact.a + i, column, axes[j][i]);
        entries.emplace_back(6 * contact.a + 3 + i, column, contact.x_a.cross(axes[j])[i]);
        if (contact.b < 0) continue;
        entries.emplace_back(6 * contact.b + i, column, -axes[j][i]);
        entries.emplace_back(6 * contact.b + 3 + i, column, -contact.x_b.cross(axes[j])[i]);
      }
  }
  SparseMatrix H(6 * bodies, 3 * Eigen::Index(contacts.size()));
  H.setFromTriplets(entries.begin(), entries.end());
  return H;
}

SparseMatrix block_diagonal(const std::vector<MatX>& blocks) {
  std::vector<Triplet> entries;
  int row = 0;
  for (const MatX& block : blocks) {
    for (int i = 0; i < int(block.rows()); ++i)
      for (int j = 0; j < int(block.cols()); ++j)
        if (block(i, j) != 0) entries.emplace_back(row + i, row + j, block(i, j));
    row += int(block.rows());
  }
  SparseMatrix M(row, row);
  M.setFromTriplets(entries.begin(), entries.end());
  return M;
}

FrictionProblem random_peg_in_hole(Random& random, int bodies, int contacts, double mu) {
  const double radius = random.log_uniform(1e-3, 0.05), length = radius * random.uniform(1, 6), h = 5e-4;
  const double tilt = random.uniform(0, 1) < 0.5 ? 0 : kPi / 6;  // flank of a thread
  const Mat3 R = random_rotation(random);
  std::vector<MatX> mass;
  for (int b = 0; b < bodies; ++b) {
    const double m = random.log_uniform(0.01, 1), across = m * (3 * radius * radius + length * length) / 12;
    const Vec3 principal(across, across, m * radius * radius / 2);
    const Vec3 spin = uniform_vector(random, 3, -1e-3, 1e-3);
    Mat3 gyroscopic;
    gyroscopic << 0, -spin[2], spin[1], spin[2], 0, -spin[0], -spin[1], spin[0], 0;
    mass.push_back(m * Mat3::Identity());
    mass.push_back(R * (Mat3(principal.asDiagonal()) + across * gyroscopic) * R.transpose());
  }
  FrictionProblem problem;
  problem.M = block_diagonal(mass);
  problem.laws.assign(std::size_t(contacts), coulomb(mu));
  problem.w = VecX::Zero(3 * contacts);
  const double clearance = radius * random.log_uniform(1e-5, 1e-2);
  const Vec3 offset = bodies == 1 ? Vec3::Zero() : Vec3(radius * uniform_vector(random, 3, -1, 1));
  std::vector<ContactSpec> specs;
  for (int c = 0; c < contacts; ++c) {
    const double angle = random.uniform(-kPi, kPi), place = random.uniform(0, 1);
    const Vec3 out(std::cos(angle), std::sin(angle), 0);
    ContactSpec spec{.a = 0, .b = bodies == 1 ? -1 : 1};
    if (place < 0.2) {  // end face
      spec.x_a = radius * std::sqrt(random.uniform(0, 1)) * out - length / 2 * Vec3::UnitZ();
      spec.normal = Vec3::UnitZ();
    } else {  // rings
      const double side = place < 0.6 ? 1 : -1;
      spec.x_a = radius * out + side * length / 2 * Vec3::UnitZ();
      spec.normal = -std::cos(tilt) * out + side * std::sin(tilt) * Vec3::UnitZ();
    }
    spec.x_a = R * spec.x_a;
    spec.x_b = spec.x_a + offset;
    spec.normal = R * spec.normal;
    specs.push_back(spec);
    if (random.uniform(0, 1) > 0.3) problem.w[3 * c] = clearance * random.uniform(0, 1) / h;
  }
  problem.H = contact_directions(bodies, specs);
  VecX v(6 * bodies);
  const double speed = random.log_uniform(1e-3, 1);
  for (int b = 0; b < bodies; ++b) {
    v.segment<3>(6 * b) = speed * uniform_vector(random, 3, -1, 1);
    v.segment<3>(6 * b + 3) = speed / radius * uniform_vector(random, 3, -1, 1);
  }
  problem.f = problem.M * v;
  return problem;
}

FrictionProblem bead_chains(const std::vector<int>& lengths, double mu) {
  const double radius = 0.05, mass = 1;
  std::vector<MatX> masses;
  std::vector<ContactSpec> specs;
  for (const int length : lengths)
    for (int k = 0; k < length; ++k) {
      const int b = int(specs.size());
      masses.push_back(mass * Mat3::Identity());
      masses.push_back(0.4 * mass * radius * radius * Mat3::Identity());
      const Vec3 normal = Vec3(0.2 * std::sin(b), 0.2 * std::cos(3 * b), 1).normalized();
      specs.push_back({.a = b,
                       .b = k > 0 ? b - 1 : -1,
                       .x_a = -radius * normal,
                       .x_b = radius * normal,
                       .normal = normal});
    }
  const int beads = int(specs.size());
  FrictionProblem problem;
  problem.M = block_diagonal(masses);
  problem.H = contact_directions(beads, specs);
  problem.f = VecX::Zero(6 * beads);
  for (int b = 0; b < beads; ++b)
    problem.f.segment<3>(6 * b) = mass * Vec3(0.2 * std::cos(b), 0.1, -0.5 - std::sin(2 * b));
  problem.w = VecX::Zero(3 * beads);
  problem.laws.assign(specs.size(), coulomb(mu));
  return problem;
}

FrictionProblem cube_stack(int n, double m, double mu) {
  const double edge = 0.1, h = 1e-3, gravity = 9.81;
  std::vector<MatX> mass;
  std::vector<ContactSpec> specs;
  for (int b = 0; b < n; ++b) {
    mass.push_back(m * Mat3::Identity());
    mass.push_back(m * edge * edge / 6 * Mat3::Identity());
    for (const double x : {-1.0, 1.0})
      for (const double y : {-1.0, 1.0})
        specs.push_back(
            {.a = b, .b = b - 1, .x_a = edge / 2 * Vec3(x, y, -1), .x_b = edge / 2 * Vec3(x, y, 1)});
  }
  FrictionProblem problem;
  problem.M = block_diagonal(mass);
  problem.H = contact_directions(n, specs);
  problem.f = VecX::Zero(6 * n);
  for (int b = 0; b < n; ++b) problem.f[6 * b + 2] = -h * m * gravity;
  problem.w = VecX::Zero(3 * Eigen::Index(specs.size()));
  problem.laws.assign(specs.size(), coulomb(mu));
  return problem;
}

}  // namespace aussois
