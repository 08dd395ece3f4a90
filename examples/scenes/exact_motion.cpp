// SPDX-License-Identifier: Apache-2.0
#include "examples/scenes/exact_motion.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>

#include "geometry/check.hpp"

namespace aussois {

std::size_t piece_at(const ExactMotion& motion, double t) {
  const auto after =
      std::upper_bound(motion.pieces.begin(), motion.pieces.end(), t,
                       [](double time, const MotionPiece& piece) { return time < piece.begin; });
  return std::size_t(std::max<std::ptrdiff_t>(after - motion.pieces.begin() - 1, 0));
}

MotionSample evaluate(const ExactMotion& motion, double t) {
  return motion.pieces[piece_at(motion, t)].at(t);
}

double root(const std::function<double(double)>& f, double a, double b) {
  const bool positive = f(a) > 0;
  require(positive != (f(b) > 0), "a root needs different signs at both ends");
  for (double middle = a + (b - a) / 2; middle > std::min(a, b) && middle < std::max(a, b);
       middle = a + (b - a) / 2)
    (f(middle) > 0) == positive ? a = middle : b = middle;
  return b;
}

double first_root(const std::function<double(double)>& f, double begin, double end, double stride) {
  const bool positive = f(begin) > 0;
  for (double t = begin; t < end; t += stride)
    if ((f(t + stride) > 0) != positive) return root(f, t, t + stride);
  return kInf;
}

std::function<VecX(double t)> ode_solution(const std::function<VecX(double, const VecX&)>& f, const VecX& y0,
                                           double t_end, double stride) {
  using Values = std::vector<double>;
  const auto step = [f](Values y, double t, double h) {
    boost::numeric::odeint::runge_kutta_fehlberg78<Values> stepper;
    stepper.do_step(
        [&](const Values& at, Values& rate, double time) {
          VecX::Map(rate.data(), Eigen::Index(rate.size())) =
              f(time, VecX::Map(at.data(), Eigen::Index(at.size())));
        },
        y, t, h);
    return y;
  };
  const auto nodes = std::make_shared<std::vector<Values>>();
  nodes->emplace_back(y0.data(), y0.data() + y0.size());
  for (int k = 0; k * stride < t_end; ++k) nodes->push_back(step(nodes->back(), k * stride, stride));
  return [nodes, step, stride](double t) -> VecX {
    const double last = double(nodes->size() - 1);
    const double k = std::clamp(std::floor(t / stride), 0.0, last);
    const Values y = step((*nodes)[std::size_t(k)], k * stride, t - k * stride);
    return VecX::Map(y.data(), Eigen::Index(y.size()));
  };
}

}  // namespace aussois
