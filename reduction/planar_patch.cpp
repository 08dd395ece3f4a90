// SPDX-License-Identifier: Apache-2.0
#include "reduction/planar_patch.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Geometry>

#include "geometry/polygon.hpp"
#include "reduction/body_frame.hpp"
#include "reduction/contact_memory.hpp"

namespace aussois {
namespace {

constexpr double kIsotropic = 1e-6;  // relative difference of principal moments below which no direction is
                                     // principal: above it, rounding turns the axis by less than 1e-9

Vec2 outward(const Vec2& side) {  // of a side of a hull that is walked counter-clockwise
  return Vec2(side.y(), -side.x()).stableNormalized();
}

// Support function of a hull for directions that turn counter-clockwise from -u on.
class TurningSupport {
 public:
  explicit TurningSupport(const std::vector<Vec2>& hull) : hull_(hull) {}
  double operator()(const Vec2& d) {
    while (d.dot(next()) > d.dot(hull_[at_])) at_ = (at_ + 1) % hull_.size();
    return d.dot(hull_[at_]);
  }

 private:
  const Vec2& next() const { return hull_[(at_ + 1) % hull_.size()]; }
  const std::vector<Vec2>& hull_;
  std::size_t at_ = 0;  // the leftmost corner, as hull_of begins
};

// Integral of |x| over the triangle of the origin, a and b: with the origin's distance p to the side, between
// the angles that its ends are seen at from the foot (RED-8).
double distance_integral(const Vec2& a, const Vec2& b) {
  const Vec2 side = b - a;
  const double length = side.norm(), p = cross(a, b) / length;
  if (!(length > 0) || p == 0) return 0;
  const auto primitive = [&](double s) { return s * std::hypot(p, s) + p * p * std::asinh(s / std::abs(p)); };
  return p / 6 * (primitive(side.dot(b) / length) - primitive(side.dot(a) / length));
}

double distance_to(const std::vector<Vec2>& hull, const Vec2& x) {
  bool inside = hull.size() > 2;
  double nearest = kInf;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Vec2 &a = hull[i], &b = hull[(i + 1) % hull.size()];
    nearest = std::min(nearest, (x - nearest_on_segment(a, b, x)).norm());
    inside = inside && cross(b - a, x - a) >= 0;
  }
  return inside ? 0 : nearest;
}

// Area, centroid and drilling radius of a patch whose hull is known.
void measure(PlanarPatch& patch) {
  const auto corner = [&](std::size_t i) { return patch.x[patch.hull[i % patch.hull.size()]]; };
  const Vec2 first = corner(0);
  Vec2 moment = Vec2::Zero();
  for (std::size_t i = 1; i + 1 < patch.hull.size(); ++i) {
    const Vec2 a = corner(i) - first, b = corner(i + 1) - first;
    patch.area += cross(a, b) / 2;
    moment += cross(a, b) / 2 * (a + b) / 3;
  }
  if (patch.area == 0) {
    const Vec2 last = corner(patch.hull.size() - 1);
    patch.centroid = (first + last) / 2;
    patch.drilling_radius = (last - first).norm() / 4;
    return;
  }
  patch.centroid = first + moment / patch.area;
  for (std::size_t i = 0; i < patch.hull.size(); ++i)
    patch.drilling_radius +=
        distance_integral(corner(i) - patch.centroid, corner(i + 1) - patch.centroid) / patch.area;
}

std::vector<Vec2> places(const PlanarPatch& patch, std::span<const int> members) {
  std::vector<Vec2> out;
  out.reserve(members.size());
  for (const int i : members) out.push_back(patch.x[i] - patch.centroid);
  return out;
}

}  // namespace

PlanarPatch planar_patch(const ContactSet& found, std::span<const int> members, std::span<const SE3> g) {
  const auto middle = [&](int i) { return mid_point(found.points[i]); };
  Vec3 n = Vec3::Zero(), mean = Vec3::Zero();
  for (const int i : members) {
    n += found.points[i].normal;  // never zero: clusters hold no normals that cancel
    mean += middle(i);
  }
  mean /= double(members.size());
  const SE3 g_wa = pose_of(g, found.points[members.front()].a.body);
  Mat3 frame = body_frame(n.normalized(), g_wa.R.toRotationMatrix());

  std::vector<Vec2> x;
  x.reserve(members.size());
  Mat2 S = Mat2::Zero();
  for (const int i : members) {
    x.push_back((frame.transpose() * (middle(i) - mean)).tail<2>());
    S += x.back() * x.back().transpose();
  }
  const double difference = 0.5 * (S(0, 0) - S(1, 1));
  if (std::hypot(difference, S(0, 1)) > 0.5 * kIsotropic * S.trace()) {
    const Mat2 turn = Eigen::Rotation2D<double>(0.5 * std::atan2(S(0, 1), difference)).toRotationMatrix();
    for (Vec2& point : x) point = turn.transpose() * point;
    frame.rightCols<2>() = (frame.rightCols<2>() * turn).eval();
  }
  PlanarPatch patch = planar_patch(std::move(x));
  patch.frame = frame;
  patch.origin = mean;
  return patch;
}

PlanarPatch planar_patch(std::vector<Vec2> x) {
  PlanarPatch patch{.x = std::move(x)};
  Vec2 lo = patch.x.front(), hi = patch.x.front();
  for (const Vec2& point : patch.x) {
    lo = lo.cwiseMin(point);
    hi = hi.cwiseMax(point);
  }
  patch.extent = (hi - lo).maxCoeff();
  std::vector<int> all(patch.x.size());
  std::iota(all.begin(), all.end(), 0);
  patch.hull = hull_of(patch, all);
  measure(patch);
  return patch;
}

