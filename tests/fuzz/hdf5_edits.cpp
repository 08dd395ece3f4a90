// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/hdf5_edits.hpp"

#include <algorithm>
#include <cstring>
#include <limits>

#include "io/hdf5_file.hpp"

namespace aussois {
namespace {

constexpr std::int64_t kIntegers[] = {0,
                                      1,
                                      -1,
                                      2,
                                      -2,
                                      3,
                                      4,
                                      5,
                                      6,
                                      7,
                                      8,
                                      12,
                                      64,
                                      255,
                                      1024,
                                      65536,
                                      1 << 20,
                                      std::numeric_limits<int>::max(),
                                      std::numeric_limits<int>::min(),
                                      std::int64_t{1} << 32,
                                      (std::int64_t{1} << 32) + 1,
                                      std::int64_t{1} << 40,
                                      std::numeric_limits<std::int64_t>::max(),
                                      std::numeric_limits<std::int64_t>::min()};
constexpr double kDoubles[] = {0,      -0.0,  1,    -1,    0.5,  1e-9,
                               5e-324, 1e308, kInf, -kInf, 1e10, std::numeric_limits<double>::quiet_NaN()};

/// What is left of the script; zeros at its end.
class Script {
 public:
  explicit Script(Bytes bytes) : bytes_(bytes) {}
  bool at_end() const { return bytes_.empty(); }
  std::size_t below(std::size_t bound) { return bound == 0 ? 0 : next() % bound; }
  std::int64_t integer() {
    const std::size_t k = next();
    return k < std::size(kIntegers) ? kIntegers[k] : std::int64_t(k) - 128;
  }
  double number() {
    const std::size_t k = next();
    return k < std::size(kDoubles) ? kDoubles[k] : double(k) - 128;
  }

