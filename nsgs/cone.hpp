// SPDX-License-Identifier: Apache-2.0
// The Coulomb cone K_mu = { |r_T| <= mu r_N }, its dual K*, and De Saxce's modified velocity (NSGS-12) to
// (NSGS-14). Vectors are (normal, tangent, tangent); mu >= 0. The projections are Euclidean: scale units
// first.
#pragma once

#include "geometry/types.hpp"

namespace aussois {

Vec3 project_cone(const Vec3& r, double mu);       // on K_mu
Vec3 project_dual_cone(const Vec3& u, double mu);  // on K*_mu = { u_N >= mu |u_T| }
Vec2 project_disk(const Vec2& r, double radius);   // on { |r| <= radius }
Vec3 de_saxce(const Vec3& u, double mu);           // u + mu |u_T| e_N

/// (max(r_N, 0), r_T shortened to mu max(r_N, 0)): the law of a contact whose compliance is the same in every
/// direction (PROX-3). Not the nearest point of K_mu: friction does not push back on the normal.
Vec3 project_coulomb(const Vec3& r, double mu);
/// The derivative of project_coulomb, one element of it at the kinks (PROX-5).
Mat3 project_coulomb_derivative(const Vec3& r, double mu);

}  // namespace aussois
