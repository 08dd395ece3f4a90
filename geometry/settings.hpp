// SPDX-License-Identifier: Apache-2.0
// The table of an options struct says each option once: range checks, flags and their help, labels,
// fingerprints and the notes of a run all read it. Inline: rooms that link with no other have options too.
//
//   void describe(SettingVisitor& visit, FallOptions& o) {
//     visit.begin("FallOptions");
//     visit.number({"h", "largest step", "s", positive_range()}, o.h);
//     visit.choice({.name = "law", .what = "of impacts", .flag = "--impact-law"}, o.law, kImpactLaws);
//     visit.group("solver", o.solver);
//   }
#pragma once

#include <array>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "geometry/check.hpp"
#include "geometry/named.hpp"

namespace aussois {

/// An interval of allowed values; an open end excludes its bound.
struct Range {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  bool open_below = false, open_above = false;
};
inline Range positive_range() {
  return {0, std::numeric_limits<double>::infinity(), true, true};  // and finite
}
inline Range not_negative_range() {
  return {0, std::numeric_limits<double>::infinity(), false, true};  // and finite
}
inline Range range_from(double lowest) {
  return {.lowest = lowest};
}
inline Range range_above(double lowest) {
  return {.lowest = lowest, .open_below = true};
}
inline Range open_range(double lowest, double highest) {
  return {lowest, highest, true, true};
}
inline Range finite_range() {
  return open_range(-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity());
}
inline Range range_open_below(double lowest, double highest) {
  return {lowest, highest, true, false};
}
inline Range range_open_above(double lowest, double highest) {
  return {lowest, highest, false, true};
}

/// NaN lies in no range.
inline bool contains(const Range& range, double x) {
  return (range.open_below ? x > range.lowest : x >= range.lowest) &&
         (range.open_above ? x < range.highest : x <= range.highest);
}

/// "in [0, 1)", ">= 1", "> 0 and finite"; empty if everything is allowed.
inline std::string range_text(const Range& range) {
  const auto text = [](double x) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%g", x);
    return std::string(digits);
  };
  const bool below = std::isfinite(range.lowest), above = std::isfinite(range.highest);
  if (below && above)
    return (range.open_below ? "in (" : "in [") + text(range.lowest) + ", " + text(range.highest) +
           (range.open_above ? ")" : "]");
  if (above) return (range.open_above ? "< " : "<= ") + text(range.highest);
  if (!below) return range.open_above ? "finite" : "";
  return (range.open_below ? "> " : ">= ") + text(range.lowest) + (range.open_above ? " and finite" : "");
}

/// The same as an order: "lie in [0, 1)", "be at least 1", "be finite and > 0".
inline std::string range_order(const Range& range) {
  const std::string text = range_text(range);
  if (text.empty()) return "be a number";
  if (text.starts_with("in ")) return "lie " + text;
  if (text.starts_with(">= ") && !range.open_above) return "be at least " + text.substr(3);
  const std::size_t finite = text.find(" and finite");
  return finite == std::string::npos ? "be " + text : "be finite and " + text.substr(0, finite);
}

/// What is known of an option besides its value.
struct Setting {
  const char* name = "";        // of the member
  const char* what = "";        // for --help
  const char* unit = "-";       // "-": a pure number; "": none, of counts
  Range range{};                // of numbers and counts
  const char* flag = nullptr;   // on command lines; null: not offered. "--not-passive=false" sets a toggle or
                                // a choice to that value and takes none
  const char* label = nullptr;  // in a label; % stands for the value; null: it makes no other method
  bool in_every_label = false;  // false: only where it is not the default
  bool changes_nothing = false;  // no result depends on it
  // The values of the struct's first choice with which this option has an effect: "nsgs, sor_prox", "not
  // none". Those of another choice before it: "order: sequential". Null: it always has
  const char* only_for = nullptr;
};

