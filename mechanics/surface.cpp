// SPDX-License-Identifier: Apache-2.0
#include "mechanics/surface.hpp"

#include <cstring>

#include "geometry/check.hpp"
#include "mechanics/layout.hpp"
#include "mechanics/tree.hpp"

namespace aussois {
namespace {

// The vertices of the simplex that carries a point.
std::vector<int> corners_of(const SimplicialComplex& k, const Feature& on) {
  const auto at = std::size_t(on.simplex);
  if (on.dim == 0) return {on.simplex};
  if (on.dim == 1) return {k.edges[at].begin(), k.edges[at].end()};
  return {k.triangles[at].begin(), k.triangles[at].end()};
}

std::string name_of(const Model& model, BodyId body) {
  return "body " + to_string(body) + " (" + model.bodies[body].name + "): ";
}

std::vector<VertexColumn> columns_of(const Model& model, const State& state, BodyId body, int vertex) {
  std::vector<VertexColumn> out;
  model.bodies[body].deformation.columns(model, state, vertex, out);
  for (const VertexColumn& c : out)
    if (c.velocity < 0 || c.velocity >= state.v.size())
      require_field(false, (name_of(model, body) + "deformation.columns: velocity").c_str(), c.velocity,
                    ("lie in [0, " + std::to_string(state.v.size()) + ")").c_str());
  return out;
}

void check_count(const Model& model, BodyId body, std::size_t count, const char* what) {
  const std::size_t vertices = model.shapes[model.bodies[body].shape]->complex.vertices.size();
  if (count != vertices)
    require_field(false, (name_of(model, body) + what).c_str(), count,
                  ("be " + std::to_string(vertices) + ", as of its shape").c_str());
}

}  // namespace

std::vector<Vec3> deformed_vertices(const Model& model, const State& state, BodyId body) {
  std::vector<Vec3> vertices = model.bodies[body].deformation.vertices(model, state);
  check_count(model, body, vertices.size(), "deformation.vertices: size");
  return vertices;
}

std::vector<double> vertex_field(const Model& model, const State& state, BodyId body) {
  const VertexField& field = model.bodies[body].deformation.field;
  if (!field.values) return {};
  std::vector<double> values = field.values(model, state);
  check_count(model, body, values.size(), "deformation.field.values: size");
  return values;
}

std::shared_ptr<const LmdShape> DeformedShapes::at(BodyId body, const LmdShape& laid,
                                                   const std::vector<Vec3>& vertices) {
  std::shared_ptr<const LmdShape> last;
  {
    const std::lock_guard lock(mutex_);
    if (std::size_t(body.index()) >= last_.size()) last_.resize(std::size_t(body.index()) + 1);
    last = last_[body];
  }
  const auto there = [&](const LmdShape& shape) {  // to the last bit
    const SharedArray<Vec3>& x = shape.complex.vertices;
    return x.size() == vertices.size() &&
           std::memcmp(x.data(), vertices.data(), vertices.size() * sizeof(Vec3)) == 0;
  };
  if (last && last->order == laid.order && last->self == laid.self && there(*last)) return last;
  auto made = std::make_shared<const LmdShape>(refit(laid, vertices));
  const std::lock_guard lock(mutex_);
  last_[body] = made;
  return made;
}

PosedShape posed_shape(const Model& model, const State& state, BodyId body, DeformedShapes* known) {
  const RigidBody& b = model.bodies[body];
  PosedShape out{.shape = model.shapes[b.shape].get(), .g_ws = pose(state, body) * b.g_bs, .body = body};
  if (!deforms(b)) return out;
  DeformedShapes unknown;
  out.own = (known ? *known : unknown).at(body, *out.shape, deformed_vertices(model, state, body));
  out.shape = out.own.get();
  return out;
}

std::vector<Vec3> vertex_velocities(const Model& model, const State& state, BodyId body, const VecX& v) {
  const RigidBody& b = model.bodies[body];
  std::vector<Vec3> out(model.shapes[b.shape]->complex.vertices.size(), Vec3::Zero());
  for (std::size_t i = 0; i < out.size(); ++i)
    for (const VertexColumn& c : columns_of(model, state, body, int(i))) out[i] += v[c.velocity] * c.column;
  return out;
}

template <int N>
PointColumns<N> point_columns(const Model& model, const State& state, const Feature& on, const Vec3& x,
                              const Vec3& base, const Mat3& frame) {
  const SE3& g = pose(state, on.body);
  const RigidBody& b = model.bodies[on.body];
  const Eigen::Matrix<double, N, 3> axes = frame.transpose().topRows<N>();
  PointColumns<N> out;
  out.twist << axes, -axes * skew(x - g.p) * g.R.toRotationMatrix();
  if (is_carried(b)) {
    for (const TwistColumn& c : carried_columns(model, state.g, on.body))
      out.others.emplace_back(c.velocity, out.twist * c.twist);
    out.twist.setZero();
  }
  if (!deforms(b)) return out;
  const Mat3 R = g.R.toRotationMatrix() * b.g_bs.R.toRotationMatrix();
  const Eigen::Matrix<double, N, 3> to_axes = axes * R;
  const Vec3 arm = R.transpose() * (x - base);
  const std::vector<int> corners = corners_of(model.shapes[b.shape]->complex, on);
  for (std::size_t k = 0; k < corners.size(); ++k)
    for (const VertexColumn& c : columns_of(model, state, on.body, corners[k]))
      out.others.emplace_back(c.velocity, on.bary[k] * (to_axes * (c.column + c.turn.cross(arm))));
  return out;
}
template PointColumns<1> point_columns<1>(const Model&, const State&, const Feature&, const Vec3&,
                                          const Vec3&, const Mat3&);
template PointColumns<3> point_columns<3>(const Model&, const State&, const Feature&, const Vec3&,
                                          const Vec3&, const Mat3&);

Vec3 point_velocity(const Model& model, const State& state, const Feature& on, const Vec3& x, const VecX& v) {
  const RigidBody& body = model.bodies[on.body];
  Vec3 out = Vec3::Zero();
  if (!is_carried(body)) {
    const auto twist = body_part(v, on.body);
    const SE3& g = pose(state, on.body);
    out = twist.head<3>() + (g.R * Vec3(twist.tail<3>())).cross(x - g.p);
  }
  if (is_carried(body) || deforms(body))
    for (const auto& [entry, column] : point_columns<3>(model, state, on, x, x, Mat3::Identity()).others)
      out += v[entry] * column;
  return out;
}

Eigen::Matrix<double, 1, 6> spin_columns(const Model& model, const State& state, BodyId body,
                                         const Vec3& axis) {
  Eigen::Matrix<double, 1, 6> out = Eigen::Matrix<double, 1, 6>::Zero();
  if (!is_carried(model.bodies[body]))
    out << 0, 0, 0, (pose(state, body).R.toRotationMatrix().transpose() * axis).transpose();
  return out;
}

std::vector<std::pair<int, double>> carried_spin(const Model& model, const State& state, const Feature& on,
                                                 const Vec3& axis) {
  std::vector<std::pair<int, double>> out;
  const RigidBody& b = model.bodies[on.body];
  for (const TwistColumn& c : carried_columns(model, state.g, on.body))
    out.emplace_back(c.velocity, axis.dot(pose(state, on.body).R * Vec3(c.twist.tail<3>())));
  if (!deforms(b)) return out;
  const Vec3 of_shape = (pose(state, on.body).R * b.g_bs.R).conjugate() * axis;
  const std::vector<int> corners = corners_of(model.shapes[b.shape]->complex, on);
  for (std::size_t k = 0; k < corners.size(); ++k)
    for (const VertexColumn& c : columns_of(model, state, on.body, corners[k]))
      if (!c.turn.isZero(0)) out.emplace_back(c.velocity, on.bary[k] * c.turn.dot(of_shape));
  return out;
}

Vec3 material_place(const Model& model, const State& state, const Feature& on, const Vec3& x) {
  const RigidBody& b = model.bodies[on.body];
  if (!deforms(b)) return inverse(pose(state, on.body)) * x;
  const SimplicialComplex& k = model.shapes[b.shape]->complex;
  const std::vector<int> corners = corners_of(k, on);
  Vec3 place = Vec3::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) place += on.bary[i] * k.vertices[corners[i]];
  return b.g_bs * place;
}

}  // namespace aussois
