// SPDX-License-Identifier: Apache-2.0
// Finds contacts of a pair whose shapes have levels: near ones by the shapes themselves, far ones by coarser
// surfaces, as a function of the pose and the search distance alone (LOD-4), (LOD-5).
#pragma once

#include "lmd/find_contacts.hpp"

namespace aussois {

struct LevelUse {
  int levels = 0;           // coarser levels that may be used
  double fine_to = 0;       // up to this gap the shapes themselves answer [m], beyond what (LOD-4) asks for
  bool fine_alone = false;  // leave the coarse contacts out of the result
};

/// If the smallest gap of the two shapes is at least 0 and at most the threshold, the smallest of both sets
/// is at most that, and at least two thirds of it.
struct LevelContacts {
  ContactSet fine{};    // of the shapes themselves, up to a quarter beyond where levels begin
  ContactSet coarse{};  // of their levels, whose features they name; gaps are faded where levels meet (LOD-5)
};

/// Without levels that answer within the threshold `fine` is the result of find_contacts, bit for bit.
LevelContacts find_contacts_by_level(const PosedShape& a, const PosedShape& b, const LmdOptions& options,
                                     const LevelUse& use, PairScratch* scratch = nullptr);

/// From which gap on level `level` of a pair answers [m]; 0 for level 0 (LOD-4).
double answers_from(const LmdShape& a, const LmdShape& b, int level);

}  // namespace aussois
