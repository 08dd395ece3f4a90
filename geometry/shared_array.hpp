// SPDX-License-Identifier: Apache-2.0
// Holds an array that never changes. Its elements belong to a vector or lie in a file that is mapped; copies
// share them.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace aussois {

template <class T>
class SharedArray {
 public:
  using value_type = T;

  SharedArray() = default;
  SharedArray(std::vector<T> elements) {
    if (elements.empty()) return;
    const auto owner = std::make_shared<const std::vector<T>>(std::move(elements));
    elements_ = *owner;
    owner_ = owner;
  }
  SharedArray(std::initializer_list<T> elements) : SharedArray(std::vector<T>(elements)) {}
  /// `elements` live as long as `owner`.
  SharedArray(std::span<const T> elements, std::shared_ptr<const void> owner)
      : elements_(elements), owner_(std::move(owner)) {}

  SharedArray(const SharedArray&) = default;
  SharedArray(SharedArray&& other) noexcept
      : elements_(std::exchange(other.elements_, {})), owner_(std::move(other.owner_)) {}
  SharedArray& operator=(SharedArray other) noexcept {
    std::swap(elements_, other.elements_);
    std::swap(owner_, other.owner_);
    return *this;
  }
  ~SharedArray() = default;

  const T& operator[](std::size_t i) const { return elements_[i]; }
  const T* begin() const { return data(); }
  const T* end() const { return data() + size(); }
  const T* data() const { return elements_.data(); }
  const T& front() const { return elements_.front(); }
  const T& back() const { return elements_.back(); }
  std::size_t size() const { return elements_.size(); }
  bool empty() const { return elements_.empty(); }

  /// A copy that may be changed and become an array of this kind again.
  std::vector<T> to_vector() const { return {begin(), end()}; }

  bool operator==(const SharedArray& other) const { return std::ranges::equal(*this, other); }

 private:
  std::span<const T> elements_{};
  std::shared_ptr<const void> owner_{};
};

}  // namespace aussois
