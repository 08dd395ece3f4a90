// SPDX-License-Identifier: Apache-2.0
#include "examples/scenes/peer_scenes.hpp"

#include <algorithm>
#include <cmath>

#include "examples/common/random.hpp"
#include "geometry/check.hpp"
#include "geometry/primitives.hpp"
#include "geometry/settings.hpp"

namespace aussois {
namespace {

constexpr double kBoxDilation = 1e-3;                              // of boxes and prisms in the kernel [m]
constexpr double kFallen = 0.1;                                    // [m]
constexpr double kDroppedRadius = 0.1, kBallMass = 10, kDrop = 5;  // of bouncing and 666 [m, kg]

PeerShape ball(double radius, double mass) {
  return {.kind = PeerShapeKind::ball,
          .size = Vec3(radius, 0, 0),
          .mass = mass,
          .inertia = 0.4 * mass * radius * radius * Mat3::Identity()};
}

PeerShape box(const Vec3& size, double mass) {
  const Vec3 s = size.cwiseAbs2();
  return {.size = size,
          .mass = mass,
          .inertia = mass / 12 * Vec3(s.y() + s.z(), s.z() + s.x(), s.x() + s.y()).asDiagonal()};
}

// A profile about its centroid; `centre` is where that was.
PeerShape prism(std::vector<Vec2> profile, double length, double density, Vec2& centre) {
  const MassProperties mass = mass_properties(make_extrusion(profile, length), density);
  centre = mass.centre.head<2>();
  for (Vec2& x : profile) x -= centre;
  return {.kind = PeerShapeKind::prism,
          .size = Vec3(0, 0, length),
          .profile = std::move(profile),
          .mass = mass.mass,
          .inertia = mass.inertia};
}

// A box below z = 0.
PeerScene on_ground(std::string name, std::string what, double half, double mu) {
  PeerScene scene{.name = std::move(name), .what = std::move(what)};
  scene.shapes.push_back(box(Vec3(2 * half, 2 * half, 1), 1));
  scene.bodies.push_back({.shape = 0, .fixed = true, .mu = mu, .g = translation(0, 0, -0.5)});
  return scene;
}

// Every side of a convex profile moved in by `depth`.
std::vector<Vec2> moved_in(const std::vector<Vec2>& profile, double depth) {
  const std::size_t n = profile.size();
  std::vector<Vec2> out;
  for (std::size_t i = 0; i < n; ++i) {
    const auto inwards = [&](std::size_t from) {
      const Vec2 along = (profile[(from + 1) % n] - profile[from]).normalized();
      return Vec2(-along.y(), along.x());
    };
    Eigen::Matrix2d sides;
    sides << inwards((i + n - 1) % n).transpose(), inwards(i).transpose();
    out.push_back(profile[i] + sides.inverse() * Vec2(depth, depth));
  }
  return out;
}

DilatedShape dilated(const PeerShape& shape) {
  switch (shape.kind) {
    case PeerShapeKind::ball:
      return dilate(make_point(), shape.size.x());
    case PeerShapeKind::box: {
      const Vec3 s = shape.size - Vec3::Constant(2 * kBoxDilation);
      return dilate(make_box(s.x(), s.y(), s.z()), kBoxDilation);
    }
    case PeerShapeKind::prism:
      break;
  }
  return dilate(make_extrusion(moved_in(shape.profile, kBoxDilation), shape.size.z() - 2 * kBoxDilation),
                kBoxDilation);
}

// Over the energy at the start, of a ball that falls by `drop` and bounces.
double exact_bounce_energy(double drop, double restitution, double t) {
  double hop = std::sqrt(2 * drop / kGravity), energy = 1;
  for (double impact = hop; impact <= t && hop > 1e-9; impact += hop) {
    energy *= restitution * restitution;
    hop *= (energy == restitution * restitution ? 2 : 1) * restitution;
  }
  return energy;
}

// Of balls, above the rest on the ground [J].
double ball_energy(const PeerScene& scene, const PeerSample& now) {
  double energy = 0;
  for (const BodyId b : now.g.ids()) {
    if (b == 0) continue;
    const PeerShape& shape = scene.shapes[scene.bodies[b].shape];
    energy += shape.mass * (kGravity * (now.g[b].p.z() - shape.size.x()) + now.v[b].squaredNorm() / 2);
  }
  return energy;
}

double deepest_overlap(const PeerScene& scene, const PeerSample& now) {
  double deepest = 0;
  for (const BodyId a : now.g.ids()) {
    if (a == 0) continue;
    const double radius = scene.shapes[scene.bodies[a].shape].size.x();
    deepest = std::max(deepest, radius - now.g[a].p.z());
    for (BodyId b = 1; b < a; ++b) {
      const double sum = radius + scene.shapes[scene.bodies[b].shape].size.x();
      const double squared = (now.g[a].p - now.g[b].p).squaredNorm();
      if (squared < sum * sum) deepest = std::max(deepest, sum - std::sqrt(squared));
    }
  }
  return deepest;
}

double largest_displacement(const PeerScene& scene, const PeerSample& now) {
  double out = 0;
  for (const BodyId b : now.g.ids()) out = std::max(out, (now.g[b].p - scene.bodies[b].g.p).norm());
  return out;
}

}  // namespace

std::vector<Vec3> corners(const PeerShape& shape, double depth) {
  const Vec2 half = shape.size.head<2>() / 2;
  const std::vector<Vec2> profile =
      shape.kind == PeerShapeKind::prism
          ? shape.profile
          : std::vector<Vec2>{-half, Vec2(half.x(), -half.y()), half, Vec2(-half.x(), half.y())};
  std::vector<Vec3> out;
  for (const double side : {-1, 1})
    for (const Vec2& x : moved_in(profile, depth))
      out.emplace_back(x.x(), x.y(), side * (shape.size.z() / 2 - depth));
  return out;
}

PeerScene rolling_scene(const Vec2& direction) {
  PeerScene scene =
      on_ground("rolling", "a box under 25 balls is pushed and slides, the balls roll", 40, 0.4);
  const double box_mass = 10, ball_mass = 1, radius = 0.5, push = 150;
  const int balls = 25;
  scene.shapes.push_back(box(Vec3(20, 20, 1), box_mass));
  scene.shapes.push_back(ball(radius, ball_mass));
  scene.bodies.push_back({.shape = 1,
                          .mu = 0.8,
                          .g = translation(0, 0, 0.5),
                          .force = push * Vec3(direction.x(), direction.y(), 0)});
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j)
      scene.bodies.push_back({.shape = 2, .mu = 0.8, .g = translation(2 * i, 2 * j, 1 + radius)});
  scene.measure = PeerMeasure::speed;
  // A ball that rolls takes 2/7 of its mass along.
  const double friction = 0.4 * (box_mass + balls * ball_mass) * kGravity;
  scene.acceleration = (push - friction) / (box_mass + 2.0 / 7 * balls * ball_mass);
  scene.t_end = 4;
  return scene;
}