/// An option with one value of a list, as a visitor sees it.
class Choice {
 public:
  virtual std::vector<std::string> names() const = 0;
  virtual const char* name() const = 0;
  virtual void set(const std::string& name) = 0;  // throws std::invalid_argument listing all names

 protected:
  ~Choice() = default;
};

/// Whether `name` is one of "nsgs, sor_prox".
inline bool is_listed(std::string_view name, std::string_view list) {
  for (std::size_t at = list.find(name); at != list.npos; at = list.find(name, at + 1)) {
    const std::size_t end = at + name.size();
    if ((at == 0 || list[at - 1] == ' ') && (end == list.size() || list[end] == ',')) return true;
  }
  return false;
}

/// Visits the options of a struct, one after the other, in the struct's describe().
class SettingVisitor {
 public:
  /// The options that follow are members of this struct.
  void begin(const char* owner) { owner_ = owner, chosen_count_ = first_; }

  virtual void number(const Setting& setting, double& value) = 0;
  virtual void count(const Setting& setting, int& value) = 0;
  virtual void toggle(const Setting& setting, bool& value) = 0;
  virtual void seed(const Setting& setting, std::uint64_t& value) = 0;
  template <class Enum, std::size_t n>
  void choice(const Setting& setting, Enum& value, const Named<Enum> (&table)[n]) {
    class OfTable final : public Choice {
     public:
      OfTable(Enum& value, const char* what, const Named<Enum> (&table)[n])
          : value_(value), what_(what), table_(table) {}
      std::vector<std::string> names() const override { return names_of(table_); }
      const char* name() const override { return name_of(value_, table_); }
      void set(const std::string& name) override { value_ = value_named(name, what_, table_); }

     private:
      Enum& value_;
      const char* what_;
      const Named<Enum> (&table_)[n];
    };
    OfTable one(value, setting.name, table);
    choose(setting, one);
    chosen_.at(chosen_count_++) = {setting.name, setting.flag, one.name()};
  }
  /// A struct in the struct; `only_for` as in Setting.
  template <class Options>
  void group(const char* name, Options& options, const char* only_for = nullptr) {
    const auto outside = std::tuple(owner_, first_, chosen_count_, group_);
    if (!group_ || group_->has()) group_ = readers_of(only_for);
    groups_.at(depth_++) = name;
    first_ = chosen_count_;
    describe(*this, options);
    --depth_;
    std::tie(owner_, first_, chosen_count_, group_) = outside;
  }

 protected:
  ~SettingVisitor() = default;
  virtual void choose(const Setting& setting, Choice& value) = 0;

  std::string field(const Setting& setting) const { return std::string(owner_) + "::" + setting.name; }
  std::string path(const Setting& setting) const {
    std::string out;
    for (std::size_t k = 0; k < depth_; ++k) (out += groups_[k]) += '.';
    return out + setting.name;
  }

  struct Chosen {
    const char* name = "";
    const char* flag = nullptr;
    const char* value = "";
  };
  /// The choice that decides whether an option is read, and the values with which it is, or is not.
  struct Readers {
    Chosen choice{};
    std::string_view values{};
    bool but_these = false;
    bool has() const { return is_listed(choice.value, values) != but_these; }
  };
  /// Nothing: it is always read.
  std::optional<Readers> readers_of(const Setting& setting) const {
    return group_ && !group_->has() ? group_ : readers_of(setting.only_for);
  }
  bool is_read(const Setting& setting) const {
    if (!setting.only_for && !group_) return true;
    const std::optional<Readers> readers = readers_of(setting);
    return !readers || readers->has();
  }

 private:
  std::optional<Readers> readers_of(const char* only_for) const {
    if (!only_for) return {};
    std::string_view values = only_for, choice;
    if (const std::size_t colon = values.find(": "); colon != values.npos)
      choice = values.substr(0, colon), values.remove_prefix(colon + 2);
    const bool but_these = values.starts_with("not ");
    if (but_these) values.remove_prefix(4);
    for (std::size_t i = first_; i < chosen_count_; ++i)
      if (choice.empty() || choice == chosen_[i].name) return Readers{chosen_[i], values, but_these};
    throw std::logic_error(std::string(owner_) + " has no choice before what is only for " + only_for);
  }

