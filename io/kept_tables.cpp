// SPDX-License-Identifier: Apache-2.0
#include "io/kept_tables.hpp"

#include <stdexcept>
#include <utility>
#include <vector>

#include "io/atomic_file.hpp"
#include "io/build_info.hpp"
#include "io/sealed_file.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

// The file and its bytes, opened one after the other: it may be replaced in between, but not for ever.
KeptFile open_sealed(const std::filesystem::path& path) {
  for (int attempt = 0; attempt < 100; ++attempt) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) break;
    FileBytes bytes = bytes_of_file(path);
    if (!is_sealed(bytes.bytes)) break;
    Hdf5Id file = open_hdf5(path, Hdf5Access::read);
    if (is_file(descriptor_of(file), bytes)) return {std::move(bytes), std::move(file)};
  }
  throw std::runtime_error(path.string() + ": missing, truncated or damaged: its checksum does not fit");
}

}  // namespace

// A vertex index beside a place has a gap in memory: each is a table of its own.
void TableWriter::table(const std::string& name, const SharedArray<MovedVertex>& values) {
  std::vector<int> vertices;
  std::vector<Vec3> places;
  for (const auto& [vertex, from] : values) {
    vertices.push_back(vertex);
    places.push_back(from);
  }
  table(name + "/vertex", std::span<const int>(vertices));
  table(name + "/from", std::span<const Vec3>(places));
}

void TableReader::table(const std::string& name, SharedArray<MovedVertex>& values) {
  SharedArray<int> vertex;
  SharedArray<Vec3> from;
  table(name + "/vertex", vertex);
  table(name + "/from", from);
  if (vertex.size() != from.size()) fail_hdf5(file_, name, "has columns of different lengths");
  std::vector<MovedVertex> moved;
  for (std::size_t i = 0; i < vertex.size(); ++i) moved.push_back({vertex[i], from[i]});
  values = std::move(moved);
}

void TableReader::one(const std::string& name, bool& value) {
  int number = 0;
  one(name, number);
  if (number != 0 && number != 1) fail_hdf5(file_, name, "is neither 0 nor 1");
  value = number != 0;
}

void write_kept(const std::filesystem::path& path, const KeptKind& kind, std::uint64_t key,
                const std::function<void(hid_t)>& write) {
  const Hdf5Silence silence;
  write_atomically(path, [&](const std::filesystem::path& temporary) {
    {
      const Hdf5Id file = create_hdf5(temporary, alignof(ConeNode));
      write_text(file, "/", "format", kind.format);
      write_text(file, "/", "version", kind.version);
      write_text(file, "/", "key", hex_text(key));
      write_text(file, "/", "build", build_info());
      write(file);
      flush_hdf5(file);
    }
    seal(temporary);
    forbid_writing(temporary);
  });
}

KeptFile open_kept(const std::filesystem::path& path, const KeptKind& kind, std::uint64_t key) {
  const Hdf5Silence silence;
  KeptFile kept = open_sealed(path);
  check_format(kept.file, kind.format, kind.version);
  if (const std::string found = read_text(kept.file, "/", "key"); found != hex_text(key))
    fail_hdf5(kept.file, "/@key", "is " + found + ", not " + hex_text(key));
  return kept;
}

}  // namespace aussois
