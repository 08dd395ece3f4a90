// SPDX-License-Identifier: Apache-2.0
#include "bench/peer_fcl.hpp"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/distance.h>

namespace aussois {
namespace {

using Mesh = fcl::BVHModel<fcl::OBBRSSd>;

std::shared_ptr<Mesh> mesh_of(const SimplicialComplex& k, double scale) {
  std::vector<fcl::Triangle> triangles;
  std::vector<Vec3> vertices;
  for (const Vec3& x : k.vertices) vertices.push_back(scale * x);
  for (const auto& t : k.triangles)
    triangles.emplace_back(std::size_t(t[0]), std::size_t(t[1]), std::size_t(t[2]));
  auto mesh = std::make_shared<Mesh>();
  mesh->beginModel();
  mesh->addSubModel(vertices, triangles);
  mesh->endModel();
  return mesh;
}

fcl::Transform3d pose_of(const SE3& g, double scale) {
  fcl::Transform3d t = fcl::Transform3d::Identity();
  t.linear() = g.R.toRotationMatrix();
  t.translation() = scale * g.p;
  return t;
}

}  // namespace

struct FclPair::Impl {
  double scale = 1;
  std::shared_ptr<Mesh> a{}, b{};
};

FclPair::FclPair(const SimplicialComplex& a, const SimplicialComplex& b)
    : impl_(new Impl{.scale = 100 / bounding_box(a).diagonal()}) {
  impl_->a = mesh_of(a, impl_->scale);
  impl_->b = mesh_of(b, impl_->scale);
}
FclPair::~FclPair() = default;

double FclPair::distance(const SE3& g_a, const SE3& g_b) const {
  const fcl::DistanceRequestd request;
  fcl::DistanceResultd result;
  const double scale = impl_->scale;
  const fcl::CollisionObjectd a(impl_->a, pose_of(g_a, scale)), b(impl_->b, pose_of(g_b, scale));
  return fcl::distance(&a, &b, request, result) / scale;
}

}  // namespace aussois
