// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/friction/profile_table.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstring>
#include <ctime>
#include <poll.h>
#include <stdexcept>
#include <unistd.h>

#include <sys/wait.h>

#include "examples/common/driver.hpp"
#include "geometry/check.hpp"
#include "geometry/digest.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

constexpr const char* kHead =
    "digest,solver,tolerance,max_iterations,status,solved,iterations,scaled_residual,natural_map_residual,"
    "cpu_s,time_limit,contacts,problem";
constexpr std::size_t kFields = 13;

/// As spreadsheets want a text: in quotes, those inside doubled; on one line.
std::string in_quotes(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : c == '\n' || c == '\r' ? " " : std::string(1, c);
  return out + '"';
}

std::string out_of_quotes(std::string_view text) {
  require(text.size() >= 2 && text.front() == '"' && text.back() == '"', "problem is not in quotes");
  std::string out;
  for (std::size_t i = 1; i + 1 < text.size(); ++i) {
    out += text[i];
    if (text[i] == '"') ++i;
  }
  return out;
}

std::string hex(std::uint64_t value) {
  char text[20];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

template <class Number, class... Base>
Number parsed(std::string_view text, const char* field, Base... base) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base...);
  require(error == std::errc() && end == text.data() + text.size(),
          std::string(field) + " = " + quoted(text) + " is not a number");
  return value;
}

/// The child of run_limited: everything that it has to say is one line. What it throws ends it.
[[noreturn]] void run_and_tell(const std::filesystem::path& path, const RunOptions& options,
                               int pipe_end) noexcept {
  const std::string line = to_line({}, result_of(run_problem(path, options)));
  const bool told = write(pipe_end, line.data(), line.size()) == ssize_t(line.size());
  _exit(told ? 0 : 1);
}

double cpu_seconds_of(pid_t process) {
  clockid_t clock{};
  timespec now{};
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &now) != 0) return 0;
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

struct Told {
  std::string text{};
  bool in_time = true;
};

/// All that a child says until it closes its end; nothing more after a signal, or `time_limit` of its CPU
/// time. It is looked at from here: a limit that the system watches makes the child's own clock tick
/// coarsely.
Told listen_to(pid_t child, int pipe_end, double time_limit) {
  Told told;
  std::array<char, 4096> part{};
  while (!interrupted()) {
    const double left = time_limit - cpu_seconds_of(child);
    if (left <= 0) return {.in_time = false};
    pollfd end{.fd = pipe_end, .events = POLLIN, .revents = 0};
    if (poll(&end, 1, int(std::clamp(500 * left, 1.0, 100.0))) <= 0) continue;  // milliseconds; or a signal
    const ssize_t count = read(pipe_end, part.data(), part.size());
    if (count == 0 || (count < 0 && errno != EINTR)) break;
    if (count > 0) told.text.append(part.data(), std::size_t(count));
  }
  return told;
}

}  // namespace

ProfileResult result_of(const ProblemRun& run) {
  return {.status = run.status,
          .solved = run.solved,
          .iterations = run.report.iterations,
          .scaled_residual = run.scaled_residual,
          .natural_map_residual = run.natural_map_residual,
          .cpu_s = run.cpu_s,
          .contacts = run.contacts,
          .problem = run.problem};
}

std::uint64_t file_digest(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path)) return 0;
  const std::string bytes = read_file(path);
  Digest digest;
  digest.add(std::as_bytes(std::span(bytes.data(), bytes.size())));
  return digest.value;
}

std::string to_line(const ProfileKey& key, const ProfileResult& result) {
  std::string line = hex(key.digest) + ',' + key.solver + ',';
  const auto add = [&](double value) {
    append_number(line, value);
    line += ',';
  };
  add(key.tolerance);
  line += std::to_string(key.max_iterations) + ',';
  line += result.status + ',' + (result.solved ? "1," : "0,") + std::to_string(result.iterations) + ',';
  add(result.scaled_residual);
  add(result.natural_map_residual);
  add(result.cpu_s);
  add(result.time_limit);
  return line + std::to_string(result.contacts) + ',' + in_quotes(result.problem);
}