  // Nothing here allocates: options are checked in every step.
  const char* owner_ = "";
  std::array<const char*, 8> groups_{};                   // the members that lead to the struct
  std::array<Chosen, 32> chosen_{};                       // in the struct and those around it
  std::size_t depth_ = 0, chosen_count_ = 0, first_ = 0;  // first_: of the struct itself
  std::optional<Readers> group_{};                        // of the struct as a whole
};

namespace detail {

class RangeCheck : public SettingVisitor {
 public:
  explicit RangeCheck(std::string_view where = {}) : where_(where) {}
  void number(const Setting& setting, double& value) override { check(setting, value); }
  void count(const Setting& setting, int& value) override { check(setting, value); }
  void toggle(const Setting&, bool&) override {}
  void seed(const Setting&, std::uint64_t&) override {}

 protected:
  void choose(const Setting&, Choice&) override {}
  template <class Value>
  void check(const Setting& setting, Value value) const {
    if (contains(setting.range, value)) return;
    const std::string order = range_order(setting.range), unit = setting.unit;
    const bool bare = unit.empty() || unit == "-", both = order.starts_with("lie");
    require_field(false, (where_.empty() ? field(setting) : std::string(where_) + path(setting)).c_str(),
                  value,
                  (order + (bare   ? ""
                            : both ? " " + unit
                                   : " [" + unit + "]"))
                      .c_str());
  }

 private:
  std::string_view where_;
};

}  // namespace detail

/// Throws std::invalid_argument "Struct::member = value must lie in [0, 1] m" for the first number out of its
/// range; `where` stands instead of "Struct::", such as "joint 3: axis[0].".
template <class Options>
void check_ranges(const Options& options, const std::string& where = {}) {
  detail::RangeCheck check(where);
  describe(check, const_cast<Options&>(options));  // it only looks
}

/// An option as text.
struct SettingValue {
  std::string path{};  // "solver.tolerance"
  std::string value{};
  Setting setting{};
};

namespace detail {

class Values final : public SettingVisitor {
 public:
  void number(const Setting& setting, double& value) override { add(setting, number_text(value)); }
  void count(const Setting& setting, int& value) override { add(setting, std::to_string(value)); }
  void toggle(const Setting& setting, bool& value) override { add(setting, value ? "true" : "false"); }
  void seed(const Setting& setting, std::uint64_t& value) override { add(setting, std::to_string(value)); }
  std::vector<SettingValue> all{};

 private:
  void choose(const Setting& setting, Choice& value) override { add(setting, value.name()); }
  void add(const Setting& setting, const std::string& value) {
    all.push_back({path(setting), value, setting});
  }
};

}  // namespace detail

/// All options of a struct and of the structs in it, in the order of their tables.
template <class Options>
std::vector<SettingValue> values_of(const Options& options) {
  detail::Values values;
  describe(values, const_cast<Options&>(options));  // it only looks
  return std::move(values.all);
}

/// What the table says of the option at `path`. Throws std::out_of_range if it has none.
template <class Options>
Setting setting_of(const std::string& path) {
  for (const SettingValue& one : values_of(Options{}))
    if (one.path == path) return one.setting;
  throw std::out_of_range(path);
}

/// "path = value" of every option that a result depends on.
template <class Options>
std::vector<std::string> settings_text(const Options& options) {
  std::vector<std::string> out;
  for (const SettingValue& one : values_of(options))
    if (!one.setting.changes_nothing) out.push_back(one.path + " = " + one.value);
  return out;
}

