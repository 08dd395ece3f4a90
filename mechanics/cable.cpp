// SPDX-License-Identifier: Apache-2.0
#include "mechanics/cable.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/check.hpp"
#include "geometry/dilated_shape.hpp"
#include "geometry/number_text.hpp"
#include "mechanics/layout.hpp"
#include "mechanics/surface.hpp"

namespace aussois {
namespace {

// Of the outermost fibre at each node, from pull and bending [-].
std::vector<double> largest_strains(const Beam& beam, const std::vector<BodyId>& nodes, double radius,
                                    const State& state) {
  PerBody<double> at(nodes.back().index() + 1, 0);
  const std::vector<BeamLoad> loads = beam_loads(beam, state);
  for (std::size_t i = 0; i < loads.size(); ++i) {
    const Vec6& strain = loads[i].strain;
    const double largest = std::abs(strain[0]) + radius * strain.tail<2>().norm();
    for (const BodyId node : {beam.elements[i].body_a, beam.elements[i].body_b})
      at[node] = std::max(at[node], largest);
  }
  std::vector<double> out;
  for (const BodyId node : nodes) out.push_back(at[node]);
  return out;
}

// A body that stays where it is, with a vertex of its shape at the origin of each node.
RigidBody surface_of(Model& model, const Cable& cable, const CableOptions& options) {
  std::vector<Vec3> places;
  for (const SE3& g : cable.laid) places.push_back(g.p);
  std::vector<std::array<int, 2>> wires;
  for (int i = 0; i + 1 < int(places.size()); ++i) wires.push_back({i, i + 1});
  if (options.closed) wires.push_back({int(places.size()) - 1, 0});
  LmdShape shape = prepare(dilate(make_complex(places, {}, wires), options.radius), {.deforming = true});
  if (options.touches_itself) shape = touching_itself(std::move(shape), kPi * options.radius);
  RigidBody body = fixed_body(options.name, add(model, std::move(shape)));
  body.deformation.vertices = [nodes = cable.nodes](const Model&, const State& state) {
    std::vector<Vec3> out;
    for (const BodyId node : nodes) out.push_back(pose(state, node).p);
    return out;
  };
  body.deformation.columns = [nodes = cable.nodes](const Model&, const State& state, int vertex,
                                                   std::vector<VertexColumn>& out) {
    const BodyId node = nodes[std::size_t(vertex)];
    const Mat3 R = pose(state, node).R.toRotationMatrix();
    for (int d = 0; d < 3; ++d) {
      out.push_back({.velocity = first_velocity(node) + d, .column = Vec3::Unit(d)});
      out.push_back({.velocity = first_velocity(node) + 3 + d, .turn = R.col(d)});
    }
  };
  body.deformation.field = {.what = "largest strain",
                            .unit = "-",
                            .values = [beam = std::make_shared<const Beam>(cable.beam), nodes = cable.nodes,
                                       radius = options.radius](const Model&, const State& state) {
                              return largest_strains(*beam, nodes, radius, state);
                            }};
  return body;
}

Beam beam_of(const Cable& cable, const CableOptions& options) {
  Beam out{.name = options.name, .sections = {options.section}};
  const std::size_t count = cable.nodes.size();
  for (std::size_t i = 0; i + (options.closed ? 0 : 1) < count; ++i) {
    const std::size_t next = (i + 1) % count;
    BeamElement element{.body_a = cable.nodes[i], .body_b = cable.nodes[next]};
    element.rest = log_se3(inverse(cable.laid[i]) * cable.laid[next]);
    element.length = element.rest.head<3>().norm();
    const std::string who = options.name + ": nodes " + std::to_string(i) + " and " + std::to_string(next);
    require(element.rest.tail<3>().norm() < kLargestBeamTurn, who + " are laid " +
                                                                  number_text(element.rest.tail<3>().norm()) +
                                                                  " rad from each other: use more elements");
    require(!(element.rest.x() < element.length / 2),
            who + ": x must lead along the cable, from each node to the next (frames_along)");
    if (options.straight) element.rest = straight_rest(element.length);
    out.elements.push_back(element);
  }
  return out;
}

}  // namespace

std::vector<Vec3> points_along(const std::vector<Vec3>& polyline, int count) {
  require_field(polyline.size() >= 2, "points of the polyline", polyline.size(), "be at least 2");
  require_field(count >= 2, "points along the polyline", count, "be at least 2");
  std::vector<double> at{0};
  for (std::size_t i = 1; i < polyline.size(); ++i)
    at.push_back(at.back() + (polyline[i] - polyline[i - 1]).norm());
  require_field(at.back() > 0 && std::isfinite(at.back()), "length of the polyline", at.back(),
                "be positive and finite [m]");
  std::vector<Vec3> out;
  std::size_t leg = 1;
  for (int k = 0; k < count; ++k) {
    const double s = at.back() * k / (count - 1);
    while (leg + 1 < at.size() && s > at[leg]) ++leg;
    const double length = at[leg] - at[leg - 1];
    const double share = length > 0 ? std::min(1.0, (s - at[leg - 1]) / length) : 0;
    out.emplace_back(polyline[leg - 1] + share * (polyline[leg] - polyline[leg - 1]));
  }
  return out;
}

std::vector<SE3> frames_along(const std::vector<Vec3>& points, const Vec3& up) {
  require_field(points.size() >= 2, "points of the line", points.size(), "be at least 2");
  std::vector<Vec3> along;  // of each leg
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vec3 leg = points[i] - points[i - 1];
    require(leg.norm() > 0 && leg.allFinite(),
            "point " + std::to_string(i) + " of the line must be finite and differ from the one before");
    along.push_back(leg.normalized());
  }
  std::vector<SE3> out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 &before = along[i > 0 ? i - 1 : 0], &after = along[std::min(i, along.size() - 1)];
    const Vec3 sum = before + after;
    const Vec3 x = sum.norm() > 1e-9 ? Vec3(sum.normalized()) : after;
    if (out.empty()) {
      const Vec3 across = x.cross(up);
      const Vec3 z = across.norm() > 1e-9 * up.norm() ? Vec3(across.normalized()) : x.unitOrthogonal();
      Mat3 R;
      R << x, z.cross(x), z;
      out.push_back({Quat(R), points[i]});
      continue;
    }
    const Quat& last = out.back().R;
    out.push_back({(Quat::FromTwoVectors(last * Vec3::UnitX(), x) * last).normalized(), points[i]});
  }
  return out;
}

