// SPDX-License-Identifier: Apache-2.0
#include "lmd/region_offset.hpp"

#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include <Eigen/Geometry>

#include "geometry/polygon.hpp"

namespace aussois {
namespace {

struct BorderStep {
  int vertex = 0, edge = 0;  // of the wavefront; the edge to the next vertex
};
using Loop = std::vector<BorderStep>;

// The borders of each region, with the region on the left.
std::vector<std::vector<Loop>> borders(const Wavefront& wave, std::size_t region_count) {
  std::vector<std::vector<Loop>> all(region_count);
  std::vector<std::vector<char>> seen(wave.vertices.size());
  for (std::size_t v = 0; v < seen.size(); ++v) seen[v].assign(wave.vertices[v].sectors.size(), 0);
  for (int v = 0; v < int(seen.size()); ++v)
    for (int s = 0; wave.vertices[v].alive && s < int(seen[v].size()); ++s) {
      Loop loop;
      for (int at = v, i = s; !seen[at][i];) {
        seen[at][i] = 1;
        const int e = wave.vertices[at].sectors[i].edge;
        loop.push_back({at, e});
        at = across(wave.edges[e], at);
        const WaveVertex& next = wave.vertices[at];
        const int count = int(next.sectors.size());
        i = (sector_of(next, e) + count - 1) % count;
      }
      const int region = wave.vertices[v].sectors[s].region;
      if (loop.size() > 2) all[region].push_back(std::move(loop));
    }
  return all;
}

bool holds(const std::vector<Vec2>& points, const std::vector<int>& loop, const Vec2& x) {
  bool odd = false;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec2 &a = points[loop[i]], &b = points[loop[(i + 1) % loop.size()]];
    if ((a.y() > x.y()) != (b.y() > x.y()) &&
        x.x() < a.x() + (x.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
      odd = !odd;
  }
  return odd;
}

// Where the corners of the solid's triangles go: to vertices of the wavefront, numbered as there, and behind
// them one for each fan, for those inside a chain, which move by shares of what its ends move, and inside a
// region.
struct Places {
  std::vector<Vec3> points{};
  std::vector<std::array<int, 3>> of_corner{};  // of each triangle; -1: none, or several
  std::vector<std::vector<int>> inside{};       // each edge of the wavefront, in its direction
};

// The chain inside which a fan lies; -1: none.
int chain_around(const SimplicialComplex& solid, const Idealisation& ideal, const Fan& fan) {
  const auto chain_at = [&](const Corner& c) {
    return ideal.edge_chain[solid.triangle_edges[c.triangle][c.side]];
  };
  if (fan.regions.size() != 2) return -1;
  const int chain = chain_at(fan.first[0]);
  return chain == chain_at(fan.first[1]) ? chain : -1;
}

Vec3 moved_with_chain(const SimplicialComplex& solid, const Chain& chain, const Wavefront& wave,
                      const WaveEdge& edge, const Vec3& x) {
  const Vec3 &first = solid.vertices[chain.first], &last = solid.vertices[chain.last];
  const double share = chain.direction.dot(x - first) / (last - first).norm();
  return x + (1 - share) * (wave.vertices[edge.ends[0]].to - first) +
         share * (wave.vertices[edge.ends[1]].to - last);
}

Places find_places(const SimplicialComplex& solid, const Idealisation& ideal, const std::vector<Fan>& fans,
                   const Wavefront& wave, double depth) {
  const std::size_t count = wave.vertices.size();
  Places out{.points = std::vector<Vec3>(count + fans.size(), Vec3::Zero()),
             .of_corner = std::vector<std::array<int, 3>>(solid.triangles.size(), {-1, -1, -1}),
             .inside = std::vector<std::vector<int>>(wave.edges.size())};
  std::vector<std::vector<int>> of_fan(fans.size());
  for (std::size_t w = 0; w < count; ++w) {
    out.points[w] = wave.vertices[w].to;
    if (!wave.vertices[w].alive) continue;
    for (int f : wave.vertices[w].fans) of_fan[f].push_back(int(w));
  }
  std::map<std::pair<int, int>, int> in_chain;  // by chain and vertex
  for (std::size_t f = 0; f < fans.size(); ++f) {
    const Fan& fan = fans[f];
    const Vec3& x = solid.vertices[fan.vertex];
    int own = -1;
    if (fan.regions.size() == 1) {
      own = int(count + f);
      out.points[count + f] = x - depth * ideal.region_normal[fan.regions[0]];
    } else if (const int c = chain_around(solid, ideal, fan); c >= 0) {
      const WaveEdge& edge = wave.edges[c];
      if (edge.alive && edge.chain == c) {
        own = in_chain[{c, fan.vertex}] = int(count + f);
        out.points[count + f] = moved_with_chain(solid, ideal.chains[c], wave, edge, x);
      }
    }
    for (const int r : fan.regions) {
      int place = own, found = 0;
      for (int w : of_fan[f])
        if (std::ranges::count(wave.vertices[w].sectors, r, &WaveSector::region) > 0)
          place = ++found == 1 ? w : -1;
      for (const Corner& c : fan.round)
        if (ideal.triangle_region[c.triangle] == r) out.of_corner[c.triangle][c.side] = place;
    }
  }
  for (std::size_t c = 0; c < ideal.chains.size(); ++c)
    for (int v : vertices_of(ideal, int(c)))
      if (const auto at = in_chain.find({int(c), v}); at != in_chain.end())
        out.inside[c].push_back(at->second);
  return out;
}

// The triangles of a region where they have moved; none if one has lost a corner or does not stay upright.
std::optional<std::vector<std::array<int, 3>>> moved_face(const Places& places,
                                                          const std::vector<int>& triangles, const Vec3& n) {
  std::vector<std::array<int, 3>> faces;
  for (int t : triangles) {
    const std::array<int, 3>& corners = places.of_corner[t];
    if (std::ranges::min(corners) < 0) return std::nullopt;
    const auto x = [&](std::size_t i) { return places.points[corners[i]]; };
    if (!((x(1) - x(0)).cross(x(2) - x(0)).dot(n) > 0)) return std::nullopt;
    faces.push_back(corners);
  }
  return faces;
}

// Triangles of a region between its borders: of each outer one with the holes that it holds.
std::optional<std::vector<std::array<int, 3>>> cut_face(const Wavefront& wave, const Places& places,
                                                        const Vec3& n, const std::vector<Loop>& loops) {
  const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
  const Vec3 origin = wave.vertices[loops[0][0].vertex].to;
  std::vector<Vec2> points;
  std::vector<int> vertex;
  std::vector<std::vector<int>> outer, holes;
  for (const Loop& loop : loops) {
    std::vector<int> indices;
    const auto add = [&](int p) {
      const Vec3 x = places.points[p] - origin;
      indices.push_back(int(points.size()));
      points.emplace_back(u.dot(x), v.dot(x));
      vertex.push_back(p);
    };
    for (const auto& [w, e] : loop) {
      add(w);
      const std::vector<int>& inside = places.inside[e];
      if (wave.edges[e].ends[0] == w)
        std::for_each(inside.begin(), inside.end(), add);
      else
        std::for_each(inside.rbegin(), inside.rend(), add);
    }
    (twice_area(points, indices) > 0 ? outer : holes).push_back(std::move(indices));
  }
  if (outer.empty()) return std::nullopt;
  std::vector<std::array<int, 3>> faces;
  std::size_t held = 0;
  for (const std::vector<int>& border : outer) {
    std::vector<std::vector<int>> group{border};
    for (const std::vector<int>& hole : holes)
      if (outer.size() == 1 || holds(points, border, points[hole[0]])) group.push_back(hole);
    held += group.size() - 1;
    const std::optional<std::vector<std::array<int, 3>>> part = triangulate(points, group);
    if (!part) return std::nullopt;
    for (const auto& [a, b, c] : *part) {
      const std::array<int, 3> corners{vertex[a], vertex[b], vertex[c]};
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])
        return std::nullopt;  // the border touches itself
      faces.push_back(corners);
    }
  }
  if (held != holes.size()) return std::nullopt;
  return faces;
}

bool cross_each_other(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  return (cross(b - a, c - a) > 0) != (cross(b - a, d - a) > 0) &&
         (cross(d - c, a - c) > 0) != (cross(d - c, b - c) > 0);
}

using Crossings = std::vector<std::array<std::vector<int>, 2>>;

// Where the borders of a region cross, in the order of the borders, which does not depend on the frame.
Crossings crossings(const Wavefront& wave, const Vec3& n, const std::vector<Loop>& loops) {
  const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
  const Vec3 origin = wave.vertices[loops[0][0].vertex].to;
  struct Side {
    int index = 0, from = 0, to = 0;  // of the side, and vertices
    Vec2 a = Vec2::Zero(), b = Vec2::Zero();
  };
  std::vector<Side> sides;
  for (const Loop& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const int from = loop[i].vertex, to = loop[(i + 1) % loop.size()].vertex;
      const Vec3 a = wave.vertices[from].to - origin, b = wave.vertices[to].to - origin;
      sides.push_back({int(sides.size()), from, to, {u.dot(a), v.dot(a)}, {u.dot(b), v.dot(b)}});
    }
  std::vector<Side> by_x = sides;
  const auto least = [](const Side& s) { return std::min(s.a.x(), s.b.x()); };
  std::ranges::stable_sort(by_x, {}, least);
  std::vector<std::pair<int, int>> pairs;
  for (auto s = by_x.begin(); s != by_x.end(); ++s)
    for (auto t = s + 1; t != by_x.end() && least(*t) <= std::max(s->a.x(), s->b.x()); ++t)
      if (s->from != t->to && s->to != t->from && cross_each_other(s->a, s->b, t->a, t->b))
        pairs.push_back(std::minmax(s->index, t->index));
  std::ranges::sort(pairs);
  Crossings out;
  for (const auto& [i, j] : pairs) {
    const Side &s = sides[i], &t = sides[j];
    out.push_back({std::vector{s.from, s.to}, std::vector{t.from, t.to}});
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
      if (ideal.region_normal[a.region].dot(ideal.region_normal[b.region]) < -kCos20) return true;
  return false;
}

Failure lost_edge(const SimplicialComplex& k, const Idealisation& ideal, const Chain& chain) {
  std::ostringstream text;
  const Vec3 &a = k.vertices[chain.first], &b = k.vertices[chain.last];
  text << "the edge of length " << (b - a).norm() << " m at vertex " << chain.first << " would vanish";
  Failure failure{ErosionStatus::lost_edge, 0.5 * (a + b), text.str(), {}};
  for (int t : k.edge_triangles[edges_of(ideal, chain).front()])
    failure.regions.push_back(ideal.triangle_region[t]);
  return failure;
}

std::optional<Failure> unsettled(const Wavefront& wave, const std::vector<Fan>& fans,
                                 const Idealisation& ideal, const std::vector<std::vector<Loop>>& loops,
                                 const ErosionOptions& options) {
  std::optional<Failure> failure;
  std::vector<std::optional<Crossings>> crossed(loops.size());
  for (int i = 0; i < int(wave.vertices.size()); ++i) {
    const WaveVertex& v = wave.vertices[i];
    if (!v.alive || v.deviation <= std::max(options.meet, options.deviation) * (1 + 1e-9)) continue;
    if (!failure) {
      std::ostringstream text;
      text << "the " << v.sectors.size() << " planes ";
      if (v.fans.size() > 1)
        text << "around " << v.fans.size() << " vertices that would merge, near ";
      else
        text << "at ";
      text << "vertex " << fans[v.fans[0]].vertex << (v.fans.size() > 1 ? "," : "")
           << " do not meet when moved, and no split is simple";
      failure = Failure{ErosionStatus::unsettled_vertex, v.from, text.str()};
    }
    std::vector<int> neighbours;
    const std::size_t before = failure->crossing.size();
    for (const WaveSector& s : v.sectors) {
      failure->regions.push_back(s.region);
      neighbours.push_back(across(wave.edges[s.edge], i));
      const auto r = std::size_t(s.region);
      if (loops[r].empty()) continue;
      if (!crossed[r]) crossed[r] = crossings(wave, ideal.region_normal[r], loops[r]);
      failure->crossing.insert(failure->crossing.end(), crossed[r]->begin(), crossed[r]->end());
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
    const int chain = out.wave.edges[out.wave.events[0]].chain;
    out.failure = lost_edge(solid, ideal, ideal.chains[std::max(chain, 0)]);
    return out;
  }
  const auto loops = borders(out.wave, ideal.region_normal.size());
  if ((out.failure = unsettled(out.wave, fans, ideal, loops, options))) return out;
  const Places places = find_places(solid, ideal, fans, out.wave, options.depth);
  std::vector<std::vector<int>> of_region(loops.size());  // triangles
  for (std::size_t t = 0; t < solid.triangles.size(); ++t)
    of_region[ideal.triangle_region[t]].push_back(int(t));
  std::vector<int> index(places.points.size(), -1);
  for (std::size_t r = 0; r < loops.size(); ++r) {
    if (loops[r].empty()) continue;  // it has vanished
    const Vec3& n = ideal.region_normal[r];
    const Crossings crossed = crossings(out.wave, n, loops[r]);
    auto faces = crossed.empty() ? moved_face(places, of_region[r], n) : std::nullopt;
    if (!faces) faces = cut_face(out.wave, places, n, loops[r]);
    if (!faces) {
      if (!out.failure)
        out.failure = Failure{ErosionStatus::lost_face, places.points[loops[r][0][0].vertex],
                              "region " + std::to_string(r) + " would turn over or cross its own border"};
      out.failure->regions.push_back(int(r));
      out.failure->crossing.insert(out.failure->crossing.end(), crossed.begin(), crossed.end());
      continue;
    }
    for (std::array<int, 3> corners : *faces) {
      for (int& corner : corners) {
        int& i = index[corner];
        if (i < 0) {
          i = int(out.vertices.size());
          out.wave_vertex.push_back(corner < int(out.wave.vertices.size()) ? corner : -1);
          out.vertices.push_back(places.points[corner]);
        }
        corner = i;
      }
      out.triangles.push_back(corners);
      out.triangle_region.push_back(int(r));
    }
  }
  return out;
}

bool join_crossing(const Failure& failure, const Idealisation& ideal, const Wavefront& wave,
                   FanOptions& of_fan) {
  const auto groups = [&](int v, int w) {
    std::set<int> all;
    for (int x : {v, w})
      for (int f : wave.vertices[x].fans) all.insert(of_fan.group[f]);
    return all;
  };
  bool any = false;
  for (const auto& [first, second] : failure.crossing) {
    std::set<int> nearest;
    double least = kInf;
    for (int v : first)
      for (int w : second) {
        const double way = (wave.vertices[v].from - wave.vertices[w].from).norm();
        if (way >= least || is_wall(ideal, wave.vertices[v], wave.vertices[w])) continue;
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
      const int along = solid.triangles[c.triangle][std::size_t(c.side + 1) % 3];
      const Vec3 spoke = solid.vertices[along] - solid.vertices[fan.vertex];
      planes.push_back({ideal.region_normal[fan.regions[s]], spoke.stableNormalized(), -1});
    }
    if (!mitre(planes, {options.meet, options.deviation, false})) continue;
    of_fan.whole[i] = 1;
    any = true;
  }
  return any;
}

}  // namespace aussois
