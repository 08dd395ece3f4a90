// SPDX-License-Identifier: Apache-2.0
// Keeps prepared shapes in files, so that the next run need not prepare them again. A file holds the tables
// of an LmdShape bit for bit, under a key made of what determines them: mesh, dilation, options, program. A
// file that is damaged or has another key is reported and replaced, never used. See
// doc/howto/keep_prepared_shapes.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "io/cache_use.hpp"
#include "lmd/lmd_shape.hpp"

namespace aussois {

/// The key made of vertices, triangles, wires, the word solid, dilation, options, build_info() and the
/// version of the format: two shapes with the same key have the same tables, except by an accident of 64
/// bits.
std::uint64_t shape_key(const DilatedShape& shape, const LmdShapeOptions& options = {});

/// Writes under a temporary name of its own, then renames: any number of processes may write the same file.
/// On failure throws std::runtime_error with the path and leaves no temporary file.
void write_lmd_shape(const std::filesystem::path& path, const LmdShape& shape, std::uint64_t key);

/// Reads the shape as it was written, bit for bit. Throws std::runtime_error with file, table and reason if
/// the file is missing, not of this format, version or key, or damaged: the checksum of the file, the sizes
/// of the tables, every index and every number are checked.
LmdShape read_lmd_shape(const std::filesystem::path& path, std::uint64_t key);

struct CachedShape : CacheUse {
  std::shared_ptr<const LmdShape> shape{};
};

/// prepare(shape, options), or the same bits from FOLDER/KEY.h5, which is written if it is missing or
/// unusable. The folder is created if needed; an empty path means no cache. A cache that does not work costs
/// time and a warning, never the run. Throws as prepare does. Use it from one thread at a time, like all of
/// io.
CachedShape prepare_cached(DilatedShape shape, const LmdShapeOptions& options,
                           const std::filesystem::path& folder);

}  // namespace aussois
