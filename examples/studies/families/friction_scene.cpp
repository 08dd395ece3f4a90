// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/families/friction_scene.hpp"

#include <algorithm>
#include <cmath>

#include "geometry/check.hpp"
#include "geometry/frame.hpp"
#include "geometry/polygon.hpp"

namespace aussois {
namespace {

using Polygon = std::vector<Vec3>;
using PlanePolygon = std::vector<Vec2>;

// ---- bodies ----

Vec3 unit_normal(const Polygon& face) {
  return (face[1] - face[0]).cross(face[2] - face[0]).normalized();
}

/// Tetrahedra from the first corner to a fan over every face (MASS-1) to (MASS-3).
void weigh(SceneBody& body, double density) {
  const Vec3 apex = body.faces[0][0];
  double volume = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();  // integral of x x^T, from the apex
  for (const Polygon& face : body.faces)
    for (std::size_t i = 2; i < face.size(); ++i) {
      Mat3 edges;
      edges << face[0] - apex, face[i - 1] - apex, face[i] - apex;
      const double part = edges.determinant() / 6;
      const Vec3 sum = edges.rowwise().sum();
      volume += part;
      first += part / 4 * sum;
      second += part / 20 * (edges * edges.transpose() + sum * sum.transpose());
    }
  const Vec3 arm = first / volume;
  second -= volume * arm * arm.transpose();
  body.centre = apex + arm;
  body.mass = density * volume;
  body.inertia = density * (second.trace() * Mat3::Identity() - second);
}

int add(FrictionScene& scene, SceneBody body) {
  scene.bodies.push_back(std::move(body));
  return int(scene.bodies.size()) - 1;
}

// ---- faces that touch ----

struct Bounds {
  Vec3 low = Vec3::Constant(kInf), high = Vec3::Constant(-kInf);
};
Bounds bounds(const SceneBody& body, double slack) {
  Bounds out;
  for (const Polygon& face : body.faces)
    for (const Vec3& x : face) {
      out.low = out.low.cwiseMin(x);
      out.high = out.high.cwiseMax(x);
    }
  out.low.array() -= slack;
  out.high.array() += slack;
  return out;
}
bool overlap(const Bounds& a, const Bounds& b) {
  return (a.low.array() <= b.high.array()).all() && (b.low.array() <= a.high.array()).all();
}

double area(const PlanePolygon& polygon) {
  double sum = 0;
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    sum += cross(polygon[i] - polygon[0], polygon[i + 1] - polygon[0]) / 2;
  return sum;
}

/// What two convex polygons share, both counter-clockwise (Sutherland and Hodgman); near points are one.
PlanePolygon shared_polygon(PlanePolygon points, const PlanePolygon& window, double near) {
  for (std::size_t e = 0; e < window.size(); ++e) {
    const Vec2& from = window[e];
    const Vec2 along = (window[(e + 1) % window.size()] - from).normalized();
    PlanePolygon inside;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec2 &p = points[i], &q = points[(i + 1) % points.size()];
      const double at_p = cross(along, p - from), at_q = cross(along, q - from);
      if (at_p >= -near) inside.push_back(p);  // edges that coincide up to rounding do not cross
      if ((at_p > near && at_q < -near) || (at_p < -near && at_q > near))
        inside.push_back(p + at_p / (at_p - at_q) * (q - p));
    }
    points = std::move(inside);
  }
  PlanePolygon out;
  for (const Vec2& p : points)
    if (std::none_of(out.begin(), out.end(), [&](const Vec2& q) { return (p - q).norm() <= near; }))
      out.push_back(p);
  return out;
}

PlanePolygon seen_along(const Mat3& frame, const Vec3& origin, const Polygon& face) {
  PlanePolygon out;
  for (const Vec3& x : face) out.push_back((frame.rightCols<2>().transpose() * (x - origin)));
  return out;
}

void touch(FrictionScene& scene, int a, int b, const Polygon& of_a, const Polygon& of_b, double slack,
           const Law& law) {
  const Vec3 normal = unit_normal(of_b);
  if (normal.dot(unit_normal(of_a)) > -1 + 1e-9) return;
  const double distance = normal.dot(of_a[0] - of_b[0]);
  const double size = (of_b[1] - of_b[0]).norm();
  if (distance < -1e-9 * size || distance > slack) return;
  const Mat3 frame = frame_of(normal);
  PlanePolygon window = seen_along(frame, of_b[0], of_a);
  std::reverse(window.begin(), window.end());
  const PlanePolygon own = seen_along(frame, of_b[0], of_b);
  const PlanePolygon shared = shared_polygon(own, window, 1e-6 * size);
  if (shared.size() < 3 || area(shared) < 1e-4 * std::min(area(own), area(window))) return;
  const double gap = distance < 1e-9 * size ? 0 : distance;
  for (const Vec2& p : shared)
    scene.contacts.push_back(
        contact(a, b, of_b[0] + frame.rightCols<2>() * p + distance / 2 * normal, normal, law, gap));
}

// ---- the step ----

Vec6 wrench_on(const SceneBody& body, const Interaction& at, const Vec6& row) {  // (FAM-2)
  Vec6 wrench = row;
  wrench.tail<3>() += (at.point - body.centre).cross(Vec3(row.head<3>()));
  return wrench;
}

/// (FAM-3): how far the gap may close, and how fast a closed contact must part again.
double bias(const FrictionScene& scene, const Interaction& at) {
  if (at.gap > 0) return at.gap / scene.h;
  const SceneBody &a = scene.bodies[at.a], &b = scene.bodies[at.b];
  const double before = wrench_on(a, at, at.rows[0]).dot(a.twist) - wrench_on(b, at, at.rows[0]).dot(b.twist);
  return at.restitution * std::min(before, 0.0);
}

SparseMatrix directions(const FrictionScene& scene, const std::vector<int>& first, int size,
                        const std::vector<Interaction>& interactions) {
  std::vector<Triplet> entries;
  int column = 0;
  for (const Interaction& at : interactions)
    for (const Vec6& row : at.rows) {
      for (const auto& [index, sign] : {std::pair(at.a, 1.0), std::pair(at.b, -1.0)}) {
        if (first[index] < 0) continue;
        const Vec6 wrench = sign * wrench_on(scene.bodies[index], at, row);
        for (int i = 0; i < 6; ++i)
          if (wrench[i] != 0) entries.emplace_back(first[index] + i, column, wrench[i]);
      }
      ++column;
    }
  SparseMatrix H(size, column);
  H.setFromTriplets(entries.begin(), entries.end());
  return H;
}

}  // namespace

