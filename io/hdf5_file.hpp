// SPDX-License-Identifier: Apache-2.0
// Wraps what io/*.cpp needs of the HDF5 C API: handles that close themselves, whole datasets as vectors, and
// columns that grow by blocks of rows. Private to io: not installed, never included by a header. Every
// failure is a std::runtime_error "FILE: /dataset: what".
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <hdf5.h>
#include <string>
#include <utility>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

/// A hid_t with the function that closes it.
class Hdf5Id {
 public:
  Hdf5Id() = default;
  Hdf5Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  Hdf5Id(Hdf5Id&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Hdf5Id& operator=(Hdf5Id&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(close_, other.close_);
    return *this;
  }
  ~Hdf5Id() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }

 private:
  hid_t id_ = -1;
  herr_t (*close_)(hid_t) = nullptr;
};

/// Keeps HDF5 from printing its error stack while in scope: our exceptions report the error.
class Hdf5Silence {
 public:
  Hdf5Silence();
  ~Hdf5Silence();
  Hdf5Silence(const Hdf5Silence&) = delete;
  Hdf5Silence& operator=(const Hdf5Silence&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

/// How a C++ type is stored in a row: its scalar type and the shape of one row.
template <class T>
struct Hdf5Row;
template <>
struct Hdf5Row<double> {
  static hid_t type() { return H5T_NATIVE_DOUBLE; }
  static std::vector<hsize_t> shape() { return {}; }
};
template <>
struct Hdf5Row<float> {
  static hid_t type() { return H5T_NATIVE_FLOAT; }
  static std::vector<hsize_t> shape() { return {}; }
};
template <>
struct Hdf5Row<std::int8_t> {
  static hid_t type() { return H5T_NATIVE_INT8; }
  static std::vector<hsize_t> shape() { return {}; }
};
template <>
struct Hdf5Row<int> {
  static hid_t type() { return H5T_NATIVE_INT32; }
  static std::vector<hsize_t> shape() { return {}; }
};
template <>
struct Hdf5Row<std::uint32_t> {
  static hid_t type() { return H5T_NATIVE_UINT32; }
  static std::vector<hsize_t> shape() { return {}; }
};
template <>
struct Hdf5Row<std::int64_t> {
  static hid_t type() { return H5T_NATIVE_INT64; }
  static std::vector<hsize_t> shape() { return {}; }
};
template <>
struct Hdf5Row<std::uint64_t> {
  static hid_t type() { return H5T_NATIVE_UINT64; }
  static std::vector<hsize_t> shape() { return {}; }
};
template <>
struct Hdf5Row<Vec3> : Hdf5Row<double> {
  static std::vector<hsize_t> shape() { return {3}; }
};
template <>
struct Hdf5Row<Mat3> : Hdf5Row<double> {  // only for symmetric matrices: Eigen stores columns, HDF5 rows
  static std::vector<hsize_t> shape() { return {3, 3}; }
};
template <class T, std::size_t n>
struct Hdf5Row<std::array<T, n>> : Hdf5Row<T> {
  static std::vector<hsize_t> shape() {
    std::vector<hsize_t> shape = Hdf5Row<T>::shape();
    shape.insert(shape.begin(), n);
    return shape;
  }
};

/// Fails if the file exists. Every dataset begins at a multiple of `alignment` bytes.
Hdf5Id create_hdf5(const std::filesystem::path& path, hsize_t alignment = 1);
enum class Hdf5Access { read, write };
Hdf5Id open_hdf5(const std::filesystem::path& path, Hdf5Access access);
void flush_hdf5(hid_t file);

[[noreturn]] void fail_hdf5(hid_t file, const std::string& name, const std::string& what);

void write_text(hid_t file, const std::string& object, const std::string& attribute, const std::string& text);
std::string read_text(hid_t file, const std::string& object, const std::string& attribute);
std::vector<std::string> attribute_names(hid_t file, const std::string& object);  // sorted
void write_texts(hid_t file, const std::string& name, const std::vector<std::string>& texts);
std::vector<std::string> read_texts(hid_t file, const std::string& name);
/// Writes one text as a dataset without extent, null-terminated, as H5LTmake_dataset_string writes it.
void write_text_dataset(hid_t file, const std::string& name, const std::string& text);
/// Reads a text of fixed or variable length.
std::string read_text_dataset(hid_t file, const std::string& name);

/// Number of values in a data space, at most kManyValues: HDF5 multiplies modulo 2^64.
hsize_t value_count(hid_t space);
inline constexpr hsize_t kManyValues = hsize_t{1} << 62;

/// Fails unless the root carries these attributes `format` and `version`.
void check_format(hid_t file, const std::string& format, const std::string& version);

void make_group(hid_t file, const std::string& name);
std::vector<std::string> group_names(hid_t file, const std::string& group);  // sorted
bool has_link(hid_t file, const std::string& name);                          // its parent must exist
/// Fails unless the dataset holds integers: HDF5 would truncate other numbers silently.
void check_integers(hid_t file, const std::string& name);

/// A dataset of shape [rows, row_shape...] that grows at its end.
class Hdf5Column {
 public:
  Hdf5Column() = default;
  /// Creates the dataset, empty; `unit` becomes an attribute unless it is empty.
  Hdf5Column(hid_t file, std::string name, hid_t type, std::vector<hsize_t> row_shape, hsize_t chunk_rows,
             const std::string& unit);
  /// Opens the dataset and checks the shape of its rows.
  static Hdf5Column open(hid_t file, std::string name, hid_t type, std::vector<hsize_t> row_shape);

  void append(const void* data, hsize_t rows);
  void truncate(hsize_t rows);  // keeps the first `rows`; fails if there are fewer
  void read(void* data, hsize_t first, hsize_t rows) const;
  hsize_t rows() const { return rows_; }
  hsize_t values() const;  // rows times the values of one row

 private:
  void check_chunks() const;
  std::vector<hsize_t> extent(hsize_t rows) const;
  hid_t file_ = -1;
  std::string name_{};
  hid_t type_ = -1;
  std::vector<hsize_t> row_shape_{};
  hsize_t rows_ = 0;
  Hdf5Id dataset_{};
};

inline constexpr hsize_t kHdf5ChunkRows = 1024;  // of scalar and three-vector columns: 8 to 24 KiB per chunk

template <class T>
void write_rows(hid_t file, const std::string& name, const std::vector<T>& rows,
                const std::string& unit = {}) {
  Hdf5Column(file, name, Hdf5Row<T>::type(), Hdf5Row<T>::shape(), kHdf5ChunkRows, unit)
      .append(rows.data(), rows.size());
}

/// Writes a dataset that will not grow: small ones inside their header, large ones compressed. It takes
/// seventy bytes more than its values; a column that can grow takes three thousand more.
void write_fixed(hid_t file, const std::string& name, hid_t type, const void* data, hsize_t count);
template <class T>
void write_fixed(hid_t file, const std::string& name, const std::vector<T>& values) {
  write_fixed(file, name, Hdf5Row<T>::type(), values.data(), values.size());
}

/// Writes a dataset as it lies in memory, in one piece.
void write_piece(hid_t file, const std::string& name, hid_t type, const std::vector<hsize_t>& row_shape,
                 const void* data, hsize_t rows);

/// Where in the file such a dataset lies.
struct Hdf5Piece {
  hsize_t offset = 0, rows = 0;
};
/// Fails unless the dataset lies in one piece inside the file, and has exactly this type and shape of rows.
Hdf5Piece piece_of(hid_t file, const std::string& name, hid_t type, const std::vector<hsize_t>& row_shape);

/// The file descriptor of a file that is open.
int descriptor_of(hid_t file);

template <class T>
std::vector<T> read_rows(hid_t file, const std::string& name) {
  const Hdf5Column column = Hdf5Column::open(file, name, Hdf5Row<T>::type(), Hdf5Row<T>::shape());
  std::vector<T> rows(column.rows());
  column.read(rows.data(), 0, column.rows());
  return rows;
}
inline VecX read_vector(hid_t file, const std::string& name) {
  const std::vector<double> values = read_rows<double>(file, name);
  return Eigen::Map<const VecX>(values.data(), Eigen::Index(values.size()));
}

}  // namespace aussois
