// SPDX-License-Identifier: Apache-2.0
// Moves the planes of a solid's regions inwards and its vertices to where they then meet, splitting and
// merging vertices (ERO-1) to (ERO-4): one attempt of an erosion.
#pragma once

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <Eigen/Geometry>

#include "geometry/polygon.hpp"
#include "lmd/erosion.hpp"
#include "lmd/mitre.hpp"

namespace aussois {

struct Corner {
  int triangle = -1, side = 0;  // the corner from which this side of the triangle starts
};

/// One round of triangles about a vertex, counter-clockwise, and the regions in it. A vertex where several
/// rounds touch has as many fans; they part when eroded.
struct Fan {
  int vertex = 0;
  std::vector<int> regions{};
  std::vector<Corner> first{};  // the first triangle of each region; its side is the edge to the one before
};

/// The fans that become one set of moved vertices: one fan, or several if edges between them would vanish.
struct Cluster {
  std::vector<int> fans{};
  Vec3 origin = Vec3::Zero();  // of the planes [m]
  std::vector<VertexPlane> planes{};
  Mitre mitre{};
  int base = 0;        // index of its first eroded vertex
  bool whole = false;  // not to be split
};

struct Stars {
  std::vector<Fan> fans{};
  std::vector<std::array<int, 3>> fan{}, sector{};  // of each corner of each triangle
};

inline int other_triangle(const SimplicialComplex& k, int edge, int t) {
  const auto both = k.edge_triangles[edge];
  return both[0] == t ? both[1] : both[0];
}

inline std::size_t corner_at(const SimplicialComplex& k, int t, int vertex) {
  const auto& v = k.triangles[std::size_t(t)];
  return std::size_t(std::find(v.begin(), v.end(), vertex) - v.begin());
}

inline Stars find_stars(const SimplicialComplex& k, const Idealisation& ideal) {
  Stars out;
  out.fan.assign(k.triangles.size(), {-1, -1, -1});
  out.sector.assign(k.triangles.size(), {0, 0, 0});
  const auto region = [&](const Corner& c) { return ideal.triangle_region[std::size_t(c.triangle)]; };
  for (int v = 0; v < int(k.vertices.size()); ++v)
    for (int t : k.vertex_triangles[v]) {
      std::size_t side = corner_at(k, t, v);
      if (out.fan[std::size_t(t)][side] >= 0) continue;
      std::vector<Corner> round;
      for (int at = t; out.fan[std::size_t(at)][side] < 0; side = corner_at(k, at, v)) {
        out.fan[std::size_t(at)][side] = int(out.fans.size());
        round.push_back({at, int(side)});
        at = other_triangle(k, k.triangle_edges[std::size_t(at)][(side + 2) % 3], at);
      }
      const std::size_t n = round.size();
      for (std::size_t i = 0; i < n; ++i)
        if (region(round[i]) != region(round[(i + n - 1) % n])) {
          std::rotate(round.begin(), round.begin() + long(i), round.end());
          break;
        }
      Fan fan{.vertex = v};
      for (std::size_t i = 0; i < n; ++i) {
        const auto c = std::size_t(round[i].triangle);
        if (i == 0 || region(round[i]) != region(round[i - 1])) {
          fan.regions.push_back(region(round[i]));
          fan.first.push_back(round[i]);
        }
        out.sector[c][std::size_t(round[i].side)] = int(fan.regions.size()) - 1;
      }
      out.fans.push_back(std::move(fan));
    }
  return out;
}

/// What stopped the attempt.
struct Failure {
  ErosionStatus status = ErosionStatus::done;
  Vec3 place = Vec3::Zero();
  std::string what{};
  std::vector<int> regions{};  // whose vertices may be tried unsplit
};

/// Attempts: positions, then faces; what an attempt shows to vanish is contracted in the next.
class Erosion {
 public:
  Erosion(const SimplicialComplex& solid, const Idealisation& ideal, const ErosionOptions& options)
      : k_(solid), ideal_(ideal), options_(options), stars_(find_stars(solid, ideal)) {
    of_region_.resize(ideal.region_normal.size());
    for (std::size_t t = 0; t < k_.triangles.size(); ++t)
      of_region_[std::size_t(ideal.triangle_region[t])].push_back(int(t));
    whole_.assign(stars_.fans.size(), 0);
    reset_clusters();
  }