FrictionProblem friction_problem(const FrictionScene& scene) {
  std::vector<int> first;  // velocity of each body, -1: fixed
  int size = 0;
  for (const SceneBody& body : scene.bodies) {
    first.push_back(body.mass > 0 ? size : -1);
    if (body.mass > 0) size += 6;
  }
  FrictionProblem out;
  out.f = VecX::Zero(size);
  std::vector<Triplet> entries;
  for (std::size_t k = 0; k < scene.bodies.size(); ++k) {
    if (first[k] < 0) continue;
    const SceneBody& body = scene.bodies[k];
    const Vec3 omega = body.twist.tail<3>(), momentum = body.inertia * omega;
    Mat6 M = Mat6::Zero();
    M.diagonal().head<3>().setConstant(body.mass);
    M.bottomRightCorner<3, 3>() =
        body.inertia + scene.h * scene.theta * (skew(omega) * body.inertia - skew(momentum));  // (FAM-4)
    Vec6 force;
    force << body.mass * scene.gravity, -omega.cross(momentum);
    out.f.segment<6>(first[k]) = M * body.twist + scene.h * force;
    for (int j = 0; j < 6; ++j)
      for (int i = 0; i < 6; ++i)
        if (M(i, j) != 0) entries.emplace_back(first[k] + i, first[k] + j, M(i, j));
  }
  out.M.resize(size, size);
  out.M.setFromTriplets(entries.begin(), entries.end());
  out.H = directions(scene, first, size, scene.contacts);
  out.w = VecX::Zero(out.H.cols());
  Eigen::Index row = 0;
  for (const Interaction& at : scene.contacts) {
    out.w[row] = bias(scene, at);
    out.laws.push_back(at.law);
    row += Eigen::Index(at.rows.size());
  }
  if (!scene.joints.empty()) {
    out.G = directions(scene, first, size, scene.joints);
    out.b = VecX::Zero(out.G.cols());
  }
  return out;
}

