// SPDX-License-Identifier: Apache-2.0
#include "integrators/prove/certify_step.hpp"

#include <algorithm>
#include <sstream>

#include "geometry/number_text.hpp"
#include "lmd/certificate.hpp"
#include "lmd/shape_levels.hpp"

namespace aussois {
namespace {

constexpr int kCoarseHalvings = 6;     // what a level does not prove soon is left to the next finer one
constexpr double kTurnOfAPiece = 0.1;  // [rad]; bounds of paths that turn by more say little
constexpr double kMostPieces = 100;    // a path that turns by more is proven in one
constexpr int kFineHalvings = 16;      // a near miss by 1 um at 1600 m/s and 1 ms needs 14

MovingShape moving_shape(const StepPath& path, BodyId body) {
  MovingShape out{.shape = shape_of(path.model, body),
                  .g_bs = path.model.bodies[body].g_bs,
                  .motion = path.bodies[body].motion,
                  .body = body};
  if (const auto moving = path.deforming.find(body); moving != path.deforming.end()) {
    out.own = path.deformed->at(body, *out.shape, moving->second.vertices);
    out.shape = out.own.get();
    out.velocity = moving->second.velocity;
  }
  return out;
}

const SE3& pose_of(const StepPath& path, BodyId body) {
  return path.bodies[body].motion.g;
}

}  // namespace

double required_distance(const StepPair& pair, const AdvancementOptions& o) {
  return std::max(1e-3, 1 - o.max_overlap) * pair.dilation;
}

std::string broken_bound(const StepPath& path, const std::vector<StepPair>& pairs, double alpha) {
  for (const StepPair& pair : pairs) {
    const RelativeBounds bound = bounds_of(path, pair);
    if (bound.displacement <= pair.threshold && bound.rotation <= pair.rotation + alpha) continue;
    std::ostringstream text;
    text << "bodies " << pair.a << " and " << pair.b << " may move by " << bound.displacement << " m and "
         << bound.rotation << " rad, their contacts were found within " << pair.threshold << " m and "
         << pair.rotation << " rad";
    return text.str();
  }
  return {};
}

std::string broken_reach(const StepPath& path, const PerBody<double>& reach) {
  for (const BodyId b : reach.ids()) {
    const double moved = path.bodies[b].displacement;
    if (!shape_of(path.model, b) || moved <= reach[b]) continue;
    std::ostringstream text;
    text << "body " << b << " may move by " << moved << " m, its neighbours were looked for within "
         << reach[b] << " m";
    return text.str();
  }
  return {};
}

namespace {

// The deepest contact of a pair; null: it has none.
const ContactPoint* deepest_contact(const StepPair& pair, const ContactSet& contacts) {
  const auto bodies = [](const ContactPoint& c) { return BodyPair{c.a.body, c.b.body}; };
  const BodyPair ours = bodies_of(pair);
  const ContactPoint* deepest = nullptr;
  for (auto c = std::ranges::lower_bound(contacts.points, ours, {}, bodies);
       c != contacts.points.end() && bodies(*c) == ours; ++c)
    if (!deepest || c->gap < deepest->gap) deepest = &*c;
  return deepest;
}

// Where a plane may part the pair, from A to B: across its deepest contact, or from centre to centre.
Vec3 likely_axis(const StepPath& path, const StepPair& pair, const ContactPoint* deepest) {
  return deepest ? Vec3(-deepest->normal) : Vec3(pose_of(path, pair.b).p - pose_of(path, pair.a).p);
}

// A path that turns far, piece by piece (CA-23). `then_apart`: later pieces may assume that the bases start
// apart and not inside each other.
Certificate certify_in_pieces(MovingShape a, MovingShape b, double h, CertificateOptions options,
                              bool then_apart) {
  const double turn = relative_rotation_bound(a.motion, b.motion, h) / kTurnOfAPiece;
  const bool cut = a.velocity.empty() && b.velocity.empty() && turn > 1 && turn < kMostPieces;
  const int pieces = cut ? int(std::ceil(turn)) : 1;
  const RigidMotion of_a = a.motion, of_b = b.motion;
  Certificate out = certify(a, b, h / pieces, options);
  options.starts_apart = then_apart;
  for (int k = 1; k < pieces && out.certified; ++k) {
    a.motion = motion_after(of_a, h * k / pieces);
    b.motion = motion_after(of_b, h * k / pieces);
    const Certificate piece = certify(a, b, h / pieces, options);
    out.certified = piece.certified;
    out.min_distance = std::min(out.min_distance, piece.min_distance);
    out.simplex_pairs += piece.simplex_pairs;
    out.rounds += piece.rounds;
  }
  return out;
}

// By levels that may prove it because they are off by less than `gap`, the coarsest first (LOD-7); `rounds`
// grows by those of the levels that do not.
std::optional<Certificate> certify_by_levels(const StepPath& path, const StepPair& pair, double gap,
                                             const CertificateOptions& options, long& rounds) {
  MovingShape a = moving_shape(path, pair.a), b = moving_shape(path, pair.b);
  const LmdShape &fine_a = *a.shape, &fine_b = *b.shape;
  for (int level = std::min(path.levels, std::max(level_count(fine_a), level_count(fine_b))); level > 0;
       --level) {
    const double off = level_off(fine_a, level) + level_off(fine_b, level);
    if (off >= gap) continue;
    a.shape = &level_shape(fine_a, level);
    b.shape = &level_shape(fine_b, level);
    CertificateOptions of_level = options;
    of_level.required += off;
    of_level.wanted += off;
    of_level.max_halvings = std::min(options.max_halvings, kCoarseHalvings);
    of_level.starts_apart = false;  // the levels may not be
    Certificate proof = certify_in_pieces(a, b, path.h, of_level, false);
    rounds += proof.rounds;
    if (!proof.certified) continue;
    proof.min_distance = std::min(proof.min_distance - off, options.wanted);
    return proof;
  }
  return std::nullopt;
}

// Without a contact nothing is near, and all pairs cost less than minima.
bool asks_minima(const StepPath& path, const StepPair& pair) {
  return path.starts_apart && pair.has_contacts;
}

DilatedBox posed_box(const StepPath& path, const PerBody<BodyBounds>& bounds, BodyId body) {
  const auto shape = path.deforming.find(body);
  return pose_of(path, body) * (shape == path.deforming.end() ? bounds[body] : shape->second.bounds).box;
}

// `apart`: by how much their boxes are; `gap`: of their deepest contact; `then_apart`: see certify_in_pieces.
StepCertificate certify_pair(const StepPath& path, const StepPair& pair, double apart, double gap,
                             const CertificateOptions& options, bool then_apart) {
  const double moved = path.bodies[pair.a].displacement + path.bodies[pair.b].displacement;
  // Both ways bound how far the pair comes nearer; the sum costs nothing
  if (apart > moved || (apart > 0 && apart > bounds_of(path, pair).displacement))  // they cannot even touch
    return {.min_distance = options.wanted};
  StepCertificate out;
  if (const auto proof = certify_by_levels(path, pair, gap, options, out.rounds)) {
    out.min_distance = proof->min_distance;
    return out;
  }
  const Certificate c =
      certify_in_pieces(moving_shape(path, pair.a), moving_shape(path, pair.b), path.h, options, then_apart);
  out.min_distance = c.min_distance;
  out.rounds += c.rounds;
  if (c.certified) return out;
  std::ostringstream text;
  text << "bodies " << pair.a << " and " << pair.b << ": base distance " << c.min_distance
       << " m is not proven to stay above " << options.required << " m";
  out.failure = text.str();
  return out;
}

// Of some pairs, up to the first that is not certified.
StepCertificate certify_pairs(const StepPath& path, std::span<const StepPair> pairs,
                              const PerBody<DilatedBox>& boxes, const ContactSet& contacts,
                              const AdvancementOptions& o, int threads) {
  StepCertificate out;
  for (const StepPair& pair : pairs) {
    const double required = required_distance(pair, o);
    const double apart = separation(boxes[pair.a], boxes[pair.b]);
    const ContactPoint* deepest = deepest_contact(pair, contacts);
    const StepCertificate of_pair = certify_pair(path, pair, apart, deepest ? deepest->gap : kInf,
                                                 {.required = required,
                                                  .wanted = std::max(pair.dilation, required),
                                                  .threads = threads,
                                                  .axis = likely_axis(path, pair, deepest),
                                                  .starts_apart = asks_minima(path, pair)},
                                                 path.starts_apart);
    out.rounds += of_pair.rounds;
    out.min_distance = std::min(out.min_distance, of_pair.min_distance);
    if (of_pair.failure.empty()) continue;
    out.failure = of_pair.failure;
    break;
  }
  return out;
}

}  // namespace

StepCertificate certify_apart(const StepPath& path, const StepPair& pair, const PerBody<BodyBounds>& bounds,
                              int threads) {
  const double apart = separation(posed_box(path, bounds, pair.a), posed_box(path, bounds, pair.b));
  return certify_pair(path, pair, apart, kInf,
                      {.required = pair.dilation,
                       .wanted = pair.dilation,
                       .max_halvings = kFineHalvings,
                       .threads = threads,
                       .starts_apart = asks_minima(path, pair)},
                      path.starts_apart);
}

StepCertificate certify_step(const StepPath& path, const std::vector<StepPair>& pairs,
                             const PerBody<BodyBounds>& bounds, const ContactSet& contacts,
                             const AdvancementOptions& o, int threads) {
  const PerBody<DilatedBox> boxes = posed_once<DilatedBox>(
      bounds.size(), pairs, [&](BodyId body) { return posed_box(path, bounds, body); });
  std::vector<StepCertificate> of_part(count_of_parts(pairs));
  for_each_part(pairs, threads, [&](int part, std::span<const StepPair> some, int threads_each) {
    of_part[part] = certify_pairs(path, some, boxes, contacts, o, threads_each);
  });
  StepCertificate out;
  for (const StepCertificate& part : of_part) {
    out.rounds += part.rounds;
    out.min_distance = std::min(out.min_distance, part.min_distance);
    out.failure = part.failure;
    if (!out.failure.empty()) break;
  }
  return out;
}

std::vector<StepPair> driven_pairs(const StepPath& path, const PerBody<BodyBounds>& bounds, int threads) {
  const Table<BodyId, RigidBody>& bodies = path.model.bodies;
  if (std::ranges::none_of(bodies, is_moved)) return {};
  std::vector<BodyId> body_of;
  std::vector<DilatedBox> boxes;
  for (const BodyId b : bodies.ids()) {
    const RigidBody& body = bodies[b];
    if (!body.shape || contacts_can_move(body)) continue;
    boxes.push_back(posed_box(path, bounds, b));
    boxes.back().radius += path.bodies[b].displacement;
    boxes.back().fixed = !is_moved(body);
    body_of.push_back(b);
  }
  std::vector<StepPair> out;
  for (const auto& [i, j] : broad_phase(boxes, threads)) {
    const BodyId a = body_of[i], b = body_of[j];
    const double dilation = shape_of(path.model, a)->radius + shape_of(path.model, b)->radius;
    if (dilation > 0 && !path.model.passing.contains({a, b}))
      out.push_back({.a = a, .b = b, .dilation = dilation});
  }
  return out;
}

namespace {

const Pieces& pieces_of(const Model& model, const Table<ShapeId, Pieces>& pieces, BodyId body) {
  return pieces[model.bodies[body].shape];
}

}  // namespace

std::vector<BodyPair> driven_overlaps(const StepPath& path, const PerBody<BodyBounds>& bounds,
                                      const Table<ShapeId, Pieces>& pieces, const AdvancementOptions& o,
                                      int threads) {
  const auto posed = [&](BodyId body) {
    const MovingShape shape = moving_shape(path, body);
    return PosedShape{shape.shape, shape.motion.g * shape.g_bs, body, shape.own};
  };
  std::vector<BodyPair> out;
  for (const StepPair& pair : driven_pairs(path, bounds, threads)) {
    const double required = required_distance(pair, o);
    const double apart = separation(posed_box(path, bounds, pair.a), posed_box(path, bounds, pair.b));
    const StepCertificate proof = certify_pair(
        path, pair, apart, kInf, {.required = required, .wanted = required, .threads = threads}, false);
    if (!proof.failure.empty() || find_nesting(posed(pair.a), pieces_of(path.model, pieces, pair.a),
                                               posed(pair.b), pieces_of(path.model, pieces, pair.b)))
      out.push_back(bodies_of(pair));
  }
  return out;
}

std::optional<Overlap> deepest_overlap(const Model& model, const State& state,
                                       const PerBody<BodyBounds>& bounds, const AdvancementOptions& options,
                                       int threads) {
  const VecX rest = VecX::Zero(state.v.size());
  const StepPath still = step_path({model, state, rest, 0}, bounds);
  std::optional<Overlap> out;
  for (const StepPair& pair :
       pairs_within(model, state, bounds, PerBody<double>(model.bodies.size(), 0), threads)) {
    const Overlap here{
        pair.a, pair.b,
        base_distance(moving_shape(still, pair.a), moving_shape(still, pair.b), pair.dilation, threads),
        required_distance(pair, options)};
    if (here.distance < here.required &&
        (!out || here.required - here.distance > out->required - out->distance))
      out = here;
  }
  return out;
}

namespace {

std::string name_of(const Model& model, BodyId body) {
  return to_string(body) + " (" + model.bodies[body].name + ")";
}

std::string text_of(const Model& model, const Overlap& overlap) {
  std::ostringstream text;
  text << "bodies " << name_of(model, overlap.a) << " and " << name_of(model, overlap.b)
       << ": base distance = " << number_text(overlap.distance) << " must be at least "
       << number_text(overlap.required) << " [m]";
  for (const JointId j : model.joints.ids())
    if (const Joint& joint = model.joints[j];
        joint.collide && ordered_pair(joint.body_a, joint.body_b) == BodyPair{overlap.a, overlap.b}) {
      text << "; they touch each other because joint " << j << " (" << joint.name << ") has collide";
      break;
    }
  return text.str();
}

}  // namespace

std::string nested_pair(const Model& model, const State& state, const std::vector<StepPair>& pairs,
                        const Table<ShapeId, Pieces>& pieces) {
  for (const StepPair& pair : pairs) {
    if (pair.a == pair.b) continue;
    if (const auto nesting =
            find_nesting(posed_shape(model, state, pair.a), pieces_of(model, pieces, pair.a),
                         posed_shape(model, state, pair.b), pieces_of(model, pieces, pair.b)))
      return to_string(*nesting, "body " + name_of(model, pair.a), "body " + name_of(model, pair.b));
  }
  return {};
}

std::string nested_at(const Model& model, const State& state, const PerBody<BodyBounds>& bounds,
                      const Table<ShapeId, Pieces>& pieces, int threads) {
  if (std::ranges::none_of(model.shapes, [](const auto& shape) { return shape->complex.solid; })) return {};
  const PerBody<double> reach(model.bodies.size(), 0);
  return nested_pair(model, state, pairs_within(model, state, bounds, reach, threads), pieces);
}

std::string wrong_start(const Model& model, const State& state, const PerBody<BodyBounds>& bounds,
                        const Table<ShapeId, Pieces>& pieces, const AdvancementOptions& options,
                        int threads) {
  const std::optional<Overlap> overlap = deepest_overlap(model, state, bounds, options, threads);
  return overlap ? text_of(model, *overlap) : nested_at(model, state, bounds, pieces, threads);
}

}  // namespace aussois
