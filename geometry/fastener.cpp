// SPDX-License-Identifier: Apache-2.0
#include "geometry/fastener.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "geometry/check.hpp"
#include "geometry/settings.hpp"

namespace aussois {
namespace {

// The basic profile of ISO 68-1 over one pitch: crest P/8 wide, root P/4 wide, flanks inclined by 30 degrees
// to the radius, 5/8 H deep with H = sqrt(3)/2 P.
struct ProfileCorner {
  double s = 0;      // height in pitches
  double depth = 0;  // below the crest, in 5/8 H
};
constexpr std::array<ProfileCorner, 4> kProfile = {{{0, 0}, {1. / 8, 0}, {7. / 16, 1}, {11. / 16, 1}}};
constexpr int kCorners = int(kProfile.size());

double thread_depth(const FastenerOptions& options) {
  return 5. / 8 * std::sqrt(3.0) / 2 * options.pitch;
}

// Height of the first corner [m]. The end planes cut the columns where s is a multiple of pitch / facets;
// with `facets` a multiple of 8 the corners lie at multiples of half of that, so a quarter keeps every corner
// off the cuts.
double thread_phase(const FastenerOptions& options) {
  return options.pitch / (4 * options.facets);
}

void validate(const FastenerOptions& o) {
  check_ranges(o);
  require_field(o.pitch <= o.diameter / 4, "FastenerOptions::pitch", o.pitch, "not exceed diameter / 4 [m]");
  require_field(o.clearance <= o.pitch / 4, "FastenerOptions::clearance", o.clearance,
                "not exceed pitch / 4 [m]");
  require_field(o.facets % 8 == 0, "FastenerOptions::facets", o.facets, "be a multiple of 8");
}

struct Surface {
  std::vector<Vec3> vertices{};
  std::vector<std::array<int, 3>> triangles{};
};

Vec3 cylindrical(double r, double angle, double z) {
  return {r * std::cos(angle), r * std::sin(angle), z};
}

// The side of the plane at height z that is above (or below) it. No vertex may lie in the plane; those made
// by the cut lie exactly in it.
Surface cut(const Surface& surface, double z, bool keep_above) {
  Surface result;
  std::vector<int> kept(surface.vertices.size(), -1);
  std::map<std::pair<int, int>, int> crossing;  // of edges with ascending ends
  const auto keeps = [&](int v) { return (surface.vertices[v].z() > z) == keep_above; };
  const auto add = [&](const Vec3& x) {
    result.vertices.push_back(x);
    return int(result.vertices.size()) - 1;
  };
  const auto cross = [&](int a, int b) {
    const auto [at, is_new] = crossing.try_emplace(std::minmax(a, b), -1);
    if (!is_new) return at->second;
    const Vec3 lo = surface.vertices[std::min(a, b)], hi = surface.vertices[std::max(a, b)];
    Vec3 x = lo + (z - lo.z()) / (hi.z() - lo.z()) * (hi - lo);
    x.z() = z;
    return at->second = add(x);
  };
  for (const auto& triangle : surface.triangles) {
    std::vector<int> polygon;
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = triangle[k], b = triangle[(k + 1) % 3];
      if (keeps(a)) {
        int& index = kept[a];
        if (index < 0) index = add(surface.vertices[a]);
        polygon.push_back(index);
      }
      if (keeps(a) != keeps(b)) polygon.push_back(cross(a, b));
    }
    for (std::size_t k = 2; k < polygon.size(); ++k)
      result.triangles.push_back({polygon[0], polygon[k - 1], polygon[k]});
  }
  return result;
}

enum class Thread { bolt, nut };

// The facetted helicoid (CPX-5) for z in [0, turns * pitch], facing away from the material.
Surface thread_surface(const FastenerOptions& options, Thread thread, int turns) {
  const int n = options.facets;
  // From two turns below to two above, to cut off what is too much.
  const int row_count = (turns + 4) * kCorners;
  const double depth = thread_depth(options), circumscribe = 1 / std::cos(kPi / n);
  Surface surface;
  for (int column = 0; column < n; ++column) {
    for (int row = 0; row < row_count; ++row) {
      const ProfileCorner corner = kProfile[row % kCorners];
      const double basic = options.diameter / 2 - corner.depth * depth;
      const double r = thread == Thread::bolt ? basic - options.clearance : basic * circumscribe;
      const int turn = row / kCorners - 2;
      const double z = thread_phase(options) + options.pitch * (turn + corner.s + double(column) / n);
      surface.vertices.push_back(cylindrical(r, 2 * kPi * column / n, z));
    }
  }
  // After a full turn a helix arrives one pitch higher. The diagonal of a twisted facet lies inside the
  // material: falling for the bolt, rising for the nut.
  const auto vertex = [&](int column, int row) {
    return column < n ? column * row_count + row : row + kCorners;
  };
  for (int column = 0; column < n; ++column) {
    for (int row = 0; row + 1 + kCorners < row_count; ++row) {
      const int a = vertex(column, row), b = vertex(column + 1, row);
      const int c = vertex(column + 1, row + 1), d = vertex(column, row + 1);
      if (thread == Thread::bolt) {
        surface.triangles.push_back({a, b, d});
        surface.triangles.push_back({b, c, d});
      } else {
        surface.triangles.push_back({a, c, b});
        surface.triangles.push_back({a, d, c});
      }
    }
  }
  return cut(cut(surface, 0, true), turns * options.pitch, false);
}

double angle_of(const Vec3& x) {
  return std::atan2(x.y(), x.x());
}

// The vertices in the plane at height z, by ascending angle: a loop around the axis.
std::vector<int> rim_at(const Surface& surface, double z) {
  std::vector<int> rim;
  for (int v = 0; v < int(surface.vertices.size()); ++v)
    if (surface.vertices[v].z() == z) rim.push_back(v);
  std::sort(rim.begin(), rim.end(),
            [&](int a, int b) { return angle_of(surface.vertices[a]) < angle_of(surface.vertices[b]); });
  return rim;
}

// Adds the corners of the wrench hexagon at height z; their angles ascend from -150 degrees.
std::vector<int> add_hexagon(Surface& surface, const FastenerOptions& options, double z) {
  std::vector<int> corners(6);
  std::iota(corners.begin(), corners.end(), int(surface.vertices.size()));
  const double r = 1.5 * options.diameter / 2 / std::cos(kPi / 6);
  for (int k = 0; k < 6; ++k) surface.vertices.push_back(cylindrical(r, kPi * (2 * k - 5) / 6, z));
  return corners;
}

// Adds the plane ring between two loops around the axis, each by ascending angle: of the next edges of the
// two loops the one whose middle comes first gets its triangle, so that every edge goes to the vertex
// opposite.
void add_ring(Surface& surface, const std::vector<int>& inner, const std::vector<int>& outer, bool faces_up) {
  const auto angle = [&](const std::vector<int>& loop, std::size_t k) {
    const double full_turn = k < loop.size() ? 0 : 2 * kPi;
    return angle_of(surface.vertices[loop[k % loop.size()]]) + full_turn;
  };
  std::size_t i = 0, j = 0;
  while (i < inner.size() || j < outer.size()) {
    const int a = inner[i % inner.size()], b = outer[j % outer.size()];
    const bool inner_moves = angle(inner, i) + angle(inner, i + 1) < angle(outer, j) + angle(outer, j + 1);
    const int c = inner_moves ? inner[++i % inner.size()] : outer[++j % outer.size()];
    surface.triangles.push_back(faces_up ? std::array{a, b, c} : std::array{a, c, b});
  }
}

void add_wall(Surface& surface, const std::vector<int>& below, const std::vector<int>& above) {
  for (std::size_t k = 0; k < below.size(); ++k) {
    const std::size_t next = (k + 1) % below.size();
    surface.triangles.push_back({below[k], below[next], above[next]});
    surface.triangles.push_back({below[k], above[next], above[k]});
  }
}

// Adds a disc around the axis inside a loop.
void add_disc(Surface& surface, const std::vector<int>& loop, double z, bool faces_up) {
  const int centre = int(surface.vertices.size());
  surface.vertices.emplace_back(0, 0, z);
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const int a = loop[k], b = loop[(k + 1) % loop.size()];
    surface.triangles.push_back(faces_up ? std::array{centre, a, b} : std::array{centre, b, a});
  }
}