Cable add_cable(Model& model, const CableOptions& options) {
  require_field(options.nodes.size() >= (options.closed ? 3 : 2), "CableOptions::nodes", options.nodes.size(),
                options.closed ? "be at least 3 of a closed cable" : "be at least 2");
  require_field(options.radius >= 0 && std::isfinite(options.radius), "CableOptions::radius", options.radius,
                "be finite and not negative [m]");
  require(options.radius > 0 || !options.touches_itself, "CableOptions::touches_itself needs a radius");
  Cable out{.laid = options.nodes};
  for (SE3& g : out.laid) g = checked_pose(g, "CableOptions::nodes");
  const BodyId first = model.bodies.next();
  for (int i = 0; i < int(out.laid.size()); ++i) out.nodes.push_back(first + i);
  out.beam = beam_of(out, options);
  Table<BodyId, RigidBody> bodies = model.bodies;  // what is wrong is said before the model changes
  bodies.resize(bodies.size() + out.nodes.size());
  validate(out.beam, bodies);
  const PerBody<NodeMass> masses = node_masses(out.beam, bodies.size());
  for (const BodyId node : out.nodes)
    add(model, RigidBody{.mass = masses[node].mass, .inertia = masses[node].inertia});
  add(model, out.beam);
  if (options.radius > 0) out.surface = add(model, surface_of(model, out, options));
  return out;
}

std::string too_coarse(const Cable& cable) {
  const std::size_t count = cable.laid.size(), elements = cable.beam.elements.size();
  double largest = 0;
  std::size_t there = 0;
  for (std::size_t i = elements == count ? 0 : 1; i < elements; ++i) {  // closed: at every node
    const Vec3 &here = cable.laid[i].p, before = here - cable.laid[(i + count - 1) % count].p,
               after = cable.laid[(i + 1) % count].p - here;
    const double turn = std::atan2(before.cross(after).norm(), before.dot(after));
    if (turn > largest) largest = turn, there = i;
  }
  if (!(largest > kLargestStraightTurn)) return {};
  return cable.beam.name + " turns by " + number_text(std::round(100 * largest) / 100) + " rad at node " +
         std::to_string(there) + ": above " + number_text(kLargestStraightTurn) +
         " it does not touch on all sides there; use at least " +
         std::to_string(int(std::ceil(double(elements) * largest / kLargestStraightTurn))) + " elements";
}

void lay(const Cable& cable, State& state) {
  for (std::size_t i = 0; i < cable.nodes.size(); ++i) pose(state, cable.nodes[i]) = cable.laid[i];
}

}  // namespace aussois
