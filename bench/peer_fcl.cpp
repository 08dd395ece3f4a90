// SPDX-License-Identifier: Apache-2.0
#include "bench/peer_fcl.hpp"

#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/distance.h>

namespace aussois {
namespace {

using Mesh = fcl::BVHModel<fcl::OBBRSSd>;

std::shared_ptr<Mesh> mesh_of(const SimplicialComplex& k) {
  std::vector<fcl::Triangle> triangles;
  for (const auto& t : k.triangles)
    triangles.emplace_back(std::size_t(t[0]), std::size_t(t[1]), std::size_t(t[2]));
  auto mesh = std::make_shared<Mesh>();
  mesh->beginModel();
  mesh->addSubModel(k.vertices, triangles);
  mesh->endModel();
  return mesh;
}

fcl::Transform3d pose_of(const SE3& g) {
  fcl::Transform3d t = fcl::Transform3d::Identity();
  t.linear() = g.R.toRotationMatrix();
  t.translation() = g.p;
  return t;
}

}  // namespace

struct FclPair::Impl {
  std::shared_ptr<Mesh> a, b;
};

FclPair::FclPair(const SimplicialComplex& a, const SimplicialComplex& b)
    : impl_(new Impl{mesh_of(a), mesh_of(b)}) {}
FclPair::~FclPair() = default;

double FclPair::distance(const SE3& g_a, const SE3& g_b) const {
  const fcl::DistanceRequestd request;
  fcl::DistanceResultd result;
  const fcl::CollisionObjectd a(impl_->a, pose_of(g_a)), b(impl_->b, pose_of(g_b));
  return fcl::distance(&a, &b, request, result);
}

}  // namespace aussois
