// SPDX-License-Identifier: Apache-2.0
// The one translation unit that knows CLI11 (seven seconds of compile time).
#include "examples/common/driver.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <map>
#include <unistd.h>

#include <CLI/CLI.hpp>

#include "geometry/number_text.hpp"
#include "io/build_info.hpp"
#include "io/mapped_file.hpp"
#include "io/recording.hpp"

namespace aussois {
namespace {

volatile std::sig_atomic_t stop_requested = 0;
extern "C" void request_stop(int) {
  stop_requested = 1;
}

// Of a mapped file whose end is gone: named, where it would be a crash.
const char* driver_name = "";
void say(const char* text) {
  static_cast<void>(!write(STDERR_FILENO, text, std::strlen(text)));
}
extern "C" void stop_at_missing_page(int signal, siginfo_t* info, void*) {
  if (const char* const path = mapped_path_at(info->si_addr)) {
    for (const char* const text : {driver_name, ": ", path, ": was cut off while it was in use\n"}) say(text);
    _exit(static_cast<int>(ExitCode::missing));
  }
  std::signal(signal, SIG_DFL);  // of something else: it comes again, and kills
}

void watch_signals(const std::string& name) {
  driver_name = name.c_str();
  struct sigaction action {};
  action.sa_handler = request_stop;
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // the second signal kills
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  action.sa_sigaction = stop_at_missing_page;
  action.sa_flags = SA_SIGINFO;
  sigaction(SIGBUS, &action, nullptr);
}

std::string text_of(double value) {
  return number_text(value);
}
std::string text_of(int value) {
  return std::to_string(value);
}
std::string text_of(std::uint64_t value) {
  return std::to_string(value);
}
std::string text_of(const std::string& value) {
  return value;
}
std::string text_of(const std::filesystem::path& value) {
  return value.string();
}
template <class Word>
std::string text_of(const std::vector<Word>& words) {
  std::string text;
  for (const Word& word : words) text += (text.empty() ? "" : " ") + text_of(word);
  return text;
}
std::string text_of(bool value) {
  return value ? "yes" : "no";
}

bool needs_quotes(const std::string& word) {
  return word.empty() || word.find_first_of(" \t\n\"'\\$*?;&|<>()#`") != std::string::npos;
}

/// The words between the commas of `text` that stand in no brackets, without blanks around them.
std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> out(1);
  int brackets = 0;
  for (const char x : text) {
    brackets += (x == '(') - (x == ')');
    if (x == ',' && brackets == 0)
      out.emplace_back();
    else if (x != ' ' || !out.back().empty())
      out.back() += x;
  }
  for (std::string& word : out) word.erase(word.find_last_not_of(' ') + 1);
  std::erase(out, "");
  return out;
}

int fail(const std::string& name, const std::string& what, ExitCode code) {
  std::fprintf(stderr, "%s: %s\n", name.c_str(), what.c_str());
  return static_cast<int>(code);
}

int exit_code_of(const Cli& cli, const std::function<ExitCode()>& body) {
  try {
    return static_cast<int>(body());
  } catch (const std::invalid_argument& wrong) {
    return fail(cli.name(), cli.said_with_flags(wrong.what()), ExitCode::usage);
  } catch (const NumericalFailure& wrong) {
    return fail(cli.name(), wrong.what(), ExitCode::numerical);
  } catch (const std::runtime_error& wrong) {
    return fail(cli.name(), wrong.what(), ExitCode::missing);
  } catch (const std::exception& wrong) {
    return fail(cli.name(), wrong.what(), ExitCode::numerical);
  }
}

}  // namespace

struct Cli::Impl {
  struct Entry {
    std::string group{}, flag{}, placeholder{}, what{}, unit{}, bound{}, initial{};
    std::function<std::string()> value{};
  };
  std::string name{}, what{}, group = "scene";
  std::vector<Entry> entries{};
  std::vector<std::pair<std::string, std::string>> examples{};
  std::vector<std::pair<std::string, const std::filesystem::path*>> inputs{};
  std::vector<std::vector<std::string>*> lists{};
  const std::vector<std::filesystem::path>* files = nullptr;
  CommonOptions* restarts = nullptr;
  std::map<std::string, std::string> flag_of{};  // by "Struct::member"
  std::map<const void*, CLI::Option*> set_by{};  // by the variable
  CLI::App app{};
  bool show_help = false, show_version = false;

