// SPDX-License-Identifier: Apache-2.0
#include "reduction/contact_memory.hpp"

#include <algorithm>
#include <numeric>
#include <span>

#include <Eigen/Geometry>

#include "geometry/check.hpp"

namespace aussois {
namespace {

RememberedContact seen(const ContactPoint& c, const Vec3& impulse, double drilling = 0) {
  return {.key = key_of(c), .normal = c.normal, .point_a = c.x_a, .impulse = impulse, .drilling = drilling};
}

bool before(const RememberedContact& a, const RememberedContact& b) {
  if (a.key != b.key) return a.key < b.key;
  return std::lexicographical_compare(a.point_a.begin(), a.point_a.end(), b.point_a.begin(), b.point_a.end());
}

// Q(from, to) x of (RED-5), written out; from . to > 0.
Vec3 turned(const Vec3& x, const Vec3& from, const Vec3& to) {
  const Vec3 w = from.cross(to);
  return x + w.cross(x) + w.cross(w.cross(x)) / (1 + from.dot(to));
}

// Two contacts of one key that may be the same, by rank, in the order of (RED-6).
struct Candidate {
  double distance = 0;
  std::size_t now = 0, old = 0;
  auto operator<=>(const Candidate&) const = default;
};

// Who is who among contacts of one key: nearest first, nobody twice.
std::vector<Candidate> matches(std::span<const RememberedContact> now,
                               std::span<const RememberedContact> old) {
  std::vector<Candidate> candidates, result;
  for (std::size_t i = 0; i < now.size(); ++i)
    for (std::size_t j = 0; j < old.size(); ++j)
      if (now[i].normal.dot(old[j].normal) > 0)
        candidates.push_back({(now[i].point_a - old[j].point_a).norm(), i, j});
  std::sort(candidates.begin(), candidates.end());

  std::vector<bool> now_taken(now.size()), old_taken(old.size());
  for (const Candidate& c : candidates) {
    if (now_taken[c.now] || old_taken[c.old]) continue;
    now_taken[c.now] = old_taken[c.old] = true;
    result.push_back(c);
  }
  return result;
}

// One past the last of the contacts that share the key of `first`.
std::size_t end_of_key(const std::vector<RememberedContact>& sorted, std::size_t first) {
  std::size_t end = first;
  while (end < sorted.size() && sorted[end].key == sorted[first].key) ++end;
  return end;
}

}  // namespace

ContactMemory remember(const ContactSet& contacts, const std::vector<Vec3>& impulses,
                       const std::vector<double>& drilling) {
  require(drilling.empty() || drilling.size() == contacts.points.size(),
          "remember: " + std::to_string(drilling.size()) + " drilling impulses for " +
              std::to_string(contacts.points.size()) + " contacts");
  require(impulses.size() == contacts.points.size(),
          "remember: " + std::to_string(impulses.size()) + " impulses for " +
              std::to_string(contacts.points.size()) + " contacts");
  ContactMemory memory;
  for (std::size_t i = 0; i < impulses.size(); ++i)
    memory.contacts.push_back(seen(contacts.points[i], impulses[i], drilling.empty() ? 0 : drilling[i]));
  std::stable_sort(memory.contacts.begin(), memory.contacts.end(), before);
  return memory;
}

WarmStart warm_start(const ContactMemory& memory, const ContactSet& contacts, double scale) {
  const std::vector<ContactPoint>& points = contacts.points;
  std::vector<std::size_t> place(points.size());  // in the set, by rank
  std::iota(place.begin(), place.end(), std::size_t(0));
  std::stable_sort(place.begin(), place.end(), [&](std::size_t i, std::size_t j) {
    return before(seen(points[i], Vec3::Zero()), seen(points[j], Vec3::Zero()));
  });
  std::vector<RememberedContact> now;
  now.reserve(place.size());
  for (const std::size_t i : place) now.push_back(seen(points[i], Vec3::Zero()));
  const std::vector<RememberedContact>& old = memory.contacts;

  WarmStart start;
  start.impulse.assign(points.size(), Vec3::Zero());
  start.drilling.assign(points.size(), 0);
  start.remembered.assign(points.size(), 0);
  std::size_t i = 0, j = 0;
  while (i < now.size() && j < old.size()) {  // merge of two sequences sorted by key
    const std::size_t i_end = end_of_key(now, i), j_end = end_of_key(old, j);
    if (now[i].key == old[j].key)
      for (const Candidate& c : matches({&now[i], i_end - i}, {&old[j], j_end - j})) {
        const RememberedContact& from = old[j + c.old];
        start.impulse[place[i + c.now]] =
            scale * turned(from.impulse, from.normal, now[i + c.now].normal);  // (RED-5)
        start.drilling[place[i + c.now]] = scale * from.drilling;
        start.remembered[place[i + c.now]] = 1;
        ++start.matched;
      }
    const bool now_first = now[i].key <= old[j].key, old_first = old[j].key <= now[i].key;
    if (now_first) i = i_end;
    if (old_first) j = j_end;
  }
  return start;
}

}  // namespace aussois