int add_prism(FrictionScene& scene, const std::vector<Vec2>& profile, const SE3& pose, double length,
              double density) {
  SceneBody body;
  Polygon low, high;
  for (const Vec2& p : profile) {
    low.push_back(pose * Vec3(p.x(), p.y(), -length / 2));
    high.push_back(pose * Vec3(p.x(), p.y(), length / 2));
  }
  for (std::size_t i = 0; i < profile.size(); ++i) {
    const std::size_t j = (i + 1) % profile.size();
    body.faces.push_back({low[i], low[j], high[j], high[i]});
  }
  std::reverse(low.begin(), low.end());
  body.faces.push_back(low);
  body.faces.push_back(high);
  weigh(body, density);
  return add(scene, std::move(body));
}

int add_box(FrictionScene& scene, const Vec3& size, const SE3& pose, double density) {
  const double x = size.x() / 2, y = size.y() / 2;
  return add_prism(scene, {{-x, -y}, {x, -y}, {x, y}, {-x, y}}, pose, size.z(), density);
}

int add_ball(FrictionScene& scene, double radius, const Vec3& centre, double density) {
  const double mass = density * 4 / 3 * kPi * radius * radius * radius;
  return add(scene,
             {.mass = mass, .inertia = 0.4 * mass * radius * radius * Mat3::Identity(), .centre = centre});
}

int add_disk(FrictionScene& scene, double radius, double height, const Vec3& centre, double density) {
  const double mass = density * kPi * radius * radius * height, r2 = radius * radius;
  const double across = mass * (3 * r2 + height * height) / 12;
  return add(scene,
             {.mass = mass, .inertia = Vec3(across, across, mass * r2 / 2).asDiagonal(), .centre = centre});
}

int add_ground(FrictionScene& scene, double half) {
  return add_box(scene, Vec3(2 * half, 2 * half, 1), translation(0, 0, -0.5), 0);
}

Interaction contact(int a, int b, const Vec3& point, const Vec3& normal, const Law& law, double gap) {
  const Mat3 frame = frame_of(normal);
  Interaction out{.a = a, .b = b, .point = point, .law = law, .gap = gap};
  const auto force = [&](int axis) {
    Vec6 row = Vec6::Zero();
    row.head<3>() = frame.col(axis);
    out.rows.push_back(row);
  };
  const auto moment = [&](int axis) {
    Vec6 row = Vec6::Zero();
    row.tail<3>() = frame.col(axis);
    out.rows.push_back(row);
  };
  for (int i = 0; i < std::min(law.rows, 3); ++i) force(i);
  if (law.kind == LawKind::rolling) moment(1), moment(2);
  if (law.kind == LawKind::contensou) moment(0);
  return out;
}

Interaction hinge(int a, int b, const Vec3& point, const Vec3& axis) {
  const Mat3 frame = frame_of(axis);
  Interaction out{.a = a, .b = b, .point = point, .law = bilateral(5)};
  for (int i = 0; i < 5; ++i) {
    Vec6 row = Vec6::Zero();
    if (i < 3)
      row.head<3>() = frame.col(i);
    else
      row.tail<3>() = frame.col(i - 2);
    out.rows.push_back(row);
  }
  return out;
}

Interaction about_axis(int a, int b, const Vec3& axis, const Law& law) {
  Vec6 row = Vec6::Zero();
  row.tail<3>() = axis;
  return {.a = a, .b = b, .rows = {row}, .law = law};
}

void touch_faces(FrictionScene& scene, double slack, const Law& law) {
  std::vector<Bounds> boxes;
  for (const SceneBody& body : scene.bodies) boxes.push_back(bounds(body, slack / 2));
  for (std::size_t a = 1; a < boxes.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) {
      const SceneBody &above = scene.bodies[a], &below = scene.bodies[b];
      if (!overlap(boxes[a], boxes[b]) || (above.mass == 0 && below.mass == 0)) continue;
      for (const Polygon& of_b : below.faces)
        for (const Polygon& of_a : above.faces) touch(scene, int(a), int(b), of_a, of_b, slack, law);
    }
}

}  // namespace aussois
