// SPDX-License-Identifier: Apache-2.0
// The Coulomb cone K_mu = { |r_T| <= mu r_N }, its dual K*, and De Saxce's modified velocity (NSGS-12) to (NSGS-14).
#pragma once

#include "geometry/types.hpp"

namespace aussois {

Vec3 project_cone(const Vec3& r, double mu);       // on K_mu
Vec3 project_dual_cone(const Vec3& u, double mu);  // on K*_mu = { u_N >= mu |u_T| }
Vec2 project_disk(const Vec2& r, double radius);   // on { |r| <= radius }
Vec3 de_saxce(const Vec3& u, double mu);           // u + mu |u_T| e_N

}  // namespace aussois