  std::optional<Failure> attempt() {
    for (;;) {
      vertices.clear();
      triangles.clear();
      triangle_region.clear();
      if (auto failure = move_vertices()) return failure;
      const std::vector<int> lost = move_chains();
      if (lost.empty()) break;
      if (!options_.contract) return lost_edge(lost[0]);
      for (int c : lost) contract(ideal_.chains[std::size_t(c)]);
    }
    for (int r = 0; r < int(of_region_.size()); ++r)
      if (auto failure = make_faces(r)) return failure;
    all_ = vertices;
    drop_unused();
    return std::nullopt;
  }

  /// Around these regions takes back splits and contractions of vertices that may deviate instead; false if
  /// there are none.
  bool join_again(const std::vector<int>& regions) {
    bool any = false;
    for (std::size_t i = 0; i < stars_.fans.size(); ++i) {
      const Fan& fan = stars_.fans[i];
      const auto near = [&](int r) { return std::ranges::count(regions, r) > 0; };
      if (whole_[i] || fan.regions.size() < 4 || std::ranges::none_of(fan.regions, near)) continue;
      if (!mitre(star_planes(fan), {options_.meet, options_.deviation, false})) continue;
      whole_[i] = 1;
      any = true;
    }
    if (any) reset_clusters();
    return any;
  }

  const std::vector<Cluster>& clusters() const { return clusters_; }
  const Fan& fan(int index) const { return stars_.fans[std::size_t(index)]; }
  bool contracted(const Chain& chain) const {
    return cluster_at(chain.first, chain.edges.front()) == cluster_at(chain.last, chain.edges.back());
  }
  /// Eroded ends of a chain that is not contracted, in its direction.
  std::array<Vec3, 2> chain_ends(const Chain& chain) const {
    return {all_[std::size_t(end_of(chain.first, chain.edges.front()))],
            all_[std::size_t(end_of(chain.last, chain.edges.back()))]};
  }

  std::vector<Vec3> vertices{};
  std::vector<std::array<int, 3>> triangles{};
  std::vector<int> triangle_region{};

 private:
  struct Place {
    int fan = 0, sector = 0;
  };

  const Vec3& x(int vertex) const { return k_.vertices[std::size_t(vertex)]; }
  Place place(const Corner& c) const {
    return {stars_.fan[std::size_t(c.triangle)][std::size_t(c.side)],
            stars_.sector[std::size_t(c.triangle)][std::size_t(c.side)]};
  }
  const Cluster& cluster(const Place& p) const {
    return clusters_[std::size_t(cluster_of_fan_[std::size_t(p.fan)])];
  }
  // Of the cluster's planes; -1: the region is swallowed by the cluster.
  int plane(const Place& p) const { return plane_of_[std::size_t(p.fan)][std::size_t(p.sector)]; }
  // Empty if the region is swallowed.
  const std::vector<int>& path(const Place& p) const {
    static const std::vector<int> none;
    return plane(p) < 0 ? none : cluster(p).mitre.of_plane[std::size_t(plane(p))];
  }
  // The sector on the other side of the edge along which sector `p` begins, at the edge's other end.
  Place across(const Place& p) const {
    const Corner& c = stars_.fans[std::size_t(p.fan)].first[std::size_t(p.sector)];
    const auto t = std::size_t(c.triangle), side = std::size_t(c.side);
    const int other = other_triangle(k_, k_.triangle_edges[t][side], c.triangle);
    return place({other, int(corner_at(k_, other, k_.triangles[t][(side + 1) % 3]))});
  }
  VertexPlane plane_at(const Place& p, const Vec3& origin) const {
    const Fan& f = stars_.fans[std::size_t(p.fan)];
    const Corner& c = f.first[std::size_t(p.sector)];
    const Vec3& n = ideal_.region_normal[std::size_t(f.regions[std::size_t(p.sector)])];
    const int along = k_.triangles[std::size_t(c.triangle)][std::size_t(c.side + 1) % 3];
    return {n, (x(along) - x(f.vertex)).stableNormalized(), n.dot(x(f.vertex) - origin) / options_.depth - 1};
  }
  std::vector<VertexPlane> star_planes(const Fan& f) const {
    std::vector<VertexPlane> planes;
    const int index = int(&f - stars_.fans.data());
    for (int s = 0; s < int(f.regions.size()); ++s) planes.push_back(plane_at({index, s}, x(f.vertex)));
    return planes;
  }