/// The options that make another method of the struct's, as people call it: "theta 0.5 moreau".
template <class Options>
std::string label_of(const Options& options) {
  const std::vector<SettingValue> values = values_of(options), usual = values_of(Options{});
  std::string out;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Setting& setting = values[i].setting;
    if (!setting.label || (!setting.in_every_label && values[i].value == usual[i].value)) continue;
    std::string text = setting.label;
    if (const std::size_t at = text.find('%'); at != std::string::npos) text.replace(at, 1, values[i].value);
    out += (out.empty() ? "" : " ") + text;
  }
  return out;
}

namespace detail {

/// A value in a form that is compared without text; toggles are numbers too.
struct PlainValue {
  double number = 0;
  std::uint64_t seed = 0;
  std::string_view name{};
};

class PlainValues final : public SettingVisitor {
 public:
  void number(const Setting&, double& value) override { all.push_back({.number = value}); }
  void count(const Setting&, int& value) override { all.push_back({.number = double(value)}); }
  void toggle(const Setting&, bool& value) override { all.push_back({.number = double(value)}); }
  void seed(const Setting&, std::uint64_t& value) override { all.push_back({.seed = value}); }
  std::vector<PlainValue> all{};

 private:
  void choose(const Setting&, Choice& value) override { all.push_back({.name = value.name()}); }
};

class OptionCheck final : public RangeCheck {
 public:
  explicit OptionCheck(const std::vector<PlainValue>& usual) : usual_(usual) {}
  void number(const Setting& setting, double& value) override {
    check(setting, value);
    if (value != usual_[next_++].number) refuse_unread(setting, {.number = value});
  }
  void count(const Setting& setting, int& value) override {
    check(setting, value);
    if (value != usual_[next_++].number) refuse_unread(setting, {.number = double(value)});
  }
  void toggle(const Setting& setting, bool& value) override {
    if (value != (usual_[next_++].number != 0)) refuse_unread(setting, {.name = value ? "true" : "false"});
  }
  void seed(const Setting& setting, std::uint64_t& value) override {
    if (value != usual_[next_++].seed) refuse_unread(setting, {.seed = value});
  }

 private:
  void choose(const Setting& setting, Choice& value) override {
    if (value.name() != usual_[next_++].name) refuse_unread(setting, {.name = value.name()});
  }
  void refuse_unread(const Setting& setting, const PlainValue& value) const {
    if (is_read(setting)) return;
    const std::string text = !value.name.empty() ? std::string(value.name)
                             : value.seed        ? std::to_string(value.seed)
                                                 : number_text(value.number);
    const Readers readers = *readers_of(setting);
    throw std::invalid_argument(field(setting) + " = " + text + " is not read by " + readers.choice.value +
                                (readers.but_these ? "" : ", only by " + std::string(readers.values)));
  }
  const std::vector<PlainValue>& usual_;
  std::size_t next_ = 0;
};

}  // namespace detail

/// What check_ranges throws, and std::invalid_argument "SolverOptions::prox = split is not read by admm, only
/// by sor_prox, jor_prox" for the first option that is not the default and that nothing reads
/// (Setting::only_for).
template <class Options>
void check_options(const Options& options) {
  static const std::vector<detail::PlainValue> usual = [] {
    detail::PlainValues values;
    Options defaults;
    describe(values, defaults);
    return std::move(values.all);
  }();
  detail::OptionCheck check(usual);
  describe(check, const_cast<Options&>(options));  // it only looks
}

/// Throws std::invalid_argument "solver.tolerance = 1 is not read by `who`" for the first of the options at
/// `paths` that is not the default.
template <class Options>
void refuse_unread(const Options& options, const std::vector<std::string>& paths, const std::string& who) {
  const std::vector<SettingValue> values = values_of(options), usual = values_of(Options{});
  for (std::size_t i = 0; i < values.size(); ++i)
    for (const std::string& path : paths)
      require(values[i].path != path || values[i].value == usual[i].value,
              path + " = " + values[i].value + " is not read by " + who);
}

}  // namespace aussois
