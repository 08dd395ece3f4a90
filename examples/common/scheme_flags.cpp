// SPDX-License-Identifier: Apache-2.0
#include "examples/common/scheme_flags.hpp"

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include "io/network_file.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

// A flag, with the options that it sets.
struct SchemeFlag {
  OfferedSetting first{};
  std::vector<std::string> paths{}, members{};
};

std::vector<SchemeFlag> flags_of(const SchemeOptions& options, SaidSettings& said) {
  SchemeOptions shown = options;
  std::vector<SchemeFlag> out;
  for (const OfferedSetting& one : offered(shown, said)) {
    const auto known =
        std::ranges::find_if(out, [&](const SchemeFlag& f) { return f.first.flag == one.flag; });
    if (known == out.end())
      out.push_back({one, {one.path}, {one.member}});
    else if (known->first.usual != one.usual)
      throw std::logic_error(one.flag + ": " + known->first.path + " = " + known->first.usual + " and " +
                             one.path + " = " + one.usual + " share the flag");
    else
      known->paths.push_back(one.path), known->members.push_back(one.member);
  }
  return out;
}

// The schemes that read one of the options.
std::vector<std::string> readers_of(const std::vector<std::string>& paths,
                                    const std::vector<std::string>& schemes) {
  std::vector<std::string> out;
  for (const std::string& scheme : schemes) {
    const std::vector<std::string> unread = unread_by(scheme);
    if (std::ranges::any_of(
            paths, [&](const std::string& path) { return std::ranges::find(unread, path) == unread.end(); }))
      out.push_back(scheme);
  }
  return out;
}

std::string listed(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

// "; only for moreau_jean", or "; not for event_driven" if that is shorter.
std::string scope(const std::vector<std::string>& readers, const std::vector<std::string>& schemes) {
  std::vector<std::string> others;
  std::ranges::copy_if(schemes, std::back_inserter(others), [&](const std::string& scheme) {
    return std::ranges::find(readers, scheme) == readers.end();
  });
  if (others.empty()) return {};
  return others.size() < readers.size() ? "; not for " + listed(others) : "; only for " + listed(readers);
}

void add(Cli& cli, SchemeFlags& f, const std::vector<SchemeFlag>& all, bool of_solver) {
  for (const SchemeFlag& flag : all) {
    const std::vector<std::string> readers = readers_of(flag.paths, f.schemes);
    if (flag.first.path.starts_with("step.solver.") != of_solver || readers.empty() ||
        std::ranges::find(f.left_out, flag.first.flag) != f.left_out.end())
      continue;
    add_flag(cli, flag.first, f.said, scope(readers, f.schemes));
    for (const std::string& member : flag.members) cli.stands_for(flag.first.flag, member);
  }
}

void set_selector(const SchemeFlags& f, ReductionOptions& options) {
  if (f.selector.empty()) return;
  options.reducer = Reducer::selector;
  options.selector = contact_selector(read_selector(f.selector), BodyId::at(f.selector_body));
}

}  // namespace

SchemeFlags::SchemeFlags() = default;

void start_from_theta(SchemeOptions& options, double theta) {
  options.moreau_jean.theta = options.moreau_jean_projected.theta = theta;
}

void add_options(Cli& cli, SchemeFlags& f) {
  const std::vector<SchemeFlag> all = flags_of(f.options, f.said);
  cli.group("scheme");
  cli.choice("--scheme", f.scheme, "scheme to run", f.schemes, f.not_offered);
  add(cli, f, all, false);
  cli.input(
      "--selector", f.selector,
      "replace --reducer by a learned selector, such as mlc_*.txt from peg_plate train on a surface set");
  cli.stands_for("--selector", "ReductionOptions::selector");
  cli.option("--selector-body", f.selector_body,
             "index in the model, from 0, of the body on which the selector acts", "", {0, 1e6});
  cli.group("solver");
  add(cli, f, all, true);
}

void refuse_unread_flags(const Cli& cli, const SchemeFlags& f) {
  if (f.selector.empty()) refuse_given(cli, {"--selector-body"}, "--selector");
  SaidSettings said;
  const std::vector<SchemeFlag> all = flags_of(f.options, said);
  for (const char* group : {"scheme", "solver"})
    for (const std::string& flag : cli.given(group)) {
      const auto known = std::ranges::find_if(all, [&](const SchemeFlag& s) { return s.first.flag == flag; });
      if (known == all.end() || !readers_of(known->paths, {f.scheme}).empty()) continue;
      throw std::invalid_argument(flag + " is not read by " + f.scheme + ", only by " +
                                  listed(readers_of(known->paths, f.schemes)));
    }
  SchemeOptions chosen = f.options;
  take(f.said, chosen);
  refuse_unread_flags(cli, chosen);
}

SchemeOptions scheme_options(const SchemeFlags& f) {
  SchemeOptions out = f.options;
  take(f.said, out);
  set_selector(f, out.step.reduction);
  return out;
}

SchemeOptions scheme_options(const Cli& cli, const SchemeFlags& f, SchemeOptions others) {
  SaidSettings said;
  for (const char* group : {"scheme", "solver"})
    for (const std::string& flag : cli.given(group))
      if (const auto known = f.said.find(flag); known != f.said.end()) said.insert(*known);
  take(said, others);
  set_selector(f, others.step.reduction);
  return others;
}

std::string choice_text(const SchemeFlags& f, const SchemeOptions& options) {
  std::string text = f.scheme;
  for (const std::string& setting : settings_text(options)) (text += '\n') += setting;
  if (!f.selector.empty())
    text += "\nselector of body " + std::to_string(f.selector_body) + "\n" + read_file(f.selector);
  return text;
}

}  // namespace aussois
