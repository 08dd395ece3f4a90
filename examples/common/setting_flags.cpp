// SPDX-License-Identifier: Apache-2.0
#include "examples/common/setting_flags.hpp"

#include <algorithm>
#include <stdexcept>

namespace aussois {
namespace {

// "--not-passive=false": the flag, and the value that it sets.
std::pair<std::string, std::string> split(const char* flag) {
  const std::string text = flag;
  const std::size_t at = text.find('=');
  return {text.substr(0, at), at == std::string::npos ? "" : text.substr(at + 1)};
}

}  // namespace

namespace detail {

SaidSetting* Offer::add(const Setting& setting, OfferedSetting::Kind kind, const std::string& usual,
                        std::vector<std::string> names) {
  if (!setting.flag) return nullptr;
  const auto [flag, fixed] = split(setting.flag);
  all.push_back({path(setting), field(setting), setting, flag, fixed, std::move(names), kind, usual});
  if (const std::optional<Readers> readers = readers_of(setting)) {
    const std::string of = readers->choice.flag ? readers->choice.flag + std::string(" ") : "";
    all.back().readers = (readers->but_these ? "not for " : "only for ") + of + std::string(readers->values);
    if (!readers->has()) all.back().unread_with = of + readers->choice.value;
  }
  return &said_[flag];
}
void Offer::number(const Setting& setting, double& value) {
  if (SaidSetting* said = add(setting, OfferedSetting::Kind::number, number_text(value)))
    said->number = value;
}
void Offer::count(const Setting& setting, int& value) {
  if (SaidSetting* said = add(setting, OfferedSetting::Kind::count, std::to_string(value)))
    said->count = value;
}
void Offer::seed(const Setting& setting, std::uint64_t& value) {
  if (SaidSetting* said = add(setting, OfferedSetting::Kind::seed, std::to_string(value))) said->seed = value;
}
void Offer::toggle(const Setting& setting, bool& value) {
  if (SaidSetting* said = add(setting, OfferedSetting::Kind::toggle, value ? "true" : "false"))
    said->toggle = split(setting.flag).second.empty() ? value : !value;
}
void Offer::choose(const Setting& setting, Choice& value) {
  if (SaidSetting* said = add(setting, OfferedSetting::Kind::choice, value.name(), value.names()))
    said->choice = value.name(), said->toggle = value.name() == split(setting.flag).second;
}

const SaidSetting* Take::find(const Setting& setting) const {
  if (!setting.flag) return nullptr;
  const auto said = said_.find(split(setting.flag).first);
  return said == said_.end() ? nullptr : &said->second;
}
void Take::number(const Setting& setting, double& value) {
  if (const SaidSetting* said = find(setting)) value = said->number;
}
void Take::count(const Setting& setting, int& value) {
  if (const SaidSetting* said = find(setting)) value = said->count;
}
void Take::seed(const Setting& setting, std::uint64_t& value) {
  if (const SaidSetting* said = find(setting)) value = said->seed;
}
void Take::toggle(const Setting& setting, bool& value) {
  if (const SaidSetting* said = find(setting))
    value = split(setting.flag).second.empty() ? said->toggle : !said->toggle;
}
void Take::choose(const Setting& setting, Choice& value) {
  const SaidSetting* said = find(setting);
  if (!said) return;
  const std::string fixed = split(setting.flag).second;
  if (fixed.empty())
    value.set(said->choice);
  else if (said->toggle)
    value.set(fixed);
}

}  // namespace detail

void add_flag(Cli& cli, const OfferedSetting& offered, SaidSettings& said, const std::string& note) {
  SaidSetting& to = said[offered.flag];
  cli.stands_for(offered.flag, offered.member);
  const Setting& s = offered.setting;
  const std::string what = s.what + (offered.readers.empty() ? "" : "; " + offered.readers) + note;
  using Kind = OfferedSetting::Kind;
  if (offered.kind == Kind::number)
    cli.option(offered.flag, to.number, what, s.unit, s.range);
  else if (offered.kind == Kind::count)
    cli.option(offered.flag, to.count, what, s.unit, s.range);
  else if (offered.kind == Kind::seed)
    cli.option(offered.flag, to.seed, what);
  else if (offered.kind == Kind::choice && offered.fixed.empty())
    cli.choice(offered.flag, to.choice, what, offered.names);
  else
    cli.flag(offered.flag, to.toggle, what);
}

void refuse_unread_flags(const Cli& cli, const std::vector<OfferedSetting>& offered) {
  for (const OfferedSetting& one : offered) {
    const auto is_read = [&](const OfferedSetting& other) {
      return other.flag == one.flag && other.unread_with.empty();
    };
    if (one.unread_with.empty() || !cli.offers(one.flag) || !cli.is_given(one.flag) ||
        std::ranges::any_of(offered, is_read))
      continue;
    throw std::invalid_argument(one.flag + " has no effect with " + one.unread_with +
                                (one.readers.starts_with("only") ? ", " + one.readers : ""));
  }
}

void add_flags(Cli& cli, const std::vector<OfferedSetting>& offered, SaidSettings& said,
               const std::vector<std::string>& flags) {
  for (const std::string& flag : flags) {
    const auto one = std::ranges::find(offered, flag, &OfferedSetting::flag);
    if (one == offered.end()) throw std::logic_error(flag + " is not offered");
    add_flag(cli, *one, said);
  }
}

}  // namespace aussois
