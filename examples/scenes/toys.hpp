// SPDX-License-Identifier: Apache-2.0
// Bullets, tops and dimers (doc/theory/toys.md): scenes whose motion shows what friction, impacts and contact
// sets are worth. Shared by examples, tests and benchmarks.
#pragma once

#include "examples/scenes/cases.hpp"

namespace aussois {

/// A5. A bullet of 8 g, 5 mm and 800 m/s along -z, `gap` above a free sheet of paper of 1 g, 100 x 100 x 0.1
/// mm, in the plane z = 0; no gravity, no friction. Bodies: paper, bullet.
inline constexpr double kBulletMass = 8e-3, kBulletRadius = 5e-3, kBulletSpeed = 800;  // SI
inline constexpr double kPaperMass = 1e-3, kPaperSide = 0.1, kPaperHalfThickness = 5e-5;
CaseScene bullet_and_paper(double restitution, double gap);
/// The paper stands upright, in the plane x = 0; the bullet comes at its upper edge, `offset` beside its
/// plane.
CaseScene bullet_on_edge(double restitution, double gap, double offset);
/// A needle of 100 x 1 mm turns about its middle, its tips at 500 m/s, at a time 10 mm too near to a fixed
/// sheet. Bodies: sheet, needle.
CaseScene needle_and_sheet(double restitution, double angle);
/// Two bullets on parallel ways against each other, which miss each other by `miss`; `distance` of the
/// centres along the way.
CaseScene crossing_bullets(double miss, double distance);

}  // namespace aussois
