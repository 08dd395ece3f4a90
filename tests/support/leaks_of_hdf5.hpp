// SPDX-License-Identifier: Apache-2.0
// HDF5 1.10 loses memory of its own over damaged files.
#pragma once

#include <hdf5.h>

#include <gtest/gtest.h>

#ifdef __SANITIZE_ADDRESS__  // of g++
#define AUSSOIS_LEAK_CHECKER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)  // of clang
#define AUSSOIS_LEAK_CHECKER
#endif
#endif
#ifdef AUSSOIS_LEAK_CHECKER
#include <sanitizer/lsan_interface.h>
#endif

namespace aussois {

/// While it lives, the leak checker does not count. When it ends, all that was opened must be closed.
class LeaksOfHdf5 {
 public:
  LeaksOfHdf5() = default;
  LeaksOfHdf5(const LeaksOfHdf5&) = delete;
  ~LeaksOfHdf5() { EXPECT_EQ(H5Fget_obj_count(hid_t(H5F_OBJ_ALL), H5F_OBJ_ALL), 0); }

 private:
#ifdef AUSSOIS_LEAK_CHECKER
  const __lsan::ScopedDisabler of_its_own{};
#endif
};

}  // namespace aussois