  // A flag stands where the value of another one should: that one is to be named, not what comes after.
  std::string without_value(int argc, const char* const* argv) const {
    const auto entry_of = [&](const std::string& word) {
      return std::ranges::find_if(entries, [&](const Entry& e) {
        return ("," + e.flag + ",").find("," + word + ",") != std::string::npos;
      });
    };
    for (int i = 1; i < argc; ++i) {
      const auto entry = entry_of(argv[i]);
      if (argv[i][0] != '-' || entry == entries.end() || entry->placeholder.empty()) continue;
      if (++i == argc) return std::string(argv[i - 1]) + " needs a value";
      if (const std::string next = argv[i];
          next.starts_with("--") || next == "-o" || (next[0] == '-' && entry_of(next) != entries.end()))
        return std::string(argv[i - 1]) + " needs a value, not " + argv[i];
    }
    return {};
  }

  template <class T>
  CLI::Option* add(const std::string& flag, T& value, const std::string& placeholder, const std::string& text,
                   const std::string& unit, const std::string& bound) {
    entries.push_back(
        {group, flag, placeholder, text, unit, bound, text_of(value), [&value] { return text_of(value); }});
    CLI::Option* option = app.add_option(flag, value);
    const auto [other, alone] = set_by.emplace(&value, option);
    if (!alone) option->excludes(other->second);  // two names of one thing: the second would win in silence
    return option;
  }
  template <class Number>
  void add_number(const std::string& flag, Number& value, const std::string& text, const std::string& unit,
                  const Range& range) {
    add(flag, value, "NUMBER", text, unit, range_text(range))->check([range](const std::string& word) {
      double number = 0;
      if (!CLI::detail::lexical_cast(word, number) || std::isnan(number))
        return "'" + word + "' is not a number";
      if (contains(range, number)) return std::string();
      return word + " must be " + range_text(range);
    });
  }
};

Cli::Cli(std::string name, std::string what) : impl_(std::make_unique<Impl>()) {
  impl_->name = std::move(name);
  impl_->what = std::move(what);
  impl_->app.set_help_flag();
  impl_->app.add_flag("-h,--help", impl_->show_help);
  impl_->app.add_flag("--version", impl_->show_version);
}
Cli::~Cli() = default;

void Cli::group(std::string heading) {
  impl_->group = std::move(heading);
}

void Cli::option(const std::string& flag, double& value, const std::string& what, const std::string& unit,
                 Range range) {
  impl_->add_number(flag, value, what, unit, range);
}
void Cli::option(const std::string& flag, int& value, const std::string& what, const std::string& unit,
                 Range range) {
  impl_->add_number(flag, value, what, unit, range);
}
void Cli::option(const Setting& setting, double& value) {
  option(setting.flag, value, setting.what, setting.unit, setting.range);
}
void Cli::option(const Setting& setting, int& value) {
  option(setting.flag, value, setting.what, setting.unit, setting.range);
}
void Cli::option(const std::string& flag, std::uint64_t& value, const std::string& what,
                 const std::string& unit) {
  impl_->add_number(flag, value, what, unit, {0, std::numeric_limits<double>::infinity()});
}
void Cli::option(const std::string& flag, std::string& value, const std::string& what) {
  impl_->add(flag, value, "TEXT", what, "", "");
}
void Cli::option(const std::string& flag, std::filesystem::path& value, const std::string& what) {
  impl_->add(flag, value, "PATH", what, "", "");
}
void Cli::option(const std::string& flag, std::vector<std::string>& words, const std::string& what) {
  impl_->add(flag, words, "NAME...", what, "", "");
  impl_->lists.push_back(&words);
}
void Cli::flag(const std::string& flag, bool& value, const std::string& what) {
  impl_->entries.push_back({impl_->group, flag, "", what, "", "", "", [&value] { return text_of(value); }});
  impl_->app.add_flag(flag, value);
}
void Cli::choice(const std::string& flag, std::string& value, const std::string& what,
                 const std::vector<std::string>& choices, const std::string& note) {
  std::string list;
  for (const std::string& choice : choices) list += (list.empty() ? "" : ", ") + choice;
  if (!note.empty()) list += " (" + note + ")";
  impl_->add(flag, value, "NAME", what, "", "one of " + list)
      ->check([choices, list](const std::string& word) {
        const bool known = std::find(choices.begin(), choices.end(), word) != choices.end();
        return known ? std::string() : "'" + word + "' must be one of " + list;
      });
}
void Cli::input(const std::string& flag, std::filesystem::path& value, const std::string& what) {
  option(flag, value, what);
  impl_->inputs.emplace_back(flag, &value);
}
void Cli::files(std::vector<std::filesystem::path>& value, const std::string& what) {
  impl_->add("FILE", value, "...", what, "", "");
  impl_->files = &value;
}
void Cli::common(CommonOptions& options, Restart restart, Threads threads) {
  group("output");
  option(
      "-o,--out", options.out,
      std::string("folder for the results, created if missing") +
          (restart == Restart::by_itself ? "; runs that this program has already saved there are not repeated"
                                         : ""));
  option("--summary", options.summary, "also write the key numbers to this JSON file");
  if (threads == Threads::yes)
    option("--threads", options.threads, "number of threads; does not affect the results", "", kThreads);
  flag("--quiet", options.quiet, "omit progress and details; still print warnings and the result");
  if (restart != Restart::yes) return;
  option(setting_of<RecordingOptions>("every"), options.every);
  option(setting_of<RecordingOptions>("checkpoint_every"), options.checkpoint_every);
  flag("--resume", options.resume, "continue from the checkpoint in the folder for the results");
  flag("--resume-anyway", options.resume_anyway,
       "like --resume, but also from a checkpoint of another build of the program");
  impl_->restarts = &options;
}
void Cli::stands_for(const std::string& flag, const std::string& member) {
  impl_->flag_of[member] = flag;
}

