// SPDX-License-Identifier: Apache-2.0
// Makes the page io/viewer/dist/template.html with one blob pasted in: base64(gzip(u32 n, JSON of n bytes,
// arrays)). The JSON names the arrays in the order in which they follow; all consist of four-byte
// little-endian numbers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <type_traits>
#include <vector>

#include "io/summary.hpp"

namespace aussois {

/// The arrays of the page, one after the other, and their names.
class PageArrays {
 public:
  template <class T>
  void add(const std::string& name, const std::vector<T>& values) {
    static_assert(sizeof(T) == 4);
    names_.push_back(name + (std::is_floating_point_v<T> ? ":f32:" : ":i32:") +
                     std::to_string(values.size()));
    bytes_.append(reinterpret_cast<const char*>(values.data()), 4 * values.size());
  }
  const std::vector<std::string>& names() const { return names_; }
  const std::string& bytes() const { return bytes_; }

 private:
  std::vector<std::string> names_{};
  std::string bytes_{};
};

/// Writes the page atomically (see write_whole_file). Throws std::runtime_error if it cannot be written.
void write_page(const std::filesystem::path& html, Summary header, const PageArrays& arrays);

}  // namespace aussois
