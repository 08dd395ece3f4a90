// SPDX-License-Identifier: Apache-2.0
// What code says where memory is scarce.
#pragma once

#include <exception>
#include <string>
#include <unistd.h>

#include <sys/resource.h>
#include <sys/wait.h>

namespace aussois {

/// The message of what `f` throws in a process that may have two gigabytes; "" if it throws nothing. (Where
/// sanitizers reserve terabytes for themselves, AUSSOIS_LIMIT_MEMORY is not defined, and it may have all.)
template <class F>
std::string message_with_little_memory(const F& f) {
  int ends[2];
  if (pipe(ends) != 0) return "no pipe";
  const pid_t child = fork();
  if (child == 0) {
#ifdef AUSSOIS_LIMIT_MEMORY
    const rlimit limit{2000000000, 2000000000};
    setrlimit(RLIMIT_AS, &limit);
#endif
    std::string message;
    try {
      f();
    } catch (const std::exception& error) {
      message = error.what();
    }
    _exit(write(ends[1], message.data(), message.size()) == ssize_t(message.size()) ? 0 : 1);
  }
  close(ends[1]);
  std::string message;
  char block[256];
  for (ssize_t count = 0; (count = read(ends[0], block, sizeof block)) > 0;)
    message.append(block, std::size_t(count));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  return status == 0 ? message : "crashed";
}

/// The most memory that a process has which does `f` and nothing else [bytes]; -1: it failed.
template <class F>
double peak_memory_of(const F& f) {
  const pid_t child = fork();
  if (child == 0) {
    try {
      f();
    } catch (const std::exception&) {
      _exit(1);
    }
    _exit(0);
  }
  int status = 0;
  rusage used{};
  wait4(child, &status, 0, &used);
  return status == 0 ? 1024.0 * double(used.ru_maxrss) : -1;
}

}  // namespace aussois
