// SPDX-License-Identifier: Apache-2.0
// Says what this program was built from, and tells it from others.
#pragma once

#include <cstdint>
#include <string>

namespace aussois {

/// "aussois 0.1.0; g++ 12.2.0 (Release: -O3 -DNDEBUG); Eigen 3.4.0; HDF5 1.10.8; CGAL 5.5.1; zlib 1.2.13;
/// licence of this binary: ...".
std::string build_info();

/// A digest that tells one program from another, made from build_info() and the bytes of the running program
/// and of those of our libraries that it loads. The same sources, built again in the same place by the same
/// compiler, give the same number; a change that does not reach the machine code of this program (a comment,
/// another driver) does not change it either. System libraries are ignored. Computed once, in some 10 ms for
/// 20 MB.
std::uint64_t program_digest();

/// "aussois 0.1.0, program 0123456789abcdef": the version and program_digest().
std::string program_version();

}  // namespace aussois
