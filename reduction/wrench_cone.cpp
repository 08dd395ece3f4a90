// SPDX-License-Identifier: Apache-2.0
#include "reduction/wrench_cone.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "reduction/body_frame.hpp"
#include "reduction/contact_memory.hpp"

namespace aussois {
namespace {

constexpr double kRounding = 1e-9;  // of a factor
constexpr double kTied = 1e-6;      // of a reach or a length: below it rounding would choose

Generators columns_of(const UnitWrenches& all, std::span<const int> members) {
  Eigen::Index count = 0;
  for (const int k : members) count += all.first[std::size_t(k) + 1] - all.first[k];
  Generators out(6, count);
  Eigen::Index at = 0;
  for (const int k : members)
    for (int j = all.first[k]; j < all.first[std::size_t(k) + 1]; ++j) out.col(at++) = all.g.col(j);
  return out;
}

// Projects on the directions in which the columns truly reach. Parallel normals have five; in a sixth only
// the last digits differ, and no choice of contacts could follow them.
Mat6 span_of(const Generators& g) {
  const Eigen::SelfAdjointEigenSolver<Mat6> directions(Mat6(g * g.transpose()));
  const Vec6 reach = directions.eigenvalues().cwiseMax(0).cwiseSqrt();
  Mat6 out = Mat6::Zero();
  for (int i = 0; i < 6; ++i)
    if (reach[i] > kTied * reach.maxCoeff())
      out += directions.eigenvectors().col(i) * directions.eigenvectors().col(i).transpose();
  return out;
}

// The least sum of weights that makes this wrench of the kept ones (RED-12).
Combination smallest_factor(const Generators& kept, const ShortVector& wrench) {
  return cheapest_combination(kept, wrench, VecX::Ones(kept.cols()));
}

int owner(const UnitWrenches& all, Eigen::Index column) {
  return int(std::upper_bound(all.first.begin(), all.first.end(), int(column)) - all.first.begin()) - 1;
}

// The member that reaches farthest in a direction of wrenches, of those as far the first.
int best_server(const UnitWrenches& all, const ShortVector& direction) {
  const Eigen::RowVectorXd reach = direction.transpose() * all.g;
  const double far = reach.maxCoeff() - kTied * reach.cwiseAbs().maxCoeff();
  Eigen::Index column = 0;
  while (reach[column] < far) ++column;
  return owner(all, column);
}

// All wrenches, the longest first, those as long in their order.
std::vector<Eigen::Index> longest_first(const UnitWrenches& all) {
  const Eigen::RowVectorXd length = all.g.colwise().norm();
  std::vector<Eigen::Index> order(all.g.cols());
  std::iota(order.begin(), order.end(), 0);
  const double grid = kTied * (order.empty() ? 1 : length.maxCoeff());
  std::ranges::stable_sort(order, std::ranges::greater(),
                           [&](Eigen::Index j) { return std::round(length[j] / grid); });
  return order;
}

}  // namespace

UnitWrenches unit_wrenches(const ReductionInput& input, std::span<const int> members) {
  const auto contact = [&](int i) -> const ContactPoint& { return input.contacts.points[i]; };
  Vec3 mean = Vec3::Zero();
  for (const int i : members) mean += mid_point(contact(i)) / double(members.size());
  double length = 0;
  for (const int i : members) length = std::max(length, (mid_point(contact(i)) - mean).norm());
  if (length == 0) length = 1;

  UnitWrenches out{.g = Generators(6, Eigen::Index(kFacets * members.size())), .first = {0}};
  int at = 0;
  for (const int i : members) {
    const Mat3 axes = pose_of(input.g, contact(i).a.body).R.toRotationMatrix();
    const Mat3 frame = axes.transpose() * body_frame(contact(i).normal, axes);
    const double mu = input.mu.empty() ? 0 : input.mu[i];
    const Vec3 arm = axes.transpose() * (mid_point(contact(i)) - mean) / length;
    for (int k = 0; k < (mu > 0 ? kFacets : 1); ++k) {
      const double angle = 2 * kPi * k / kFacets;
      const Vec3 force = frame * Vec3(1, mu * std::cos(angle), mu * std::sin(angle));
      out.g.col(at++) << force, arm.cross(force);
    }
    out.first.push_back(at);
  }
  out.g.conservativeResize(6, at);
  const ShortVector centre = out.g.rowwise().mean();
  out.g.colwise() -= centre;
  out.g = (span_of(out.g) * out.g).eval();
  return out;
}

double wrench_factor(const UnitWrenches& all, std::span<const int> kept) {
  const Generators G = columns_of(all, kept);
  double factor = 1;
  for (Eigen::Index j = 0; j < all.g.cols(); ++j)
    if (std::ranges::find(kept, owner(all, j)) == kept.end())
      factor = std::max(factor, smallest_factor(G, all.g.col(j)).cost);
  return factor;
}

// Each wrench in turn, the longest moments first; what serves the direction in which it falls short joins.
// Those that were served before stay so, because the part only grows.
std::vector<int> wrench_cone(const UnitWrenches& all, std::vector<int> start, double loss) {
  const double allowed = 1 / (1 - loss) + kRounding;
  std::vector<int> kept = std::move(start);
  Generators G = columns_of(all, kept);
  const auto has = [&](int member) { return std::ranges::find(kept, member) != kept.end(); };
  for (const Eigen::Index j : longest_first(all)) {
    while (!has(owner(all, j))) {
      const Combination found = smallest_factor(G, all.g.col(j));
      if (found.cost <= allowed) break;
      const int server = best_server(all, found.dual);
      kept.push_back(has(server) ? owner(all, j) : server);  // within rounding of what is kept: itself
      G = columns_of(all, kept);
    }
  }
  std::sort(kept.begin(), kept.end());
  return kept;
}

}  // namespace aussois
