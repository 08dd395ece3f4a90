// SPDX-License-Identifier: Apache-2.0
// One factorisation for many right-hand sides. Private to nsgs.
#pragma once

#include "nsgs/delassus.hpp"

namespace aussois {

/// Dense LU if A is small or full; else sparse LDL^T if A is symmetric, and KLU if it is not. Empty if A is
/// singular or not finite. A symmetric A must be definite.
LinearSolve factorised(const SparseMatrix& A);

}  // namespace aussois
