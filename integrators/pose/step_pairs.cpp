// SPDX-License-Identifier: Apache-2.0
#include "integrators/pose/step_pairs.hpp"

#include <algorithm>
#include <span>

#include "geometry/number_text.hpp"
#include "geometry/parallel.hpp"

namespace aussois {
namespace {

constexpr int kPairsOfAPart = 16;  // of a piece of work; so many pairs or fewer get all threads each instead
constexpr double kLargestRotation = 0.2;  // [rad]; cones enlarged by more exclude nothing

}  // namespace

const LmdShape* shape_of(const Model& model, BodyId body) {
  const ShapeId shape = model.bodies[body].shape;
  return shape ? model.shapes[shape].get() : nullptr;
}

RelativeBounds bounds_of(const StepPath& path, const StepPair& pair) {
  RelativeBounds out = relative_bounds(path.bodies[pair.a], path.bodies[pair.b], path.h);
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

namespace {

BodyBounds bounds_of_body(const RigidBody& body, std::span<const Vec3> vertices, const DilatedBox& box) {
  BodyBounds out{.box = body.g_bs * box};
  out.box.fixed = !contacts_can_move(body);
  for (const Vec3& x : vertices) out.radius = std::max(out.radius, (body.g_bs * x).norm());
  return out;
}

DilatedBox dilated_box(std::span<const Vec3> vertices, double radius) {
  DilatedBox box = box_around(vertices);
  box.radius = radius;
  return box;
}

// Largest angle that a normal or a wire turns by while the vertices move on, at most pi [rad].
double bend_of(const SimplicialComplex& complex, const DeformingShape& moving, double h) {
  const std::vector<Vec3>&start = moving.vertices, &velocity = moving.velocity;
  double least = 1;
  for (std::size_t e = 0; e < complex.edges.size(); ++e) {
    if (!complex.edge_triangles[int(e)].empty()) continue;
    const auto [a, b] = complex.edges[e];
    const Vec3 before = start[b] - start[a], after = before + h * (velocity[b] - velocity[a]);
    const double size = before.norm() * after.norm();
    least = std::min(least, size > 0 ? before.dot(after) / size : -1);
  }
  for (const auto& t : complex.triangles) {
    const auto normal = [&](double s) {
      const auto at = [&](int v) { return Vec3(start[v] + s * velocity[v]); };
      return (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
    };
    const Vec3 before = normal(0), after = normal(h);
    const double size = before.norm() * after.norm();
    least = std::min(least, size > 0 ? before.dot(after) / size : -1);
  }
  return std::acos(std::clamp(least, -1.0, 1.0));
}

BodyBounds bounds_of_deformed(const Model& model, BodyId body, std::span<const Vec3> vertices) {
  return bounds_of_body(model.bodies[body], vertices, dilated_box(vertices, shape_of(model, body)->radius));
}

DeformingShape deforming_shape(const StepMotion& step, BodyId body) {
  DeformingShape out{.vertices = deformed_vertices(step.model, step.state, body),
                     .velocity = vertex_velocities(step.model, step.state, body, step.v)};
  out.bounds = bounds_of_deformed(step.model, body, out.vertices);
  return out;
}

}  // namespace

PerBody<BodyBounds> body_bounds(const Model& model) {
  Table<ShapeId, DilatedBox> box_of_shape;
  for (const auto& shape : model.shapes)
    box_of_shape.push_back(dilated_box(shape->complex.vertices, shape->radius));
  PerBody<BodyBounds> bounds(model.bodies.size());
  for (const BodyId b : bounds.ids())
    if (const RigidBody& body = model.bodies[b]; body.shape)
      bounds[b] = bounds_of_body(body, model.shapes[body.shape]->complex.vertices, box_of_shape[body.shape]);
  return bounds;
}

Table<ShapeId, Pieces> pieces_of_shapes(const Model& model) {
  Table<ShapeId, Pieces> out;
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

NearPairs near_pairs(const Model& model, const State& state, const PerBody<BodyBounds>& bounds,
                     PerBody<double> reach, int threads, ContactScratch* scratch) {
  std::vector<BodyId> body_of;
  std::vector<DilatedBox> boxes;
  body_of.reserve(bounds.size());
  boxes.reserve(bounds.size());
  for (const BodyId b : model.bodies.ids()) {
    if (!shape_of(model, b)) continue;
    const bool rigid = !deforms(model.bodies[b]);
    boxes.push_back(
        pose(state, b) *
        (rigid ? bounds[b].box : bounds_of_deformed(model, b, deformed_vertices(model, state, b)).box));
    boxes.back().radius += reach[b];
    body_of.push_back(b);
  }
  NearPairs out{.reach = std::move(reach)};
  for (const auto& [i, j] : near_boxes(boxes, threads, scratch)) {  // (CA-12)
    const BodyId a = body_of[i], b = body_of[j];
    if (model.passing.contains({a, b}))
      ++out.passing;
    else
      out.pairs.push_back(
          {.a = a, .b = b, .dilation = shape_of(model, a)->radius + shape_of(model, b)->radius});
  }
  const std::size_t others = out.pairs.size();
  for (const BodyId b : body_of)
    if (const LmdShape& shape = *shape_of(model, b); shape.self && deforms(model.bodies[b]))
      out.pairs.push_back({.a = b, .b = b, .dilation = 2 * shape.radius});
  if (out.pairs.size() > others) std::ranges::sort(out.pairs, {}, bodies_of);
  return out;
}

std::vector<StepPair> pairs_within(const Model& model, const State& state, const PerBody<BodyBounds>& bounds,
                                   const PerBody<double>& reach, int threads, ContactScratch* scratch) {
  return near_pairs(model, state, bounds, reach, threads, scratch).pairs;
}

StepPath step_path(const StepMotion& step, const PerBody<BodyBounds>& bounds, double enlargement) {
  StepPath path{.model = step.model, .h = step.h};
  path.bodies.reserve(bounds.size());
  for (const BodyId b : bounds.ids()) {
    const RigidMotion motion{.g = pose(step.state, b),
                             .v = enlargement * linear_part(step.v, b),
                             .omega = enlargement * angular_part(step.v, b)};
    if (!deforms(step.model.bodies[b])) {
      path.bodies.push_back(moving_body(motion, bounds[b].radius, step.h));
      continue;
    }
    DeformingShape& shape = path.deforming[b] = deforming_shape(step, b);
    double fastest = 0;
    for (Vec3& v : shape.velocity) fastest = std::max(fastest, (v *= enlargement).norm());
    const double stretch = step.h * fastest;
    path.bodies.push_back(moving_body(motion, shape.bounds.radius + stretch, step.h));
    path.bodies.back().displacement += stretch;
    path.bodies.back().stretch = stretch;
    path.bodies.back().bend = bend_of(shape_of(step.model, b)->complex, shape, step.h);
  }
  return path;
}

std::string strayed(const StepPath& path, const State& end) {
  constexpr double kRounding = 1e-9;  // of the size of the shape and of what it travels
  for (const auto& [body, shape] : path.deforming) {
    const std::vector<Vec3> there = deformed_vertices(path.model, end, body);
    double off = 0;
    for (std::size_t i = 0; i < shape.velocity.size(); ++i)
      off = std::max(off, (there[i] - shape.vertices[i] - path.h * shape.velocity[i]).norm());
    if (off > kRounding * (shape.bounds.radius + path.bodies[body].stretch))
      return "body " + to_string(body) + ": a vertex is " + number_text(off) +
             " m away from where the columns of its deformation led";
  }
  return {};
}

NearPairs step_pairs(const StepMotion& estimate, const PerBody<BodyBounds>& bounds,
                     const AdvancementOptions& o, int threads, ContactScratch* scratch) {
  const StepPath path = step_path(estimate, bounds, o.enlargement);
  PerBody<double> reach;
  reach.reserve(bounds.size());
  for (const BodyId b : bounds.ids()) {
    const LmdShape* shape = shape_of(path.model, b);
    reach.push_back(shape ? path.bodies[b].displacement + o.floor * shape->radius : 0);
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

ContactSet joined(const std::vector<LevelContacts>& parts, ContactSet LevelContacts::*of) {
  std::size_t count = 0;
  for (const LevelContacts& part : parts) count += (part.*of).points.size();
  ContactSet all;
  all.points.reserve(count);
  for (const LevelContacts& part : parts)
    all.points.insert(all.points.end(), (part.*of).points.begin(), (part.*of).points.end());
  return all;  // pairs are sorted, so the whole set is
}

// `scratch` is of every pair, or empty.
LevelContacts contacts_of(const Model& model, const State& state, const std::vector<StepPair>& pairs,
                          const LmdOptions& options, const LevelUse& use, std::span<PairScratch> scratch,
                          DeformedShapes* deformed = nullptr) {
  const PerBody<PosedShape> posed = posed_once<PosedShape>(
      model.bodies.size(), pairs, [&](BodyId body) { return posed_shape(model, state, body, deformed); });
  std::vector<LevelContacts> found(count_of_parts(pairs));
  for_each_part(pairs, options.threads, [&](int part, std::span<const StepPair> some, int threads) {
    for (const StepPair& pair : some) {
      LmdOptions lmd = options;
      lmd.threads = threads;
      lmd.threshold = pair.threshold;
      lmd.alpha =
          std::min(0.5, lmd.alpha + pair.rotation);  // contacts that the step's rotation can bring about
      lmd.alpha_ee = std::max(lmd.alpha_ee, lmd.alpha);
      const PosedShape &a = posed[pair.a], &b = posed[pair.b];
      PairScratch* of_pair = scratch.empty() || a.own || b.own ? nullptr : &scratch[&pair - pairs.data()];
      LevelUse of_levels = use;
      of_levels.fine_to = pair.fine_to;
      const LevelContacts now = find_contacts_by_level(a, b, lmd, of_levels, of_pair);
      for (const auto set : {&LevelContacts::fine, &LevelContacts::coarse}) {
        std::vector<ContactPoint>& points = (found[part].*set).points;
        points.insert(points.end(), (now.*set).points.begin(), (now.*set).points.end());
      }
    }
  });
  return {joined(found, &LevelContacts::fine), joined(found, &LevelContacts::coarse)};
}

// Keeps the scratch of these pairs, in their order.
void keep_those_of(const std::vector<StepPair>& pairs, ContactScratch& scratch) {
  std::vector<BodyPair> bodies;
  std::vector<PairScratch> kept;
  bodies.reserve(pairs.size());
  kept.reserve(pairs.size());
  std::size_t next = 0;
  for (const StepPair& pair : pairs) {
    bodies.push_back(bodies_of(pair));
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
  return contacts_of(model, state, pairs, options, {}, std::span<PairScratch>()).fine;
}

LevelContacts contacts_of(const Model& model, const State& state, const std::vector<StepPair>& pairs,
                          const LmdOptions& options, const LevelUse& use, ContactScratch& scratch) {
  const std::unique_lock lock(scratch.in_use, std::try_to_lock);
  DeformedShapes* deformed = scratch.deformed.get();
  if (!lock) return contacts_of(model, state, pairs, options, use, std::span<PairScratch>(), deformed);
  const auto is_of = [](const StepPair& pair, const BodyPair& bodies) { return bodies_of(pair) == bodies; };
  if (!std::ranges::equal(pairs, scratch.bodies, is_of)) keep_those_of(pairs, scratch);
  return contacts_of(model, state, pairs, options, use, std::span(scratch.pairs), deformed);
}

std::size_t bytes_of(ContactScratch& scratch) {
  const std::unique_lock lock(scratch.in_use, std::try_to_lock);
  if (!lock) return 0;
  std::size_t out = bytes_of(scratch.near) + scratch.bodies.capacity() * sizeof(BodyPair) +
                    scratch.pairs.capacity() * sizeof(PairScratch);
  for (const PairScratch& pair : scratch.pairs) out += bytes_of(pair);
  return out;
}

}  // namespace aussois
