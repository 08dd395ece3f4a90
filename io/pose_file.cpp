// SPDX-License-Identifier: Apache-2.0
#include "io/pose_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>

#include "geometry/check.hpp"
#include "io/atomic_file.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

// That of checked_pose: seven printed digits pass, an unscaled axis does not
constexpr double kUnitTolerance = 1e-6;

class PoseReader {
 public:
  PoseReader(const std::filesystem::path& path, std::string_view text) : in_(path, text) {}

  PoseFile read(double scale) {
    if (!in_.next_row(fields_)) in_.fail("file must have a header line that names the columns");
    read_header();
    return read_rows(scale);
  }
  /// Without a header; `order` are the columns of x, y, z, qw, qx, qy, qz.
  PoseFile read_plain(double scale, const std::array<std::size_t, 7>& order) {
    columns_.assign(order.begin(), order.end());
    field_count_ = order.size();
    return read_rows(scale);
  }

 private:
  PoseFile read_rows(double scale) {
    while (in_.next_row(fields_)) {
      check_field_count();
      add_time();
      add_pose(scale);
    }
    if (poses_.pose.size() < 2)
      in_.fail("rows = " + std::to_string(poses_.pose.size()) + " must be at least 2 for a path");
    return std::move(poses_);
  }

  static constexpr const char* kNames[] = {"x", "y", "z", "qw", "qx", "qy", "qz"};

  void read_header() {
    for (const char* name : kNames) columns_.push_back(column(name));
    if (std::find(fields_.begin(), fields_.end(), "t") != fields_.end()) time_column_ = column("t");
    field_count_ = fields_.size();
  }

  std::size_t column(const char* name) const {
    const auto count = std::count(fields_.begin(), fields_.end(), name);
    if (count != 1)
      in_.fail("column '" + std::string(name) + "' must occur once in the header, occurs " +
               std::to_string(count) + " times");
    return std::size_t(std::find(fields_.begin(), fields_.end(), name) - fields_.begin());
  }

  void check_field_count() const {
    if (fields_.size() != field_count_)
      in_.fail("fields = " + std::to_string(fields_.size()) + " must be " + std::to_string(field_count_) +
               (time_column_ == kNone && field_count_ == 7 ? ", of a pose" : ", as in the header"));
  }

  void add_time() {
    if (time_column_ == kNone) return;
    const double t = in_.number(fields_[time_column_], "t");
    if (!poses_.t.empty() && t <= poses_.t.back())
      in_.fail("t = " + std::string(fields_[time_column_]) + " must be > the time of the row before");
    poses_.t.push_back(t);
  }

  void add_pose(double scale) {
    double value[7];
    for (std::size_t k = 0; k < 7; ++k) value[k] = in_.number(fields_[columns_[k]], kNames[k]);
    SE3 g{Quat(value[3], value[4], value[5], value[6]), scale * Vec3(value[0], value[1], value[2])};
    if (!g.p.allFinite()) in_.fail("position times scale must be finite");
    const double norm = g.R.norm();
    if (!(std::abs(norm - 1) <= kUnitTolerance)) {
      std::string text = "|(qw, qx, qy, qz)| = ";
      append_number(text, norm);
      in_.fail(text + " must lie within 1e-6 of 1");
    }
    g.R.coeffs() /= norm;
    // q and -q are one rotation; the nearer one keeps interpolation and differences on the short way.
    if (!poses_.pose.empty() && g.R.dot(poses_.pose.back().R) < 0) g.R.coeffs() = -g.R.coeffs();
    poses_.pose.push_back(g);
    poses_.line.push_back(in_.line());
  }

  static constexpr std::size_t kNone = std::size_t(-1);

  TextReader in_;
  std::vector<std::string_view> fields_{};
  std::vector<std::size_t> columns_{};  // of x, y, z, qw, qx, qy, qz
  std::size_t time_column_ = kNone;
  std::size_t field_count_ = 0;
  PoseFile poses_{};
};

