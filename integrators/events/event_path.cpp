// SPDX-License-Identifier: Apache-2.0
// Do bodies keep apart between two internal steps? (EVD-10)
#include <algorithm>
#include <cmath>
#include <iterator>

#include "integrators/events/event_run.hpp"
#include "integrators/prove/certify_step.hpp"
#include "lmd/motion_bound.hpp"

namespace aussois {
namespace {

constexpr double kChord = 1e-3;  // pieces of the certificate follow the path to this part of a dilation
constexpr double kTiny = 1e-12;  // instead of zero [m/s^2]
constexpr int kMaxPieces = 256;

}  // namespace

// Are the bodies apart on the way between two states that are one internal step from each other? (EVD-10)
bool EventRun::certified(const State& from, const State& to, const std::function<State(double)>& at) {
  const double dt = to.t - from.t;
  const auto path = [&](const State& a, const State& b) {
    VecX v = VecX::Zero(a.v.size());
    for (const BodyId k : model_.bodies.ids())
      body_part(v, k) = twist_between(pose(a, k), pose(b, k), b.t - a.t);
    return v;
  };
  double dilation = kInf, off = 0;
  for (const auto& shape : model_.shapes)
    if (shape->radius > 0) dilation = std::min(dilation, shape->radius);
  if (dilation == kInf) return true;
  const State middle = at(from.t + dt / 2);
  const State straight = retract(model_, from, path(from, to), dt / 2);
  for (const BodyId b : model_.bodies.ids())
    off = std::max(off, (middle.g[b].p - straight.g[b].p).norm() +
                            setting_.bounds[b].radius * angle_between(middle.g[b].R, straight.g[b].R));
  const int pieces = std::clamp(int(std::ceil(std::sqrt(off / (kChord * dilation)))), 1, kMaxPieces);
  State a = from;
  for (int k = 1; k <= pieces; ++k) {
    const State b = k == pieces ? to : at(from.t + dt * k / pieces);
    const VecX v = path(a, b);
    const StepMotion motion{model_, a, v, b.t - a.t};
    const AdvancementOptions& o = setting_.options.advancement;
    StepPath gone = step_path(motion, setting_.bounds);
    gone.starts_apart = proven_apart_;
    const StepCertificate proof =
        certify_step(gone, step_pairs(motion, setting_.bounds, o, setting_.options.threads).pairs,
                     setting_.bounds, {}, o, setting_.options.threads);
    report_.certificate_rounds += int(proof.rounds);
    if (!proof.failure.empty()) {
      report_.reason = proof.failure;
      return false;
    }
    report_.min_base_distance = std::min(report_.min_base_distance, proof.min_distance);
    report_.pieces.push_back({.t = a.t, .h = b.t - a.t, .g = a.g, .v = v});
    std::vector<BodyPair> told;
    std::ranges::set_union(
        report_.driven_overlaps,
        driven_overlaps(gone, setting_.bounds, setting_.pieces, o, setting_.options.threads),
        std::back_inserter(told));
    report_.driven_overlaps = std::move(told);
    a = b;
  }
  return true;
}

// How far an internal step may go without passing through a body unseen: half a dilation with twice the speed
// and acceleration of now (EVD-10).
double EventRun::safe_until(const State& from, double stop) const {
  const double dt = stop - from.t;
  PerBody<double> speed, acceleration, reach;
  for (const BodyId b : model_.bodies.ids()) {
    const double radius = setting_.bounds[b].radius;
    const auto size = [&](const Vec6& v) { return 2 * (v.head<3>().norm() + radius * v.tail<3>().norm()); };
    speed.push_back(size(twist(from, b)));
    acceleration.push_back(size(body_part(a_, b)));
    reach.push_back(o_.horizon + dt * (speed.back() + dt * acceleration.back() / 2));
  }
  double stride = kInf;
  for (const StepPair& pair : pairs_within(model_, from, setting_.bounds, reach, setting_.options.threads)) {
    const auto sum = [&](const PerBody<double>& of) { return of[pair.a] + of[pair.b]; };
    const double room = pair.dilation / 2;
    stride = std::min(stride, room / (sum(speed) + std::sqrt(room * (sum(acceleration) + kTiny))));
  }
  return std::min(stop, from.t + stride);
}

// Could a pair have passed through each other in an internal step?
bool EventRun::leapt(const State& from, const State& to) {
  PerBody<double> moved;
  for (const BodyId b : model_.bodies.ids())
    moved.push_back((pose(to, b).p - pose(from, b).p).norm() +
                    setting_.bounds[b].radius * angle_between(pose(from, b).R, pose(to, b).R));
  const NearPairs near = near_pairs(model_, from, setting_.bounds, moved, setting_.options.threads);
  report_.passing_pairs = std::max(report_.passing_pairs, near.passing);
  for (const StepPair& pair : near.pairs)
    if (moved[pair.a] + moved[pair.b] > pair.dilation) return true;
  return false;
}

}  // namespace aussois
