// SPDX-License-Identifier: Apache-2.0
// Flags of a command line, made from the table of an options struct.
#pragma once

#include <cstdint>
#include <map>

#include "examples/common/driver.hpp"

namespace aussois {

/// An option that has a flag; several may share one, such as theta of two schemes.
struct OfferedSetting {
  std::string path{};    // "moreau_jean.theta"
  std::string member{};  // "MoreauJeanOptions::theta"
  Setting setting{};
  std::string flag{};                // "--not-passive"
  std::string fixed{};               // the value that the flag sets and the user does not say; empty: none
  std::vector<std::string> names{};  // of a choice
  enum class Kind { number, count, toggle, choice, seed } kind = Kind::number;
  std::string usual{};        // its value when it was offered
  std::string readers{};      // "only for --solver sor_prox, jor_prox"; empty: it is always read
  std::string unread_with{};  // "--solver admm" if nothing reads it as the options are; empty: it is read
};

/// What the user said of an option, as Cli keeps it.
struct SaidSetting {
  double number = 0;
  int count = 0;
  bool toggle = false;
  std::uint64_t seed = 0;
  std::string choice{};
};
using SaidSettings = std::map<std::string, SaidSetting>;  // by flag

namespace detail {

class Offer final : public SettingVisitor {
 public:
  explicit Offer(SaidSettings& said) : said_(said) {}
  void number(const Setting& setting, double& value) override;
  void count(const Setting& setting, int& value) override;
  void toggle(const Setting& setting, bool& value) override;
  void seed(const Setting& setting, std::uint64_t& value) override;
  std::vector<OfferedSetting> all{};

 private:
  void choose(const Setting& setting, Choice& value) override;
  SaidSetting* add(const Setting& setting, OfferedSetting::Kind kind, const std::string& usual,
                   std::vector<std::string> names = {});
  SaidSettings& said_;
};

class Take final : public SettingVisitor {
 public:
  explicit Take(const SaidSettings& said) : said_(said) {}
  void number(const Setting& setting, double& value) override;
  void count(const Setting& setting, int& value) override;
  void toggle(const Setting& setting, bool& value) override;
  void seed(const Setting& setting, std::uint64_t& value) override;

 private:
  void choose(const Setting& setting, Choice& value) override;
  const SaidSetting* find(const Setting& setting) const;
  const SaidSettings& said_;
};

}  // namespace detail

/// The options of the table that have a flag, in its order; `said` gets their present values, which are the
/// defaults of the flags.
template <class Options>
std::vector<OfferedSetting> offered(Options& options, SaidSettings& said) {
  detail::Offer offer(said);
  describe(offer, options);
  return std::move(offer.all);
}

/// Adds one flag; `note` stands behind what the table says. `said` must outlive `cli`.
void add_flag(Cli& cli, const OfferedSetting& offered, SaidSettings& said, const std::string& note = {});

/// Adds a flag for every option of the table that has one. `said` must outlive `cli`.
template <class Options>
void add_flags(Cli& cli, Options& options, SaidSettings& said) {
  for (const OfferedSetting& one : offered(options, said)) add_flag(cli, one, said);
}

/// Adds some flags of the table, in the order of `flags`. Throws std::logic_error for one that is not in it.
void add_flags(Cli& cli, const std::vector<OfferedSetting>& offered, SaidSettings& said,
               const std::vector<std::string>& flags);
template <class Options>
void add_flags(Cli& cli, Options& options, SaidSettings& said, const std::vector<std::string>& flags) {
  add_flags(cli, offered(options, said), said, flags);
}

/// Throws std::invalid_argument "--prox has no effect with --solver admm, only for --solver sor_prox,
/// jor_prox" for the first flag that the user said although none of its options is read (Setting::only_for).
void refuse_unread_flags(const Cli& cli, const std::vector<OfferedSetting>& offered);
template <class Options>
void refuse_unread_flags(const Cli& cli, Options options) {
  SaidSettings said;
  refuse_unread_flags(cli, offered(options, said));
}

/// Gives the options what the user said.
template <class Options>
void take(const SaidSettings& said, Options& options) {
  detail::Take take(said);
  describe(take, options);
}

}  // namespace aussois
