// SPDX-License-Identifier: Apache-2.0
#include "reduction/mean_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "geometry/check.hpp"
#include "reduction/contact_order.hpp"

namespace aussois {
namespace {

Vec3 mid_point(const ContactPoint& c) {
  return 0.5 * (c.x_a + c.x_b);
}

double depth(const ContactPoint& c) {
  return std::max(0.0, -c.gap);
}

void check(const ContactSet& found, const std::vector<double>& mu, const std::vector<double>& force) {
  const auto check_size = [&](const std::vector<double>& x, const char* name) {
    require(x.empty() || x.size() == found.points.size(),
            "mean_contacts: " + std::to_string(x.size()) + " entries of " + name + " for " +
                std::to_string(found.points.size()) + " contacts");
    require(std::ranges::all_of(x, [](double y) { return y >= 0 && std::isfinite(y); }),
            std::string("mean_contacts: ") + name + " must be finite and at least 0");
  };
  check_size(mu, "mu");
  check_size(force, "force");
  for (std::size_t i = 0; i < found.points.size(); ++i) {
    const ContactPoint& c = found.points[i];
    const std::string name = "mean_contacts: contact " + std::to_string(i);
    require(c.x_a.allFinite() && c.x_b.allFinite() && std::isfinite(c.gap) && c.normal.allFinite(),
            name + ": points, normal and gap must be finite");
    require(c.a.body == found.points[0].a.body && c.b.body == found.points[0].b.body,
            name + " is of another pair");
  }
}

// Where a contact stands for k-means, in the coordinates of the rule [m].
VecX coordinates(const ContactPoint& c, double mu, const MeanContactOptions& o) {
  if (o.rule != MeanRule::position_normal_friction) return mid_point(c);
  VecX z(7);
  z << mid_point(c), o.normal_length * c.normal, o.friction_length * mu;  // (CLU-6)
  return z;
}

}  // namespace

void validate(const MeanContactOptions& o) {
  require_field(o.k >= 1, "MeanContactOptions::k", o.k, "be at least 1");
  require_field(o.normal_length >= 0, "MeanContactOptions::normal_length", o.normal_length,
                "be at least 0 m");
  require_field(o.friction_length >= 0, "MeanContactOptions::friction_length", o.friction_length,
                "be at least 0 m");
  require_field(o.depth_floor > 0, "MeanContactOptions::depth_floor", o.depth_floor, "be > 0 m");
  require_field(o.max_iterations >= 0, "MeanContactOptions::max_iterations", o.max_iterations,
                "be at least 0");
}

MeanContacts mean_contacts(const ContactSet& found, const std::vector<double>& mu,
                           const std::vector<double>& force, const MeanContactOptions& options) {
  validate(options);
  check(found, mu, force);
  const std::size_t n = found.points.size();
  MeanContacts out{.label = std::vector<int>(n)};
  if (n == 0) return out;

  const std::vector<int> order = canonical_order(found);
  const auto mu_of = [&](int i) { return mu.empty() ? 0 : mu[std::size_t(i)]; };
  const auto force_of = [&](int i) { return force.empty() ? 1 : force[std::size_t(i)]; };
  const auto point = [&](int i) -> const ContactPoint& { return found.points[std::size_t(i)]; };
  const int rows = options.rule == MeanRule::position_normal_friction ? 7 : 3;
  MatX z(rows, Eigen::Index(n));
  VecX weight = VecX::Ones(Eigen::Index(n));
  for (std::size_t i = 0; i < n; ++i) {
    z.col(Eigen::Index(i)) = coordinates(point(order[i]), mu_of(order[i]), options);
    if (options.rule == MeanRule::position_depth)  // (CLU-7)
      weight[Eigen::Index(i)] = depth(point(order[i])) + options.depth_floor;
  }
  out.found = kmeans(z, weight,
                     {.k = options.k, .seeding = options.seeding, .max_iterations = options.max_iterations});
  out.centres = out.found.centres;

  for (int g = 0; g < int(out.centres.cols()); ++g) {
    std::vector<int> members;  // positions in the order
    for (int i = 0; i < int(n); ++i)
      if (out.found.label[std::size_t(i)] == g) members.push_back(i);
    if (members.empty()) continue;
    Vec3 p = Vec3::Zero(), normal = Vec3::Zero();
    double sum = 0, gap = kInf, mu_sum = 0, mu_plain = 0, force_sum = 0;
    MeanContact mean{.mu_min = kInf, .mu_max = 0, .count = int(members.size())};
    for (const int i : members) {
      const int at = order[std::size_t(i)];
      p += weight[i] * mid_point(point(at));
      normal += weight[i] * point(at).normal;
      sum += weight[i];
      gap = std::min(gap, point(at).gap);
      mu_sum += force_of(at) * mu_of(at);
      mu_plain += mu_of(at);
      force_sum += force_of(at);
      mean.mu_min = std::min(mean.mu_min, mu_of(at));
      mean.mu_max = std::max(mean.mu_max, mu_of(at));
      out.label[std::size_t(at)] = int(out.contacts.size());
    }
    p /= sum;
    const int nearest = *std::ranges::min_element(
        members, {}, [&](int i) { return (mid_point(point(order[std::size_t(i)])) - p).squaredNorm(); });
    mean.point = point(order[std::size_t(nearest)]);
    if (normal.norm() > 1e-6 * sum)
      mean.point.normal = normal.normalized();
    else
      ++out.cancelled;
    mean.point.gap = gap;
    mean.point.x_a = p + gap / 2 * mean.point.normal;
    mean.point.x_b = p - gap / 2 * mean.point.normal;
    mean.mu = force_sum > 0 ? mu_sum / force_sum : mu_plain / double(members.size());
    if (mean.mu_max > 0) out.mu_spread = std::max(out.mu_spread, mean.mu_max / mean.mu_min);
    out.contacts.push_back(mean);
  }
  return out;
}

}  // namespace aussois
