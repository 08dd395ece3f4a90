// SPDX-License-Identifier: Apache-2.0
#include "io/mapped_file.hpp"

#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <functional>
#include <mutex>
#include <stdexcept>
#include <unistd.h>
#include <utility>
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

// All mappings of this process. Entries are never deleted, so that a signal handler may walk them, but used
// again.
struct Mapping {
  std::atomic<const std::byte*> first = nullptr;  // null: of no file now
  std::size_t size = 0;
  std::string path{};
  struct stat status = {};
  Mapping* next = nullptr;
};
std::atomic<Mapping*> mappings = nullptr;
std::mutex changing;               // the list, but for its readers
std::vector<std::string> changed;  // while they were mapped, not yet taken

// A file that was replaced is another one: what is mapped did not change.
void tell_if_written(Mapping& mapping) {
  const struct stat then = mapping.status;
  struct stat now = {};
  if (stat(mapping.path.c_str(), &now) != 0 || now.st_dev != then.st_dev || now.st_ino != then.st_ino) return;
  mapping.status = now;
  if (now.st_size != then.st_size || now.st_mtim.tv_sec != then.st_mtim.tv_sec ||
      now.st_mtim.tv_nsec != then.st_mtim.tv_nsec)
    changed.push_back(mapping.path);
}

Mapping& mapping_for(const std::byte* first, const std::filesystem::path& path, const struct stat& status) {
  const std::scoped_lock lock(changing);
  Mapping* found = mappings;
  while (found && found->first) found = found->next;
  if (!found) {
    found = new Mapping{.next = mappings};
    mappings = found;
  }
  found->size = std::size_t(status.st_size);
  found->path = path.string();
  found->status = status;
  found->first = first;
  return *found;
}

void unmap(Mapping& mapping) {
  const std::scoped_lock lock(changing);
  tell_if_written(mapping);
  munmap(const_cast<std::byte*>(mapping.first.exchange(nullptr)), mapping.size);
}

void map(const Descriptor& file, const std::filesystem::path& path, const struct stat& status,
         FileBytes& out) {
  const auto size = std::size_t(status.st_size);
  void* const place = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
  if (place == MAP_FAILED) file.fail(std::strerror(errno));
  const auto* const first = static_cast<const std::byte*>(place);
  Mapping& mapping = mapping_for(first, path, status);
  out.owner = std::shared_ptr<const void>(place, [&mapping](const void*) { unmap(mapping); });
  out.bytes = {first, size};
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
  if (fixed)
    map(file, path, status, out);
  else
    copy(file, std::size_t(status.st_size), out);
  return out;
}

void drop_pages(const FileBytes& bytes) {
  if (bytes.mapped) madvise(const_cast<std::byte*>(bytes.bytes.data()), bytes.bytes.size(), MADV_DONTNEED);
}

bool is_file(int descriptor, const FileBytes& bytes) {
  struct stat status = {};
  return fstat(descriptor, &status) == 0 && status.st_dev == bytes.device && status.st_ino == bytes.inode;
}

const char* mapped_path_at(const void* address) {
  const auto* const byte = static_cast<const std::byte*>(address);
  for (const Mapping* mapping = mappings; mapping; mapping = mapping->next)
    if (const std::byte* const first = mapping->first;
        first && std::less_equal()(first, byte) && std::less()(byte, first + mapping->size))
      return mapping->path.c_str();
  return nullptr;
}

std::vector<std::string> take_files_changed_while_mapped() {
  const std::scoped_lock lock(changing);
  for (Mapping* mapping = mappings; mapping; mapping = mapping->next)
    if (mapping->first) tell_if_written(*mapping);
  return std::exchange(changed, {});
}

void forbid_writing(const std::filesystem::path& path) {
  using std::filesystem::perms;
  std::filesystem::permissions(path, perms::owner_write | perms::group_write | perms::others_write,
                               std::filesystem::perm_options::remove);
}

}  // namespace aussois
