// SPDX-License-Identifier: Apache-2.0
// Reduces contacts by making new ones: each group of k-means is replaced by its mean. Engines and papers do
// this. The means lie inside the hull of what they stand for, so they carry less than it (CLU-8). Use them
// for comparison, and where a bounded number of contacts matters more than what they can carry.
#pragma once

#include "lmd/contact_point.hpp"
#include "reduction/kmeans.hpp"

namespace aussois {

class SettingVisitor;

enum class MeanRule {
  position_normal_friction,  // seven dimensions (CLU-6) [Hauser2013]
  position_depth,            // weighted by depth, for penalty forces (CLU-7) [Kim2003]
  position,                  // KMC, and KMCW with previous centres [Kim2019]
};

/// `describe` gives the ranges, and with which choice an option is read: with others only its default is
/// taken.
struct MeanContactOptions {
  MeanRule rule = MeanRule::position;
  int k = 3;
  double normal_length = 0.1;    // a unit change of the normal counts as this [m]; 0.1: as Klampt
  double friction_length = 0.1;  // a unit change of mu counts as this [m]
  double depth_floor = 1e-6;     // the weight of a contact is its depth plus this [m]
  int max_iterations = 100;
  KMeansSeeding seeding{};  // SeedWarm{previous.centres}: as KMCW, idempotent
};
void validate(const MeanContactOptions& options);  // throws std::invalid_argument: field, value, bound
void describe(SettingVisitor& visit, MeanContactOptions& options);

struct MeanContact {
  ContactPoint point{};  // with the features of the member nearest to the mean; x_a - x_b = gap * normal
  double mu = 0, mu_min = 0, mu_max = 0;  // weighted mean, least and largest of the members
  int count = 0;                          // number of members
  bool cancelled = false;                 // the normals cancel; `point` has that of the nearest member
};

struct MeanContacts {
  std::vector<MeanContact> contacts{};
  std::vector<int> label{};  // for each contact of the set, the mean that stands for it
  MatX centres{};            // in the space of the rule, for SeedWarm
  double mu_spread = 1;      // largest ratio mu_max / mu_min of any mean; report it above 1.2
  int cancelled = 0;         // number of means whose normals cancelled
  KMeans found{};            // the result of k-means, for the contacts in canonical order
};

/// The contacts must be of one body pair. `mu` has one entry per contact or none (all zero). `force` weights
/// the mean of mu; it has one entry >= 0 per contact, or none (all one). Normals are weighted like points;
/// the gap is the least of the members. Apart from random seeds, the order of the set does not matter. Throws
/// std::invalid_argument if numbers are not finite, sizes are wrong, or there are several pairs.
MeanContacts mean_contacts(const ContactSet& found, const std::vector<double>& mu,
                           const std::vector<double>& force, const MeanContactOptions& options = {});

}  // namespace aussois
