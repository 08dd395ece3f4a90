// SPDX-License-Identifier: Apache-2.0
// Hashes states, keys and files to 64 bits that tell them apart. Not secure against malice.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "geometry/types.hpp"

namespace aussois {

/// Order-dependent mix of 64-bit words: the finaliser of splitmix64 after each word; one-to-one in the word.
struct Digest {
  std::uint64_t value = 0;
  void add(std::uint64_t word) {
    std::uint64_t z = (value ^ word) + 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    value = z ^ (z >> 31);
  }
  void add(double x) { add(std::bit_cast<std::uint64_t>(x)); }
  void add(const Vec3& x) {
    for (const double component : x) add(component);
  }
  /// Adds the number of bytes, then the bytes as words, the last one padded with zeros.
  void add(std::span<const std::byte> bytes) {
    add(std::uint64_t(bytes.size()));
    for (std::size_t i = 0; i < bytes.size(); i += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, bytes.data() + i, std::min<std::size_t>(8, bytes.size() - i));
      add(word);
    }
  }
};

}  // namespace aussois