// Andrew's monotone chain, whose order bears no tolerance; then without what stands out less than rounding,
// from a corner that surely does.
std::vector<int> hull_of(const PlanarPatch& patch, std::span<const int> members) {
  const auto at = [&](int i) -> const Vec2& { return patch.x[i]; };
  struct Place {
    double x, y;
    int i;
    auto operator<=>(const Place&) const = default;
  };
  const auto place_of = [&](int i) { return Place{at(i).x(), at(i).y(), i}; };
  std::vector<Place> from_left;
  from_left.reserve(members.size());
  for (const int i : members) from_left.push_back(place_of(i));
  std::sort(from_left.begin(), from_left.end());
  std::vector<int> order;
  order.reserve(members.size());
  for (const Place& place : from_left)
    if (order.empty() || at(order.back()) != at(place.i)) order.push_back(place.i);
  if (order.size() < 3) return order;
  const auto append = [&](std::vector<int>& chain, std::size_t first, int i, const auto& stands_out) {
    while (chain.size() >= first + 2 && !stands_out(at(chain[chain.size() - 2]), at(chain.back()), at(i)))
      chain.pop_back();
    chain.push_back(i);
  };
  std::vector<int> ring;
  for (int side = 0; side < 2; ++side) {  // below from left to right, above from right to left
    const std::size_t first = ring.size();
    for (const int i : order)
      append(ring, first, i,
             [](const Vec2& a, const Vec2& b, const Vec2& c) { return cross(b - a, c - a) > 0; });
    ring.pop_back();  // the first of the other side
    std::reverse(order.begin(), order.end());
  }
  const Vec2 left = at(ring.front());
  std::rotate(ring.begin(),
              std::max_element(
                  ring.begin(), ring.end(),
                  [&](int i, int j) { return (at(i) - left).squaredNorm() < (at(j) - left).squaredNorm(); }),
              ring.end());
  ring.push_back(ring.front());
  std::vector<int> hull;
  for (const int i : ring)
    append(hull, 0, i, [same = kSamePlace * patch.extent](const Vec2& a, const Vec2& b, const Vec2& c) {
      return (b - nearest_on_segment(a, c, b)).norm() > same;
    });
  hull.pop_back();
  std::rotate(hull.begin(), std::ranges::min_element(hull, {}, place_of), hull.end());
  return hull;
}

Margin margin_of(const PlanarPatch& patch, std::span<const int> part) {
  if (part.empty()) return {.value = -kInf};
  if (!(patch.extent > 0)) return {};
  const std::vector<Vec2> P = places(patch, patch.hull), S = places(patch, hull_of(patch, part));
  std::vector<std::pair<double, Vec2>> directions;  // and their angles
  directions.reserve(P.size() + S.size());
  const auto add = [&](const Vec2& d) { directions.emplace_back(std::atan2(d.y(), d.x()), d); };
  if (P.size() == 2) {  // only the line's own directions matter
    for (const int i : {0, 1}) directions.emplace_back(0, (P[i] - P[1 - i]).stableNormalized());
  } else {
    for (const std::vector<Vec2>* hull : {&P, &S})
      for (std::size_t i = 0; hull->size() > 1 && i < hull->size(); ++i)
        add(outward((*hull)[(i + 1) % hull->size()] - (*hull)[i]));
    std::ranges::sort(directions, {}, &std::pair<double, Vec2>::first);
  }
  Margin worst;
  TurningSupport h_P(P), h_S(S);
  for (const auto& [angle, d] : directions) {
    const double ratio = h_S(d) / h_P(d);  // P surrounds its centroid
    if (ratio < worst.value) worst = {ratio, d};
  }
  return worst;
}

LossReport loss_of(const PlanarPatch& patch, std::span<const int> part) {
  if (part.empty()) return {.margin = -kInf, .area = 0, .torsion = 0, .hausdorff = patch.extent};
  LossReport loss{.margin = margin_of(patch, part).value};
  const std::vector<Vec2> S = places(patch, hull_of(patch, part));
  if (patch.area > 0) {
    double area = 0;
    for (std::size_t i = 0; i < S.size(); ++i) area += cross(S[i], S[(i + 1) % S.size()]) / 2;
    loss.area = std::clamp(area / patch.area, 0.0, 1.0);
  }
  std::vector<char> kept(patch.x.size(), 0);
  for (const int i : part) kept[i] = 1;
  for (const int i : patch.hull)
    if (!kept[i]) loss.hausdorff = std::max(loss.hausdorff, distance_to(S, patch.x[i] - patch.centroid));
  if (patch.drilling_radius > 0) {
    double sum = 0;
    for (const Vec2& x : places(patch, part)) sum += x.norm();
    loss.torsion = sum / double(part.size()) / patch.drilling_radius;  // (RED-8)
  }
  return loss;
}

int extreme_member(const PlanarPatch& patch, const Vec2& d, const Vec2& side, double tie) {
  double far = -kInf, aside = -kInf;
  for (const Vec2& point : patch.x) far = std::max(far, d.dot(point));
  const auto tied = [&](const Vec2& point) { return d.dot(point) >= far - tie; };
  for (const Vec2& point : patch.x)
    if (tied(point)) aside = std::max(aside, side.dot(point));
  const double same = kSamePlace * patch.extent;
  const auto first = std::find_if(patch.x.begin(), patch.x.end(),
                                  [&](const Vec2& p) { return tied(p) && side.dot(p) >= aside - same; });
  return int(first - patch.x.begin());
}

}  // namespace aussois
