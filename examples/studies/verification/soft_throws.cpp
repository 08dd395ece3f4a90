// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/verification/soft_throws.hpp"

#include <algorithm>
#include <cmath>

#include "examples/common/random.hpp"
#include "examples/studies/verification/running.hpp"
#include "geometry/primitives.hpp"
#include "geometry/volume_primitives.hpp"
#include "integrators/prove/path_audit.hpp"
#include "integrators/schemes/moreau_jean.hpp"
#include "mechanics/cable.hpp"
#include "mechanics/sheet.hpp"
#include "mechanics/solid.hpp"

namespace aussois {
namespace {

constexpr double kSize = 0.06, kRadius = 1e-3;  // of what is thrown, of surfaces [m]

// What was added: a cable, or a solid or a sheet.
struct Thrown {
  std::vector<BodyId> nodes{};  // of a cable
  BlockId points{};             // else
  std::size_t count = 0;        // of points
};

Thrown add_thrown(Model& model, Random& random, const SE3& place, std::vector<Cable>& cables) {
  const int kind = random.index(3);
  if (kind == 0) {
    std::vector<Vec3> line;
    for (const double s : {-0.5, 0.0, 0.5})
      line.push_back(place.R * Vec3(s * kSize, random.uniform(-0.01, 0.01), 0) + place.p);
    cables.push_back(add_cable(
        model, {.nodes = frames_along(points_along(line, 3 + random.index(3))),
                .section = beam_section(
                    {.radius = kRadius, .young = 2e9, .poisson = 0.4, .density = 1200, .damping_time = 1e-4}),
                .radius = kRadius}));
    return {.nodes = cables.back().nodes};
  }
  Material soft{.young = 1e6, .poisson = 0.3, .density = 1000};
  if (kind == 1) {
    soft.viscosity = 200;
    const double wide = random.uniform(0.2, 1);
    const VolumeMesh mesh =
        make_box_mesh(Vec3(kSize, wide * kSize, 0.2 * kSize), {1 + random.index(2), 1, 1});
    const Solid solid = add_solid(model, mesh, {.materials = {soft}, .place = place, .radius = kRadius});
    return {.points = solid.points, .count = mesh.points.size()};
  }
  const SimplicialComplex plate = make_plate(kSize, kSize, 2, 2);
  const Sheet sheet = add_sheet(
      model, plate, {.material = soft, .thickness = 4 * kRadius, .place = place, .radius = kRadius});
  return {.points = sheet.points, .count = plate.vertices.size()};
}

void set_speed(const Model& model, State& state, const Thrown& thrown, const Vec3& v) {
  for (const BodyId node : thrown.nodes) linear_part(state.v, node) = v;
  if (thrown.count == 0) return;
  const int first = first_speed(model, thrown.points);
  for (std::size_t i = 0; i < thrown.count; ++i) state.v.segment<3>(first + 3 * Eigen::Index(i)) = v;
}

SimplicialComplex target_mesh(Random& random) {
  switch (random.index(5)) {
    case 0:
      return make_plate(2 * kSize, 2 * kSize);
    case 1:
      return make_box(kSize, kSize, 1e-4);
    case 2:
      return make_torus(kSize / 2, kSize / 8, 12, 6);
    case 3:
      return make_extrusion(gear_profile(8, 0.3 * kSize, 0.5 * kSize), 0.2 * kSize);
    default:
      return make_cylinder(0.1 * kSize, 2 * kSize, 12);
  }
}

// One throw; adds to the tally what came of it.
void throw_once(std::uint64_t seed, ThrowTally& tally) {
  Random random(seed);
  Model model;
  model.gravity = Vec3::Zero();
  model.contact_law.mu = random.uniform(0, 1);
  std::vector<Cable> cables;
  if (random.index(2) == 0)
    add_thrown(model, random, SE3{random.rotation(), Vec3::Zero()}, cables);
  else
    add(model, RigidBody{.name = "target",
                         .shape = add(model, prepare(dilate(target_mesh(random), kRadius))),
                         .g_bs = {random.rotation(), Vec3::Zero()},
                         .motion = FixedMotion{}});
  const Vec3 way = random.direction();
  SE3 start = random.pose(0.2 * kSize);
  start.p += 2.5 * kSize * way;
  const Thrown thrown = add_thrown(model, random, start, cables);
  State state = rest_state(model);
  for (const Cable& cable : cables) lay(cable, state);
  const double speed = random.uniform(1, 10);
  set_speed(model, state, thrown, -speed * way);
  const double h = random.uniform(2, 30) * kRadius / speed;
  const MoreauJean scheme(model, {.h = h}, {.theta = 1, .newton = {.max_iterations = 15, .tolerance = 1e-6}});
  PathAudit audit{.samples = 4};
  int steps_since = 0;  // the first touch
  while (state.t < 4 * kSize / speed && steps_since < 15) {
    const State before = state;
    const StepReport report = scheme.step(state);
    if (!report.ok()) {
      ++tally.refused;
      break;
    }
    steps_since += steps_since > 0 || std::ranges::any_of(report.contacts, [](const StepContact& c) {
                     return c.impulse.norm() > 0;
                   });
    audit_path(model, before, state, report, 1, audit);
  }
  ++tally.throws;
  tally.touched += steps_since > 0;
  tally.violations += audit.violations;
}

VerificationCase random_throws() {
  return {.name = "S2.throws",
          .what =
              "200 cables, soft blocks and pieces of cloth thrown at random at each other, at sheets, edges "
              "and meshes at 1 to 10 m/s, in steps of 2 to 30 dilations",
          .rows = {{"violations", "steps that samples of their paths refute", "-", 0,
                    "certificate (CA-9): base complexes never cross", Sense::exactly},
                   {"refused", "throws that end in a step that is not accepted", "-", 0,
                    "each is an ordinary impact", Sense::exactly},
                   {"touched", "part of the throws in which anything touches", "-", 0.9,
                    "they are aimed at each other", Sense::at_least}},
          .measure =
              [] {
                const ThrowTally t = throw_soft_parts(1, 200);
                return Figures{{"violations", double(t.violations)},
                               {"refused", double(t.refused)},
                               {"touched", double(t.touched) / t.throws}};
              },
          .slow = true,
          .certified = true};
}

}  // namespace

ThrowTally throw_soft_parts(std::uint64_t first, int count) {
  ThrowTally out;
  for (int k = 0; k < count; ++k) throw_once(first + std::uint64_t(k), out);
  return out;
}

std::vector<VerificationCase> soft_throw_verification() {
  return {random_throws()};
}

}  // namespace aussois
