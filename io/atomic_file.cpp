// SPDX-License-Identifier: Apache-2.0
#include "io/atomic_file.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <system_error>

namespace aussois {

std::filesystem::path temporary_name(const std::filesystem::path& path) {
  std::filesystem::path temporary = path;
  temporary += ".tmp";
  return temporary;
}

void publish(const std::filesystem::path& temporary, const std::filesystem::path& path) {
  std::error_code failed;
  std::filesystem::rename(temporary, path, failed);
  if (failed)
    throw std::runtime_error(path.string() + ": cannot rename " + temporary.string() +
                             " to it: " + failed.message());
}

void write_whole_file(const std::filesystem::path& path, std::string_view content) {
  const std::filesystem::path temporary = temporary_name(path);
  errno = 0;
  std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
  file.write(content.data(), std::streamsize(content.size()));
  file.close();
  std::error_code ignored;
  if (!file) {
    const std::string reason = errno != 0 ? std::strerror(errno) : "the stream failed";
    std::filesystem::remove(temporary, ignored);
    throw std::runtime_error(path.string() + ": cannot be written: " + reason);
  }
  try {
    publish(temporary, path);
  } catch (...) {
    std::filesystem::remove(temporary, ignored);
    throw;
  }
}

}  // namespace aussois
