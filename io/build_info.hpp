// SPDX-License-Identifier: Apache-2.0
// What this program was made of.
#pragma once

#include <string>

namespace aussois {

/// "aussois 0.1.0; g++ 12.2.0 (Release: -O3 -DNDEBUG); Eigen 3.4.0; HDF5 1.10.8; CGAL 5.5.1; zlib 1.2.13;
/// licence of this binary: ...".
std::string build_info();

}  // namespace aussois
