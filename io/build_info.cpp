// SPDX-License-Identifier: Apache-2.0
#include "io/build_info.hpp"

#include <H5public.h>
#include <zlib.h>

#include <CGAL/version.h>
#include <Eigen/Core>

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

}  // namespace

std::string build_info() {
  return "aussois " AUSSOIS_VERSION "; " + compiler() + " " AUSSOIS_BUILD_FLAGS "; Eigen " +
         dotted(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION) + "; HDF5 " +
         dotted(H5_VERS_MAJOR, H5_VERS_MINOR, H5_VERS_RELEASE) +
         "; CGAL " CGAL_VERSION_STR "; zlib " ZLIB_VERSION
         "; licence of this binary: Apache-2.0, with LGPL-3.0-or-later parts of CGAL";
}

}  // namespace aussois
