// SPDX-License-Identifier: Apache-2.0
#include "integrators/advancement.hpp"

#include <algorithm>
#include <sstream>

#include "geometry/check.hpp"
#include "lmd/broad_phase.hpp"
#include "lmd/certificate.hpp"

namespace aussois {
namespace {

constexpr double kLargestRotation = 0.2;  // [rad]; cones enlarged by more say nothing, the certificate has to

RigidMotion motion_of(const StepMotion& step, int body, double scale = 1) {
  return {.g = pose(step.state, body),
          .v = scale * step.v.segment<3>(6 * body),
          .omega = scale * step.v.segment<3>(6 * body + 3)};
}

const LmdShape* shape_of(const Model& model, int body) {
  const int shape = model.bodies[std::size_t(body)].shape;
  return shape < 0 ? nullptr : model.shapes[std::size_t(shape)].get();
}

MovingShape moving_shape(const StepMotion& step, int body) {
  return {.shape = shape_of(step.model, body),
          .g_bs = step.model.bodies[std::size_t(body)].g_bs,
          .motion = motion_of(step, body)};
}

PosedShape posed_shape(const Model& model, const State& state, int body) {
  return {.shape = shape_of(model, body),
          .g_ws = pose(state, body) * model.bodies[std::size_t(body)].g_bs,
          .body = body};
}

struct PairBounds {
  double displacement = 0;  // [m]
  double rotation = 0;      // [rad]
};

PairBounds bounds_of(const StepMotion& step, const StepPair& pair, const std::vector<double>& radii,
                     double scale = 1) {
  const RigidMotion a = motion_of(step, pair.a, scale), b = motion_of(step, pair.b, scale);
  return {relative_displacement_bound(a, radii[std::size_t(pair.a)], b, radii[std::size_t(pair.b)], step.h),
          std::min(relative_rotation_bound(a, b, step.h), kLargestRotation)};
}

// How far a body reaches: what broad phase inflates it by, and what a step may not exceed.
double reach_of(const StepMotion& estimate, int body, const std::vector<double>& radii,
                const AdvancementOptions& o) {
  const LmdShape* shape = shape_of(estimate.model, body);
  const double moved =
      displacement_bound(motion_of(estimate, body, o.enlargement), radii[std::size_t(body)], estimate.h);
  return shape ? moved + o.floor * shape->radius : 0;
}

}  // namespace

void validate(const AdvancementOptions& o) {
  require_field(o.enlargement >= 1 && o.enlargement <= 4, "AdvancementOptions::enlargement", o.enlargement,
                "lie in [1, 4]");
  require_field(o.floor > 0 && o.floor <= 1, "AdvancementOptions::floor", o.floor, "lie in (0, 1]");
  require_field(o.max_overlap >= 0 && o.max_overlap <= 0.99, "AdvancementOptions::max_overlap", o.max_overlap,
                "lie in [0, 0.99]");
  require_field(o.min_h > 0, "AdvancementOptions::min_h", o.min_h, "be positive [s]");
  require_field(o.growth >= 1 && o.growth <= 4, "AdvancementOptions::growth", o.growth, "lie in [1, 4]");
  require_field(o.max_attempts >= 1, "AdvancementOptions::max_attempts", o.max_attempts, "be at least 1");
}

std::vector<double> body_radii(const Model& model) {
  std::vector<double> radii;
  for (int b = 0; b < int(model.bodies.size()); ++b) {
    const LmdShape* shape = shape_of(model, b);
    radii.push_back(
        shape ? radius_about(transformed(shape->complex, model.bodies[std::size_t(b)].g_bs), Vec3::Zero())
              : 0);
  }
  return radii;
}

std::vector<StepPair> pairs_within(const Model& model, const State& state, const std::vector<double>& reach) {
  std::vector<int> body_of;
  std::vector<Ball> balls;
  for (int b = 0; b < int(model.bodies.size()); ++b) {
    const LmdShape* shape = shape_of(model, b);
    if (!shape) continue;
    balls.push_back({pose(state, b) * (model.bodies[std::size_t(b)].g_bs * shape->centre),
                     shape->bounding_radius + shape->radius + reach[std::size_t(b)]});
    body_of.push_back(b);
  }
  std::vector<StepPair> pairs;
  for (const auto& [i, j] : broad_phase(balls)) {
    const int a = body_of[std::size_t(i)], b = body_of[std::size_t(j)];
    if (!is_dynamic(model.bodies[std::size_t(a)]) && !is_dynamic(model.bodies[std::size_t(b)])) continue;
    pairs.push_back({.a = a, .b = b, .dilation = shape_of(model, a)->radius + shape_of(model, b)->radius});
  }
  return pairs;
}

std::vector<StepPair> step_pairs(const StepMotion& estimate, const std::vector<double>& radii,
                                 const AdvancementOptions& o) {
  std::vector<double> reach;
  reach.reserve(radii.size());
  for (int b = 0; b < int(radii.size()); ++b) reach.push_back(reach_of(estimate, b, radii, o));
  std::vector<StepPair> pairs = pairs_within(estimate.model, estimate.state, reach);
  for (StepPair& pair : pairs) {
    const PairBounds bounds = bounds_of(estimate, pair, radii, o.enlargement);
    pair.threshold = std::max(o.floor * pair.dilation, bounds.displacement);
    pair.rotation = bounds.rotation;
  }
  return pairs;
}

ContactSet contacts_of(const Model& model, const State& state, const std::vector<StepPair>& pairs,
                       const LmdOptions& options) {
  ContactSet all;
  for (const StepPair& pair : pairs) {
    LmdOptions lmd = options;
    lmd.threshold = pair.threshold;
    lmd.alpha =
        std::min(0.5, lmd.alpha + pair.rotation);  // contacts that the step's rotation can bring about
    lmd.alpha_ee = std::max(lmd.alpha_ee, lmd.alpha);
    const ContactSet found =
        find_contacts(posed_shape(model, state, pair.a), posed_shape(model, state, pair.b), lmd);
    all.points.insert(all.points.end(), found.points.begin(), found.points.end());
  }
  return all;  // pairs are sorted, so the whole set is
}

std::string broken_bound(const StepMotion& step, const StepMotion& estimate,
                         const std::vector<StepPair>& pairs, const std::vector<double>& radii, double alpha,
                         const AdvancementOptions& o) {
  std::ostringstream text;
  for (const StepPair& pair : pairs) {
    const PairBounds bounds = bounds_of(step, pair, radii);
    if (bounds.displacement <= pair.threshold && bounds.rotation <= pair.rotation + alpha) continue;
    text << "bodies " << pair.a << " and " << pair.b << " may move by " << bounds.displacement << " m and "
         << bounds.rotation << " rad, their contacts were found within " << pair.threshold << " m and "
         << pair.rotation << " rad";
    return text.str();
  }
  for (int b = 0; b < int(radii.size()); ++b) {  // pairs that were not even near
    const double moved = displacement_bound(motion_of(step, b), radii[std::size_t(b)], step.h);
    const double reach = reach_of(estimate, b, radii, o);
    if (!shape_of(step.model, b) || moved <= reach) continue;
    text << "body " << b << " may move by " << moved << " m, its neighbours were looked for within " << reach
         << " m";
    return text.str();
  }
  return {};
}

StepCertificate certify_step(const StepMotion& step, const std::vector<StepPair>& pairs,
                             const AdvancementOptions& o, int threads) {
  StepCertificate out;
  for (const StepPair& pair : pairs) {
    const double required = std::max(1e-3, 1 - o.max_overlap) * pair.dilation;
    const Certificate c =
        certify(moving_shape(step, pair.a), moving_shape(step, pair.b), step.h,
                {.required = required, .wanted = std::max(pair.dilation, required), .threads = threads});
    out.rounds += c.rounds;
    out.min_distance = std::min(out.min_distance, c.min_distance);
    if (c.certified) continue;
    std::ostringstream text;
    text << "bodies " << pair.a << " and " << pair.b << ": base distance " << c.min_distance
         << " m is not proven to stay above " << required << " m";
    out.failure = text.str();
    break;
  }
  return out;
}

double min_base_distance(const Model& model, const State& state, double cutoff, int threads) {
  double distance = cutoff;
  const VecX rest = VecX::Zero(state.v.size());
  const StepMotion still{model, state, rest, 0};
  for (const StepPair& pair :
       pairs_within(model, state, std::vector<double>(model.bodies.size(), cutoff / 2)))
    distance = base_distance(moving_shape(still, pair.a), moving_shape(still, pair.b), distance, threads);
  return distance;
}

}  // namespace aussois
