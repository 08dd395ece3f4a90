// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/friction/limited_run.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <ctime>
#include <poll.h>
#include <stdexcept>
#include <unistd.h>

#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/wait.h>

#include "examples/common/driver.hpp"
#include "geometry/check.hpp"

namespace aussois {
namespace {

/// Ends this process with `parent`, whatever ends that. Elsewhere than on Linux it goes on to its own end.
void end_with(pid_t parent) noexcept {
#ifdef __linux__
  if (prctl(PR_SET_PDEATHSIG, SIGKILL) == 0 && getppid() != parent) _exit(1);  // it had ended before
#else
  static_cast<void>(parent);
#endif
}

/// The child of run_limited: all that it has to say is its result as JSON. What it throws ends it.
[[noreturn]] void run_and_tell(const std::filesystem::path& path, const RunOptions& options,
                               int pipe_end) noexcept {
  const std::string text = to_json(result_of(run_problem(path, options)));
  const bool written = write(pipe_end, text.data(), text.size()) == ssize_t(text.size());
  _exit(written ? 0 : 1);
}

double cpu_seconds_of(pid_t process) {
  clockid_t clock{};
  timespec now{};
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &now) != 0) return 0;
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

struct ChildReport {
  std::string text{};
  bool in_time = true;
};

/// All that a child says until it closes its end; nothing more after a signal, or `time_limit` of its CPU
/// time. It is looked at from here: a limit that the system watches makes the child's own clock tick
/// coarsely.
ChildReport listen_to(pid_t child, int pipe_end, double time_limit) {
  ChildReport report;
  std::array<char, 4096> part{};
  while (!interrupted()) {
    const double left = time_limit - cpu_seconds_of(child);
    if (left <= 0) return {.in_time = false};
    pollfd end{.fd = pipe_end, .events = POLLIN, .revents = 0};
    if (poll(&end, 1, int(std::clamp(500 * left, 1.0, 100.0))) <= 0) continue;  // milliseconds; or a signal
    const ssize_t count = read(pipe_end, part.data(), part.size());
    if (count == 0 || (count < 0 && errno != EINTR)) break;
    if (count > 0) report.text.append(part.data(), std::size_t(count));
  }
  return report;
}

}  // namespace

ProfileResult run_limited(const std::filesystem::path& path, const RunOptions& options, double time_limit) {
  require_field(time_limit > 0 && time_limit < 1e8, "time_limit", time_limit, "lie in (0, 1e8) [s]");
  validate(options);
  ProfileResult result{.status = "crashed", .problem = path.stem().string()};
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error(std::string("pipe: ") + std::strerror(errno));
  const pid_t parent = getpid(), child = fork();
  if (child == 0) {
    end_with(parent);
    close(ends[0]);
    run_and_tell(path, options, ends[1]);
  }
  close(ends[1]);
  if (child < 0) {
    close(ends[0]);
    throw std::runtime_error(std::string("fork: ") + std::strerror(errno));
  }
  const ChildReport report = listen_to(child, ends[0], time_limit);
  close(ends[0]);
  if (interrupted() || !report.in_time) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (interrupted())
    result.status = "interrupted";
  else if (!report.in_time)
    result.status = "time_limit";
  else if (WIFEXITED(status) && WEXITSTATUS(status) == 0)
    result = profile_result_in(report.text);
  result.time_limit = time_limit;
  return result;
}

}  // namespace aussois
