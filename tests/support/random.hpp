// SPDX-License-Identifier: Apache-2.0
// The random numbers of the tests are those of the examples.
#pragma once

#include "examples/common/random.hpp"
