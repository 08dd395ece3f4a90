// SPDX-License-Identifier: Apache-2.0
#include "io/build_info.hpp"

#include <H5public.h>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <link.h>
#include <span>
#include <vector>
#include <zlib.h>

#include <CGAL/version.h>
#include <Eigen/Core>

#include "geometry/digest.hpp"
#include "io/text.hpp"

namespace aussois {
namespace {

std::string dotted(int major, int minor, int patch) {
  return std::to_string(major) + '.' + std::to_string(minor) + '.' + std::to_string(patch);
}

std::string compiler() {
#ifdef __clang__
  return "clang++ " + dotted(__clang_major__, __clang_minor__, __clang_patchlevel__);
#else
  return "g++ " + dotted(__GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#endif
}

int collect_ours(dl_phdr_info* object, std::size_t, void* names) {
  const std::filesystem::path path = object->dlpi_name;
  if (path.filename().string().rfind("libaussois_", 0) == 0)
    static_cast<std::vector<std::filesystem::path>*>(names)->push_back(path);
  return 0;
}

/// The program and our shared libraries, in an order that does not depend on where they were loaded.
std::vector<std::filesystem::path> files_of_the_program() {
  std::vector<std::filesystem::path> files;
  dl_iterate_phdr(collect_ours, &files);
  std::ranges::sort(files, {}, [](const auto& path) { return path.filename(); });
  files.insert(files.begin(), "/proc/self/exe");
  return files;
}

std::uint64_t digest_of_the_program() {
  Digest digest;
  const auto add = [&](const std::string& bytes) { digest.add(std::as_bytes(std::span(bytes))); };
  add(build_info());
  for (const std::filesystem::path& path : files_of_the_program()) {
    std::ifstream file(path, std::ios::binary);
    add({std::istreambuf_iterator<char>(file), {}});
  }
  return digest.value;
}

}  // namespace

std::string build_info() {
  return "aussois " AUSSOIS_VERSION "; " + compiler() + " " AUSSOIS_BUILD_FLAGS "; Eigen " +
         dotted(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION) + "; HDF5 " +
         dotted(H5_VERS_MAJOR, H5_VERS_MINOR, H5_VERS_RELEASE) +
         "; CGAL " CGAL_VERSION_STR "; zlib " ZLIB_VERSION
         "; licence of this binary: Apache-2.0, with LGPL-3.0-or-later parts of CGAL";
}

std::uint64_t program_digest() {
  static const std::uint64_t digest = digest_of_the_program();
  return digest;
}

std::string program_version() {
  return "aussois " AUSSOIS_VERSION ", program " + hex_text(program_digest());
}

}  // namespace aussois
