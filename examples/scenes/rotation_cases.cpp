// SPDX-License-Identifier: Apache-2.0
// Rotations: free tops, and a block that rocks on its edges. Exact by quadrature of their ordinary
// differential equations.
#include <cmath>

#include "examples/scenes/cases.hpp"
#include "geometry/primitives.hpp"

namespace aussois {
namespace {

/// The axes x and z of the body, and its speed of rotation in the body [rad/s].
MotionSample attitude(const Quat& R, const Vec3& omega) {
  Vec6 axes;
  axes << R * Vec3::UnitX(), R * Vec3::UnitZ();
  return {.q = axes, .v = omega};
}

// D1, D2. q' = q omega / 2, J omega' = -omega x J omega.
ExactMotion free_top(const Vec3& J, const Vec3& omega, double t_end, double stride) {
  VecX start(7);
  start << 1, 0, 0, 0, omega;
  const auto rates = [J](double, const VecX& y) -> VecX {
    const Quat q(y[0], y[1], y[2], y[3]);
    const Vec3 w = y.tail<3>(), momentum = J.cwiseProduct(w);
    const Quat turn = q * Quat(0, w[0] / 2, w[1] / 2, w[2] / 2);
    VecX rate(7);
    rate << turn.w(), turn.vec(), momentum.cross(w).cwiseQuotient(J);
    return rate;
  };
  const auto y = ode_solution(rates, start, t_end, stride);
  return {.pieces = {{0, [y](double t) {
                        const VecX at = y(t);
                        return attitude(Quat(at[0], at[1], at[2], at[3]).normalized(), at.tail<3>());
                      }}}};
}

CaseScene free_top_scene(const Vec3& J, const Vec3& omega) {
  CaseScene s;
  s.model.gravity = Vec3::Zero();
  s.body = add(s.model, RigidBody{.name = "top", .mass = 1, .inertia = J.asDiagonal()});
  s.state = rest_state(s.model);
  twist(s.state, s.body).tail<3>() = omega;
  return s;
}

Case free_top_case(const char* name, const char* what, const Vec3& J, const Vec3& omega, double t_end,
                   double h) {
  return {.name = name,
          .what = what,
          .t_end = t_end,
          .h = h,
          .smooth = true,
          .scene = [=] { return free_top_scene(J, omega); },
          .observe = [](const CaseScene& s, const State& state) -> MotionSample {
            return attitude(pose(state, s.body).R, twist(state, s.body).tail<3>());
          },
          .exact = [=](double until) { return free_top(J, omega, until, h / 2); }};
}

// C1. Housner's block: half width b, half height a; it turns about the edge it stands on and passes to the
// other with omega+ = r omega-, the angular momentum about the new edge being kept.
struct RockingBlock {
  double b = 0.05, a = 0.2;
  double alpha() const { return std::atan2(b, a); }
  double p2() const { return 3 * kGravity / (4 * std::hypot(a, b)); }
  double ratio() const { return 1 - 1.5 * std::pow(std::sin(alpha()), 2); }
};

MotionSample tilt_motion(double tilt, double omega) {
  return {.q = VecX::Constant(1, tilt), .v = VecX::Constant(1, omega)};
}

ExactMotion rocking(const RockingBlock& block, double t_end) {
  constexpr double kStride = 2e-3;
  const double p2 = block.p2(), alpha = block.alpha();
  ExactMotion out;
  Vec2 start(alpha / 2, 0);
  double begin = 0, side = 1;  // of the edge it stands on
  while (begin < t_end) {
    const auto rates = [=](double, const VecX& y) -> VecX {
      return Vec2(y[1], -side * p2 * std::sin(alpha - side * y[0]));
    };
    const auto y = ode_solution(rates, start, t_end - begin + 0.5,
                                kStride);  // of the swing; an impact comes sooner or later
    out.pieces.push_back({begin, [=](double t) {
                            const VecX at = y(t - begin);
                            return tilt_motion(at[0], at[1]);
                          }});
    // The tilt is zero at the begin of a swing too: look from where it has grown.
    const double swing =
        first_root([&](double t) { return side * y(t)[0]; }, kStride, t_end - begin + 0.5, kStride);
    if (!std::isfinite(swing)) break;
    start = Vec2(0, block.ratio() * y(swing)[1]);
    side = -side, begin += swing;
  }
  return out;
}

/// A sharp block on a dilated plate, tilted about the edge of its foot at x = b, y along the edge.
CaseScene rocking_scene(const RockingBlock& block) {
  constexpr double kDilation = 1e-2, kDepth = 0.1;
  constexpr double kMu = 0.6;          // 0.185 < mu < 4: no slip, Housner's ratio
  constexpr double kTouching = 1e-14;  // overlap, so that rounding does not decide whether it stands [m]
  CaseScene s;
  s.model.contact_law = {.mu = kMu, .restitution = 0};
  const SimplicialComplex box = make_box(2 * block.b, kDepth, 2 * block.a);
  const auto plate = add(s.model, prepare(dilate(make_plate(2, 2), kDilation)));
  const ShapeId shape = add(s.model, prepare(dilate(box, 0)));
  add(s.model, fixed_body("plate", plate));
  s.body = add(s.model, solid_body("block", shape, mass_properties(box, 1000)));
  s.state = rest_state(s.model);
  SE3& g = pose(s.state, s.body);
  g.R = rotation(Vec3::UnitY(), block.alpha() / 2).R;
  g.p = Vec3(block.b, 0, kDilation - kTouching) - g.R * Vec3(block.b, 0, -block.a);
  return s;
}

MotionSample tilt(const CaseScene& s, const State& state) {
  const Vec3 up = pose(state, s.body).R * Vec3::UnitZ();
  return tilt_motion(std::atan2(up.x(), up.z()), twist(state, s.body)[4]);
}

}  // namespace

std::vector<Case> rotation_cases() {
  const RockingBlock block;
  return {{.name = "rocking_block",
           .what = "Housner's block rocks from edge to edge (C1)",
           .t_end = 1,  // three impacts
           .h = 1e-3,
           .at_once = true,  // the edge that it leaves and the one that it hits
           .scene = [block] { return rocking_scene(block); },
           .observe = tilt,
           .exact = [block](double until) { return rocking(block, until); }},
          free_top_case("free_top", "a free asymmetric top (D2)", {3, 2, 1}, {0.6, 1, 1.3}, 10, 0.1),
          free_top_case("dzhanibekov", "a free top about its middle axis flips over (D1)", {1, 10, 11},
                        {0, 2, 0.1}, 10, 0.02)};
}

}  // namespace aussois
