// SPDX-License-Identifier: Apache-2.0
// The shared reference series in tests, which skip without them.
#pragma once

#include <gtest/gtest.h>

#include "examples/scenes/shared_series.hpp"

/// Declares the rows, or skips the test.
#define REFERENCE(rows, name)            \
  std::vector<SeriesRow> rows;           \
  try {                                  \
    (rows) = shared_series(name);        \
  } catch (const MissingData& missing) { \
    GTEST_SKIP() << missing.what();      \
  }
