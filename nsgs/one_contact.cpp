// SPDX-License-Identifier: Apache-2.0
#include "nsgs/one_contact.hpp"

#include <cmath>

#include "nsgs/block_solver.hpp"

namespace aussois {

LocalSolution solve_one_contact(const Mat3& W, const Vec3& q, double mu, const Vec3& r_start,
                                LocalSolver solver) {
  const double w = W.trace() / 3, size = q.norm();
  if (!(W.allFinite() && std::isfinite(size) && w > 0 && std::isfinite(w))) return {.solved = false};
  if (q[0] >= 0) return {};  // separation (ONE-1)
  const Law law = coulomb(mu);
  const double unit = size / w;
  const Vec3 start = r_start.allFinite() ? block_answer<3>(law, r_start / unit) : Vec3(Vec3::Zero());
  const BlockSolution<3> found = solve_block(prepare_block(Mat3(W / w), law), q / size, law, start, solver);
  return {.r = found.r * unit, .solved = found.solved, .fail_safe = found.fail_safe};
}

}  // namespace aussois
