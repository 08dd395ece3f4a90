// SPDX-License-Identifier: Apache-2.0
#include "reduction/redistribute.hpp"

#include <algorithm>

#include <Eigen/Geometry>
#include <Eigen/QR>

#include "geometry/check.hpp"
#include "geometry/frame.hpp"

namespace aussois {
namespace {

// A x = b, or as near as possible, with the smallest x: the patch may be a line or a point.
VecX least_norm(const MatX& A, const VecX& b) {
  Eigen::CompleteOrthogonalDecomposition<MatX> decomposition(A);
  decomposition.setThreshold(1e-9);
  return decomposition.solve(b);
}

// One cluster in the frame of its mean normal: coordinates n, t1, t2 about the mean of the kept points,
// lengths over the patch's size.
struct Patch {
  Mat3 frame = Mat3::Identity();
  Vec3 centre = Vec3::Zero();
  double size = 1;

  Vec3 point(const ContactPoint& c) const { return frame.transpose() * (mid_point(c) - centre) / size; }
};

Patch patch_of(const ContactSet& contacts, const std::vector<int>& kept) {
  Vec3 normal = Vec3::Zero();
  Patch patch;
  for (const int i : kept) {
    const ContactPoint& c = contacts.points[i];
    normal += c.normal;
    patch.centre += mid_point(c) / double(kept.size());
  }
  if (normal.norm() > 0.5) patch.frame = frame_of(normal.normalized());
  double size = 0;
  for (const int i : kept) size = std::max(size, (mid_point(contacts.points[i]) - patch.centre).norm());
  if (size > 0) patch.size = size;
  return patch;
}

// Adds the normal wrench `target` (force, two moments) to `normal`, none of which becomes negative: those
// that would are set to zero and the rest is shared again, fewer each time.
void add_normal(const std::vector<Vec3>& x, const Vec3& target, std::vector<double>& normal) {
  Vec3 left = target;
  std::vector<std::size_t> free;
  for (std::size_t k = 0; k < x.size(); ++k) free.push_back(k);
  while (!free.empty()) {
    MatX A(3, Eigen::Index(free.size()));
    for (std::size_t k = 0; k < free.size(); ++k)
      A.col(Eigen::Index(k)) = Vec3(1, x[free[k]].y(), x[free[k]].z());
    const VecX more = least_norm(A, left);
    const auto after = [&](std::size_t k) { return normal[free[k]] + more[Eigen::Index(k)]; };
    std::size_t least = 0;
    for (std::size_t k = 1; k < free.size(); ++k)
      if (after(k) < after(least)) least = k;
    const std::size_t f = free[least];
    if (after(least) >= 0) {
      for (std::size_t k = 0; k < free.size(); ++k) normal[free[k]] += more[Eigen::Index(k)];
      return;
    }
    left += normal[f] * Vec3(1, x[f].y(), x[f].z());
    normal[f] = 0;
    free.erase(free.begin() + std::ptrdiff_t(least));
  }
}

// Adds the tangential wrench `target` (two forces, one moment about the normal).
void add_tangential(const std::vector<Vec3>& x, const Vec3& target, std::vector<Vec2>& tangential) {
  MatX A(3, 2 * Eigen::Index(x.size()));
  for (std::size_t k = 0; k < x.size(); ++k) {
    const Eigen::Index at = 2 * Eigen::Index(k);
    A.col(at) = Vec3(1, 0, -x[k].z());
    A.col(at + 1) = Vec3(0, 1, x[k].y());
  }
  const VecX more = least_norm(A, target);
  for (std::size_t k = 0; k < x.size(); ++k) tangential[k] += more.segment<2>(2 * Eigen::Index(k));
}

void share(const ContactSet& contacts, const std::vector<int>& kept, const std::vector<int>& dropped,
           const std::vector<Vec3>& impulse, const std::vector<double>& mu, std::vector<Vec3>& start) {
  const Patch patch = patch_of(contacts, kept);
  Vec3 normal_wrench = Vec3::Zero(), tangential_wrench = Vec3::Zero();
  for (const int i : dropped) {
    const Vec3 x = patch.point(contacts.points[i]);
    const Vec3 r = patch.frame.transpose() * impulse[i];
    normal_wrench += r.x() * Vec3(1, x.y(), x.z());
    tangential_wrench += Vec3(r.y(), r.z(), x.y() * r.z() - x.z() * r.y());
  }
  std::vector<Vec3> x;
  std::vector<double> normal;
  std::vector<Vec2> tangential;
  for (const int i : kept) {
    const Vec3 r = patch.frame.transpose() * impulse[i];
    x.push_back(patch.point(contacts.points[i]));
    normal.push_back(std::max(0.0, r.x()));
    tangential.push_back(r.tail<2>());
  }
  add_normal(x, normal_wrench, normal);
  add_tangential(x, tangential_wrench, tangential);
  for (std::size_t k = 0; k < kept.size(); ++k) {
    const auto i = std::size_t(kept[k]);
    const double most = mu[i] * normal[k], length = tangential[k].norm();
    if (length > most) tangential[k] *= most / length;
    start[i] = patch.frame * Vec3(normal[k], tangential[k].x(), tangential[k].y());
  }
}

}  // namespace

std::vector<Vec3> redistribute(const ContactSet& contacts, const Selection& selection,
                               const std::vector<Vec3>& impulse, const std::vector<double>& mu) {
  const std::size_t n = contacts.points.size();
  require(impulse.size() == n && mu.size() == n && selection.cluster.size() == n,
          "redistribute: impulses, friction and selection must be of the same set");
  std::vector<Vec3> start(n, Vec3::Zero());
  for (const int i : selection.kept) start[i] = impulse[i];
  if (start == impulse) return start;  // nothing was dropped
  std::vector<std::vector<int>> kept(selection.cluster_count), dropped = kept;
  std::vector<char> is_kept(n, 0);
  for (const int i : selection.kept) is_kept[i] = 1;
  for (int i = 0; i < int(n); ++i)
    if (!is_kept[i] && !impulse[i].isZero(0)) dropped[selection.cluster[i]].push_back(i);
  for (int i = 0; i < int(n); ++i)
    if (is_kept[i] && !dropped[selection.cluster[i]].empty()) kept[selection.cluster[i]].push_back(i);
  for (std::size_t c = 0; c < kept.size(); ++c)
    if (!dropped[c].empty() && !kept[c].empty()) share(contacts, kept[c], dropped[c], impulse, mu, start);
  return start;
}

}  // namespace aussois
