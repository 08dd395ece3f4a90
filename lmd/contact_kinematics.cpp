// SPDX-License-Identifier: Apache-2.0
#include "lmd/contact_kinematics.hpp"

#include "geometry/check.hpp"
#include "geometry/frame.hpp"
#include "geometry/named.hpp"
#include "lmd/leaf.hpp"

namespace aussois {
namespace {

using Mat3x2 = Eigen::Matrix<double, 3, 2>;
using Mat2x12 = Eigen::Matrix<double, 2, 12>;

Vec3 chain_direction(const LmdShape& shape, int chain) {
  if (shape.deforming) {
    const auto [a, b] = shape.complex.edges[chain];
    return (shape.complex.vertices[b] - shape.complex.vertices[a]).normalized();
  }
  return leaf_of(shape, {.index = chain, .dim = 1, .side = 1}).direction;
}

// The directions in which the foot may slide on its simplex, orthonormal, world.
struct SlidingSpace {
  int dim = 0;
  Mat3x2 basis = Mat3x2::Zero();
};

SlidingSpace sliding_space(const Feature& feature, const PosedShape& posed, const Vec3& normal) {
  SlidingSpace space{.dim = feature.dim};
  if (feature.dim == 1) space.basis.col(0) = posed.g_ws.R * chain_direction(*posed.shape, feature.region);
  if (feature.dim == 2) space.basis = frame_of(normal).rightCols<2>();
  return space;
}

// Where a body's twist stands in a Vec12, and what it does to a point of the body.
struct Side {
  int first;
  Mat3 R;
  Vec3 origin;
  Mat3x12 omega() const {  // angular velocity in the world
    Mat3x12 map = Mat3x12::Zero();
    map.middleCols<3>(first + 3) = R;
    return map;
  }
  Mat3x12 velocity(const Vec3& point) const {
    Mat3x12 map = -skew(point - origin) * omega();
    map.middleCols<3>(first) = Mat3::Identity();
    return map;
  }
  // n . (w x (w x r)) as a quadratic form of the twists: the acceleration at constant twists
  Mat12 centripetal(const Vec3& n, const Vec3& point) const {
    const Vec3 r = point - origin;
    const Mat3 form = (n * r.transpose() + r * n.transpose()) / 2 - n.dot(r) * Mat3::Identity();
    const Mat3x12 w = omega();
    return w.transpose() * form * w;
  }
};

}  // namespace

constexpr Named<KinematicsStatus> kKinematicsStatuses[] = {
    {KinematicsStatus::ok, "ok"},
    {KinematicsStatus::bases_too_near, "bases_too_near"},
    {KinematicsStatus::parallel_edges, "parallel_edges"}};

const char* to_string(KinematicsStatus status) {
  return name_of(status, kKinematicsStatuses);
}

ContactKinematics contact_kinematics(const ContactPoint& contact, const PosedShape& a, const SE3& g_a,
                                     const PosedShape& b, const SE3& g_b) {
  const Vec3& n = contact.normal;
  const double dilations = a.shape->radius + b.shape->radius;
  const Side side_a{0, g_a.R.toRotationMatrix(), g_a.p}, side_b{6, g_b.R.toRotationMatrix(), g_b.p};
  ContactKinematics k;
  k.foot_a = contact.x_a + a.shape->radius * n;
  k.foot_b = contact.x_b - b.shape->radius * n;
  k.distance = contact.gap + dilations;

  // First order: the feet slide at right angles to n, so only the material moves the gap (KIN-1), (KIN-9).
  const Mat3 tangent = Mat3::Identity() - n * n.transpose();
  const Mat3x12 V = side_a.velocity(k.foot_a) - side_b.velocity(k.foot_b);
  k.gap_rate = n.transpose() * V;
  k.slip = tangent * (side_a.velocity(contact.x_a) - side_b.velocity(contact.x_b));

  // How the feet slide: L = L_a + L_b = [T_a, -T_b] and its Gram matrix (KIN-3); columns not used are zero.
  const SlidingSpace on_a = sliding_space(contact.a, a, n), on_b = sliding_space(contact.b, b, n);
  AUSSOIS_ASSERT(on_a.dim + on_b.dim <= 2);
  if (on_a.dim == 1 && on_b.dim == 1) k.sin_psi = on_a.basis.col(0).cross(on_b.basis.col(0)).norm();
  if (k.sin_psi <= 1e-8) k.status = KinematicsStatus::parallel_edges;
  if (k.distance <= 1e-3 * dilations) k.status = KinematicsStatus::bases_too_near;
  if (k.status != KinematicsStatus::ok) return k;
  Mat3x2 L_a = Mat3x2::Zero(), L_b = Mat3x2::Zero();
  for (int i = 0; i < on_a.dim; ++i) L_a.col(i) = on_a.basis.col(i);
  for (int i = 0; i < on_b.dim; ++i) L_b.col(on_a.dim + i) = -on_b.basis.col(i);
  const Mat3x2 L = L_a + L_b;
  Mat2 gram = L.transpose() * L;
  for (int i = on_a.dim + on_b.dim; i < 2; ++i) gram(i, i) = 1;
  const Mat2 gram_inverse = gram.inverse();

  // Second order (KIN-4) to (KIN-7). Neither the term with e nor that of the feet divides by the distance.
  const Mat2x12 LV = L.transpose() * V;
  const Mat2x12 e = L_a.transpose() * skew(n) * side_a.omega() + L_b.transpose() * skew(n) * side_b.omega();
  const Mat2x12 beta = -gram_inverse * (LV + k.distance * e);
  k.slide_a = L_a * beta;
  k.slide_b = -L_b * beta;
  const Mat3x12 held = (tangent - L * gram_inverse * L.transpose()) * V;  // where no foot can follow
  k.normal_rate = held / k.distance - L * gram_inverse * e;
  const Mat12 mixed = LV.transpose() * gram_inverse * e;
  k.gap_hessian = held.transpose() * held / k.distance - mixed - mixed.transpose() -
                  k.distance * e.transpose() * gram_inverse * e + side_a.centripetal(n, k.foot_a) -
                  side_b.centripetal(n, k.foot_b);
  return k;
}

Mat12 jacobian_derivative(const ContactKinematics& kinematics) {
  Mat12 B = kinematics.gap_hessian;
  for (const int first : {3, 9})  // (KIN-8)
    B.block<3, 3>(first, first) -= skew(kinematics.gap_rate.segment<3>(first).transpose()) / 2;
  return B;
}

}  // namespace aussois