  void reset_clusters() {
    clusters_.clear();
    cluster_of_fan_.clear();
    plane_of_.clear();
    for (std::size_t i = 0; i < stars_.fans.size(); ++i) {
      const Fan& f = stars_.fans[i];
      cluster_of_fan_.push_back(int(i));
      std::vector<int> all(f.regions.size());
      std::iota(all.begin(), all.end(), 0);
      plane_of_.push_back(std::move(all));
      clusters_.push_back(
          {.fans = {int(i)}, .origin = x(f.vertex), .planes = star_planes(f), .whole = whole_[i] != 0});
    }
    todo_.assign(clusters_.size(), 1);
  }

  // Puts the fans along a chain into one cluster; the planes around it are found by walking along its rim.
  void contract(const Chain& chain) {
    int into = -1;
    for (std::size_t i = 0; i < chain.vertices.size(); ++i) {
      const int edge = chain.edges[std::min(i, chain.edges.size() - 1)];
      const int from = cluster_at(chain.vertices[i], edge);
      if (into < 0) into = from;
      if (from == into) continue;
      Cluster &a = clusters_[std::size_t(into)], &b = clusters_[std::size_t(from)];
      for (int f : b.fans) cluster_of_fan_[std::size_t(f)] = into;
      a.fans.insert(a.fans.end(), b.fans.begin(), b.fans.end());
      b = {};
    }
    walk_rim(clusters_[std::size_t(into)], into);
    todo_[std::size_t(into)] = 1;
  }

  void walk_rim(Cluster& c, int index) {
    c.planes.clear();
    c.whole = false;
    c.origin = Vec3::Zero();
    for (int f : c.fans) c.origin += x(stars_.fans[std::size_t(f)].vertex) / double(c.fans.size());
    const auto inside = [&](const Place& p) { return cluster_of_fan_[std::size_t(p.fan)] == index; };
    std::optional<Place> start;
    for (int f : c.fans) {
      auto& planes = plane_of_[std::size_t(f)];
      std::ranges::fill(planes, -1);
      for (int s = 0; s < int(planes.size()) && !start; ++s)
        if (!inside(across({f, s}))) start = Place{f, s};
    }
    if (!start) return;  // everything vanishes
    Place at = *start;
    do {
      const int number = int(c.planes.size());
      c.planes.push_back(plane_at(at, c.origin));
      for (;;) {
        plane_of_[std::size_t(at.fan)][std::size_t(at.sector)] = number;
        const auto count = int(stars_.fans[std::size_t(at.fan)].regions.size());
        const Place next{at.fan, (at.sector + 1) % count}, over = across(next);
        at = inside(over) ? over : next;
        if (!inside(over)) break;
      }
    } while (at.fan != start->fan || at.sector != start->sector);
  }

  std::optional<Failure> move_vertices() {
    for (std::size_t i = 0; i < clusters_.size(); ++i) {
      Cluster& c = clusters_[i];
      if (c.planes.empty()) continue;
      if (todo_[i]) {
        const std::optional<Mitre> m =
            mitre(c.planes, {options_.meet, options_.deviation, options_.split && !c.whole});
        if (!m) return unsettled(c);
        c.mitre = *m;
        todo_[i] = 0;
      }
      c.base = int(vertices.size());
      for (const Vec3& p : c.mitre.points) vertices.push_back(c.origin + options_.depth * p);
    }
    return std::nullopt;
  }

  Failure unsettled(const Cluster& c) const {
    std::ostringstream text;
    text << "the " << c.planes.size() << " planes ";
    if (c.fans.size() > 1)
      text << "around " << c.fans.size() << " vertices that would merge, near ";
    else
      text << "at ";
    text << "vertex " << stars_.fans[std::size_t(c.fans[0])].vertex << (c.fans.size() > 1 ? "," : "")
         << " do not meet when moved, and no split is simple";
    Failure failure{ErosionStatus::unsettled_vertex, c.origin, text.str(), {}};
    for (int f : c.fans)
      failure.regions.insert(failure.regions.end(), stars_.fans[std::size_t(f)].regions.begin(),
                             stars_.fans[std::size_t(f)].regions.end());
    return failure;
  }

