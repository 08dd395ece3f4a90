// SPDX-License-Identifier: Apache-2.0
// Friction problems for the tests of nsgs: random ones of the kind an assembly replay poses, and stacks whose
// answer is known by hand.
#pragma once

#include "nsgs/friction_problem.hpp"
#include "tests/support/random.hpp"

namespace aussois {

VecX uniform_vector(Random& random, int size, double low, double high);
Mat3 random_rotation(Random& random);

/// A contact of body `a` against body `b` (-1: the fixed world) at arms x_a, x_b from the centres of mass,
/// all in the world; twists are (v_G, omega) in the world.
struct ContactSpec {
  int a = 0, b = -1;
  Vec3 x_a = Vec3::Zero(), x_b = Vec3::Zero(), normal = Vec3::UnitZ();
};
SparseMatrix contact_directions(int bodies, const std::vector<ContactSpec>& contacts);
SparseMatrix block_diagonal(const std::vector<MatX>& blocks);

/// A peg (1e-3 to 0.1 m, 0.01 to 1 kg) in a hole, or a bolt in a nut where the normals are tilted: contacts
/// on two rings and the end face, w = gap / h with some of the gaps closed, a random free velocity that
/// pushes it into the wall. With two bodies the hole is free too. M carries a gyroscopic term, so W is
/// slightly unsymmetric.
FrictionProblem random_peg_in_hole(Random& random, int bodies, int contacts, double mu);

/// Chains of balls under a push from below, one on the other, each chain on the ground and apart from the
/// rest: neighbours alone feel each other.
FrictionProblem bead_chains(const std::vector<int>& lengths, double mu);

/// n cubes of mass m [kg] and edge 0.1 m on a plane, four contacts under each, one step h = 1 ms of gravity.
FrictionProblem cube_stack(int n, double m, double mu);

}  // namespace aussois
