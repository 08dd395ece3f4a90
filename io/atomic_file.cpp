// SPDX-License-Identifier: Apache-2.0
#include "io/atomic_file.hpp"

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <random>
#include <stdexcept>
#include <system_error>
#include <unistd.h>
#include <utility>

#include <sys/file.h>
#include <sys/stat.h>

namespace aussois {
namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
  throw std::runtime_error(path.string() + ": " + what);
}

std::string reason() {
  return errno != 0 ? std::strerror(errno) : "the stream failed";
}

/// In the same folder, so that the rename cannot cross file systems.
std::filesystem::path unique_name(const std::filesystem::path& path) {
  std::random_device random;
  char text[32];
  std::snprintf(text, sizeof text, ".%08x%08x.tmp", random(), random());
  std::filesystem::path unique = path;
  return unique += text;
}

bool same_file(int descriptor, const std::filesystem::path& path) {
  struct stat opened = {};
  struct stat named = {};
  return fstat(descriptor, &opened) == 0 && stat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

}  // namespace

void sync_to_disk(const std::filesystem::path& path) {
  const int descriptor = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0 && errno == EACCES) return;  // a folder that we may write and not read
  const bool synced = descriptor >= 0 && (fsync(descriptor) == 0 || errno == EINVAL);  // EINVAL: it cannot
  const std::string why = reason();
  if (descriptor >= 0) close(descriptor);
  if (!synced) fail(path, "cannot be flushed to disk: " + why);
}

void publish_file(const std::filesystem::path& complete, const std::filesystem::path& path) {
  sync_to_disk(complete);
  std::error_code failed;
  std::filesystem::rename(complete, path, failed);
  if (failed) fail(path, "cannot rename " + complete.string() + " to it: " + failed.message());
  sync_to_disk(path.has_parent_path() ? path.parent_path() : ".");
}

void write_atomically(const std::filesystem::path& path,
                      const std::function<void(const std::filesystem::path&)>& write) {
  const std::filesystem::path temporary = unique_name(path);
  try {
    write(temporary);
    publish_file(temporary, path);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw;
  }
}

void write_whole_file(const std::filesystem::path& path, std::string_view content) {
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    errno = 0;
    std::ofstream file(temporary, std::ios::binary);
    file.write(content.data(), std::streamsize(content.size()));
    file.close();
    if (!file) fail(path, "cannot be written: " + reason());
  });
}

std::filesystem::path growing_name(const std::filesystem::path& path) {
  std::filesystem::path growing = path;
  return growing += ".tmp";
}

WriterLock::WriterLock(const std::filesystem::path& path) : path_(path) {
  do {
    if (descriptor_ >= 0) close(descriptor_);
    descriptor_ = open(path.c_str(), O_RDWR | O_CLOEXEC);
    if (descriptor_ < 0) return;  // none, or not writable: the code that makes or opens it reports that
    if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      close(descriptor_);
      fail(path, "another run is writing it: wait until it ends, or choose another folder");
    }
  } while (!same_file(descriptor_, path));  // renamed or removed before it was ours
}

WriterLock::~WriterLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

WriterLock::WriterLock(WriterLock&& other) noexcept
    : path_(std::move(other.path_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

WriterLock& WriterLock::operator=(WriterLock&& other) noexcept {
  std::swap(path_, other.path_);
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

void WriterLock::remove_file() {
  std::error_code ignored;  // the code that makes the new file reports what is in the way
  if (descriptor_ >= 0) std::filesystem::remove(path_, ignored);
}

}  // namespace aussois