 private:
  unsigned char next() {
    if (bytes_.empty()) return 0;
    const unsigned char byte = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return byte;
  }
  Bytes bytes_;
};

herr_t collect(hid_t, const char* name, const H5O_info_t*, void* names) {
  if (std::strcmp(name, ".") != 0)
    static_cast<std::vector<std::string>*>(names)->push_back(std::string("/") + name);
  return 0;
}

std::vector<std::string> objects(hid_t file) {
  std::vector<std::string> names;
  H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_INC, collect, &names, H5O_INFO_BASIC);
  std::sort(names.begin(), names.end());
  return names;
}

Hdf5Id type_of(Script& script) {
  const hid_t kinds[] = {H5T_STD_I32LE, H5T_IEEE_F64LE, H5T_STD_I64LE,
                         H5T_STD_U64LE, H5T_STD_I8LE,   H5T_IEEE_F32BE};
  const std::size_t k = script.below(std::size(kinds) + 2);
  if (k < std::size(kinds)) return {H5Tcopy(kinds[k]), H5Tclose};
  Hdf5Id text(H5Tcopy(H5T_C_S1), H5Tclose);
  const std::int64_t length = script.integer();
  H5Tset_size(
      text, k == std::size(kinds) ? std::size_t(std::clamp<std::int64_t>(length, 1, 1 << 16)) : H5T_VARIABLE);
  return text;
}

/// Scalars, and up to four sides; a side may be anything.
Hdf5Id space_of(Script& script, bool chunked) {
  const std::size_t rank = script.below(5);
  if (rank == 0 && !chunked) return {H5Screate(H5S_SCALAR), H5Sclose};
  std::vector<hsize_t> sides(std::max<std::size_t>(rank, 1)), endless(sides.size(), H5S_UNLIMITED);
  for (hsize_t& side : sides) side = hsize_t(std::max<std::int64_t>(script.integer(), 0));
  return {H5Screate_simple(int(sides.size()), sides.data(), chunked ? endless.data() : nullptr), H5Sclose};
}

Hdf5Id layout_of(Script& script, bool chunked, hid_t space) {
  Hdf5Id layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  if (!chunked) {
    if (script.below(4) == 3) H5Pset_layout(layout, H5D_COMPACT);
    return layout;
  }
  std::vector<hsize_t> chunk(std::size_t(std::max(H5Sget_simple_extent_ndims(space), 1)));
  const hsize_t most = chunk.size() == 1 ? 1 << 22 : 32;  // HDF5 makes a whole chunk in memory to write it
  for (hsize_t& side : chunk) side = std::clamp<hsize_t>(hsize_t(script.integer()), 1, most);
  H5Pset_chunk(layout, int(chunk.size()), chunk.data());
  if (script.below(2) == 1) H5Pset_deflate(layout, 1);
  return layout;
}

/// All values of a small dataset: the script's as far as they go.
void fill(Script& script, hid_t dataset) {
  const Hdf5Id space(H5Dget_space(dataset), H5Sclose), type(H5Dget_type(dataset), H5Tclose);
  const hsize_t count = value_count(space);
  if (count == 0 || count > 256) return;
  if (H5Tget_class(type) == H5T_FLOAT) {
    std::vector<double> values(count);
    for (double& value : values) value = script.number();
    H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  } else if (H5Tget_class(type) == H5T_INTEGER) {
    std::vector<std::int64_t> values(count);
    for (std::int64_t& value : values) value = script.integer();
    H5Dwrite(dataset, H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  }
}

void replace(Script& script, hid_t file, const std::string& name) {
  H5Ldelete(file, name.c_str(), H5P_DEFAULT);
  const bool chunked = script.below(2) == 1;
  const Hdf5Id type = type_of(script), space = space_of(script, chunked);
  if (space < 0) return;
  const Hdf5Id layout = layout_of(script, chunked, space);
  const Hdf5Id dataset(H5Dcreate2(file, name.c_str(), type, space, H5P_DEFAULT, layout, H5P_DEFAULT),
                       H5Dclose);
  if (dataset >= 0) fill(script, dataset);
}

/// One value of a small dataset, its other values as they are.
void poke(Script& script, hid_t file, const std::string& name) {
  const Hdf5Id dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (dataset < 0) return;
  const Hdf5Id space(H5Dget_space(dataset), H5Sclose), type(H5Dget_type(dataset), H5Tclose);
  const hsize_t count = value_count(space);
  const std::size_t size = H5Tget_size(type);
  if (count == 0 || count > 1 << 16 || size > 64 || H5Tis_variable_str(type) > 0) return;
  std::string bytes(count * size, '\0');
  if (H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) < 0) return;
  const std::size_t at = (256 * script.below(256) + script.below(256)) % count;
  const std::int64_t integer = script.integer();
  const double number = script.number();
  char* value = bytes.data() + at * size;
  if (H5Tget_class(type) == H5T_FLOAT && size == sizeof number)
    std::memcpy(value, &number, size);
  else
    std::memcpy(value, &integer, std::min(size, sizeof integer));
  H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
}

/// Other first sides, without values behind them.
void stretch(Script& script, hid_t file, const std::string& name) {
  const Hdf5Id dataset(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (dataset < 0) return;
  const Hdf5Id space(H5Dget_space(dataset), H5Sclose);
  std::vector<hsize_t> sides(std::size_t(std::max(H5Sget_simple_extent_ndims(space), 0)));
  H5Sget_simple_extent_dims(space, sides.data(), nullptr);
  if (sides.empty() || sides[0] > 1 << 20) return;  // HDF5 looks at every chunk that goes away
  sides[0] = hsize_t(std::max<std::int64_t>(script.integer(), 0));
  H5Dset_extent(dataset, sides.data());
}

void relabel(Script& script, hid_t file) {
  const char* names[] = {"format", "version", "title", "key", "build", "program"};
  const char* name = names[script.below(std::size(names))];
  H5Adelete(file, name);
  const Hdf5Id type = type_of(script), space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Id attribute(H5Acreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
}

void change(Script& script, hid_t file) {
  const std::vector<std::string> names = objects(file);
  if (names.empty()) return;
  const std::size_t kind = script.below(8);
  const std::string& name = names[script.below(names.size())];
  const std::string& other = names[script.below(kind >= 6 ? names.size() : 0)];
  if (kind == 0) return void(H5Ldelete(file, name.c_str(), H5P_DEFAULT));
  if (kind == 1) return replace(script, file, name);
  if (kind <= 3) return poke(script, file, name);
  if (kind == 4) return stretch(script, file, name);
  if (kind == 5) return relabel(script, file);
  if (name == other) return;
  H5Ldelete(file, name.c_str(), H5P_DEFAULT);
  if (kind == 6)
    H5Lcreate_hard(file, other.c_str(), file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
  else
    H5Lcreate_soft(other.c_str(), file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
}

}  // namespace

void edit_hdf5(const std::filesystem::path& path, Bytes bytes) {
  const Hdf5Silence silence;
  const Hdf5Id file = open_hdf5(path, Hdf5Access::write);
  Script script(bytes);
  for (int changes = 0; changes < 16 && !script.at_end(); ++changes) change(script, file);
}

}  // namespace aussois
