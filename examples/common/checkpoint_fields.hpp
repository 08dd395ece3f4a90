// SPDX-License-Identifier: Apache-2.0
// Members of a struct and their names in a checkpoint, told once for writing and for reading.
#pragma once

#include "io/checkpoint.hpp"

namespace aussois {

template <class Struct, class Value>
struct CheckpointField {
  const char* name;
  Value Struct::*member;
};

template <class Struct, std::size_t n>
void keep(const CheckpointField<Struct, double> (&fields)[n], const Struct& from, Checkpoint& checkpoint) {
  for (const auto& [name, member] : fields) checkpoint.numbers[name] = from.*member;
}
template <class Struct, std::size_t n>
void keep(const CheckpointField<Struct, std::int64_t> (&fields)[n], const Struct& from,
          Checkpoint& checkpoint) {
  for (const auto& [name, member] : fields) checkpoint.counts[name] = from.*member;
}
template <class Struct, std::size_t n>
void take(const CheckpointField<Struct, double> (&fields)[n], const Checkpoint& checkpoint, Struct& to) {
  for (const auto& [name, member] : fields) to.*member = checkpoint_number(checkpoint, name);
}
template <class Struct, std::size_t n>
void take(const CheckpointField<Struct, std::int64_t> (&fields)[n], const Checkpoint& checkpoint,
          Struct& to) {
  for (const auto& [name, member] : fields) to.*member = checkpoint_count(checkpoint, name);
}

}  // namespace aussois
