// SPDX-License-Identifier: Apache-2.0
// Asks whether the tables of a shape, or of its mesh, are ones that every search can walk through.
#pragma once

#include <hdf5.h>

namespace aussois {

struct LmdShape;
struct SimplicialComplex;

/// Fails, naming the table of `file` that is wrong: an index, a size or a number out of its range, incidences
/// that are not those of the simplices, a hierarchy that is no tree over all of them. One pass over all.
void check_shape(hid_t file, const LmdShape& shape);
/// The same of a mesh alone.
void check_complex(hid_t file, const SimplicialComplex& complex);

}  // namespace aussois
