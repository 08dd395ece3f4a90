// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/nsgs/planted_problem.hpp"

#include <Eigen/LU>

namespace aussois {

namespace {

AnyRows unit_vector(Random& random, int rows) {
  for (;;) {
    AnyRows x(rows);
    for (int i = 0; i < rows; ++i) x[i] = random.uniform(-1, 1);
    if (x.norm() > 0.1) return x.normalized();
  }
}

struct Pair {
  AnyRows u{}, r{};
};

Pair planted_pair(Random& random, const Law& law) {
  Pair out{AnyRows::Zero(law.rows), AnyRows::Zero(law.rows)};
  if (law.kind == LawKind::bilateral) {
    const double length = random.uniform(0.1, 1);
    out.r = length * unit_vector(random, law.rows);
    return out;
  }
  if (has_normal(law)) {
    if (random.uniform() < 1.0 / 3) {  // open: the tangents may do anything
      const double length = random.uniform(0.1, 1);
      out.u = length * unit_vector(random, law.rows);
      out.u[0] = std::abs(out.u[0]) + 0.1;
      return out;
    }
    out.r[0] = random.uniform(0.1, 1);
  }
  for (const Ball& ball : balls(law)) {
    const double radius = ball.mu * out.r[0] + ball.limit;
    const AnyRows along = unit_vector(random, ball.rows);
    if (random.uniform() < 0.5) {
      out.r.segment(ball.first, ball.rows) = 0.6 * radius * along;
    } else {
      out.r.segment(ball.first, ball.rows) = -radius * along;
      out.u.segment(ball.first, ball.rows) = random.uniform(0.1, 1) * along;
    }
  }
  if (law.kind == LawKind::contensou) {  // the ball is one of (r_T, r_D / radius), (u_T, radius u_D)
    out.r[3] *= law.radius;
    out.u[3] /= law.radius;
  }
  return out;
}

}  // namespace

std::vector<Law> random_laws(Random& random, int count) {
  std::vector<Law> laws;
  for (int c = 0; c < count; ++c) {
    const double mu = random.uniform(0.05, 0.4);
    const Law kinds[] = {coulomb(mu),
                         rolling(mu, random.uniform(0.01, 0.1)),
                         contensou(mu, random.uniform(0.2, 0.5)),
                         unilateral(),
                         dry_friction(random.uniform(0.05, 0.5)),
                         coulomb_2d(mu),
                         bilateral(1 + random.index(3))};
    laws.push_back(kinds[c % 7]);
  }
  return laws;
}

Planted planted(Random& random, const std::vector<Law>& laws, int velocities, double gyroscopic) {
  Planted out;
  FrictionProblem& problem = out.problem;
  problem.laws = laws;
  const std::vector<int> first = first_rows(laws);
  const int rows = first.back();
  out.u = out.r = VecX::Zero(rows);
  for (std::size_t c = 0; c < laws.size(); ++c) {
    const Pair pair = planted_pair(random, laws[c]);
    out.u.segment(first[c], laws[c].rows) = pair.u;
    out.r.segment(first[c], laws[c].rows) = pair.r;
  }
  std::vector<Triplet> mass, directions;
  for (int b = 0; b < velocities / 3; ++b) {
    const Mat3 factor = Mat3::NullaryExpr([&] { return random.uniform(-1, 1); });
    const Vec3 spin = random.vector();
    Mat3 skew;
    skew << 0, -spin[2], spin[1], spin[2], 0, -spin[0], -spin[1], spin[0], 0;
    const Mat3 block = 0.3 * factor * factor.transpose() + 0.5 * Mat3::Identity() + gyroscopic * skew;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) mass.emplace_back(3 * b + i, 3 * b + j, block(i, j));
  }
  for (int i = 0; i < velocities; ++i)
    for (int j = 0; j < rows; ++j) directions.emplace_back(i, j, random.uniform(-1, 1));
  problem.M.resize(velocities, velocities);
  problem.M.setFromTriplets(mass.begin(), mass.end());
  problem.H.resize(velocities, rows);
  problem.H.setFromTriplets(directions.begin(), directions.end());
  problem.f = VecX::NullaryExpr(velocities, [&] { return random.uniform(-1, 1); });
  const VecX v = MatX(problem.M).partialPivLu().solve(VecX(problem.H * out.r + problem.f));
  problem.w = out.u - problem.H.transpose() * v;
  return out;
}

}  // namespace aussois
