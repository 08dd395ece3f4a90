// SPDX-License-Identifier: Apache-2.0
// Options with one of them changed: a key of kept results tells them apart.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "geometry/settings.hpp"

namespace aussois {

/// Changes the option of the table that is number `wanted`, within its range, and by as little as can be.
class Alter final : public SettingVisitor {
 public:
  explicit Alter(int wanted) : wanted_(wanted) {}
  void number(const Setting& setting, double& value) override {
    if (!is_wanted(setting)) return;
    const double more = std::nextafter(value, setting.range.highest);
    value =
        more != value && contains(setting.range, more) ? more : std::nextafter(value, setting.range.lowest);
  }
  void count(const Setting& setting, int& value) override {
    if (is_wanted(setting)) value += contains(setting.range, value + 1) ? 1 : -1;
  }
  void toggle(const Setting& setting, bool& value) override {
    if (is_wanted(setting)) value = !value;
  }
  void seed(const Setting& setting, std::uint64_t& value) override { value += is_wanted(setting); }
  std::string changed{};  // its path; empty: there are fewer options

 private:
  void choose(const Setting& setting, Choice& value) override {
    if (!is_wanted(setting)) return;
    const std::vector<std::string> names = value.names();
    value.set(value.name() == names.front() ? names.back() : names.front());
  }
  bool is_wanted(const Setting& setting) {
    if (setting.changes_nothing || wanted_-- != 0) return false;
    changed = path(setting);
    return true;
  }
  int wanted_ = 0;
};

/// For each option that a result depends on: its path, and the options where it alone is another.
template <class Options>
std::vector<std::pair<std::string, Options>> altered(const Options& options) {
  std::vector<std::pair<std::string, Options>> out;
  for (int i = 0;; ++i) {
    Options other = options;
    Alter alter(i);
    describe(alter, other);
    if (alter.changed.empty()) return out;
    out.emplace_back(alter.changed, other);
  }
}

}  // namespace aussois