PeerScene bouncing_scene(double restitution) {
  PeerScene scene = on_ground("bouncing", "49 balls fall 4.9 m and bounce", 10, 0);
  scene.shapes.push_back(ball(kDroppedRadius, kBallMass));
  for (int i = -3; i <= 3; ++i)
    for (int j = -3; j <= 3; ++j) scene.bodies.push_back({.shape = 1, .g = translation(i, j, kDrop)});
  scene.restitution = restitution;
  scene.measure = PeerMeasure::energy;
  scene.t_end = restitution < 1 ? 12 : 20;
  return scene;
}

PeerScene pile_666_scene(bool elastic) {
  PeerScene scene = on_ground("666", "6 x 6 x 6 balls fall on the ground and on each other", 10, 0);
  scene.shapes.push_back(ball(kDroppedRadius, kBallMass));
  Random random(666);
  const double pitch = 0.21, height = elastic ? 1.101 : 0.101;
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      for (int k = 0; k < 6; ++k) {
        const Vec3 off = random.vector(1e-3);
        scene.bodies.push_back({.shape = 1,
                                .g = translation(pitch * (i - 2.5) + off.x(), pitch * (j - 2.5) + off.y(),
                                                 height + pitch * k + off.z())});
      }
  scene.restitution = elastic ? 1 : 0;
  scene.measure = PeerMeasure::overlap;
  return scene;
}

PeerScene tower_scene(double top_mass) {
  const double edge = 0.2, mass = 8;
  PeerScene scene = on_ground("tower", "ten cubes on each other", 5, 0.5);
  scene.shapes.push_back(box(Vec3::Constant(edge), mass));
  scene.shapes.push_back(box(Vec3::Constant(edge), top_mass));
  for (int i = 0; i < 10; ++i)
    scene.bodies.push_back(
        {.shape = ShapeId::at(i < 9 ? 1 : 2), .mu = 0.5, .g = translation(0, 0, (i + 0.5) * edge)});
  scene.t_end = 10;
  return scene;
}

