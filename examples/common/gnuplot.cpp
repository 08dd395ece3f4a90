// SPDX-License-Identifier: Apache-2.0
#include "examples/common/gnuplot.hpp"

#include <cstdio>
#include <unistd.h>

#include <sys/wait.h>

namespace aussois {

bool run_gnuplot(const std::filesystem::path& folder, const std::string& script) {
  const pid_t child = fork();
  if (child < 0) return false;
  if (child == 0) {
    if (chdir(folder.c_str()) == 0) execlp("gnuplot", "gnuplot", script.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  int status = 0;
  return waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

void tell_no_picture() {
  std::fprintf(stderr, "no picture: gnuplot is missing or failed\n");
}

}  // namespace aussois