// Words between blanks, as OMPL prints a path of SE(3): x y z qx qy qz qw.
std::string csv_of_words(std::string_view text) {
  std::string out;
  bool gap = false;
  for (const char c : text) {
    const bool blank = c == ' ' || c == '\t' || c == '\r';
    if (blank) {
      gap = !out.empty() && out.back() != '\n';
      continue;
    }
    if (gap && c != '\n') out += ',';
    gap = false;
    out += c;
  }
  return out;
}

// A row of NumPy's format 1 or 2 is a line: x y z qw qx qy qz in doubles.
std::string csv_of_npy(const std::filesystem::path& path, std::string_view bytes) {
  const auto refuse = [&](const std::string& what) {
    throw std::runtime_error(path.string() + ":1: " + what);
  };
  if (bytes.size() < 12 || bytes.substr(0, 6) != "\x93NUMPY") refuse("is no NPY file");
  const bool first = bytes[6] == 1;
  std::size_t length = 0;
  for (std::size_t k = 0; k < (first ? 2u : 4u); ++k)
    length |= std::size_t(std::uint8_t(bytes[8 + k])) << (8 * k);
  const std::size_t begin = (first ? 10u : 12u) + length;
  if (begin > bytes.size()) refuse("its header is cut off");
  const std::string_view header = bytes.substr(first ? 10 : 12, length), data = bytes.substr(begin);
  if (header.find("'<f8'") == header.npos || header.find("'fortran_order': False") == header.npos)
    refuse("must hold doubles, row by row: descr '<f8', fortran_order False");
  constexpr std::size_t kRow = 7 * sizeof(double);
  const std::string shape = "(" + std::to_string(data.size() / kRow) + ", 7)";
  if (data.size() % kRow != 0 || header.find(shape) == header.npos) refuse("must have the shape (poses, 7)");
  std::string out;
  for (std::size_t at = 0; at < data.size(); at += sizeof(double)) {
    double value = 0;
    std::memcpy(&value, data.data() + at, sizeof value);
    append_number(out, value);
    out += (at / sizeof(double)) % 7 == 6 ? '\n' : ',';
  }
  return out;
}

}  // namespace

PoseFile read_poses(const std::filesystem::path& path, double scale) {
  require_field(std::isfinite(scale) && scale > 0, "scale", scale, "be finite and > 0");
  const std::string text = read_file(path);
  if (path.extension() == ".npy") {
    const std::string rows = csv_of_npy(path, text);
    return PoseReader(path, rows).read_plain(scale, {0, 1, 2, 3, 4, 5, 6});
  }
  if (path.extension() == ".path") {
    const std::string rows = csv_of_words(text);
    return PoseReader(path, rows).read_plain(scale, {0, 1, 2, 6, 3, 4, 5});
  }
  return PoseReader(path, text).read(scale);
}

void write_poses(const std::filesystem::path& path, const PoseFile& poses, double scale) {
  require_field(std::isfinite(scale) && scale > 0, "scale", scale, "be finite and > 0");
  const bool timed = !poses.t.empty();
  require_field(!timed || poses.t.size() == poses.pose.size(), "PoseFile::t.size()", poses.t.size(),
                "be 0 or the number of poses");
  std::string text = timed ? "index,t,x,y,z,qw,qx,qy,qz\n" : "index,x,y,z,qw,qx,qy,qz\n";
  for (std::size_t i = 0; i < poses.pose.size(); ++i) {
    text += std::to_string(i);
    if (timed) append_number(text += ',', poses.t[i]);
    const SE3& g = poses.pose[i];
    for (int k = 0; k < 3; ++k) append_number(text += ',', g.p[k] / scale);
    for (const double part : {g.R.w(), g.R.x(), g.R.y(), g.R.z()}) append_number(text += ',', part);
    text += '\n';
  }
  write_whole_file(path, text);
}

}  // namespace aussois
