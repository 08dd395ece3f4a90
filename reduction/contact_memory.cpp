// SPDX-License-Identifier: Apache-2.0
#include "reduction/contact_memory.hpp"

#include <algorithm>

#include "geometry/check.hpp"

namespace aussois {
namespace {

bool before(const RememberedContact& a, const RememberedContact& b) {
  if (a.key != b.key) return a.key < b.key;
  return std::lexicographical_compare(a.point_a.begin(), a.point_a.end(), b.point_a.begin(), b.point_a.end());
}

}  // namespace

SE3 pose_of(std::span<const SE3> g, BodyId body) {
  return g.empty() || !body ? SE3{} : g[body.index()];
}

std::vector<SE3> inverses(std::span<const SE3> g) {
  std::vector<SE3> out;
  out.reserve(g.size());
  for (const SE3& pose : g) out.push_back(inverse(pose));
  return out;
}

ContactMemory remember(const ContactSet& contacts, const std::vector<Vec3>& impulses,
                       const StepTrace& trace) {
  const auto check_size = [&](std::size_t size, bool may_be_empty, const char* what) {
    if (size == contacts.points.size() || (may_be_empty && size == 0)) return;
    require(false, "remember: " + std::to_string(size) + " " + what + " for " +
                       std::to_string(contacts.points.size()) + " contacts");
  };
  check_size(impulses.size(), false, "impulses");
  check_size(trace.drilling.size(), true, "drilling impulses");
  check_size(trace.anchors.size(), true, "anchors");
  check_size(trace.solved.size(), true, "marks");
  check_size(trace.places.size(), true, "places");
  ContactMemory memory;
  memory.contacts.reserve(impulses.size());
  const std::vector<SE3> to_body = inverses(impulses.empty() ? std::span<const SE3>() : trace.g);
  for (std::size_t i = 0; i < impulses.size(); ++i) {
    const ContactPoint& c = contacts.points[i];
    const Anchor anchor = trace.anchors.empty() ? Anchor{} : trace.anchors[i];
    const SE3 to_b = pose_of(to_body, c.b.body);
    RememberedContact r{
        .key = key_of(c),
        .normal = c.normal,
        .point_a = trace.places.empty() ? pose_of(to_body, c.a.body) * c.x_a : trace.places[i][0],
        .point_b = trace.places.empty() ? to_b * c.x_b : trace.places[i][1],
        .impulse = impulses[i],
        .drilling = trace.drilling.empty() ? 0 : trace.drilling[i],
        .held = anchor.held,
        .solved = trace.solved.empty() || trace.solved[i] != 0};
    r.anchor_b = anchor.held ? to_b * Vec3(c.x_b - anchor.drift) : r.point_b;
    memory.contacts.push_back(r);
  }
  if (!std::is_sorted(memory.contacts.begin(), memory.contacts.end(), before))
    std::stable_sort(memory.contacts.begin(), memory.contacts.end(), before);
  return memory;
}

}  // namespace aussois
