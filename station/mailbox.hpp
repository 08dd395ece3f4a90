// SPDX-License-Identifier: Apache-2.0
// How threads of a station talk: they exchange values, and hold no lock while they work.
#pragma once

#include <cstddef>
#include <mutex>
#include <utility>
#include <vector>

namespace aussois {

/// One writes, others read: the newest wins.
template <class T>
class Latest {
 public:
  void set(T value) {
    const std::lock_guard lock(mutex_);
    value_ = std::move(value);
  }
  T get() const {
    const std::lock_guard lock(mutex_);
    return value_;
  }

 private:
  mutable std::mutex mutex_{};
  T value_{};
};

/// What must not be lost, in order, up to a bound.
template <class T>
class Mail {
 public:
  explicit Mail(std::size_t bound) : bound_(bound) {}
  /// False: the box is full.
  bool put(T value) {
    const std::lock_guard lock(mutex_);
    if (values_.size() >= bound_) return false;
    values_.push_back(std::move(value));
    return true;
  }
  std::vector<T> take_all() {
    const std::lock_guard lock(mutex_);
    return std::exchange(values_, {});
  }

 private:
  std::size_t bound_;
  std::mutex mutex_{};
  std::vector<T> values_{};
};

}  // namespace aussois