std::string Cli::said_with_flags(std::string message) const {
  const auto in_word = [](char x) { return x == '_' || std::isalnum(static_cast<unsigned char>(x)); };
  for (const auto& [member, flag] : impl_->flag_of)
    for (std::size_t at = 0; (at = message.find(member, at)) != std::string::npos;) {
      const std::size_t end = at + member.size();
      const bool whole =
          (at == 0 || !in_word(message[at - 1])) && (end == message.size() || !in_word(message[end]));
      if (whole) message.replace(at, member.size(), flag);
      at += whole ? flag.size() : member.size();
    }
  return message;
}

void Cli::example(std::string command, std::string shows) {
  impl_->examples.emplace_back(std::move(command), std::move(shows));
}

std::string Cli::help() const {
  std::string text =
      impl_->what + "\n\nusage: " + impl_->name + " [options]" + (impl_->files ? " FILE...\n" : "\n");
  std::vector<std::string> left;
  std::size_t width = 0;
  for (const Impl::Entry& entry : impl_->entries) {
    left.push_back("  " + entry.flag + (entry.placeholder.empty() ? "" : " " + entry.placeholder));
    width = std::max(width, left.back().size());
  }
  std::string heading;
  for (std::size_t i = 0; i < left.size(); ++i) {
    const Impl::Entry& entry = impl_->entries[i];
    if (entry.group != heading) text += "\n" + (heading = entry.group) + "\n";
    text += left[i] + std::string(width + 2 - left[i].size(), ' ') + entry.what;
    if (!entry.unit.empty()) text += " [" + entry.unit + "]";
    if (!entry.bound.empty()) text += ", " + entry.bound;
    if (!entry.initial.empty()) text += ", default " + entry.initial;
    text += '\n';
  }
  text +=
      "\n  -h, --help  show this help\n  --version   show versions, compiler, flags and licence of this "
      "binary\n";
  if (!impl_->examples.empty()) text += "\nexamples\n";
  for (const auto& [command, shows] : impl_->examples) text += "  " + command + "\n      " + shows + "\n";
  text +=
      "\nexit codes: 0 success, 1 acceptance check failed, 2 usage error, 3 missing or unreadable file, 4 "
      "numerical failure, 130 interrupted\n";
  return text;
}

