// SPDX-License-Identifier: Apache-2.0
// Motions that are known exactly: smooth pieces, one after the other, with a jump of the velocity or of the
// acceleration between them.
#pragma once

#include <functional>
#include <vector>

#include "geometry/types.hpp"

namespace aussois {

/// What of a motion is compared: a few numbers that the case chooses, all of one unit in q, all of one in v.
struct MotionSample {
  VecX q{}, v{};
};

struct MotionPiece {
  double begin = 0;                            // [s]
  std::function<MotionSample(double t)> at{};  // for t from begin to the next piece's, both ends included
};

/// Pieces by ascending begin; the first begins at 0, the last never ends.
struct ExactMotion {
  std::vector<MotionPiece> pieces{};
};

/// Right-continuous: at a jump the velocity after it.
MotionSample evaluate(const ExactMotion& motion, double t);
/// Where the last piece that begins at or before t stands.
std::size_t piece_at(const ExactMotion& motion, double t);

/// A root of f between a and b, where f has different signs: bisection down to neighbouring numbers.
double root(const std::function<double(double)>& f, double a, double b);
/// The first change of sign of f after `begin`, looked for in strides; infinity if there is none up to `end`.
double first_root(const std::function<double(double)>& f, double begin, double end, double stride);

/// y(t) of y' = f(t, y), y(0) = y0, on [0, t_end]: nodes every `stride`, one step of order eight each, and
/// one more from the node before t (Runge-Kutta-Fehlberg 7(8)). Its error is that of the stride: halve it to
/// see.
std::function<VecX(double t)> ode_solution(const std::function<VecX(double, const VecX&)>& f, const VecX& y0,
                                           double t_end, double stride);

}  // namespace aussois
