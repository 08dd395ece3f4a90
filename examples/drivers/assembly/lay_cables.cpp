// SPDX-License-Identifier: Apache-2.0
#include "examples/drivers/assembly/lay_cables.hpp"

#include <cmath>
#include <optional>

#include "geometry/mass_properties.hpp"
#include "geometry/primitives.hpp"

namespace aussois {
namespace {

constexpr int kClipFacets = 24, kClipSides = 12;
constexpr double kClipDensity = 1000;  // of clips on the moving part [kg/m^3]

/// On the cubic that leads from a to b with these derivatives, s in [0, 1]. (Hermite)
Vec3 cubic(const Vec3& a, const Vec3& da, const Vec3& b, const Vec3& db, double s) {
  const double r = 1 - s;
  return r * r * (1 + 2 * s) * a + s * r * r * da + s * s * (3 - 2 * s) * b - s * s * r * db;
}

/// A joint holds the body at this pose to the moving part.
void hold(AssemblyScene& scene, BodyId body, const SE3& at, const std::string& name) {
  PerBody<SE3> poses(scene.model.bodies.size());
  poses[scene.moving] = scene.path.pose.front();
  poses[body] = at;
  add(scene.model, joint_at(JointKind::fixed, name, body, scene.moving, poses, at));
}

/// The pose of the moving part's mesh at the start.
SE3 start_of_moving(const AssemblyScene& scene) {
  return scene.path.pose.front() * scene.model.bodies[scene.moving].g_bs;
}

void add_clip(AssemblyScene& scene, const CableStop& clip, const std::string& name) {
  const double dilation = clip.thickness / 4;
  // Vertices on a circle: the edges between them come nearer to the axis
  const double major = (clip.hole + dilation) / std::cos(kPi / kClipFacets) + dilation;
  const SimplicialComplex ring = make_torus(major, clip.thickness / 2 - dilation, kClipFacets, kClipSides),
                          body_of_ring = make_torus(major, clip.thickness / 2, kClipFacets, kClipSides);
  const ShapeId shape = add(scene.model, prepare(dilate(ring, dilation)));
  const SE3 there{Quat::FromTwoVectors(Vec3::UnitZ(), clip.place.along), clip.place.at};
  if (clip.place.moving) {
    const RigidBody body = solid_body(name, shape, mass_properties(body_of_ring, kClipDensity));
    const SE3 at = start_of_moving(scene) * there * inverse(body.g_bs);
    const BodyId id = add(scene.model, body);
    hold(scene, id, at, name);
    scene.clips.emplace_back(id, at);
  } else {
    RigidBody body = fixed_body(name, shape);
    body.g_bs = there;
    add(scene.model, std::move(body));
  }
}

}  // namespace

std::vector<Vec3> route(const RoutedCable& cable, const SE3& moving) {
  struct Knot {
    Vec3 at{};
    std::optional<Vec3> along{};  // unit; none: as its neighbours want
  };
  const auto there = [&](const OnPart& place) {
    const SE3 g = place.moving ? moving : SE3{};
    return Knot{g * place.at, g.R * place.along};
  };
  std::vector<Knot> knots{there(cable.from)};
  for (const CableStop& stop : cable.via) {
    knots.push_back(there(stop.place));
    if (!stop.is_clip()) knots.back().along.reset();
  }
  knots.push_back(there(cable.to));
  double straight = 0;
  for (std::size_t i = 1; i < knots.size(); ++i) straight += (knots[i].at - knots[i - 1].at).norm();
  require(straight > 0, "its points must not be at one place");
  std::vector<Vec3> line{knots.front().at};
  for (std::size_t i = 1; i < knots.size(); ++i) {
    const double length = (knots[i].at - knots[i - 1].at).norm();
    const int pieces = 64 + int(16 * cable.elements * length / straight);
    const auto slope = [&](std::size_t k) -> Vec3 {
      if (knots[k].along) return length * *knots[k].along;
      return length * (knots[k + 1].at - knots[k - 1].at).normalized();
    };
    for (int s = 1; s <= pieces; ++s)
      line.push_back(cubic(knots[i - 1].at, slope(i - 1), knots[i].at, slope(i), double(s) / pieces));
  }
  return points_along(line, cable.elements + 1);
}

void lay_cables(const std::vector<RoutedCable>& cables, AssemblyScene& scene) {
  Model& model = scene.model;
  for (const RoutedCable& cable : cables) {
    int clips = 0;
    for (const CableStop& stop : cable.via)
      if (stop.is_clip()) add_clip(scene, stop, clip_name(cable, ++clips));
    const std::vector<SE3> frames = frames_along(route(cable, start_of_moving(scene)));
    const Cable added = add_cable(model, {.name = cable.name,
                                          .nodes = frames,
                                          .section = beam_section(cable.section),
                                          .radius = cable.section.radius,
                                          .touches_itself = cable.touches_itself,
                                          .straight = cable.straight});
    for (const auto& [place, node] : {std::pair(&cable.from, 0), std::pair(&cable.to, cable.elements)}) {
      const BodyId end = added.nodes[std::size_t(node)];
      if (!place->moving)
        model.bodies[end].motion = FixedMotion{};
      else
        hold(scene, end, added.laid[std::size_t(node)],
             cable.name + (node == 0 ? " first end" : " last end"));
    }
    scene.cables.push_back(added);
  }
}

}  // namespace aussois
