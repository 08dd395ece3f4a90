// SPDX-License-Identifier: Apache-2.0
// One factorisation for many right-hand sides. Private to nsgs.
#pragma once

#include "nsgs/delassus.hpp"

namespace aussois {

/// Dense LU up to 150 rows, then sparse LDL^T of a symmetric matrix, else KLU. Empty if A is singular
/// or not finite. A symmetric A must be definite.
LinearSolve factorised(const SparseMatrix& A);

}  // namespace aussois
