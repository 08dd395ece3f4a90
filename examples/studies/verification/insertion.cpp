// SPDX-License-Identifier: Apache-2.0
// Group P: pegs in holes, against the two-point theory of insertion [Whitney1982]. A peg of half-width r
// touches one wall with the corner of its tip and the rim of the other wall with its side, a depth l above.
// Forces on the tip: F_x across, F_z into the hole, M about the tip. With lambda = l / (2 r mu) it slides in
// if
//   |M / (r F_z) + mu (1 + lambda) F_x / F_z| < lambda,
// and jams otherwise; where it slides, F_z is that for which both sides are equal.
#include <algorithm>

#include "examples/studies/verification/running.hpp"
#include "examples/studies/verification/verification.hpp"
#include "geometry/primitives.hpp"
#include "integrators/run.hpp"
#include "integrators/scheme.hpp"
#include "mechanics/model.hpp"

namespace aussois {
namespace {

constexpr double kPegHalf = 0.01, kPegMu = 0.3;                       // of the peg, dilated [m]; friction
constexpr double kPegSkin = 1e-4, kPegPlay = 1e-7;                    // dilation; play on each side [m]
constexpr double kPegLong = 0.06, kPegWide = 0.02, kPegThick = 0.01;  // of peg and walls [m]
constexpr double kPegMass = 0.05;                                     // of the peg [kg]

/// On the tip, in the world; M as it turns x towards z.
struct TipLoad {
  double Fx = 0, Fz = 0, M = 0;  // [N], [N], [N m]
};

struct Insertion {
  Model model{};
  State state{};
  BodyId peg{};
  double depth = 0;  // of the corner below the rim, where they touch [m]
};

// The load turns and moves with nothing: it acts at the corner's height on the axis, as it lies at the start.
ForceLaw load_law(BodyId peg, const TipLoad& load) {
  return {.name = "load", .add_to = [=](const Model&, const State& state, double, GeneralisedForce& sum) {
            const Vec3 force(load.Fx, 0, -load.Fz), arm(0, 0, -(kPegLong / 2 - kPegSkin));
            linear_part(sum.f, peg) += force;
            angular_part(sum.f, peg) +=
                pose(state, peg).R.conjugate() * Vec3(arm.cross(force) - load.M * Vec3::UnitY());
          }};
}

Insertion insertion(double depth) {
  Insertion out{.depth = depth};
  out.model.gravity.setZero();
  out.model.contact_law = {.mu = kPegMu};
  RigidBody peg{.name = "peg",
                .mass = kPegMass,
                .inertia = kPegMass / 12 *
                           Vec3(kPegWide * kPegWide + kPegLong * kPegLong,
                                4 * kPegHalf * kPegHalf + kPegLong * kPegLong,
                                kPegWide * kPegWide + 4 * kPegHalf * kPegHalf)
                               .asDiagonal()};
  peg.shape =
      add(out.model,
          prepare(dilate(make_box(2 * (kPegHalf - kPegSkin), kPegWide, kPegLong - 2 * kPegSkin), kPegSkin)));
  out.peg = add(out.model, std::move(peg));
  const ShapeId wall = add(out.model, prepare(dilate(make_box(kPegThick, 2 * kPegWide, kPegLong), kPegSkin)));
  out.state.g.push_back(translation(0, 0, kPegLong / 2 - depth - 2 * kPegSkin));
  for (const double side : {-1.0, 1.0}) {
    add(out.model, fixed_body(side < 0 ? "left" : "right", wall));
    out.state.g.push_back(
        translation(side * (kPegHalf + kPegPlay + kPegSkin + kPegThick / 2), 0, -kPegLong / 2 - kPegSkin));
  }
  const PerBody<SE3> places = out.state.g;
  out.state = rest_state(out.model);
  for (const BodyId b : places.ids()) out.state.g[b] = places[b];
  return out;
}

SchemeOptions options(double h) {
  SchemeOptions out;
  out.step.h = h;
  out.step.solver.tolerance = 1e-13;
  out.moreau_jean.theta = 1;
  return out;
}

// The state after the load has acted for a time.
State loaded(const Insertion& scene, const State& from, const TipLoad& load, double time, double h) {
  Model model = scene.model;
  add(model, load_law(scene.peg, load));
  const Scheme scheme = make_scheme("moreau_jean", model, options(h));
  State state = from;
  if (!run_until(scheme, state, state.t + time).ok())
    throw NumericalFailure("a step of the peg was not solved");
  return state;
}

// The moment at which a peg that leans on corner and rim begins to slide, by bisection.
double moment_of_jamming(const Insertion& scene, const State& seated, double Fx, double low, double high) {
  double jams = low, slides = high;
  for (int k = 0; k < 16; ++k) {
    const double M = 0.5 * (jams + slides);
    const State after = loaded(scene, seated, {Fx, 1, M}, 2e-3, 5e-4);
    (pose(after, scene.peg).p.z() < pose(seated, scene.peg).p.z() - 1e-10 ? slides : jams) = M;
  }
  return 0.5 * (jams + slides);
}

VerificationCase jamming(double depth) {
  const double lambda = depth / (2 * kPegHalf * kPegMu);
  char setting[40];
  std::snprintf(setting, sizeof setting, "lambda = %.3g", lambda);
  return {
      .name = "P1.jamming_diagram",
      .setting = setting,
      .what =
          "peg with two-point contact in a slot, mu = 0.3; moment at which it begins to slide, at five F_x",
      .rows = {{"edge", "largest M / (r F_z) off the edge of the diagram", "-", 5e-4,
                "closed form [Whitney1982]; first order of the tilt, 2e-5, and the bisection"}},
      .measure = [=] {
        const Insertion scene = insertion(depth);
        const State seated = loaded(scene, scene.state, {0, 1, -3 * lambda * kPegHalf}, 0.1, 1e-3);
        Worst off;
        for (const double share : {-0.8, -0.4, 0.0, 0.4, 0.8}) {
          const double Fx = share / kPegMu, edge = -lambda - kPegMu * (1 + lambda) * Fx;
          const double M = moment_of_jamming(scene, seated, Fx, (edge - 0.5 * lambda) * kPegHalf,
                                             (edge + 0.5 * lambda) * kPegHalf);
          off.add(std::abs(M / kPegHalf - edge));
        }
        return Figures{{"edge", off}};
      }};
}

// A wrist: springs across and in rotation at the tip, whose rest is off the axis and tilted, and dampers.
// Along the hole it is led at a constant speed.
struct Wrist {
  double across = 2e3, turning = 0.5, along = 1e5;  // [N/m], [N m/rad], [N/m]
  double damping = 20, turn_damping = 2e-3;         // [N s/m], [N m s/rad]
  double off = 0, tilt = 2e-2;                      // of its rest [m], [rad]
  double speed = 5e-3;                              // into the hole [m/s]
};

// What it exerts on the tip.
TipLoad load_of(const Wrist& w, const State& state, BodyId peg, double begin) {
  const SE3& g = pose(state, peg);
  const Mat3 R = g.R.toRotationMatrix();
  const Vec3 arm = R * Vec3(0, 0, -(kPegLong / 2 - kPegSkin)), tip = g.p + arm;
  const Vec6 v = twist(state, peg);
  const Vec3 slip = v.head<3>() + (R * Vec3(v.tail<3>())).cross(arm);
  const double tilt = -std::atan2(R(0, 2), R(2, 2)), turning = -v[4];  // as M turns
  return {.Fx = w.across * (w.off - tip.x()) - w.damping * slip.x(),
          .Fz = w.along * (tip.z() - (begin - w.speed * state.t)) + 10 * w.damping * (slip.z() + w.speed),
          .M = w.turning * (w.tilt - tilt) - w.turn_damping * turning};
}

ForceLaw wrist_law(BodyId peg, const Wrist& wrist, double begin) {
  return {.name = "wrist", .add_to = [=](const Model&, const State& state, double, GeneralisedForce& sum) {
            const TipLoad load = load_of(wrist, state, peg, begin);
            const Quat& R = pose(state, peg).R;
            const Vec3 force(load.Fx, 0, -load.Fz), arm = R * Vec3(0, 0, -(kPegLong / 2 - kPegSkin));
            linear_part(sum.f, peg) += force;
            angular_part(sum.f, peg) += R.conjugate() * Vec3(arm.cross(force) - load.M * Vec3::UnitY());
          }};
}

// Over a depth from 1.2 to 3 half-widths; where the wrist's own M and F_x are what the theory asks for F_z.
VerificationCase insertion_force() {
  return {
      .name = "P2.insertion_force",
      .what =
          "peg pressed against its slot by a wrist with a tilted rest, led in at 5 mm/s, mu = 0.3, h = "
          "0.2 ms",
      .rows = {{"force", "worst force into the hole off the theory, relative, 12 to 30 mm deep", "-", 1e-3,
                "closed form [Whitney1982]; quasi-static"},
               {"depth", "depth reached", "m", 0.03, "led so far", Sense::at_least}},
      .measure = [] {
        const Wrist wrist;
        Insertion scene = insertion(0.01);
        const double tip = -0.01 - kPegSkin;
        add(scene.model, wrist_law(scene.peg, wrist, tip));
        const Scheme scheme = make_scheme("moreau_jean", scene.model, options(2e-4));
        State state = scene.state;
        Worst off;
        double l = 0;
        run_accepted(scheme, state, 4.1, [&](const StepReport&) {
          l = -(pose(state, scene.peg) * Vec3(-(kPegHalf - kPegSkin), 0, -(kPegLong / 2 - kPegSkin))).z() -
              kPegSkin;
          const TipLoad load = load_of(wrist, state, scene.peg, tip);
          // The rest turns the tip towards x: it leans on the right wall, the side on the rim of the left
          // one
          const double asked = 2 * kPegMu / l * (load.M - (kPegHalf * kPegMu + l / 2) * -load.Fx);
          if (l > 0.012) off.add(std::abs(load.Fz / asked - 1));
          return true;
        });
        return Figures{{"force", off}, {"depth", l}};
      }};
}

}  // namespace

std::vector<VerificationCase> insertion_verification() {
  return {jamming(0.009), jamming(0.012), jamming(0.024), insertion_force()};
}

}  // namespace aussois
