// SPDX-License-Identifier: Apache-2.0
// What this program was made of.
#pragma once

#include <cstdint>
#include <string>

namespace aussois {

/// "aussois 0.1.0; g++ 12.2.0 (Release: -O3 -DNDEBUG); Eigen 3.4.0; HDF5 1.10.8; CGAL 5.5.1; zlib 1.2.13;
/// licence of this binary: ...".
std::string build_info();

/// Tells one program from another: of build_info() and the bytes of the running program, with those libraries
/// of ours that it loads. The same sources, built again in the same place by the same compiler, give the same
/// number; a change that does not reach the machine code of this program (a comment, another driver) does not
/// change it either. Libraries of the system are not looked at. Read once, some 10 ms for 20 MB.
std::uint64_t program_digest();

/// "aussois 0.1.0, program 0123456789abcdef": the version and program_digest().
std::string program_version();

}  // namespace aussois