bool Cli::parse(int argc, const char* const* argv, ExitCode& code) {
  code = ExitCode::ok;
  if (const std::string flag = impl_->without_value(argc, argv); !flag.empty()) {
    fail(impl_->name, flag + " (try --help)", code = ExitCode::usage);
    return false;
  }
  try {
    impl_->app.parse(argc, argv);
  } catch (const CLI::ParseError& wrong) {
    fail(impl_->name, std::string(wrong.what()) + " (try --help)", code = ExitCode::usage);
    return false;
  }
  for (std::vector<std::string>* list : impl_->lists) {
    std::vector<std::string> words;
    for (const std::string& text : *list)
      for (std::string& word : words_of(text)) words.push_back(std::move(word));
    *list = words;
  }
  if (impl_->show_help) std::fputs(help().c_str(), stdout);
  if (impl_->show_version) std::printf("%s\n%s\n", impl_->name.c_str(), build_info().c_str());
  if (impl_->show_help || impl_->show_version) return false;
  if (impl_->files != nullptr && impl_->files->empty()) {
    fail(impl_->name, "give at least one FILE (try --help)", code = ExitCode::usage);
    return false;
  }
  if (impl_->restarts != nullptr && impl_->restarts->resume_anyway) impl_->restarts->resume = true;
  for (const auto& [flag, path] : impl_->inputs)
    if (!path->empty() && !std::filesystem::exists(*path)) {
      fail(impl_->name, flag + " " + path->string() + ": no such file or folder", code = ExitCode::missing);
      return false;
    }
  return true;
}

std::string Cli::values(const std::string& group) const {
  std::string text;
  for (const Impl::Entry& entry : impl_->entries)
    if (group.empty() || entry.group == group) text += entry.flag + " " + entry.value() + "\n";
  return text;
}

std::vector<std::string> Cli::given(const std::string& group) const {
  std::vector<std::string> out;
  for (const Impl::Entry& entry : impl_->entries)
    if (const std::string flag = entry.flag.substr(entry.flag.rfind(',') + 1);  // of "-o,--out"
        entry.group == group && impl_->app.count(flag) > 0)
      out.push_back(flag);
  return out;
}

bool Cli::offers(const std::string& flag) const {
  return impl_->app.get_option_no_throw(flag) != nullptr;
}

bool Cli::is_given(const std::string& flag) const {
  return impl_->app.count(flag) > 0;
}

const std::string& Cli::name() const {
  return impl_->name;
}

void refuse_given(const Cli& cli, const std::vector<std::string>& flags, const std::string& what) {
  for (const std::string& flag : flags) require(!cli.is_given(flag), flag + " needs " + what);
}

int run_driver(Cli& cli, int argc, const char* const* argv, const std::function<ExitCode()>& body) {
  ExitCode code = ExitCode::ok;
  if (!cli.parse(argc, argv, code)) return static_cast<int>(code);
  stop_requested = 0;
  watch_signals(cli.name());
  int result = exit_code_of(cli, body);
  for (const std::string& file : take_files_changed_while_mapped())
    result =
        fail(cli.name(), file + ": was written while it was in use; results may be wrong", ExitCode::missing);
  return result;
}

void make_folders(const CommonOptions& options) {
  for (const std::filesystem::path& folder : {options.summary.parent_path(), options.out})
    if (!folder.empty()) std::filesystem::create_directories(folder);
}

bool interrupted() {
  return stop_requested != 0;
}

std::string gap_text(double smallest_gap) {
  if (smallest_gap == std::numeric_limits<double>::infinity()) return "no contact";
  char text[48];
  std::snprintf(text, sizeof text, "smallest gap %.4g um", 1e6 * smallest_gap);
  return text;
}

std::string distance_text(double least_base_distance) {
  if (least_base_distance == std::numeric_limits<double>::infinity()) return "no bodies near each other";
  char text[64];
  std::snprintf(text, sizeof text, "base distance at least %.4g um", 1e6 * least_base_distance);
  return text;
}

std::string command_line(int argc, const char* const* argv) {
  std::string line;
  for (int i = 0; i < argc; ++i) {
    std::string word = i == 0 ? std::filesystem::path(argv[i]).filename().string() : argv[i];
    if (needs_quotes(word)) {
      for (std::size_t at = 0; (at = word.find('\'', at)) != std::string::npos; at += 4)
        word.replace(at, 1, "'\\''");
      word = "'" + word + "'";
    }
    line += (i == 0 ? "" : " ") + word;
  }
  return line;
}

}  // namespace aussois
