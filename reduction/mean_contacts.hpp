// SPDX-License-Identifier: Apache-2.0
// Fewer contacts by making new ones: each group of k-means gives its mean. What engines and papers do; the
// means lie inside the hull of what they stand for, so they carry less than it (CLU-8): for comparison, and
// where a bounded number of contacts matters more than what they can carry.
#pragma once

#include "lmd/contact_point.hpp"
#include "reduction/kmeans.hpp"

namespace aussois {

enum class MeanRule {
  position_normal_friction,  // seven dimensions (CLU-6) [Hauser2013]
  position_depth,            // weighted by depth, for penalty forces (CLU-7) [Kim2003]
  position,                  // KMC, and KMCW with previous centres [Kim2019]
};

struct MeanContactOptions {
  MeanRule rule = MeanRule::position;
  int k = 3;                     // >= 1
  double normal_length = 0.1;    // what a change of the normal by one counts as [m], >= 0; 0.1: as Klampt
  double friction_length = 0.1;  // what a change of mu by one counts as [m], >= 0
  double depth_floor = 1e-6;     // weight of a contact is its depth plus this [m], > 0
  int max_iterations = 100;      // >= 0
  KMeansSeeding seeding{};       // SeedWarm{previous.centres}: as KMCW, idempotent
};
void validate(const MeanContactOptions& options);  // throws std::invalid_argument: field, value, bound

struct MeanContact {
  ContactPoint point{};  // features: of the member nearest to the mean. x_a - x_b = gap * normal
  double mu = 0, mu_min = 0, mu_max = 0;  // weighted mean, bounds of the members
  int count = 0;                          // of members
  bool cancelled = false;                 // their normals cancel; the nearest member's stands here
};

struct MeanContacts {
  std::vector<MeanContact> contacts{};
  std::vector<int> label{};  // of each contact of the set: which mean stands for it
  MatX centres{};            // in the space of the rule, for SeedWarm
  double mu_spread = 1;      // largest ratio mu_max / mu_min of a mean; report above 1.2
  int cancelled = 0;         // means whose normals cancelled
  KMeans found{};            // of the contacts in canonical order
};

/// Contacts of one body pair; `mu` one per contact or none (zero), `force` weights for the mean of mu
/// one per contact >= 0, or none: all one. Normals are weighted like points, gaps are the least of
/// the members. Does not depend on the order of the set but for random seeds. Throws std::invalid_argument on
/// numbers that are not finite, wrong sizes, or several pairs.
MeanContacts mean_contacts(const ContactSet& found, const std::vector<double>& mu,
                           const std::vector<double>& force, const MeanContactOptions& options = {});

}  // namespace aussois
