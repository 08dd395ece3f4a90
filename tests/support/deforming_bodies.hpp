// SPDX-License-Identifier: Apache-2.0
// Two kinds of body that the kernel does not know: a ball whose radius is a degree of freedom, and a cloth of
// points with mass. They are made of what mechanics shows, and nothing else knows of them.
#pragma once

#include <cmath>

#include "geometry/dilated_shape.hpp"
#include "geometry/primitives.hpp"
#include "mechanics/surface.hpp"

namespace aussois {

struct PulsatingBall {
  double radius = 0.1, dilation = 1e-3;  // of the mesh at rest [m]
  double mass = 1;                       // [kg]
  double swelling_mass = 2e-3;           // of the swelling: energy swelling_mass / 2 * rate^2 [kg m^2]
  double stiffness = 40, damping = 0;    // [N m, N m s]
  int subdivisions = 2;
};

/// A ball that swells by 1 + q: six degrees of freedom of the body, the seventh is the last block of
/// coordinates. Returns the body.
inline BodyId add_pulsating_ball(Model& model, const PulsatingBall& ball, const std::string& name = "ball") {
  const auto block =
      add(model,
          Coordinates{.name = "swelling of " + name,
                      .size = 1,
                      .mass = [ball](const VecX&) { return MatX::Constant(1, 1, ball.swelling_mass); },
                      .force =
                          [ball](double, const VecX& q, const VecX& v) {
                            return CoordinateForce{.f = -ball.stiffness * q - ball.damping * v,
                                                   .K = MatX::Constant(1, 1, ball.stiffness),
                                                   .C = MatX::Constant(1, 1, ball.damping)};
                          },
                      .potential = [ball](const VecX& q) { return ball.stiffness / 2 * q.squaredNorm(); }});
  const SimplicialComplex sphere = make_sphere(ball.radius, ball.subdivisions);
  RigidBody body{.name = name,
                 .shape = add(model, prepare(dilate(sphere, ball.dilation), {.deforming = true})),
                 .mass = ball.mass,
                 .inertia = Mat3(0.4 * ball.mass * ball.radius * ball.radius * Mat3::Identity())};
  body.deformation.vertices = [block, rest = sphere.vertices](const Model& m, const State& state) {
    std::vector<Vec3> out = rest.to_vector();
    for (Vec3& x : out) x *= 1 + coordinates(m, state, block)[0];
    return out;
  };
  body.deformation.columns = [block, rest = sphere.vertices](const Model& m, const State&, int vertex,
                                                             std::vector<VertexColumn>& out) {
    out.push_back({first_speed(m, block), rest[vertex]});
  };
  return add(model, std::move(body));
}

/// A square cloth in the plane z = 0 of n x n points with mass, each with a stiff spring to its place: three
/// coordinates a point, on a body that stays where it is. Returns the body.
inline BodyId add_cloth(Model& model, double side, int n, double mass, double stiffness, double dilation) {
  const SimplicialComplex sheet = make_plate(side, side, n - 1, n - 1);
  const auto points = Eigen::Index(sheet.vertices.size());
  VecX rest(3 * points);
  for (Eigen::Index i = 0; i < points; ++i) rest.segment<3>(3 * i) = sheet.vertices[i];
  const double of_point = mass / double(points);
  const auto block = add(
      model, Coordinates{
                 .name = "points of the cloth",
                 .size = int(rest.size()),
                 .mass = [=](const VecX& q) { return MatX(of_point * MatX::Identity(q.size(), q.size())); },
                 .force =
                     [=](double, const VecX& q, const VecX&) {
                       return CoordinateForce{
                           .f = -stiffness * q, .K = stiffness * MatX::Identity(q.size(), q.size()), .C = {}};
                     },
                 .potential = [=](const VecX& q) { return stiffness / 2 * q.squaredNorm(); }});
  RigidBody body = fixed_body("cloth", add(model, prepare(dilate(sheet, dilation), {.deforming = true})));
  body.deformation.vertices = [block, rest](const Model& m, const State& state) {
    const VecX x = rest + coordinates(m, state, block);
    std::vector<Vec3> out;
    for (Eigen::Index i = 0; i < x.size(); i += 3) out.emplace_back(x.segment<3>(i));
    return out;
  };
  body.deformation.columns = [block](const Model& m, const State&, int vertex,
                                     std::vector<VertexColumn>& out) {
    for (int d = 0; d < 3; ++d) out.push_back({first_speed(m, block) + 3 * vertex + d, Vec3::Unit(d)});
  };
  return add(model, std::move(body));
}

}  // namespace aussois
