// SPDX-License-Identifier: Apache-2.0
#include "bench/peer_cgal.hpp"

#include <vector>

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>

namespace aussois {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 point_of(const Vec3& x) {
  return {x.x(), x.y(), x.z()};
}

// Counts the output of CGAL's traversal.
struct Counter {
  using iterator_category = std::output_iterator_tag;
  using value_type = void;
  using difference_type = std::ptrdiff_t;
  using pointer = void;
  using reference = void;
  long* count;
  Counter& operator*() { return *this; }
  Counter& operator++() { return *this; }
  Counter& operator++(int) { return *this; }
  template <class Id>
  void operator=(const Id&) {
    ++*count;
  }
};

}  // namespace

struct CgalPair::Impl {
  const SimplicialComplex* a = nullptr;
  Triangles triangles{};
  Tree tree{};
};

CgalPair::CgalPair(const SimplicialComplex& a, const SimplicialComplex& b) : impl_(new Impl{.a = &a}) {
  for (const auto& t : b.triangles)
    impl_->triangles.emplace_back(point_of(b.vertices[t[0]]), point_of(b.vertices[t[1]]),
                                  point_of(b.vertices[t[2]]));
  impl_->tree.insert(impl_->triangles.cbegin(), impl_->triangles.cend());
  impl_->tree.build();
}
CgalPair::~CgalPair() = default;

long CgalPair::count_near(const SE3& g_ba, double reach) const {
  const SimplicialComplex& a = *impl_->a;
  std::vector<Vec3> x;
  for (const Vec3& v : a.vertices) x.push_back(g_ba * v);
  long count = 0;
  for (const auto& t : a.triangles) {
    const Vec3 &p = x[t[0]], &q = x[t[1]], &r = x[t[2]];
    const Vec3 lo = p.cwiseMin(q).cwiseMin(r).array() - reach, hi = p.cwiseMax(q).cwiseMax(r).array() + reach;
    const CGAL::Bbox_3 box(lo.x(), lo.y(), lo.z(), hi.x(), hi.y(), hi.z());
    impl_->tree.all_intersected_primitives(box, Counter{&count});
  }
  return count;
}

}  // namespace aussois
