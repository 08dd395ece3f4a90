// SPDX-License-Identifier: Apache-2.0
#include "integrators/pose/step_pairs.hpp"

#include <algorithm>

#include "geometry/parallel.hpp"

namespace aussois {
namespace {

constexpr int kPairsOfAPart = 16;  // of a piece of work; so many pairs or fewer get all threads each instead
constexpr double kLargestRotation = 0.2;  // [rad]; cones enlarged by more say nothing, the certificate has to

}  // namespace

const LmdShape* shape_of(const Model& model, int body) {
  const int shape = model.bodies[std::size_t(body)].shape;
  return shape < 0 ? nullptr : model.shapes[std::size_t(shape)].get();
}

RelativeBounds bounds_of(const StepPath& path, const StepPair& pair) {
  RelativeBounds out =
      relative_bounds(path.bodies[std::size_t(pair.a)], path.bodies[std::size_t(pair.b)], path.h);
  out.rotation = std::min(out.rotation, kLargestRotation);
  return out;
}

int count_of_parts(const std::vector<StepPair>& pairs) {
  return int((pairs.size() + kPairsOfAPart - 1) / kPairsOfAPart);
}

void for_each_part(const std::vector<StepPair>& pairs, int threads,
                   const std::function<void(int part, std::span<const StepPair>, int threads)>& f) {
  const int parts = count_of_parts(pairs);
  parallel_for(parts, threads, [&](int k) {
    const std::size_t first = std::size_t(k) * kPairsOfAPart;
    const std::size_t count = std::min(pairs.size() - first, std::size_t(kPairsOfAPart));
    f(k, std::span(pairs).subspan(first, count), parts > 1 ? 1 : threads);
  });
}

std::vector<BodyBounds> body_bounds(const Model& model) {
  std::vector<DilatedBox> box_of_shape;
  for (const auto& shape : model.shapes) {
    box_of_shape.push_back(box_around(shape->complex.vertices));
    box_of_shape.back().radius = shape->radius;
  }
  std::vector<BodyBounds> bounds(model.bodies.size());
  for (std::size_t b = 0; b < bounds.size(); ++b) {
    const RigidBody& body = model.bodies[b];
    if (body.shape < 0) continue;
    bounds[b].box = body.g_bs * box_of_shape[std::size_t(body.shape)];
    bounds[b].box.fixed = !is_dynamic(body);
    for (const Vec3& x : model.shapes[std::size_t(body.shape)]->complex.vertices)
      bounds[b].radius = std::max(bounds[b].radius, (body.g_bs * x).norm());
  }
  return bounds;
}

std::vector<Pieces> pieces_of_shapes(const Model& model) {
  std::vector<Pieces> out;
  out.reserve(model.shapes.size());
  for (const auto& shape : model.shapes) out.push_back(connected_pieces(shape->complex));
  return out;
}

namespace {

std::vector<std::pair<int, int>> near_boxes(const std::vector<DilatedBox>& boxes, int threads,
                                            ContactScratch* scratch) {
  if (!scratch) return broad_phase(boxes, threads);
  const std::unique_lock lock(scratch->in_use, std::try_to_lock);
  return lock ? broad_phase(boxes, threads, scratch->near) : broad_phase(boxes, threads);
}

}  // namespace

NearPairs near_pairs(const Model& model, const State& state, const std::vector<BodyBounds>& bounds,
                     std::vector<double> reach, int threads, ContactScratch* scratch) {
  std::vector<int> body_of;
  std::vector<DilatedBox> boxes;
  body_of.reserve(bounds.size());
  boxes.reserve(bounds.size());
  for (int b = 0; b < int(model.bodies.size()); ++b) {
    if (!shape_of(model, b)) continue;
    boxes.push_back(pose(state, b) * bounds[std::size_t(b)].box);
    boxes.back().radius += reach[std::size_t(b)];
    body_of.push_back(b);
  }
  NearPairs out{.reach = std::move(reach)};
  for (const auto& [i, j] : near_boxes(boxes, threads, scratch)) {  // (CA-12)
    const int a = body_of[std::size_t(i)], b = body_of[std::size_t(j)];
    if (model.passing.contains({a, b}))
      ++out.passing;
    else
      out.pairs.push_back(
          {.a = a, .b = b, .dilation = shape_of(model, a)->radius + shape_of(model, b)->radius});
  }
  return out;
}

std::vector<StepPair> pairs_within(const Model& model, const State& state,
                                   const std::vector<BodyBounds>& bounds, const std::vector<double>& reach,
                                   int threads, ContactScratch* scratch) {
  return near_pairs(model, state, bounds, reach, threads, scratch).pairs;
}

StepPath step_path(const StepMotion& step, const std::vector<BodyBounds>& bounds, double enlargement) {
  StepPath path{.model = step.model, .h = step.h};
  path.bodies.reserve(bounds.size());
  for (int b = 0; b < int(bounds.size()); ++b)
    path.bodies.push_back(moving_body({.g = pose(step.state, b),
                                       .v = enlargement * linear_part(step.v, b),
                                       .omega = enlargement * angular_part(step.v, b)},
                                      bounds[std::size_t(b)].radius, step.h));
  return path;
}

NearPairs step_pairs(const StepMotion& estimate, const std::vector<BodyBounds>& bounds,
                     const AdvancementOptions& o, int threads, ContactScratch* scratch) {
  const StepPath path = step_path(estimate, bounds, o.enlargement);
  std::vector<double> reach;
  reach.reserve(bounds.size());
  for (int b = 0; b < int(bounds.size()); ++b) {
    const LmdShape* shape = shape_of(path.model, b);
    reach.push_back(shape ? path.bodies[std::size_t(b)].displacement + o.floor * shape->radius : 0);
  }
  NearPairs out = near_pairs(estimate.model, estimate.state, bounds, std::move(reach), threads, scratch);
  for (StepPair& pair : out.pairs) {
    const RelativeBounds bound = bounds_of(path, pair);
    pair.threshold = std::max(o.floor * pair.dilation, bound.displacement);
    pair.rotation = bound.rotation;
  }
  return out;
}

namespace {

// `scratch` is of every pair, or empty.
ContactSet contacts_of(const Model& model, const State& state, const std::vector<StepPair>& pairs,
                       const LmdOptions& options, std::span<PairScratch> scratch) {
  const std::vector<PosedShape> posed = posed_once<PosedShape>(
      model.bodies.size(), pairs, [&](int body) { return posed_shape(model, state, body); });
  std::vector<ContactSet> found(std::size_t(count_of_parts(pairs)));
  for_each_part(pairs, options.threads, [&](int part, std::span<const StepPair> some, int threads) {
    for (const StepPair& pair : some) {
      LmdOptions lmd = options;
      lmd.threads = threads;
      lmd.threshold = pair.threshold;
      lmd.alpha =
          std::min(0.5, lmd.alpha + pair.rotation);  // contacts that the step's rotation can bring about
      lmd.alpha_ee = std::max(lmd.alpha_ee, lmd.alpha);
      const PosedShape &a = posed[std::size_t(pair.a)], &b = posed[std::size_t(pair.b)];
      const ContactSet of_pair = scratch.empty()
                                     ? find_contacts(a, b, lmd)
                                     : find_contacts(a, b, lmd, scratch[std::size_t(&pair - pairs.data())]);
      std::vector<ContactPoint>& points = found[std::size_t(part)].points;
      points.insert(points.end(), of_pair.points.begin(), of_pair.points.end());
    }
  });
  std::size_t count = 0;
  for (const ContactSet& some : found) count += some.points.size();
  ContactSet all;
  all.points.reserve(count);
  for (const ContactSet& some : found)
    all.points.insert(all.points.end(), some.points.begin(), some.points.end());
  return all;  // pairs are sorted, so the whole set is
}

// What the scratch knows of these pairs, in their order.
void keep_those_of(const std::vector<StepPair>& pairs, ContactScratch& scratch) {
  std::vector<std::pair<int, int>> bodies;
  std::vector<PairScratch> kept;
  bodies.reserve(pairs.size());
  kept.reserve(pairs.size());
  std::size_t next = 0;
  for (const StepPair& pair : pairs) {
    bodies.emplace_back(pair.a, pair.b);
    while (next < scratch.bodies.size() && scratch.bodies[next] < bodies.back()) ++next;
    const bool known = next < scratch.bodies.size() && scratch.bodies[next] == bodies.back();
    kept.push_back(known ? std::move(scratch.pairs[next]) : PairScratch{});
  }
  scratch.bodies = std::move(bodies);
  scratch.pairs = std::move(kept);
}

}  // namespace

ContactSet contacts_of(const Model& model, const State& state, const std::vector<StepPair>& pairs,
                       const LmdOptions& options) {
  return contacts_of(model, state, pairs, options, std::span<PairScratch>());
}

ContactSet contacts_of(const Model& model, const State& state, const std::vector<StepPair>& pairs,
                       const LmdOptions& options, ContactScratch& scratch) {
  const std::unique_lock lock(scratch.in_use, std::try_to_lock);
  if (!lock) return contacts_of(model, state, pairs, options);
  const auto is_of = [](const StepPair& pair, const std::pair<int, int>& bodies) {
    return std::pair(pair.a, pair.b) == bodies;
  };
  if (!std::ranges::equal(pairs, scratch.bodies, is_of)) keep_those_of(pairs, scratch);
  return contacts_of(model, state, pairs, options, std::span(scratch.pairs));
}

}  // namespace aussois