  // The place at a vertex whose sector begins along a border edge that leaves the vertex.
  Place place_along(int vertex, int edge) const {
    for (int t : k_.edge_triangles[edge]) {
      const Corner c{t, int(corner_at(k_, t, vertex))};
      if (k_.triangle_edges[std::size_t(t)][std::size_t(c.side)] == edge) return place(c);
    }
    return {};  // not reached: both directions of an edge of a solid exist
  }
  int cluster_at(int vertex, int edge) const {
    return cluster_of_fan_[std::size_t(place_along(vertex, edge).fan)];
  }
  // The eroded vertex in which such an edge begins.
  int end_of(int vertex, int edge) const {
    const Place p = place_along(vertex, edge);
    return cluster(p).base + path(p).front();
  }

  // Vertices inside a chain keep their shares of its length, so none passes an end. Returns the chains that
  // would turn around.
  std::vector<int> move_chains() {
    std::vector<int> lost;
    all_ = vertices;
    for (std::size_t c = 0; c < ideal_.chains.size(); ++c) {
      const Chain& chain = ideal_.chains[c];
      if (contracted(chain)) continue;
      const std::array<Vec3, 2> ends = chain_ends(chain);
      const Vec3 before = x(chain.last) - x(chain.first), after = ends[1] - ends[0];
      if (!(after.dot(chain.direction) > 0)) lost.push_back(int(c));
      for (std::size_t i = 1; i + 1 < chain.vertices.size(); ++i) {
        const int index = end_of(chain.vertices[i], chain.edges[i]);
        const double share = chain.direction.dot(x(chain.vertices[i]) - x(chain.first)) / before.norm();
        vertices[std::size_t(index)] = ends[0] + share * after;
      }
    }
    all_ = vertices;
    return lost;
  }

  Failure lost_edge(int index) const {
    const Chain& chain = ideal_.chains[std::size_t(index)];
    std::ostringstream text;
    text << "the edge of length " << (x(chain.last) - x(chain.first)).norm() << " m at vertex " << chain.first
         << " would vanish";
    Failure failure{ErosionStatus::lost_edge, 0.5 * (x(chain.first) + x(chain.last)), text.str(), {}};
    for (int t : k_.edge_triangles[chain.edges.front()])
      failure.regions.push_back(ideal_.triangle_region[std::size_t(t)]);
    return failure;
  }

  std::optional<Failure> make_faces(int region) {
    const Vec3& n = ideal_.region_normal[std::size_t(region)];
    std::vector<std::array<int, 3>> moved;
    for (int t : of_region_[std::size_t(region)]) {
      std::array<int, 3> corners{};
      for (int side = 0; side < 3; ++side) {
        const Place p = place({t, side});
        if (path(p).size() != 1) return cut_face(region);
        corners[std::size_t(side)] = cluster(p).base + path(p)[0];
      }
      const auto& [a, b, c] = corners;
      const Vec3 &o = vertices[std::size_t(a)], &p = vertices[std::size_t(b)], &q = vertices[std::size_t(c)];
      if (!((p - o).cross(q - o).dot(n) > 0)) return cut_face(region);
      moved.push_back(corners);
    }
    append(moved, region);
    return std::nullopt;
  }

  void append(const std::vector<std::array<int, 3>>& faces, int region) {
    triangles.insert(triangles.end(), faces.begin(), faces.end());
    triangle_region.insert(triangle_region.end(), faces.size(), region);
  }

  bool on_border(const Corner& c) const {
    const int edge = k_.triangle_edges[std::size_t(c.triangle)][std::size_t(c.side)];
    return ideal_.triangle_region[std::size_t(other_triangle(k_, edge, c.triangle))] !=
           ideal_.triangle_region[std::size_t(c.triangle)];
  }

