// SPDX-License-Identifier: Apache-2.0
#include "lmd/region_offset.hpp"

#include <cmath>
#include <set>
#include <sstream>

#include <Eigen/Geometry>

#include "geometry/polygon.hpp"

namespace aussois {
namespace {

using Loop = std::vector<int>;  // of vertices of the wavefront

// The borders of each region, with the region on the left.
std::vector<std::vector<Loop>> borders(const Wavefront& wave, std::size_t region_count) {
  std::vector<std::vector<Loop>> all(region_count);
  std::vector<std::vector<char>> seen(wave.vertices.size());
  for (std::size_t v = 0; v < seen.size(); ++v) seen[v].assign(wave.vertices[v].sectors.size(), 0);
  for (int v = 0; v < int(seen.size()); ++v)
    for (int s = 0; wave.vertices[std::size_t(v)].alive && s < int(seen[std::size_t(v)].size()); ++s) {
      Loop loop;
      for (int at = v, i = s; !seen[std::size_t(at)][std::size_t(i)];) {
        seen[std::size_t(at)][std::size_t(i)] = 1;
        loop.push_back(at);
        const int e = wave.vertices[std::size_t(at)].sectors[std::size_t(i)].edge;
        at = across(wave.edges[std::size_t(e)], at);
        const WaveVertex& next = wave.vertices[std::size_t(at)];
        const int count = int(next.sectors.size());
        i = (sector_of(next, e) + count - 1) % count;
      }
      const int region = wave.vertices[std::size_t(v)].sectors[std::size_t(s)].region;
      if (loop.size() > 2) all[std::size_t(region)].push_back(std::move(loop));
    }
  return all;
}

bool holds(const std::vector<Vec2>& points, const std::vector<int>& loop, const Vec2& x) {
  bool odd = false;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 &a = points[std::size_t(loop[i])], &b = points[std::size_t(loop[(i + 1) % loop.size()])];
    if ((a.y() > x.y()) != (b.y() > x.y()) &&
        x.x() < a.x() + (x.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      odd = !odd;
  }
  return odd;
}

// Triangles of a region between its borders: of each outer one with the holes that it holds.
std::optional<std::vector<std::array<int, 3>>> cut_face(const Wavefront& wave, const Vec3& n,
                                                        const std::vector<Loop>& loops) {
  const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
  const Vec3 origin = wave.vertices[std::size_t(loops[0][0])].to;
  std::vector<Vec2> points;
  std::vector<int> vertex;
  std::vector<std::vector<int>> outer, holes;
  for (const Loop& loop : loops) {
    std::vector<int> indices;
    for (int w : loop) {
      const Vec3 x = wave.vertices[std::size_t(w)].to - origin;
      indices.push_back(int(points.size()));
      points.emplace_back(u.dot(x), v.dot(x));
      vertex.push_back(w);
    }
    (twice_area(points, indices) > 0 ? outer : holes).push_back(std::move(indices));
  }
  if (outer.empty()) return std::nullopt;
  std::vector<std::array<int, 3>> faces;
  std::size_t held = 0;
  for (const std::vector<int>& border : outer) {
    std::vector<std::vector<int>> group{border};
    for (const std::vector<int>& hole : holes)
      if (outer.size() == 1 || holds(points, border, points[std::size_t(hole[0])])) group.push_back(hole);
    held += group.size() - 1;
    const std::optional<std::vector<std::array<int, 3>>> part = triangulate(points, group);
    if (!part) return std::nullopt;
    for (const auto& [a, b, c] : *part) {
      const std::array<int, 3> corners{vertex[std::size_t(a)], vertex[std::size_t(b)],
                                       vertex[std::size_t(c)]};
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
        return std::nullopt;  // the border touches itself
      faces.push_back(corners);
    }
  }
  if (held != holes.size()) return std::nullopt;
  return faces;
}

double cross(const Vec2& a, const Vec2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

bool cross_each_other(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  return (cross(b - a, c - a) > 0) != (cross(b - a, d - a) > 0) &&
         (cross(d - c, a - c) > 0) != (cross(d - c, b - c) > 0);
}

// Where the borders of a region cross.
std::vector<std::array<std::vector<int>, 2>> crossings(const Wavefront& wave, const Vec3& n,
                                                       const std::vector<Loop>& loops) {
  const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
  const Vec3 origin = wave.vertices[std::size_t(loops[0][0])].to;
  const auto at = [&](int w) {
    const Vec3 x = wave.vertices[std::size_t(w)].to - origin;
    return Vec2(u.dot(x), v.dot(x));
  };
  std::vector<std::array<int, 2>> sides;
  std::vector<std::array<std::vector<int>, 2>> out;
  for (const Loop& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i) sides.push_back({loop[i], loop[(i + 1) % loop.size()]});
  for (std::size_t i = 0; i < sides.size(); ++i)
    for (std::size_t j = i + 1; j < sides.size(); ++j) {
      const auto& [a, b] = sides[i];
      const auto& [c, d] = sides[j];
      if (a == d || b == c || !cross_each_other(at(a), at(b), at(c), at(d))) continue;
      out.push_back({std::vector{a, b}, std::vector{c, d}});
    }
  return out;
}

// Planes at these two vertices bound a wall: they are within 20 degrees of opposite. Where such planes meet,
// something thinner than twice the depth would vanish.
bool is_wall(const Idealisation& ideal, const WaveVertex& v, const WaveVertex& w) {
  constexpr double kCos20 = 0.9396926207859084;
  std::vector<WaveSector> all = v.sectors;
  all.insert(all.end(), w.sectors.begin(), w.sectors.end());
  for (const WaveSector& a : all)
    for (const WaveSector& b : all)
      if (ideal.region_normal[std::size_t(a.region)].dot(ideal.region_normal[std::size_t(b.region)]) <
          -kCos20)
        return true;
  return false;
}

Failure lost_edge(const SimplicialComplex& k, const Idealisation& ideal, const Chain& chain) {
  std::ostringstream text;
  const Vec3 &a = k.vertices[std::size_t(chain.first)], &b = k.vertices[std::size_t(chain.last)];
  text << "the edge of length " << (b - a).norm() << " m at vertex " << chain.first << " would vanish";
  Failure failure{ErosionStatus::lost_edge, 0.5 * (a + b), text.str(), {}};
  for (int t : k.edge_triangles[chain.edges.front()])
    failure.regions.push_back(ideal.triangle_region[std::size_t(t)]);
  return failure;
}

std::optional<Failure> unsettled(const Wavefront& wave, const std::vector<Fan>& fans,
                                 const Idealisation& ideal, const std::vector<std::vector<Loop>>& loops,
                                 const ErosionOptions& options) {
  std::optional<Failure> failure;
  for (int i = 0; i < int(wave.vertices.size()); ++i) {
    const WaveVertex& v = wave.vertices[std::size_t(i)];
    if (!v.alive || v.deviation <= std::max(options.meet, options.deviation) * (1 + 1e-9)) continue;
    if (!failure) {
      std::ostringstream text;
      text << "the " << v.sectors.size() << " planes ";
      if (v.fans.size() > 1)
        text << "around " << v.fans.size() << " vertices that would merge, near ";
      else
        text << "at ";
      text << "vertex " << fans[std::size_t(v.fans[0])].vertex << (v.fans.size() > 1 ? "," : "")
           << " do not meet when moved, and no split is simple";
      failure = Failure{ErosionStatus::unsettled_vertex, v.from, text.str()};
    }
    std::vector<int> neighbours;
    const std::size_t before = failure->crossing.size();
    for (const WaveSector& s : v.sectors) {
      failure->regions.push_back(s.region);
      neighbours.push_back(across(wave.edges[std::size_t(s.edge)], i));
      if (const auto& of_region = loops[std::size_t(s.region)]; !of_region.empty())
        for (const auto& pair : crossings(wave, ideal.region_normal[std::size_t(s.region)], of_region))
          failure->crossing.push_back(pair);
    }
    if (failure->crossing.size() == before) failure->crossing.push_back({std::vector{i}, neighbours});
  }
  return failure;
}

}  // namespace

RegionOffset offset_regions(const SimplicialComplex& solid, const Idealisation& ideal,
                            const std::vector<Fan>& fans, const FanOptions& of_fan,
                            const ErosionOptions& options, double together) {
  RegionOffset out{
      .wave = move_planes(solid, ideal, fans, of_fan,
                          {options.depth, options.meet, options.deviation, options.split, together})};
  if (!options.contract && !out.wave.events.empty()) {
    const int chain = out.wave.edges[std::size_t(out.wave.events[0])].chain;
    out.failure = lost_edge(solid, ideal, ideal.chains[std::size_t(std::max(chain, 0))]);
    return out;
  }
  const auto loops = borders(out.wave, ideal.region_normal.size());
  if ((out.failure = unsettled(out.wave, fans, ideal, loops, options))) return out;
  std::vector<int> index(out.wave.vertices.size(), -1);
  for (int r = 0; r < int(loops.size()); ++r) {
    const auto& of_region = loops[std::size_t(r)];
    if (of_region.empty()) continue;  // it has vanished
    const auto faces = cut_face(out.wave, ideal.region_normal[std::size_t(r)], of_region);
    if (!faces) {
      if (!out.failure)
        out.failure = Failure{ErosionStatus::lost_face, out.wave.vertices[std::size_t(of_region[0][0])].to,
                              "region " + std::to_string(r) + " would turn over or cross its own border"};
      out.failure->regions.push_back(r);
      for (const auto& pair : crossings(out.wave, ideal.region_normal[std::size_t(r)], of_region))
        out.failure->crossing.push_back(pair);
      continue;
    }
    for (std::array<int, 3> corners : *faces) {
      for (int& corner : corners) {
        int& i = index[std::size_t(corner)];
        if (i < 0) {
          i = int(out.vertices.size());
          out.wave_vertex.push_back(corner);
          out.vertices.push_back(out.wave.vertices[std::size_t(corner)].to);
        }
        corner = i;
      }
      out.triangles.push_back(corners);
      out.triangle_region.push_back(r);
    }
  }
  return out;
}

bool join_crossing(const Failure& failure, const Idealisation& ideal, const Wavefront& wave,
                   FanOptions& of_fan) {
  const auto groups = [&](int v, int w) {
    std::set<int> all;
    for (int x : {v, w})
      for (int f : wave.vertices[std::size_t(x)].fans) all.insert(of_fan.group[std::size_t(f)]);
    return all;
  };
  bool any = false;
  for (const auto& [first, second] : failure.crossing) {
    std::set<int> nearest;
    double least = kInf;
    for (int v : first)
      for (int w : second) {
        const double way = (wave.vertices[std::size_t(v)].from - wave.vertices[std::size_t(w)].from).norm();
        if (way >= least || is_wall(ideal, wave.vertices[std::size_t(v)], wave.vertices[std::size_t(w)]))
          continue;
        if (const std::set<int> both = groups(v, w); both.size() > 1) least = way, nearest = both;
      }
    for (int from : nearest)
      if (from != *nearest.begin()) std::ranges::replace(of_fan.group, from, *nearest.begin());
    any |= !nearest.empty();
  }
  return any;
}

bool keep_whole(const SimplicialComplex& solid, const Idealisation& ideal, const std::vector<Fan>& fans,
                const std::vector<int>& regions, const ErosionOptions& options, FanOptions& of_fan) {
  bool any = false;
  for (std::size_t i = 0; i < fans.size(); ++i) {
    const Fan& fan = fans[i];
    const auto near = [&](int r) { return std::ranges::find(regions, r) != regions.end(); };
    if (of_fan.whole[i] || fan.regions.size() < 4 || std::ranges::none_of(fan.regions, near)) continue;
    std::vector<VertexPlane> planes;
    for (std::size_t s = 0; s < fan.regions.size(); ++s) {
      const Corner& c = fan.first[s];
      const int along = solid.triangles[std::size_t(c.triangle)][std::size_t(c.side + 1) % 3];
      const Vec3 spoke = solid.vertices[std::size_t(along)] - solid.vertices[std::size_t(fan.vertex)];
      planes.push_back({ideal.region_normal[std::size_t(fan.regions[s])], spoke.stableNormalized(), -1});
    }
    if (!mitre(planes, {options.meet, options.deviation, false})) continue;
    of_fan.whole[i] = 1;
    any = true;
  }
  return any;
}

}  // namespace aussois
