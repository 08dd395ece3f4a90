// SPDX-License-Identifier: Apache-2.0
#include "reduction/mean_contacts.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "geometry/settings.hpp"
#include "reduction/contact_order.hpp"

namespace aussois {
namespace {

constexpr Named<MeanRule> kRules[] = {{MeanRule::position_normal_friction, "position_normal_friction"},
                                      {MeanRule::position_depth, "position_depth"},
                                      {MeanRule::position, "position"}};

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

// A contact with all that its mean needs.
struct Member {
  const ContactPoint* contact = nullptr;
  double weight = 1, mu = 0, force = 1;
};

MeanContact mean_of(const std::vector<Member>& members) {
  MeanContact mean{.mu_min = kInf, .count = int(members.size())};
  Vec3 p = Vec3::Zero(), normal = Vec3::Zero();
  double weight = 0, gap = kInf, mu = 0, force = 0, mu_by_force = 0;
  for (const Member& m : members) {
    p += m.weight * mid_point(*m.contact);
    normal += m.weight * m.contact->normal;
    weight += m.weight;
    gap = std::min(gap, m.contact->gap);
    mu += m.mu;
    force += m.force;
    mu_by_force += m.force * m.mu;
    mean.mu_min = std::min(mean.mu_min, m.mu);
    mean.mu_max = std::max(mean.mu_max, m.mu);
  }
  p /= weight;
  mean.mu = force > 0 ? mu_by_force / force : mu / double(members.size());
  mean.point = *std::ranges::min_element(members, {}, [&](const Member& m) {
                  return (mid_point(*m.contact) - p).squaredNorm();
                })->contact;
  mean.cancelled = normal.norm() <= 1e-6 * weight;
  if (!mean.cancelled) mean.point.normal = normal.normalized();
  mean.point.gap = gap;
  mean.point.x_a = p + gap / 2 * mean.point.normal;
  mean.point.x_b = p - gap / 2 * mean.point.normal;
  return mean;
}

}  // namespace

void describe(SettingVisitor& visit, MeanContactOptions& o) {
  visit.begin("MeanContactOptions");
  visit.choice({"rule", "space in which contacts are near"}, o.rule, kRules);
  visit.count({"k", "number of means", "", range_from(1)}, o.k);
  visit.number({.name = "normal_length",
                .what = "length that a unit change of the normal counts as",
                .unit = "m",
                .range = range_from(0),
                .only_for = "position_normal_friction"},
               o.normal_length);
  visit.number({.name = "friction_length",
                .what = "length that a unit change of friction counts as",
                .unit = "m",
                .range = range_from(0),
                .only_for = "position_normal_friction"},
               o.friction_length);
  visit.number({.name = "depth_floor",
                .what = "added to the depth to give the weight of a contact",
                .unit = "m",
                .range = range_above(0),
                .only_for = "position_depth"},
               o.depth_floor);
  visit.count({"max_iterations", "iterations of k-means", "", range_from(0)}, o.max_iterations);
}

void validate(const MeanContactOptions& options) {
  check_options(options);
}

MeanContacts mean_contacts(const ContactSet& found, const std::vector<double>& mu,
                           const std::vector<double>& force, const MeanContactOptions& options) {
  validate(options);
  check(found, mu, force);
  const std::size_t n = found.points.size();
  MeanContacts out{.label = std::vector<int>(n)};
  if (n == 0) return out;

  const std::vector<int> order = canonical_order(found);
  std::vector<Member> members;
  for (const int at : order) {
    const std::size_t i = std::size_t(at);
    members.push_back(
        {.contact = &found.points[i], .mu = mu.empty() ? 0 : mu[i], .force = force.empty() ? 1 : force[i]});
    if (options.rule == MeanRule::position_depth)
      members.back().weight = depth(found.points[i]) + options.depth_floor;  // (CLU-7)
  }
  MatX z(options.rule == MeanRule::position_normal_friction ? 7 : 3, Eigen::Index(n));
  VecX weight = VecX::Ones(Eigen::Index(n));
  for (std::size_t k = 0; k < n; ++k) {
    z.col(Eigen::Index(k)) = coordinates(*members[k].contact, members[k].mu, options);
    weight[Eigen::Index(k)] = members[k].weight;
  }
  out.found = kmeans(z, weight,
                     {.k = options.k, .seeding = options.seeding, .max_iterations = options.max_iterations});
  out.centres = out.found.centres;

  for (int g = 0; g < int(out.centres.cols()); ++g) {
    std::vector<Member> group;
    for (std::size_t k = 0; k < n; ++k) {
      if (out.found.label[k] != g) continue;
      group.push_back(members[k]);
      out.label[order[k]] = int(out.contacts.size());
    }
    if (group.empty()) continue;
    const MeanContact mean = mean_of(group);
    out.cancelled += mean.cancelled ? 1 : 0;
    if (mean.mu_max > 0) out.mu_spread = std::max(out.mu_spread, mean.mu_max / mean.mu_min);
    out.contacts.push_back(mean);
  }
  return out;
}

}  // namespace aussois
