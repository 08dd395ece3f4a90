// SPDX-License-Identifier: Apache-2.0
// Writes tables to a file once, under a key made of what they follow from; the file is sealed and mapped.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

#include "io/hdf5_file.hpp"
#include "io/mapped_file.hpp"
#include "io/shape_tables.hpp"

namespace aussois {

template <class T>
using PlainRow = Hdf5Row<typename Plain<T>::type>;

class TableWriter {
 public:
  explicit TableWriter(hid_t file) : file_(file) {}
  template <class T>
  void table(const std::string& name, std::span<const T> values) {
    static_assert(sizeof(T) == sizeof(typename Plain<T>::type));
    write_piece(file_, name, PlainRow<T>::type(), PlainRow<T>::shape(), values.data(), values.size());
  }
  template <class T>
  void table(const std::string& name, const SharedArray<T>& values) {
    table(name, std::span<const T>(values));
  }
  void table(const std::string& name, const SharedArray<MovedVertex>& values);
  template <class T>
  void one(const std::string& name, const T& value) {
    table(name, std::span<const T>(&value, 1));
  }
  void one(const std::string& name, bool value) { one(name, int(value)); }

 private:
  hid_t file_;
};

/// Tables become spans of the file's bytes.
class TableReader {
 public:
  TableReader(hid_t file, const FileBytes& bytes) : file_(file), bytes_(bytes) {}
  template <class T>
  void table(const std::string& name, SharedArray<T>& values) {
    const Hdf5Piece piece = piece_of(file_, name, PlainRow<T>::type(), PlainRow<T>::shape());
    if (piece.offset % alignof(T) != 0 || piece.rows > hsize_t{1} << 31)
      fail_hdf5(file_, name, "does not begin where its numbers may lie, or has more than 2^31 rows");
    if (piece.offset + piece.rows * sizeof(T) > bytes_.bytes.size()) fail_hdf5(file_, name, "is cut off");
    const auto* const first = reinterpret_cast<const T*>(bytes_.bytes.data() + piece.offset);
    values = piece.rows > 0 ? SharedArray<T>({first, piece.rows}, bytes_.owner) : SharedArray<T>();
  }
  void table(const std::string& name, SharedArray<MovedVertex>& values);
  template <class T>
  void one(const std::string& name, T& value) {
    SharedArray<T> values;
    table(name, values);
    if (values.size() != 1)
      fail_hdf5(file_, name, "has " + std::to_string(values.size()) + " rows instead of 1");
    value = values[0];
  }
  void one(const std::string& name, bool& value);
  [[noreturn]] void fail(const std::string& name, const std::string& what) { fail_hdf5(file_, name, what); }

 private:
  hid_t file_;
  const FileBytes& bytes_;
};

/// What is in a file. Raise the version when a table, or what is computed for it, changes.
struct KeptKind {
  const char* format;
  const char* version;
};

struct KeptFile {
  FileBytes bytes{};
  Hdf5Id file{};
};

/// Atomically; without permission to write afterwards. Throws std::runtime_error with the path.
void write_kept(const std::filesystem::path& path, const KeptKind& kind, std::uint64_t key,
                const std::function<void(hid_t)>& write);
/// Throws std::runtime_error, with file and reason, unless the file is whole and of this kind and key.
KeptFile open_kept(const std::filesystem::path& path, const KeptKind& kind, std::uint64_t key);

}  // namespace aussois
