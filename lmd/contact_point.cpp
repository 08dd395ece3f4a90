// SPDX-License-Identifier: Apache-2.0
#include "lmd/contact_point.hpp"

#include <algorithm>

#include "geometry/check.hpp"

namespace aussois {

namespace {

constexpr std::uint32_t kRegionBits = 30, kRegionMask = (1u << kRegionBits) - 1;

std::uint32_t half_word(const KeyFeature& f) {
  AUSSOIS_ASSERT(f.dim >= 0 && f.dim <= 3 && f.region >= 0 && std::uint32_t(f.region) <= kRegionMask);
  return std::uint32_t(f.dim) << kRegionBits | std::uint32_t(f.region);
}

KeyFeature from_half_word(std::uint32_t word) {
  return {.dim = int(word >> kRegionBits), .region = int(word & kRegionMask)};
}

}  // namespace

std::uint64_t feature_word(const KeyFeature& a, const KeyFeature& b) {
  return std::uint64_t(half_word(a)) << 32 | half_word(b);
}

KeyFeature feature_a(const ContactKey& key) {
  return from_half_word(std::uint32_t(key.feature >> 32));
}

KeyFeature feature_b(const ContactKey& key) {
  return from_half_word(std::uint32_t(key.feature));
}

ContactKey key_of(const ContactPoint& contact) {
  const Feature &a = contact.a, &b = contact.b;
  return {.body_a = a.body, .body_b = b.body, .feature = feature_word({a.dim, a.region}, {b.dim, b.region})};
}

double smallest_gap(const ContactSet& contacts) {
  double gap = kInf;
  for (const ContactPoint& contact : contacts.points) gap = std::min(gap, contact.gap);
  return gap;
}

}  // namespace aussois