std::pair<ProfileKey, ProfileResult> from_line(const std::string& line) {
  std::array<std::string_view, kFields> field;
  std::string_view rest = line;
  for (std::size_t i = 0; i + 1 < kFields; ++i) {
    const std::size_t comma = rest.find(',');
    require(comma != rest.npos, "has " + std::to_string(i + 1) + " fields, must have 13");
    field[i] = rest.substr(0, comma);
    rest.remove_prefix(comma + 1);
  }
  return {{.digest = parsed<std::uint64_t>(field[0], "digest", 16),
           .solver = std::string(field[1]),
           .tolerance = parsed<double>(field[2], "tolerance"),
           .max_iterations = parsed<int>(field[3], "max_iterations")},
          {.status = std::string(field[4]),
           .solved = parsed<int>(field[5], "solved") != 0,
           .iterations = parsed<int>(field[6], "iterations"),
           .scaled_residual = parsed<double>(field[7], "scaled_residual"),
           .natural_map_residual = parsed<double>(field[8], "natural_map_residual"),
           .cpu_s = parsed<double>(field[9], "cpu_s"),
           .time_limit = parsed<double>(field[10], "time_limit"),
           .contacts = parsed<int>(field[11], "contacts"),
           .problem = out_of_quotes(rest)}};
}

ProfileTable::ProfileTable(std::filesystem::path path) : path_(std::move(path)) {
  std::string text;
  if (std::filesystem::exists(path_) && std::filesystem::file_size(path_) > 0) text = read_file(path_);
  const std::size_t whole = text.rfind('\n') + 1;  // npos + 1 = 0
  TextReader reader(path_, std::string_view(text).substr(0, whole));
  if (whole > 0 && reader.rest_of_line() != kHead)
    throw std::runtime_error(path_.string() + ":1: is not a table of solver_profile");
  for (int number = 2; !reader.at_end(); ++number) {
    try {
      auto [key, result] = from_line(std::string(reader.rest_of_line()));
      results_.insert_or_assign(std::move(key), std::move(result));
    } catch (const std::invalid_argument& error) {
      reader.fail_at(number, error.what());
    }
  }
  if (whole < text.size()) std::filesystem::resize_file(path_, whole);
  file_.reset(std::fopen(path_.c_str(), "ab"));
  if (!file_) throw std::runtime_error(path_.string() + ": cannot be written: " + std::strerror(errno));
  if (whole == 0) std::fprintf(file_.get(), "%s\n", kHead);
}

const ProfileResult* ProfileTable::find(const ProfileKey& key, double time_limit) const {
  const auto found = results_.find(key);
  if (found == results_.end()) return nullptr;
  const ProfileResult& result = found->second;
  return result.status == "time_limit" && result.time_limit < time_limit ? nullptr : &result;
}

void ProfileTable::add(const ProfileKey& key, const ProfileResult& result) {
  results_[key] = result;
  std::fprintf(file_.get(), "%s\n", to_line(key, result).c_str());
  if (std::fflush(file_.get()) != 0)
    throw std::runtime_error(path_.string() + ": cannot be written: " + std::strerror(errno));
}

ProfileResult run_limited(const std::filesystem::path& path, const RunOptions& options, double time_limit) {
  require_field(time_limit > 0 && time_limit < 1e8, "time_limit", time_limit, "lie in (0, 1e8) [s]");
  validate(options.solver);
  ProfileResult result{.status = "crashed", .problem = path.stem().string()};
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error(std::string("pipe: ") + std::strerror(errno));
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    run_and_tell(path, options, ends[1]);
  }
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  }
  const Told told = listen_to(child, ends[0], time_limit);
  close(ends[0]);
  if (interrupted() || !told.in_time) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (interrupted())
    result.status = "interrupted";
  else if (!told.in_time)
    result.status = "time_limit";
  else if (WIFEXITED(status) && WEXITSTATUS(status) == 0)
    result = from_line(told.text).second;
  result.time_limit = time_limit;
  return result;
}

}  // namespace aussois