PeerScene kapla_scene() {
  PeerScene scene = on_ground("kapla", "a house of cards, six floors of 8 legs and 14 walls", 5, 0.5);
  scene.shapes.push_back(box(Vec3(0.05, 0.25, 0.1), 10));
  scene.shapes.push_back(box(Vec3(0.2, 0.05, 0.1), 10));
  for (int floor = 0; floor < 6; ++floor) {
    const double z = 0.2 * floor;
    for (int j = 0; j < 8; ++j)
      scene.bodies.push_back({.shape = 1, .mu = 0.5, .g = translation(0.2 * j, 0, z + 0.05)});
    for (int j = 0; j < 7; ++j)
      for (const double y : {-0.1, 0.1})
        scene.bodies.push_back({.shape = 2, .mu = 0.5, .g = translation(0.2 * j + 0.1, y, z + 0.15)});
  }
  scene.t_end = 600;
  return scene;
}

void describe(SettingVisitor& visit, Arch& o) {
  visit.begin("Arch");
  visit.count({"stones", "number of stones of the arch", "", {3, 1001}, "--stones"}, o.stones);
  Setting mu = setting_of<ContactLaw>("mu");
  mu.what = "friction coefficient of the arch's stones and its ground";
  visit.number(mu, o.mu);
  visit.number(
      {"thickness", "thickness of the arch, relative to its mean radius", "-", {0.01, 0.9}, "--thickness"},
      o.thickness);
  visit.number({"tilt", "tilt of arch and ground", "rad", {-1.1, 1.1}, "--tilt"}, o.tilt);
  visit.number({"scatter",
                "largest random offset of each stone of the arch; 0: exact places",
                "m",
                {0, 1e-3},
                "--scatter"},
               o.scatter);
}

PeerScene arch_scene(const Arch& arch) {
  check_ranges(arch);
  PeerScene scene = on_ground("arch", "half a ring of stones on the ground", 5, arch.mu);
  const double half = kPi / arch.stones / 2, in = 1 - arch.thickness / 2, out = 1 + arch.thickness / 2;
  const Vec2 a(std::cos(half), -std::sin(half)), b(a.x(), -a.y());
  Vec2 centre;
  scene.shapes.push_back(prism({in * a, out * a, out * b, in * b}, 0.2, 1000, centre));
  Random random(25);
  for (int i = 0; i < arch.stones; ++i) {
    const SE3 turn = rotation(Vec3::UnitY(), -(2 * i + 1) * half) * rotation(Vec3::UnitX(), kPi / 2);
    SE3 g = turn * translation(centre.x(), centre.y(), 0);
    if (arch.scatter > 0) g.p += arch_spread(arch) * arch.scatter * g.p + random.vector(arch.scatter);
    scene.bodies.push_back({.shape = 1, .mu = arch.mu, .g = g});
  }
  scene.gravity = kGravity * Vec3(std::sin(arch.tilt), 0, -std::cos(arch.tilt));
  scene.t_end = 60;
  return scene;
}

BodyId crown(const PeerScene& arch) {
  return BodyId::at(arch.bodies.size() / 2);
}

namespace {

struct NamedScene {
  const char* name;
  PeerScene (*scene)();
};
constexpr NamedScene kScenes[]{
    {"rolling", [] { return rolling_scene(Vec2::UnitY()); }},
    {"rolling_xy", [] { return rolling_scene(Vec2(0.5, std::sqrt(0.75))); }},
    {"bouncing", [] { return bouncing_scene(1); }},
    {"bouncing_08", [] { return bouncing_scene(0.8); }},
    {"666", [] { return pile_666_scene(false); }},
    {"666_elastic", [] { return pile_666_scene(true); }},
    {"tower", [] { return tower_scene(8); }},
    {"heavy_tower", [] { return tower_scene(800); }},
    {"arch", [] { return arch_scene({}); }},
    {"arch_101", [] { return arch_scene({.stones = 101}); }},
    {"kapla", [] { return kapla_scene(); }},
};

}  // namespace

std::vector<std::string> peer_scene_names() {
  std::vector<std::string> names;
  for (const NamedScene& scene : kScenes) names.emplace_back(scene.name);
  return names;
}

