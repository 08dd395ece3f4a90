// SPDX-License-Identifier: Apache-2.0
// The targets without libFuzzer: every file of the folders that the command line names, once. Those whose
// names begin with "good" have to be accepted, or nothing behind the reader's first refusal would be tried.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

#include <sys/resource.h>

#include "tests/fuzz/readers.hpp"

int main(int argc, char** argv) {
#ifdef AUSSOIS_FUZZ_MEMORY  // [bytes]: sanitizers reserve terabytes
  const rlimit limit{AUSSOIS_FUZZ_MEMORY, AUSSOIS_FUZZ_MEMORY};
  setrlimit(RLIMIT_AS, &limit);
#endif
  std::vector<std::filesystem::path> files;
  for (int i = 1; i < argc; ++i)
    for (const auto& entry : std::filesystem::directory_iterator(argv[i])) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  int refused = 0;
  for (const std::filesystem::path& file : files) {
    std::ifstream in(file, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
    std::printf("%s, %zu bytes\n", file.c_str(), bytes.size());
    std::fflush(stdout);  // the last line names the culprit
    const bool accepted =
        aussois::is_accepted({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()});
    if (accepted || !file.filename().string().starts_with("good")) continue;
    std::printf("  is refused\n");
    ++refused;
  }
  std::printf("%zu files\n", files.size());
  return files.empty() || refused > 0;
}
