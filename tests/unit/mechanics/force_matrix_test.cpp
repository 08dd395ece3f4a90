// SPDX-License-Identifier: Apache-2.0
// Blocks of several laws against dense algebra, with bodies that are fixed and axes that are held.
#include "mechanics/force_matrix.hpp"

#include <gtest/gtest.h>

#include "mechanics/layout.hpp"
#include "mechanics/model.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

// Three bodies, the middle one fixed, and two points, of which the second is held along y.
Model some_model() {
  Model model;
  for (int i = 0; i < 3; ++i) add(model, RigidBody{.mass = 1, .inertia = Mat3::Identity()});
  model.bodies[BodyId::at(1)].motion = FixedMotion{};
  add(model,
      Coordinates{
          .name = "points", .size = 6, .points = {{.mass = 1}, {.mass = 1, .held = {false, true, false}}}});
  return model;
}

// A matrix with random numbers, and the same added to a dense one.
ForceMatrix random_matrix(std::shared_ptr<const BlockPattern> pattern, int first, bool damped, Random& random,
                          MatX& K, MatX& C) {
  ForceMatrix out{.pattern = pattern, .first = first};
  out.K.assign(pattern->values(), 0);
  if (damped) out.C.assign(pattern->values(), 0);
  const int size = pattern->size;
  for (int j = 0; j < std::ssize(pattern->entry); ++j)
    for (int k = pattern->begin[std::size_t(j)]; k < pattern->begin[std::size_t(j) + 1]; ++k) {
      MatX block(size, size);
      const auto add = [&](std::vector<double>& values, MatX& dense) {
        for (double& x : block.reshaped()) x = random.uniform(-1, 1);
        const int row = pattern->row[std::size_t(k)];
        const int at = block_at(*pattern, row, j);
        if (size == 6)
          add_to_block<6>(*pattern, at, j, block, values);
        else
          add_to_block<3>(*pattern, at, j, block, values);
        dense.block(first + pattern->entry[std::size_t(row)], first + pattern->entry[std::size_t(j)], size,
                    size) += block;
      };
      add(out.K, K);
      if (damped) add(out.C, C);
    }
  return out;
}

TEST(ForceMatrix, IsTheSumOfItsBlocksBetweenWhatIsFree) {
  Random random(1);
  const Model model = some_model();
  const Layout dofs = layout(model);
  const int n = velocity_count(model);
  MatX K = MatX::Zero(n, n), C = MatX::Zero(n, n);
  const auto chain = block_pattern(6, {0, 6, 12}, {{0, 1}, {1, 2}}),
             ends = block_pattern(6, {0, 12}, {{0, 1}}), points = block_pattern(3, {0, 3}, {{0, 1}});
  const std::vector<ForceMatrix> all{random_matrix(chain, 0, true, random, K, C),
                                     random_matrix(points, 18, false, random, K, C),
                                     random_matrix(ends, 0, false, random, K, C)};
  const MatX free(free_matrix(all, 2, 3, dofs));
  ASSERT_EQ(free.rows(), 18);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int row = any_row_of(dofs, i), column = any_row_of(dofs, j);
      if (row < 0 || column < 0) continue;
      const bool held = row_of(dofs, i) < 0 || row_of(dofs, j) < 0;
      EXPECT_NEAR(free(row, column), held ? 0 : 2 * K(i, j) + 3 * C(i, j), 1e-14) << i << ", " << j;
    }
  VecX dq(n), dv(n);
  for (double& x : dq) x = random.uniform(-1, 1);
  for (double& x : dv) x = random.uniform(-1, 1);
  EXPECT_LT((force_change(all, dq, dv) - K * dq - C * dv).norm(), 1e-13);
}

TEST(ForceMatrix, IsRefusedByName) {
  const auto pattern = block_pattern(6, {0, 6}, {{0, 1}});
  ForceMatrix good{.pattern = pattern, .K = std::vector<double>(pattern->values())};
  EXPECT_EQ(message_of([&] { validate(good, 12); }), "");
  expect_names(message_of([&] { validate(ForceMatrix{}, 12); }), "ForceMatrix::pattern must not be null");
  ForceMatrix bad = good;
  bad.K.pop_back();
  expect_names(message_of([&] { validate(bad, 12); }), "ForceMatrix::K.size() = 143 must be 144");
  bad = good, bad.C = {1};
  expect_names(message_of([&] { validate(bad, 12); }), "ForceMatrix::C.size() = 1 must be 0 or 144");
  expect_names(message_of([&] { validate(good, 11); }), "last entry of ForceMatrix = 11 must be below 11");
  bad = good, bad.first = -1;
  expect_names(message_of([&] { validate(bad, 12); }), "first entry of ForceMatrix = -1 must be at least 0");
}

}  // namespace
}  // namespace aussois