PeerScene peer_scene(const std::string& name) {
  std::string known;
  for (const NamedScene& scene : kScenes) {
    known += std::string(known.empty() ? "" : ", ") + scene.name;
    if (name != scene.name) continue;
    PeerScene out = scene.scene();
    out.name = name;
    return out;
  }
  throw std::invalid_argument("scene = " + name + " must be one of " + known);
}

KernelScene kernel_scene(const PeerScene& scene) {
  KernelScene out;
  Model& model = out.model;
  model.gravity = scene.gravity;
  model.contact_law = {.mu = scene.bodies.back().mu, .restitution = scene.restitution};  // of most pairs
  for (const PeerShape& s : scene.shapes) add(model, prepare(dilated(s)));
  for (const BodyId b : scene.bodies.ids()) {
    const PeerBody& body = scene.bodies[b];
    const PeerShape& s = scene.shapes[body.shape];
    const std::string name = "body " + to_string(b);
    add(model, body.fixed
                   ? fixed_body(name, body.shape)
                   : RigidBody{.name = name, .shape = body.shape, .mass = s.mass, .inertia = s.inertia});
    for (BodyId a = 0; a < b; ++a)
      if (const double mu = std::min(scene.bodies[a].mu, body.mu); mu != model.contact_law.mu)
        model.pair_laws[{a, b}] = {.mu = mu, .restitution = scene.restitution};
    if (body.force.isZero(0)) continue;
    add(model,
        ForceLaw{.name = "push",
                 .add_to = [b, force = body.force](const Model&, const State&, double,
                                                   GeneralisedForce& f) { linear_part(f.f, b) += force; },
                 .potential = {}});
  }
  out.state = rest_state(model);
  for (const BodyId b : scene.bodies.ids()) out.state.g[b] = scene.bodies[b].g;
  return out;
}

SchemeOptions kernel_options(const PeerScene& scene, double h) {
  SchemeOptions options{.step = {.h = h}, .moreau_jean = {.theta = 1}};
  if (scene.restitution > 0) {
    options.moreau_jean.theta = 0.5;
    options.moreau_jean.law = NormalLaw::moreau;
  }
  return options;
}

PeerSample sample(const State& state) {
  PeerSample out{.t = state.t, .g = state.g};
  for (const BodyId b : state.g.ids()) out.v.push_back(twist(state, b).head<3>());
  return out;
}

PeerOff off_exact(const PeerScene& scene, const PeerSample& start, const PeerSample& now) {
  PeerOff out;
  switch (scene.measure) {
    case PeerMeasure::speed: {
      const Vec3 exact = scene.acceleration * now.t * scene.bodies[1].force.normalized();
      const double off = (now.v[1] - exact).norm();
      out.term = off * off;
      out.scale = exact.squaredNorm();
      if (now.t > 0) out.off = off / exact.norm();
      break;
    }
    case PeerMeasure::energy: {
      const double exact = exact_bounce_energy(kDrop - kDroppedRadius, scene.restitution, now.t);
      out.off = out.term = std::abs(ball_energy(scene, now) / ball_energy(scene, start) - exact);
      break;
    }
    case PeerMeasure::overlap:
      out.off = deepest_overlap(scene, now);
      break;
    case PeerMeasure::displacement:
      out.off = largest_displacement(scene, now);
      if (out.off > kFallen) out.fall_time = now.t;
      break;
  }
  return out;
}

void add(const PeerOff& one, PeerTotals& totals) {
  ++totals.samples;
  totals.sum += one.term;
  totals.scale += one.scale;
  totals.worst = std::max(totals.worst, one.off);
  totals.fall_time = std::min(totals.fall_time, one.fall_time);
}

double error_of(const PeerScene& scene, const PeerTotals& totals) {
  switch (scene.measure) {
    case PeerMeasure::speed:
      return totals.scale > 0 ? std::sqrt(totals.sum / totals.scale) : 0;
    case PeerMeasure::energy:
      return totals.samples > 0 ? totals.sum / double(totals.samples) : 0;
    case PeerMeasure::overlap:
    case PeerMeasure::displacement:
      break;
  }
  return totals.worst;
}

void PeerJudge::see(const PeerSample& now) {
  if (totals_.samples == 0) start_ = now;
  add(off_exact(scene_, start_, now), totals_);
}

}  // namespace aussois