SimplicialComplex make_solid(Surface surface) {
  return make_complex(std::move(surface.vertices), std::move(surface.triangles), {}, true);
}

}  // namespace

void describe(SettingVisitor& visit, FastenerOptions& o) {
  visit.begin("FastenerOptions");
  visit.number({"diameter", "nominal diameter of the thread", "m", positive_range()}, o.diameter);
  visit.number({"pitch", "rise of the thread per turn", "m", positive_range()}, o.pitch);
  visit.number({"clearance", "radial gap between the threads", "m", positive_range()}, o.clearance);
  visit.count({"facets", "number of facets per turn", "", {16, 240}}, o.facets);
  visit.count({"bolt_turns", "threaded length of the bolt in pitches", "", {1, 100}}, o.bolt_turns);
  visit.count({"nut_turns", "height of the nut in pitches", "", {1, 100}}, o.nut_turns);
}

SimplicialComplex make_bolt(const FastenerOptions& options) {
  validate(options);
  const double tip = options.bolt_turns * options.pitch, bottom = -0.65 * options.diameter;
  Surface bolt = thread_surface(options, Thread::bolt, options.bolt_turns);
  const std::vector<int> neck = rim_at(bolt, 0);
  add_disc(bolt, rim_at(bolt, tip), tip, true);
  const std::vector<int> below = add_hexagon(bolt, options, bottom), above = add_hexagon(bolt, options, 0);
  add_ring(bolt, neck, above, true);
  add_wall(bolt, below, above);
  add_disc(bolt, below, bottom, false);
  return make_solid(std::move(bolt));
}

