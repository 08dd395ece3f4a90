// SPDX-License-Identifier: Apache-2.0
// Changes of a good HDF5 file, told by bytes: any bytes tell some, so that libFuzzer's small changes of an
// input are small changes of a file that HDF5 itself can still read. Datasets of other types, shapes and
// layouts, sizes from 0 to 2^63, numbers and texts that are none, links that are gone, doubled or in a
// circle.
#pragma once

#include <filesystem>

#include "tests/fuzz/readers.hpp"

namespace aussois {

/// Changes the file in place; at most 16 changes.
void edit_hdf5(const std::filesystem::path& file, Bytes script);

}  // namespace aussois
