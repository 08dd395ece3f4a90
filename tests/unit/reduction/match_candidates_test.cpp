// SPDX-License-Identifier: Apache-2.0
// Candidates are those that (PER-4) and (PER-5) define, here compared one by one.
#include "reduction/match_candidates.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "geometry/primitives.hpp"
#include "lmd/feature_incidence.hpp"
#include "tests/support/random.hpp"

namespace aussois {
namespace {

std::vector<KeyFeature> features_of(const LmdShape& shape) {
  std::vector<KeyFeature> all;
  for (int dim = 0; dim < 3; ++dim)
    for (int i = 0; i < int(feature_count(shape, dim)); ++i) all.push_back({dim, i});
  return all;
}

LmdShape shape_of(SimplicialComplex complex) {
  return prepare({.complex = std::move(complex), .radius = 1e-3});
}

// Random contacts of two shapes in a cube of 40 mm.
struct Contacts {
  std::vector<PresentContact> now{};
  std::vector<RememberedContact> old{};
  Unmatched unmatched{};

  Contacts(const LmdShape& a, const LmdShape& b, int count, Random& random) {
    const std::vector<KeyFeature> of_a = features_of(a), of_b = features_of(b);
    const auto fill = [&](auto& c) {
      const KeyFeature on_a = of_a[random.index(int(of_a.size()))],
                       on_b = of_b[random.index(int(of_b.size()))];
      c.key = {BodyId::at(0), BodyId::at(1), feature_word(on_a, on_b)};
      c.normal = random.direction();
      c.point_a = 0.02 * random.vector();
      c.point_b = c.point_a + 1e-3 * random.vector();
    };
    for (int i = 0; i < count; ++i) fill(now.emplace_back());
    for (int i = 0; i < count; ++i) fill(old.emplace_back()), old.back().solved = random.index(4) > 0;
    std::ranges::sort(now, {}, &PresentContact::key);
    std::ranges::sort(old, {}, &RememberedContact::key);
    unmatched = {.now = now, .old = old};
    for (int i = 0; i < count; ++i) {
      unmatched.has_name.push_back(char(random.index(4) == 0));
      if (random.index(4) > 0) unmatched.left.push_back(std::size_t(i));
    }
  }
};

std::vector<MatchCandidate> sorted(std::vector<MatchCandidate> all) {
  std::ranges::sort(all);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

std::vector<MatchCandidate> one_by_one(const Unmatched& c, auto&& is_wanted) {
  std::vector<MatchCandidate> all;
  for (std::size_t k = 0; k < c.now.size(); ++k)
    for (std::size_t l : c.left) {
      const PresentContact& now = c.now[k];
      const RememberedContact& old = c.old[l];
      const double apart = std::max((now.point_a - old.point_a).norm(), (now.point_b - old.point_b).norm());
      if ((!c.has_name[k] || old.solved) && now.normal.dot(old.normal) > 0 && is_wanted(k, l, apart))
        all.push_back({squared_distance(now, old), k, l});
    }
  return sorted(std::move(all));
}

TEST(FeatureIncidence, IsToLeadOneToTheOther) {
  for (const SimplicialComplex& complex : {make_box(1, 2, 3, 2), make_sphere(1, 1), make_plate(1, 1, 2, 2),
                                           make_polyline({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}})}) {
    const LmdShape shape = shape_of(complex);
    const std::vector<KeyFeature> all = features_of(shape);
    const auto leads = [&](const KeyFeature& f, const KeyFeature& g) {
      bool found = false;
      for_each_led_to(shape, f, [&](const KeyFeature& h) { found = found || h == g; });
      return found;
    };
    for (const KeyFeature& f : all)
      for (const KeyFeature& g : all)
        EXPECT_EQ(are_incident(shape, f, g), f == g || leads(f, g) || leads(g, f));
  }
}

// Few features on A, as of a plane that carries all, few on B, and many on both.
TEST(MatchCandidates, AreThoseOfTheDefinition) {
  const LmdShape box = shape_of(make_box(1, 2, 3)), ball = shape_of(make_sphere(1, 2));
  Random random(1);
  std::size_t incident = 0, near = 0;
  for (const auto& pair : {std::pair{&box, &ball}, {&ball, &box}, {&box, &box}, {&ball, &ball}})
    for (const int count : {1, 10, 1000}) {
      const LmdShape &a = *pair.first, &b = *pair.second;
      const Contacts contacts(a, b, count, random);
      const Unmatched& c = contacts.unmatched;
      if (c.left.empty()) continue;
      const auto incident_there = one_by_one(c, [&](std::size_t k, std::size_t l, double apart) {
        const ContactKey &p = c.now[k].key, &q = c.old[l].key;
        return apart <= 0.01 && are_incident(a, feature_a(p), feature_a(q)) &&
               are_incident(b, feature_b(p), feature_b(q));
      });
      EXPECT_EQ(sorted(incident_candidates(c, a, b, 0.01)), incident_there);
      const auto reach = [](std::size_t k) { return 1e-3 * double(k % 10); };
      const auto near_there = one_by_one(c, [&](std::size_t k, std::size_t l, double apart) {
        const double turn = std::acos(c.now[k].normal.dot(c.old[l].normal));
        return apart <= reach(k) && turn <= 0.5;
      });
      EXPECT_EQ(sorted(near_candidates(c, reach, 0.5)), near_there);
      incident += incident_there.size(), near += near_there.size();
    }
  EXPECT_GT(incident, 100U);
  EXPECT_GT(near, 100U);
}

// All at one place, on a line along an axis, and so far away that nothing is near.
TEST(MatchCandidates, AreFoundInAFlatGridToo) {
  std::vector<PresentContact> now(3);
  std::vector<RememberedContact> old(3);
  for (auto& c : now) c.normal = Vec3::UnitZ();
  const auto count = [&](double reach) {
    return near_candidates(
               {.now = now, .old = old, .left = {0, 1, 2}, .has_name = {0, 0, 0}},
               [&](std::size_t) { return reach; }, 0.1)
        .size();
  };
  EXPECT_EQ(count(0), 9U);
  for (int i = 0; i < 3; ++i) now[i].point_a.y() = old[i].point_a.y() = i;
  EXPECT_EQ(count(0), 3U);
  EXPECT_EQ(count(1), 7U);
  for (auto& c : now) c.point_a.x() = 1e9;
  EXPECT_EQ(count(1), 0U);
}

}  // namespace
}  // namespace aussois
