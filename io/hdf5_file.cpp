// SPDX-License-Identifier: Apache-2.0
#include "io/hdf5_file.hpp"

#include <algorithm>
#include <stdexcept>

namespace aussois {
namespace {

std::string file_name(hid_t file) {
  const ssize_t length = H5Fget_name(file, nullptr, 0);
  std::string name(std::size_t(std::max<ssize_t>(length, 0)) + 1, '\0');
  H5Fget_name(file, name.data(), name.size());
  name.pop_back();
  return name;
}

hsize_t chunk_bytes(hid_t layout, hsize_t value_size) {
  std::vector<hsize_t> sides(H5S_MAX_RANK);
  const int rank = H5Pget_chunk(layout, int(sides.size()), sides.data());
  hsize_t bytes = value_size;  // below 2^32: HDF5 makes and reads no larger chunks
  for (int i = 0; i < rank; ++i) bytes *= sides[i];
  return bytes;
}

/// A dataset's size may be damaged: it must not ask for more memory than its bytes can hold, and HDF5 reads
/// over the end of one that lies in its header. Deflate, which chunks may have, makes at most 1032 bytes from
/// one. Zeros may not be stored at all: such a dataset may be as large as the file.
void check_size(hid_t file, const std::string& name, hid_t dataset) {
  const Hdf5Id space(H5Dget_space(dataset), H5Sclose), type(H5Dget_type(dataset), H5Tclose),
      list(H5Dget_create_plist(dataset), H5Pclose);
  const hsize_t values = value_count(space), size = H5Tget_size(type);
  const H5D_layout_t layout = H5Pget_layout(list);
  const hsize_t stored = H5Dget_storage_size(dataset);
  hsize_t bytes = 0;
  H5Fget_filesize(file, &bytes);
  if (stored > 0 || layout == H5D_COMPACT) bytes = std::min(bytes, stored);
  if (stored > 0 && layout == H5D_CHUNKED) {
    bytes *= 1032;
    if (const hsize_t chunk = chunk_bytes(list, size); chunk > bytes)  // HDF5 makes all of it to read a value
      fail_hdf5(file, name,
                "has chunks of " + std::to_string(chunk) + " bytes, more than its bytes can hold");
  }
  if (values > 0 && size > bytes / values)
    fail_hdf5(file, name, "claims " + std::to_string(values) + " values, more than its bytes can hold");
}

/// Fixed length, padded with zeros, UTF-8: readable by everything that reads HDF5.
Hdf5Id text_type(std::size_t length) {
  Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, std::max<std::size_t>(length, 1));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

std::string without_padding(const char* text, std::size_t length) {
  const std::string padded(text, length);
  return padded.substr(0, padded.find('\0'));
}

Hdf5Id parent_groups_on_demand() {
  Hdf5Id list(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(list, 1);
  return list;
}

/// Datasets that do not remember when they were written: the same data make the same bytes.
Hdf5Id without_times() {
  Hdf5Id list(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(list, false);
  return list;
}

herr_t collect_link(hid_t, const char* name, const H5L_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

herr_t collect_attribute(hid_t, const char* name, const H5A_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

}  // namespace

Hdf5Silence::Hdf5Silence() {
  H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}
Hdf5Silence::~Hdf5Silence() {
  H5Eset_auto2(H5E_DEFAULT, print_, data_);
}

hsize_t value_count(hid_t space) {
  if (H5Sget_simple_extent_type(space) != H5S_SIMPLE) return H5Sget_simple_extent_type(space) == H5S_SCALAR;
  std::vector<hsize_t> sides(H5S_MAX_RANK);
  sides.resize(std::max(H5Sget_simple_extent_dims(space, sides.data(), nullptr), 0));
  if (std::ranges::count(sides, hsize_t{0}) > 0) return 0;
  hsize_t values = 1;
  for (const hsize_t side : sides) values = side > kManyValues / values ? kManyValues : values * side;
  return values;
}

void fail_hdf5(hid_t file, const std::string& name, const std::string& what) {
  throw std::runtime_error(file_name(file) + ": " + name + ": " + what);
}

Hdf5Id create_hdf5(const std::filesystem::path& path, hsize_t alignment) {
  const Hdf5Id access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  if (alignment > 1) {
    H5Pset_alignment(access, 1, alignment);
    H5Pset_small_data_block_size(access, 0);  // where small ones would lie side by side
  }
  Hdf5Id file(H5Fcreate(path.c_str(), H5F_ACC_EXCL, H5P_DEFAULT, access), H5Fclose);
  if (file < 0) throw std::runtime_error(path.string() + ": cannot be created");
  return file;
}

Hdf5Id open_hdf5(const std::filesystem::path& path, Hdf5Access access) {
  if (!std::filesystem::is_regular_file(path)) throw std::runtime_error(path.string() + ": no such file");
  const unsigned flags = access == Hdf5Access::read ? H5F_ACC_RDONLY : H5F_ACC_RDWR;
  const Hdf5Id access_list(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_fclose_degree(access_list, H5F_CLOSE_STRONG);  // a damaged file leaves objects open inside HDF5
  Hdf5Id file(H5Fopen(path.c_str(), flags, access_list), H5Fclose);
  if (file < 0)
    throw std::runtime_error(path.string() + ": not an HDF5 file, truncated or damaged, or not permitted");
  return file;
}

void flush_hdf5(hid_t file) {
  if (H5Fflush(file, H5F_SCOPE_LOCAL) < 0) fail_hdf5(file, "/", "cannot be flushed");
}

void write_text(hid_t file, const std::string& object, const std::string& attribute,
                const std::string& text) {
  const Hdf5Id type = text_type(text.size()), space(H5Screate(H5S_SCALAR), H5Sclose);
  const Hdf5Id id(H5Acreate_by_name(file, object.c_str(), attribute.c_str(), type, space, H5P_DEFAULT,
                                    H5P_DEFAULT, H5P_DEFAULT),
                  H5Aclose);
  if (id < 0 || H5Awrite(id, type, text.c_str()) < 0)
    fail_hdf5(file, object + "@" + attribute, "cannot be written (attributes hold at most 64 KiB)");
}

std::string read_text(hid_t file, const std::string& object, const std::string& attribute) {
  const Hdf5Id id(H5Aopen_by_name(file, object.c_str(), attribute.c_str(), H5P_DEFAULT, H5P_DEFAULT),
                  H5Aclose);
  if (id < 0) fail_hdf5(file, object + "@" + attribute, "is missing");
  const Hdf5Id type(H5Aget_type(id), H5Tclose);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0)
    fail_hdf5(file, object + "@" + attribute, "is not a text of fixed length");
  const std::size_t length = H5Tget_size(type);
  if (H5Aget_storage_size(id) != length)
    fail_hdf5(file, object + "@" + attribute, "is not one text of " + std::to_string(length) + " bytes");
  std::string text(length, '\0');
  if (H5Aread(id, type, text.data()) < 0) fail_hdf5(file, object + "@" + attribute, "cannot be read");
  return without_padding(text.data(), text.size());
}

std::vector<std::string> attribute_names(hid_t file, const std::string& object) {
  std::vector<std::string> names;
  if (H5Aiterate_by_name(file, object.c_str(), H5_INDEX_NAME, H5_ITER_INC, nullptr, collect_attribute, &names,
                         H5P_DEFAULT) < 0)
    fail_hdf5(file, object, "its attributes cannot be read");
  std::sort(names.begin(), names.end());
  return names;
}

void write_texts(hid_t file, const std::string& name, const std::vector<std::string>& texts) {
  std::size_t length = 1;
  for (const std::string& text : texts) length = std::max(length, text.size());
  std::string padded;
  for (const std::string& text : texts) padded += text + std::string(length - text.size(), '\0');
  const hsize_t rows = texts.size();
  const Hdf5Id type = text_type(length), links = parent_groups_on_demand(), layout = without_times();
  const Hdf5Id space(H5Screate_simple(1, &rows, nullptr), H5Sclose);
  const Hdf5Id id(H5Dcreate2(file, name.c_str(), type, space, links, layout, H5P_DEFAULT), H5Dclose);
  if (id < 0 || H5Dwrite(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()) < 0)
    fail_hdf5(file, name, "cannot be written");
}

std::vector<std::string> read_texts(hid_t file, const std::string& name) {
  const Hdf5Id id(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (id < 0) fail_hdf5(file, name, "is missing");
  const Hdf5Id type(H5Dget_type(id), H5Tclose), space(H5Dget_space(id), H5Sclose);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0 ||
      H5Sget_simple_extent_ndims(space) != 1)
    fail_hdf5(file, name, "is not a list of texts of fixed length");
  const std::size_t length = H5Tget_size(type), rows = std::size_t(H5Sget_simple_extent_npoints(space));
  check_size(file, name, id);
  std::string padded(length * rows, '\0');
  if (H5Dread(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, padded.data()) < 0)
    fail_hdf5(file, name, "cannot be read");
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < rows; ++i) texts.push_back(without_padding(padded.data() + i * length, length));
  return texts;
}

void write_text_dataset(hid_t file, const std::string& name, const std::string& text) {
  const Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose), space(H5Screate(H5S_SCALAR), H5Sclose),
      links = parent_groups_on_demand(), layout = without_times();
  H5Tset_size(type, text.size() + 1);
  H5Tset_cset(type, H5T_CSET_UTF8);
  const Hdf5Id id(H5Dcreate2(file, name.c_str(), type, space, links, layout, H5P_DEFAULT), H5Dclose);
  if (id < 0 || H5Dwrite(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()) < 0)
    fail_hdf5(file, name, "cannot be written");
}

std::string read_text_dataset(hid_t file, const std::string& name) {
  const Hdf5Id id(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (id < 0) fail_hdf5(file, name, "is missing");
  const Hdf5Id type(H5Dget_type(id), H5Tclose), space(H5Dget_space(id), H5Sclose);
  if (H5Tget_class(type) != H5T_STRING || value_count(space) != 1) fail_hdf5(file, name, "is not one text");
  check_size(file, name, id);
  if (H5Tis_variable_str(type) > 0) {
    char* text = nullptr;
    if (H5Dread(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &text) < 0 || text == nullptr)
      fail_hdf5(file, name, "cannot be read");
    std::string copy = text;
    H5Dvlen_reclaim(type, space, H5P_DEFAULT, &text);
    return copy;
  }
  std::string text(H5Tget_size(type), '\0');
  if (H5Dread(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()) < 0)
    fail_hdf5(file, name, "cannot be read");
  return without_padding(text.data(), text.size());
}

void check_format(hid_t file, const std::string& format, const std::string& version) {
  if (H5Aexists(file, "format") <= 0 || read_text(file, "/", "format") != format)
    fail_hdf5(file, "/@format", "is not '" + format + "'");
  if (const std::string found = read_text(file, "/", "version"); found != version)
    fail_hdf5(file, "/@version", "is " + found + ", this program reads version " + version);
}

void make_group(hid_t file, const std::string& name) {
  const Hdf5Id links = parent_groups_on_demand();
  const Hdf5Id id(H5Gcreate2(file, name.c_str(), links, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  if (id < 0) fail_hdf5(file, name, "cannot be created");
}

std::vector<std::string> group_names(hid_t file, const std::string& group) {
  std::vector<std::string> names;
  const Hdf5Id id(H5Gopen2(file, group.c_str(), H5P_DEFAULT), H5Gclose);
  if (id < 0 || H5Literate(id, H5_INDEX_NAME, H5_ITER_INC, nullptr, collect_link, &names) < 0)
    fail_hdf5(file, group, "is missing or not a group");
  std::sort(names.begin(), names.end());
  return names;
}

bool has_link(hid_t file, const std::string& name) {
  return H5Lexists(file, name.c_str(), H5P_DEFAULT) > 0;
}

void check_integers(hid_t file, const std::string& name) {
  const Hdf5Id id(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (id < 0) fail_hdf5(file, name, "is missing");
  const Hdf5Id type(H5Dget_type(id), H5Tclose);
  if (H5Tget_class(type) != H5T_INTEGER) fail_hdf5(file, name, "does not hold integers");
}

Hdf5Column::Hdf5Column(hid_t file, std::string name, hid_t type, std::vector<hsize_t> row_shape,
                       hsize_t chunk_rows, const std::string& unit)
    : file_(file), name_(std::move(name)), type_(type), row_shape_(std::move(row_shape)) {
  std::vector<hsize_t> chunk = extent(chunk_rows), none = extent(0), endless = extent(H5S_UNLIMITED);
  for (hsize_t& side : chunk)
    side = std::max<hsize_t>(side, 1);  // a run without bodies has rows of no values
  const Hdf5Id space(H5Screate_simple(int(none.size()), none.data(), endless.data()), H5Sclose);
  const Hdf5Id layout = without_times(), links = parent_groups_on_demand();
  H5Pset_chunk(layout, int(chunk.size()), chunk.data());
  H5Pset_shuffle(layout);
  H5Pset_deflate(layout, 1);
  dataset_ = Hdf5Id(H5Dcreate2(file, name_.c_str(), type, space, links, layout, H5P_DEFAULT), H5Dclose);
  if (dataset_ < 0) fail_hdf5(file, name_, "cannot be created");
  if (!unit.empty()) write_text(file, name_, "unit", unit);
}

void write_fixed(hid_t file, const std::string& name, hid_t type, const void* data, hsize_t count) {
  constexpr hsize_t kInHeader = 4096, kChunk = 8192;  // bytes, values
  const Hdf5Id space(H5Screate_simple(1, &count, nullptr), H5Sclose), layout = without_times(),
                                                                      links = parent_groups_on_demand();
  if (count > kChunk) {
    H5Pset_chunk(layout, 1, &kChunk);
    H5Pset_shuffle(layout);
    H5Pset_deflate(layout, 1);
  } else if (count > 0 && count * H5Tget_size(type) <= kInHeader) {
    H5Pset_layout(layout, H5D_COMPACT);
  }
  const Hdf5Id id(H5Dcreate2(file, name.c_str(), type, space, links, layout, H5P_DEFAULT), H5Dclose);
  if (id < 0 || (count > 0 && H5Dwrite(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0))
    fail_hdf5(file, name, "cannot be written (is the disk full?)");
}

void write_piece(hid_t file, const std::string& name, hid_t type, const std::vector<hsize_t>& row_shape,
                 const void* data, hsize_t rows) {
  std::vector<hsize_t> extent = row_shape;
  extent.insert(extent.begin(), rows);
  const Hdf5Id space(H5Screate_simple(int(extent.size()), extent.data(), nullptr), H5Sclose),
      layout = without_times(), links = parent_groups_on_demand();
  const Hdf5Id id(H5Dcreate2(file, name.c_str(), type, space, links, layout, H5P_DEFAULT), H5Dclose);
  if (id < 0 || (rows > 0 && H5Dwrite(id, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0))
    fail_hdf5(file, name, "cannot be written (is the disk full?)");
}

Hdf5Piece piece_of(hid_t file, const std::string& name, hid_t type, const std::vector<hsize_t>& row_shape) {
  const Hdf5Id id(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (id < 0) fail_hdf5(file, name, "is missing");
  const Hdf5Id space(H5Dget_space(id), H5Sclose), found(H5Dget_type(id), H5Tclose),
      list(H5Dget_create_plist(id), H5Pclose);
  std::vector<hsize_t> extent(std::size_t(std::max(H5Sget_simple_extent_ndims(space), 0)));
  H5Sget_simple_extent_dims(space, extent.data(), nullptr);
  if (extent.size() != row_shape.size() + 1 ||
      !std::equal(row_shape.begin(), row_shape.end(), extent.begin() + 1))
    fail_hdf5(file, name, "does not have the shape [rows, ...] of the format");
  if (H5Tequal(found, type) <= 0) fail_hdf5(file, name, "does not have the type of the format");
  if (H5Pget_layout(list) != H5D_CONTIGUOUS || H5Pget_external_count(list) != 0)
    fail_hdf5(file, name, "does not lie in one piece");
  const hsize_t values = value_count(space), size = H5Tget_size(type);
  if (values == 0) return {};
  hsize_t file_size = 0;
  H5Fget_filesize(file, &file_size);
  const haddr_t offset = H5Dget_offset(id);
  if (offset == HADDR_UNDEF || offset > file_size || values > (file_size - offset) / size)
    fail_hdf5(file, name, "claims " + std::to_string(values) + " values, more than the file holds");
  return {offset, extent[0]};
}

int descriptor_of(hid_t file) {
  void* handle = nullptr;
  if (H5Fget_vfd_handle(file, H5P_DEFAULT, &handle) < 0) fail_hdf5(file, "/", "has no file descriptor");
  return *static_cast<int*>(handle);
}

Hdf5Column Hdf5Column::open(hid_t file, std::string name, hid_t type, std::vector<hsize_t> row_shape) {
  Hdf5Column column;
  column.file_ = file;
  column.name_ = std::move(name);
  column.type_ = type;
  column.row_shape_ = std::move(row_shape);
  column.dataset_ = Hdf5Id(H5Dopen2(file, column.name_.c_str(), H5P_DEFAULT), H5Dclose);
  if (column.dataset_ < 0) fail_hdf5(file, column.name_, "is missing");
  const Hdf5Id space(H5Dget_space(column.dataset_), H5Sclose);
  std::vector<hsize_t> found(std::size_t(std::max(H5Sget_simple_extent_ndims(space), 0)));
  H5Sget_simple_extent_dims(space, found.data(), nullptr);
  if (!found.empty()) column.rows_ = found[0];
  if (found != column.extent(column.rows_))
    fail_hdf5(file, column.name_, "does not have the shape [rows, ...] of the format");
  if (column.rows_ > hsize_t{1} << 32) fail_hdf5(file, column.name_, "claims more than 2^32 rows");
  column.check_chunks();
  check_size(file, column.name_, column.dataset_);
  return column;
}

// HDF5 1.10 takes the chunk of a damaged file at its word and reads beyond what it decompressed.
void Hdf5Column::check_chunks() const {
  const Hdf5Id layout(H5Dget_create_plist(dataset_), H5Pclose);
  if (H5Pget_layout(layout) != H5D_CHUNKED) return;
  std::vector<hsize_t> chunk(row_shape_.size() + 1);
  if (H5Pget_chunk(layout, int(chunk.size()), chunk.data()) != int(chunk.size()))
    fail_hdf5(file_, name_, "has chunks of another rank");
  for (std::size_t i = 0; i < row_shape_.size(); ++i)
    if (chunk[i + 1] > std::max<hsize_t>(row_shape_[i], 1))
      fail_hdf5(file_, name_, "has chunks that are wider than its rows");
}

std::vector<hsize_t> Hdf5Column::extent(hsize_t rows) const {
  std::vector<hsize_t> extent = row_shape_;
  extent.insert(extent.begin(), rows);
  return extent;
}

hsize_t Hdf5Column::values() const {
  hsize_t values = rows_;
  for (const hsize_t side : row_shape_) values *= side;
  return values;
}

void Hdf5Column::append(const void* data, hsize_t rows) {
  if (rows == 0) return;
  std::vector<hsize_t> start(row_shape_.size() + 1, 0);
  start[0] = rows_;
  const std::vector<hsize_t> grown = extent(rows_ + rows), block = extent(rows);
  if (H5Dset_extent(dataset_, grown.data()) < 0) fail_hdf5(file_, name_, "cannot grow");
  rows_ += rows;
  if (values() == 0) return;
  const Hdf5Id in_file(H5Dget_space(dataset_), H5Sclose);
  const Hdf5Id in_memory(H5Screate_simple(int(block.size()), block.data(), nullptr), H5Sclose);
  H5Sselect_hyperslab(in_file, H5S_SELECT_SET, start.data(), nullptr, block.data(), nullptr);
  if (H5Dwrite(dataset_, type_, in_memory, in_file, H5P_DEFAULT, data) < 0)
    fail_hdf5(file_, name_, "cannot be written (is the disk full?)");
}

void Hdf5Column::truncate(hsize_t rows) {
  if (rows_ < rows)
    fail_hdf5(file_, name_,
              "has " + std::to_string(rows_) + " rows, " + std::to_string(rows) + " are needed to resume");
  const std::vector<hsize_t> kept = extent(rows);
  if (H5Dset_extent(dataset_, kept.data()) < 0) fail_hdf5(file_, name_, "cannot be cut");
  rows_ = rows;
}

void Hdf5Column::read(void* data, hsize_t first, hsize_t rows) const {
  if (values() == 0 || rows == 0) return;
  std::vector<hsize_t> start(row_shape_.size() + 1, 0);
  start[0] = first;
  const std::vector<hsize_t> block = extent(rows);
  const Hdf5Id in_file(H5Dget_space(dataset_), H5Sclose);
  const Hdf5Id in_memory(H5Screate_simple(int(block.size()), block.data(), nullptr), H5Sclose);
  H5Sselect_hyperslab(in_file, H5S_SELECT_SET, start.data(), nullptr, block.data(), nullptr);
  if (H5Dread(dataset_, type_, in_memory, in_file, H5P_DEFAULT, data) < 0)
    fail_hdf5(file_, name_, "cannot be read");
}

}  // namespace aussois
