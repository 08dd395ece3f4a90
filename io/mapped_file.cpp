// SPDX-License-Identifier: Apache-2.0
#include "io/mapped_file.hpp"

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <stdexcept>
#include <unistd.h>
#include <vector>

#include <sys/mman.h>
#include <sys/stat.h>

namespace aussois {
namespace {

class Descriptor {
 public:
  explicit Descriptor(const std::filesystem::path& path)
      : path_(path), descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (descriptor_ < 0) fail(std::strerror(errno));
  }
  ~Descriptor() { close(descriptor_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  operator int() const { return descriptor_; }

  [[noreturn]] void fail(const std::string& why) const {
    throw std::runtime_error(path_.string() + ": cannot be read: " + why);
  }

 private:
  const std::filesystem::path& path_;
  int descriptor_;
};

void map(const Descriptor& file, std::size_t size, FileBytes& out) {
  void* const place = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
  if (place == MAP_FAILED) file.fail(std::strerror(errno));
  out.owner =
      std::shared_ptr<const void>(place, [size](const void* p) { munmap(const_cast<void*>(p), size); });
  out.bytes = {static_cast<const std::byte*>(place), size};
  out.mapped = true;
}

// As far from the next multiple of a cache line as a mapping is: at none.
struct alignas(64) Line {
  std::byte byte[64];
};

void copy(const Descriptor& file, std::size_t size, FileBytes& out) {
  const auto lines = std::make_shared<std::vector<Line>>((size + sizeof(Line) - 1) / sizeof(Line));
  auto* const place = reinterpret_cast<std::byte*>(lines->data());
  for (std::size_t done = 0; done < size;) {
    const ssize_t got = read(file, place + done, size - done);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) file.fail(got < 0 ? std::strerror(errno) : "it became shorter");
    done += std::size_t(got);
  }
  out.owner = lines;
  out.bytes = {place, size};
}

}  // namespace

FileBytes bytes_of_file(const std::filesystem::path& path) {
  const Descriptor file(path);
  struct stat status = {};
  if (fstat(file, &status) != 0) file.fail(std::strerror(errno));
  if (!S_ISREG(status.st_mode)) file.fail("it is no regular file");
  FileBytes out{.device = status.st_dev, .inode = status.st_ino};
  if (status.st_size == 0) return out;
  const bool fixed = (status.st_mode & (S_IWUSR | S_IWGRP | S_IWOTH)) == 0;
  (fixed ? map : copy)(file, std::size_t(status.st_size), out);
  return out;
}

void drop_pages(const FileBytes& bytes) {
  if (bytes.mapped) madvise(const_cast<std::byte*>(bytes.bytes.data()), bytes.bytes.size(), MADV_DONTNEED);
}

bool is_file(int descriptor, const FileBytes& bytes) {
  struct stat status = {};
  return fstat(descriptor, &status) == 0 && status.st_dev == bytes.device && status.st_ino == bytes.inode;
}

void forbid_writing(const std::filesystem::path& path) {
  using std::filesystem::perms;
  std::filesystem::permissions(path, perms::owner_write | perms::group_write | perms::others_write,
                               std::filesystem::perm_options::remove);
}

}  // namespace aussois