SimplicialComplex make_nut(const FastenerOptions& options) {
  validate(options);
  const double top = options.nut_turns * options.pitch;
  Surface nut = thread_surface(options, Thread::nut, options.nut_turns);
  const std::vector<int> lower_rim = rim_at(nut, 0), upper_rim = rim_at(nut, top);
  const std::vector<int> below = add_hexagon(nut, options, 0), above = add_hexagon(nut, options, top);
  add_ring(nut, lower_rim, below, false);
  add_ring(nut, upper_rim, above, true);
  add_wall(nut, below, above);
  return make_solid(std::move(nut));
}

double thread_radius(const FastenerOptions& options, double s) {
  validate(options);
  const double turns = (s - thread_phase(options)) / options.pitch;
  const double at = turns - std::floor(turns);
  const auto next =
      std::find_if(kProfile.begin(), kProfile.end(), [&](const ProfileCorner& c) { return c.s > at; });
  const ProfileCorner from = *(next - 1), to = next == kProfile.end() ? ProfileCorner{1, 0} : *next;
  const double depth = from.depth + (at - from.s) / (to.s - from.s) * (to.depth - from.depth);
  return options.diameter / 2 - options.clearance - depth * thread_depth(options);
}

double thread_gap(const FastenerOptions& options) {
  validate(options);
  // A segment from bolt to nut shorter than the clearance stays outside of this radius.
  const double root = options.diameter / 2 - options.clearance - thread_depth(options);
  const double radius = root * std::cos(kPi / options.facets) - options.clearance / 2;
  const double lead = options.pitch / (2 * kPi * radius), slope = std::sqrt(3.0);
  return options.clearance / std::sqrt(1 + slope * slope * (1 + lead * lead));
}

}  // namespace aussois
