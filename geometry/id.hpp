// SPDX-License-Identifier: Apache-2.0
// Indices that differ by what they count: the third body is neither the third joint nor the number three.
#pragma once

#include <compare>
#include <concepts>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "geometry/check.hpp"

namespace aussois {

/// The place of an item in a Table, or none. A constant converts (`pose(state, 0)`); a number of run time
/// does not: Id::at(number).
template <class Tag>
class Id {
 public:
  constexpr Id() = default;                         // none
  consteval Id(int constant) : index_(constant) {}  // NOLINT(google-explicit-constructor)
  static constexpr Id at(std::integral auto index) {
    static_assert(!std::same_as<decltype(index), bool>);
    AUSSOIS_ASSERT(std::in_range<int>(index));
    Id out;
    out.index_ = int(index);
    return out;
  }

  constexpr int index() const { return index_; }  // -1: none
  constexpr explicit operator bool() const { return index_ >= 0; }
  constexpr Id& operator++() {
    ++index_;
    return *this;
  }
  friend constexpr Id operator+(Id id, int places) { return at(id.index_ + places); }
  friend constexpr auto operator<=>(const Id&, const Id&) = default;
  friend std::string to_string(Id id) { return std::to_string(id.index()); }
  friend std::ostream& operator<<(std::ostream& out, Id id) { return out << id.index(); }

 private:
  int index_ = -1;
};

/// The ids from 0 to `end`, without it.
template <class AnyId>
class IdRange {
 public:
  explicit constexpr IdRange(AnyId end) : end_(end) {}
  struct Iterator {
    AnyId id{};
    constexpr AnyId operator*() const { return id; }
    constexpr Iterator& operator++() {
      ++id;
      return *this;
    }
    friend constexpr bool operator==(const Iterator&, const Iterator&) = default;
  };
  constexpr Iterator begin() const { return {0}; }
  constexpr Iterator end() const { return {end_}; }

 private:
  AnyId end_;
};

/// A vector whose [] and `at` take ids of one kind.
template <class AnyId, class T>
class Table : public std::vector<T> {
  using Base = std::vector<T>;

 public:
  using Base::Base;
  // The caller of [] sees to it that there is such an item; `at` throws std::out_of_range.
  T& operator[](AnyId id) {
    AUSSOIS_ASSERT(contains(id));
    return Base::operator[](id.index());
  }
  const T& operator[](AnyId id) const {
    AUSSOIS_ASSERT(contains(id));
    return Base::operator[](id.index());
  }

  T& at(AnyId id) { return Base::at(std::size_t(id.index())); }
  const T& at(AnyId id) const { return Base::at(std::size_t(id.index())); }

  bool contains(AnyId id) const { return id >= 0 && id < next(); }
  IdRange<AnyId> ids() const { return IdRange<AnyId>(next()); }
  AnyId next() const { return AnyId::at(this->size()); }  // of an item that is appended now
  AnyId append(T item) {
    const AnyId id = next();
    this->push_back(std::move(item));
    return id;
  }
};

}  // namespace aussois