  // The region anew from its moved border: where vertices were split or merged, or inner ones were passed.
  std::optional<Failure> cut_face(int region) {
    const std::vector<int>& faces_before = of_region_[std::size_t(region)];
    const Vec3& n = ideal_.region_normal[std::size_t(region)];
    const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
    const Vec3 origin = x(k_.triangles[std::size_t(faces_before[0])][0]);
    const auto flat = [&](const Vec3& p) { return Vec2(u.dot(p - origin), v.dot(p - origin)); };
    std::vector<Vec2> before, after;
    std::vector<int> vertex;  // of the points in `after`
    std::vector<std::vector<int>> loops;
    bool simple = true;
    int outer = 0;
    for (const std::vector<Place>& border : borders(faces_before)) {
      std::vector<int> old_loop, loop;
      std::vector<std::array<int, 2>> stops;  // clusters on the way, with their plane
      for (const Place& p : border) {
        old_loop.push_back(int(before.size()));
        before.push_back(flat(x(stars_.fans[std::size_t(p.fan)].vertex)));
        const std::array<int, 2> stop{cluster_of_fan_[std::size_t(p.fan)], plane(p)};
        if (stop[1] >= 0 && (stops.empty() || stops.back() != stop)) stops.push_back(stop);
      }
      while (stops.size() > 1 && stops.front() == stops.back()) stops.pop_back();
      for (const auto& [c, plane] : stops) {
        const Cluster& at = clusters_[std::size_t(c)];
        const std::vector<int>& points = at.mitre.of_plane[std::size_t(plane)];
        for (auto p = points.rbegin(); p != points.rend(); ++p) {
          loop.push_back(int(after.size()));
          vertex.push_back(at.base + *p);
          after.push_back(flat(vertices[std::size_t(vertex.back())]));
        }
      }
      const bool is_outer = twice_area(before, old_loop) > 0;
      simple = simple && loop.size() > 2 && is_outer == (twice_area(after, loop) > 0);
      outer += is_outer;
      loops.insert(is_outer ? loops.begin() : loops.end(), std::move(loop));
    }
    if (after.empty()) return std::nullopt;  // the merged vertices have swallowed it
    if (simple && outer == 1)
      if (std::optional<std::vector<std::array<int, 3>>> faces = triangulate(after, loops)) {
        for (auto& corners : *faces)
          for (int& corner : corners) corner = vertex[std::size_t(corner)];
        append(*faces, region);
        return std::nullopt;
      }
    Vec3 centre = Vec3::Zero();
    for (const Vec2& p : before) centre += (u * p.x() + v * p.y()) / double(before.size());
    return Failure{ErosionStatus::lost_face,
                   origin + centre,
                   "region " + std::to_string(region) + " would turn over or cross its own border",
                   {region}};
  }

  // The places met on each way along the border of a region, given by its triangles, ascending.
  std::vector<std::vector<Place>> borders(const std::vector<int>& region) const {
    std::vector<std::array<char, 3>> seen(region.size(), {0, 0, 0});
    const auto mark = [&](const Corner& c) -> char& {
      const auto row = std::lower_bound(region.begin(), region.end(), c.triangle) - region.begin();
      return seen[std::size_t(row)][std::size_t(c.side)];
    };
    std::vector<std::vector<Place>> all;
    for (int t : region)
      for (int side = 0; side < 3; ++side) {
        if (mark({t, side}) || !on_border({t, side})) continue;
        all.emplace_back();
        for (Corner c{t, side}; !mark(c);) {
          mark(c) = 1;
          const Place end = place({c.triangle, (c.side + 1) % 3});
          all.back().push_back(end);
          c = stars_.fans[std::size_t(end.fan)].first[std::size_t(end.sector)];
        }
      }
    return all;
  }

  void drop_unused() {
    std::vector<int> index(vertices.size(), -1);
    std::vector<Vec3> used;
    for (auto& corners : triangles)
      for (int& corner : corners) {
        int& i = index[std::size_t(corner)];
        if (i < 0) {
          i = int(used.size());
          used.push_back(vertices[std::size_t(corner)]);
        }
        corner = i;
      }
    vertices = std::move(used);
  }

  const SimplicialComplex& k_;
  const Idealisation& ideal_;
  const ErosionOptions& options_;
  Stars stars_;
  std::vector<std::vector<int>> of_region_{};  // triangles
  std::vector<char> whole_{};                  // fans that may not be split
  std::vector<Cluster> clusters_{};
  std::vector<int> cluster_of_fan_{};
  std::vector<std::vector<int>> plane_of_{};  // of the cluster, for each fan and sector
  std::vector<char> todo_{};                  // clusters whose mitre is to be found
  std::vector<Vec3> all_{};                   // moved vertices before unused ones are dropped
};

inline Vec3 centre_of(const SimplicialComplex& k, int t) {
  const auto& [a, b, c] = k.triangles[std::size_t(t)];
  return (k.vertices[std::size_t(a)] + k.vertices[std::size_t(b)] + k.vertices[std::size_t(c)]) / 3;
}

}  // namespace aussois
