// SPDX-License-Identifier: Apache-2.0
// Shrinks a solid by eps before it is dilated by eps: all planes of its regions move inwards (ERO-1), and its
// vertices to where the planes meet (ERO-2) to (ERO-4). The dilation then restores faces and concave edges
// exactly and rounds convex edges by (ERO-5). The result is measured afterwards (ERO-6) to (ERO-9). Edges
// and faces that shrink to nothing on the way vanish, and their neighbours meet (ERO-10). A solid with a
// feature thinner than 2 eps is refused, with the reason and the place.
#pragma once

#include <optional>
#include <string>

#include "geometry/simplicial_complex.hpp"
#include "lmd/idealisation.hpp"
#include "lmd/lmd_shape.hpp"
#include "lmd/mitre.hpp"

namespace aussois {

class SettingVisitor;

/// `describe` gives the ranges.
struct ErosionOptions {
  double depth = 0;                                // eps, the radius of the dilation to come [m]
  double planarity = LmdShapeOptions{}.planarity;  // relative to the box diagonal [-]
  double meet = MitreOptions{}.meet;  // planes that pass a point within this many depths meet there [-]
  double deviation = 1e-3;  // where a vertex cannot be split, its planes may miss a common point by this
                            // many depths, and a split saddle the depth by as much [-];
                            // 0: exact or refused. Deviations used are counted, and missing depth is
                            // measured.
  bool split = true;        // a vertex of more than three planes may become several; false: smooth surfaces
                            // keep their triangles and lose up to `deviation`
  bool contract = true;     // edges that would turn around may vanish; false: the solid is refused
  double max_rounding = kInf;  // refused if the solid loses more than this anywhere [m]
  int samples = 100'000;       // of each surface, roughly; every triangle has at least seven
};
void describe(SettingVisitor& visit, ErosionOptions& options);

enum class ErosionStatus {
  done,
  not_solid,          // open, inside out or self-intersecting: there is no inside to move to
  unsettled_vertex,   // its planes do not meet, and no split is simple
  lost_edge,          // an edge between regions would turn around
  lost_face,          // a region would turn over or cross its own border
  inside_out,         // nothing would be left
  self_intersecting,  // parts of the surface would pass through each other
  too_shallow,        // the eroded surface would come closer than eps to the solid's
  too_round,          // the rounding would exceed max_rounding
};
const char* to_string(ErosionStatus status);

/// Lengths in metres; over deterministic samples of both surfaces, corners and middles of sides included.
struct ErosionMeasures {
  double shallow = 0;         // (ERO-6): largest eps - distance of the eroded surface to the solid's, or 0
  double face_error = 0;      // (ERO-7): | distance to the eroded solid - eps | on faces and concave edges
  double edge_error = 0;      // (ERO-8): the same on convex edges, against eps / sin(psi / 2)
  double rounding = 0;        // (ERO-7): largest distance of the solid's surface to the eroded, minus eps
  double edge_rounding = 0;   // (ERO-5): predicted, of the sharpest convex edge
  double rounding_bound = 0;  // (ERO-5): predicted, corners included
  double hausdorff = 0;       // symmetric, between the solid's surface and the dilated eroded one
  double volume_lost = 0;     // (ERO-9): by rounding, to first order: edges without corners [m^3]
  double thickness = kInf;    // smallest of the eroded solid, between faces within 30 degrees of parallel
  double deviation = 0;       // largest accepted distance of a vertex from one of its own planes
  int regions = 0, chains = 0, convex_chains = 0, concave_chains = 0;
  int split_vertices = 0;      // vertices that became several
  int merged_vertices = 0;     // vertices that merged with others into one or several
  int deviating_vertices = 0;  // vertices whose planes miss a common point by more than `meet`
  int samples = 0;             // of both surfaces
  int face_samples = 0;        // samples of the solid's surface that face_error is about
};

struct ErosionResult {
  ErosionStatus status = ErosionStatus::done;
  std::string reason{};                // one line naming place and thickness; empty if done
  Vec3 place = Vec3::Zero();           // of the refusal [m]
  double thickness = kInf;             // smallest of the solid, if the refusal has to do with it [m]
  SimplicialComplex complex{};         // the eroded solid; empty if refused
  std::vector<int> triangle_region{};  // region in `ideal` of each of its triangles
  Idealisation ideal{};                // of the solid
  ErosionMeasures measures{};          // of an eroded solid, or of one refused as too_round
  bool ok() const { return status == ErosionStatus::done; }
};

/// Throws std::invalid_argument for a bad option only; whatever goes wrong in the geometry is a status.
ErosionResult erode(const SimplicialComplex& solid, const ErosionOptions& options);

/// Finds a depth of two digits below `options.depth` at which the solid can be eroded: halves the depth until
/// one works, then raises it by bisection to where the next is refused. A smaller depth need not work; a
/// larger one may. nullopt if none of ten halved depths works. Takes ten to twenty erosions.
std::optional<double> erodible_depth(const SimplicialComplex& solid, ErosionOptions options);

/// Interior angle between the two regions of a chain with two triangles, psi in (ERO-5), in (0, 2 pi) [rad].
double interior_angle(const SimplicialComplex& complex, const Idealisation& ideal, const Chain& chain);

/// Measures any pair of a solid and an eroded one (ERO-6), (ERO-7): fills shallow, face_error, rounding,
/// hausdorff, thickness and samples. Since nothing is known about edges, a sample here belongs to a face if
/// its nearest point is neither on a convex edge of the eroded solid nor at its ends. Both solids must have
/// triangles.
ErosionMeasures measure_erosion(const SimplicialComplex& solid, const SimplicialComplex& eroded, double depth,
                                int samples);

}  // namespace aussois
