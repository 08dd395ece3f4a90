// SPDX-License-Identifier: Apache-2.0
#include "lmd/erosion.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <sstream>

#include <Eigen/Geometry>

#include "geometry/check.hpp"
#include "geometry/polygon.hpp"
#include "geometry/self_intersections.hpp"
#include "geometry/surface_tree.hpp"
#include "lmd/mitre.hpp"

namespace aussois {
namespace {

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

int other_triangle(const SimplicialComplex& k, int edge, int t) {
  const auto both = k.edge_triangles[edge];
  return both[0] == t ? both[1] : both[0];
}

std::size_t corner_at(const SimplicialComplex& k, int t, int vertex) {
  const auto& v = k.triangles[std::size_t(t)];
  return std::size_t(std::find(v.begin(), v.end(), vertex) - v.begin());
}

Stars find_stars(const SimplicialComplex& k, const Idealisation& ideal) {
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

Vec3 centre_of(const SimplicialComplex& k, int t) {
  const auto& [a, b, c] = k.triangles[std::size_t(t)];
  return (k.vertices[std::size_t(a)] + k.vertices[std::size_t(b)] + k.vertices[std::size_t(c)]) / 3;
}

/// Builds the complex of an attempt and looks whether it is an eroded solid.
std::optional<Failure> check(const SimplicialComplex& solid, const SurfaceTree& tree, const Erosion& made,
                             const ErosionOptions& options, SimplicialComplex& out) {
  if (made.triangles.empty())
    return Failure{ErosionStatus::inside_out, solid.vertices[0], "nothing would be left", {}};
  out = make_complex(made.vertices, made.triangles);
  if (!is_closed_oriented(out))
    return Failure{
        ErosionStatus::self_intersecting, solid.vertices[0], "parts of the surface would touch", {}};
  if (!(signed_volume(out) > 0))
    return Failure{ErosionStatus::inside_out, solid.vertices[0], "nothing would be left", {}};
  out.solid = true;
  const double size = bounding_box(solid).diagonal();
  double deviation = 0;
  for (const Cluster& c : made.clusters()) deviation = std::max(deviation, c.mitre.deviation);
  const double least = options.depth * (1 - std::max(2 * deviation, 2 * options.meet)) - 1e-12 * size;
  const auto refuse = [&](ErosionStatus status, int triangle, const std::string& what) {
    const int region = made.triangle_region[std::size_t(triangle)];
    return Failure{status, centre_of(out, triangle), what + " at region " + std::to_string(region), {region}};
  };
  for (std::size_t t = 0; t < out.triangles.size(); ++t)
    for (int v : out.triangles[t])
      if (!(-tree.signed_distance(out.vertices[std::size_t(v)]) >= least))
        return refuse(ErosionStatus::too_shallow, int(t),
                      "the eroded surface would come closer than the depth to the solid's surface");
  const auto pairs = self_intersections(out, 1);
  if (!pairs.empty()) {
    Failure failure = refuse(ErosionStatus::self_intersecting, pairs[0][0],
                             "parts of the surface would pass through each other");
    failure.regions.push_back(made.triangle_region[std::size_t(pairs[0][1])]);
    return failure;
  }
  return std::nullopt;
}

/// f(triangle, x) at the points of a regular grid on each triangle: corners, middles of sides, centre and as
/// many more as its share of the area asks for. Returns their number.
template <class F>
int for_samples(const SimplicialComplex& k, int wanted, const F& f) {
  double total = 0;
  std::vector<double> area(k.triangles.size());
  for (std::size_t t = 0; t < area.size(); ++t) {
    const auto& [a, b, c] = k.triangles[t];
    const Vec3& o = k.vertices[std::size_t(a)];
    area[t] = 0.5 * (k.vertices[std::size_t(b)] - o).cross(k.vertices[std::size_t(c)] - o).norm();
    total += area[t];
  }
  int count = 0;
  for (std::size_t t = 0; t < area.size(); ++t) {
    const auto& [a, b, c] = k.triangles[t];
    const Vec3 &o = k.vertices[std::size_t(a)], &p = k.vertices[std::size_t(b)],
               &q = k.vertices[std::size_t(c)];
    const double share = total > 0 ? area[t] / total : 0;
    const int n = std::max(2, int(std::sqrt(2 * double(wanted) * share)));
    f(int(t), Vec3((o + p + q) / 3));
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) f(int(t), Vec3(o + double(i) / n * (p - o) + double(j) / n * (q - o)));
    count += 1 + (n + 1) * (n + 2) / 2;
  }
  return count;
}

struct Thickness {
  double value = kInf;
  Vec3 place = Vec3::Zero();
  int triangle = -1;
};

/// Shortest way through the solid along the inward normal of a face to a face within 30 degrees of parallel.
Thickness smallest_thickness(const SimplicialComplex& k, const SurfaceTree& tree, int samples) {
  Thickness best;
  constexpr double kCos30 = 0.8660254037844387;
  for_samples(k, samples, [&](int t, const Vec3& x) {
    const Vec3& n = tree.normal(t);
    if (n.isZero()) return;
    const Vec3 inner = 0.98 * x + 0.02 * centre_of(k, t);  // off the sides, where rays slip through
    const std::optional<double> length = tree.first_exit(inner, -n, 0, kCos30);
    if (length && *length < best.value) best = {*length, inner, t};
  });
  return best;
}

/// +1 convex, -1 concave, 0 flat: where the triangle's neighbour over the edge lies.
int bend(const SimplicialComplex& k, const SurfaceTree& tree, int edge) {
  const auto both = k.edge_triangles[edge];
  const Vec3 d = k.vertices[std::size_t(k.edges[std::size_t(edge)][1])] -
                 k.vertices[std::size_t(k.edges[std::size_t(edge)][0])];
  const Vec3 &n = tree.normal(both[0]), &m = tree.normal(both[1]);
  const auto corner = corner_at(k, both[0], k.edges[std::size_t(edge)][0]);
  const bool upwards = k.triangle_edges[std::size_t(both[0])][corner] == edge;
  const double sine = n.cross(m).dot(d.stableNormalized()) * (upwards ? 1 : -1);
  return sine > 1e-6 ? 1 : sine < -1e-6 ? -1 : 0;
}

struct ConvexParts {
  std::vector<char> edges{}, vertices{};
};

ConvexParts convex_parts(const SimplicialComplex& k, const SurfaceTree& tree) {
  ConvexParts out{std::vector<char>(k.edges.size(), 0), std::vector<char>(k.vertices.size(), 0)};
  for (std::size_t e = 0; e < k.edges.size(); ++e)
    if (k.edge_triangles[int(e)].size() == 2 && bend(k, tree, int(e)) > 0) {
      out.edges[e] = 1;
      for (int v : k.edges[e]) out.vertices[std::size_t(v)] = 1;
    }
  return out;
}

/// restored(triangle, x, foot): the dilation is to give this sample of the solid back.
template <class Restored>
ErosionMeasures measure(const SimplicialComplex& solid, const SimplicialComplex& eroded,
                        const SurfaceTree& inner, double depth, int samples, const Restored& restored) {
  const SurfaceTree outer(solid);
  ErosionMeasures out;
  out.rounding = -kInf;
  out.samples += for_samples(solid, samples, [&](int t, const Vec3& x) {
    const SurfacePoint foot = inner.nearest(x);
    const double off = foot.distance - depth;
    out.rounding = std::max(out.rounding, off);
    const bool face = restored(t, x, foot);
    out.face_samples += face;
    out.face_error = std::max(out.face_error, face ? std::abs(off) : -off);
  });
  out.samples += for_samples(eroded, samples, [&](int, const Vec3& x) {
    out.shallow = std::max(out.shallow, depth + outer.signed_distance(x));
  });
  const ConvexParts convex = convex_parts(eroded, inner);
  for (std::size_t e = 0; e < eroded.edges.size(); ++e)  // the middle of the round of each convex edge
    if (convex.edges[e]) {
      const auto both = eroded.edge_triangles[int(e)];
      const auto& [a, b] = eroded.edges[e];
      const Vec3 middle = 0.5 * (eroded.vertices[std::size_t(a)] + eroded.vertices[std::size_t(b)]);
      const Vec3 way = (inner.normal(both[0]) + inner.normal(both[1])).stableNormalized();
      out.hausdorff = std::max(out.hausdorff, outer.nearest(middle + depth * way).distance);
    }
  out.hausdorff = std::max(out.hausdorff, out.rounding);
  out.thickness = smallest_thickness(eroded, inner, 1).value;
  return out;
}

/// What convex chains and corners round off a region: everything within `reach` of a segment.
struct Rounded {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  double reach = 0;
};

std::vector<std::vector<Rounded>> rounded_parts(const SimplicialComplex& solid, const Idealisation& ideal,
                                                const Erosion& made, double depth) {
  std::vector<double> way(solid.vertices.size(), 0);  // farthest that a vertex moves
  for (const Cluster& c : made.clusters())
    for (int f : c.fans)
      for (const Vec3& p : c.mitre.points) {
        const auto v = std::size_t(made.fan(f).vertex);
        way[v] = std::max(way[v], (c.origin + depth * p - solid.vertices[v]).norm());
      }
  std::vector<std::vector<Rounded>> parts(ideal.region_normal.size());
  for (const Chain& chain : ideal.chains) {
    const double psi = interior_angle(solid, ideal, chain);
    if (!(psi < kPi)) continue;
    const Vec3 &a = solid.vertices[std::size_t(chain.first)], &b = solid.vertices[std::size_t(chain.last)];
    for (int t : solid.edge_triangles[chain.edges.front()]) {
      auto& list = parts[std::size_t(ideal.triangle_region[std::size_t(t)])];
      list.push_back({a, b, depth / std::tan(psi / 2)});
      list.push_back({a, a, way[std::size_t(chain.first)]});
      list.push_back({b, b, way[std::size_t(chain.last)]});
    }
  }
  for (const Cluster& c : made.clusters())  // new edges between split and merged vertices may be convex
    if (c.mitre.points.size() > 1 || c.fans.size() > 1)
      for (int f : c.fans) {
        const Fan& fan = made.fan(f);
        const Vec3& x = solid.vertices[std::size_t(fan.vertex)];
        for (int r : fan.regions) parts[std::size_t(r)].push_back({x, x, way[std::size_t(fan.vertex)]});
      }
  return parts;
}

bool within(const Rounded& part, const Vec3& x) {
  const Vec3 along = part.to - part.from;
  const double length2 = along.squaredNorm();
  const double share = length2 > 0 ? std::clamp(along.dot(x - part.from) / length2, 0.0, 1.0) : 0;
  return (x - part.from - share * along).norm() <= part.reach * (1 + 1e-9);
}

void predict(const SimplicialComplex& solid, const Idealisation& ideal, const Erosion& made,
             const SurfaceTree& eroded, const ErosionOptions& options, ErosionMeasures& out) {
  const double eps = options.depth;
  out.regions = int(ideal.region_normal.size());
  out.chains = int(ideal.chains.size());
  std::vector<char> convex_end(solid.vertices.size(), 0);
  for (const Chain& chain : ideal.chains) {
    const double psi = interior_angle(solid, ideal, chain);
    if (psi > kPi) ++out.concave_chains;
    if (!(psi < kPi)) continue;
    ++out.convex_chains;
    convex_end[std::size_t(chain.first)] = convex_end[std::size_t(chain.last)] = 1;
    const double reach = eps / std::sin(psi / 2);
    out.edge_rounding = std::max(out.edge_rounding, reach - eps);
    if (made.contracted(chain)) continue;
    const std::array<Vec3, 2> ends = made.chain_ends(chain);
    const Vec3& a = solid.vertices[std::size_t(chain.first)];
    const double length = (solid.vertices[std::size_t(chain.last)] - a).norm();
    const double flat = reach * std::cos(psi / 2);
    out.volume_lost += length * (flat * eps - 0.5 * (kPi - psi) * eps * eps);  // (ERO-9)
    for (int i = 1; i < 8; ++i) {
      const Vec3 inner = ends[0] + i / 8.0 * (ends[1] - ends[0]);
      const double along = chain.direction.dot(inner - a);
      if (along < 0 || along > length) continue;
      const Vec3 x = a + along * chain.direction;
      const SurfacePoint foot = eroded.nearest(x);
      if ((foot.x - inner).norm() <= 0.1 * eps)  // else another face is nearer, and nothing is predicted
        out.edge_error = std::max(out.edge_error, std::abs(foot.distance - reach));
    }
  }
  for (const Cluster& c : made.clusters()) {
    out.split_vertices += c.fans.size() == 1 && c.mitre.points.size() > 1;
    out.merged_vertices += c.fans.size() > 1 ? int(c.fans.size()) : 0;
    out.deviating_vertices += c.mitre.deviation > options.meet;
    out.deviation = std::max(out.deviation, eps * c.mitre.deviation);
    for (int f : c.fans) {
      const int v = made.fan(f).vertex;
      if (!convex_end[std::size_t(v)]) continue;
      for (const Vec3& p : c.mitre.points)
        out.rounding_bound =
            std::max(out.rounding_bound, (c.origin + eps * p - solid.vertices[std::size_t(v)]).norm() - eps);
    }
  }
  out.rounding_bound = std::max(out.rounding_bound, out.edge_rounding);
}

std::string place_text(const Vec3& x) {
  std::ostringstream text;
  text << " at (" << x.x() << ", " << x.y() << ", " << x.z() << ") m";
  return text.str();
}

/// Says whether the reason is that something is thinner than twice the depth.
void refuse(ErosionResult& result, const SimplicialComplex& solid, const SurfaceTree& tree,
            const Failure& failure, double depth) {
  result.status = failure.status;
  result.place = failure.place;
  result.reason = failure.what + place_text(failure.place);
  const Thickness thin = smallest_thickness(solid, tree, 1);
  if (thin.value > 2 * depth * (1 + 1e-9)) return;
  result.thickness = thin.value;
  std::ostringstream text;
  text << "; the solid is " << thin.value << " m thick" << place_text(thin.place) << ", region "
       << result.ideal.triangle_region[std::size_t(thin.triangle)]
       << ", which is not more than twice the depth, " << 2 * depth
       << " m: take a smaller dilation, or model a thin plate as a sheet";
  result.reason += text.str();
}

}  // namespace

const char* to_string(ErosionStatus status) {
  switch (status) {
    case ErosionStatus::done:
      return "done";
    case ErosionStatus::not_solid:
      return "not_solid";
    case ErosionStatus::unsettled_vertex:
      return "unsettled_vertex";
    case ErosionStatus::lost_edge:
      return "lost_edge";
    case ErosionStatus::lost_face:
      return "lost_face";
    case ErosionStatus::inside_out:
      return "inside_out";
    case ErosionStatus::self_intersecting:
      return "self_intersecting";
    case ErosionStatus::too_shallow:
      return "too_shallow";
    case ErosionStatus::too_round:
      return "too_round";
  }
  return "unknown";
}

double interior_angle(const SimplicialComplex& k, const Idealisation& ideal, const Chain& chain) {
  const int edge = chain.edges.front();
  const auto both = k.edge_triangles[edge];
  const Vec3 &n = ideal.region_normal[std::size_t(ideal.triangle_region[std::size_t(both[0])])],
             &m = ideal.region_normal[std::size_t(ideal.triangle_region[std::size_t(both[1])])];
  const auto corner = corner_at(k, both[0], chain.vertices[0]);
  const bool along = k.triangle_edges[std::size_t(both[0])][corner] == edge;
  return kPi - std::atan2(n.cross(m).dot(chain.direction) * (along ? 1 : -1), n.dot(m));
}

ErosionMeasures measure_erosion(const SimplicialComplex& solid, const SimplicialComplex& eroded, double depth,
                                int samples) {
  const SurfaceTree inner(eroded);
  const ConvexParts convex = convex_parts(eroded, inner);
  return measure(solid, eroded, inner, depth, samples, [&](int, const Vec3&, const SurfacePoint& foot) {
    return !(foot.dim == 1 && convex.edges[std::size_t(foot.simplex)]) &&
           !(foot.dim == 0 && convex.vertices[std::size_t(foot.simplex)]);
  });
}

ErosionResult erode(const SimplicialComplex& solid, const ErosionOptions& options) {
  require_field(options.depth > 0 && std::isfinite(options.depth), "ErosionOptions::depth", options.depth,
                "be finite and > 0 [m]");
  require_field(options.planarity >= 0 && options.planarity <= 1e-2, "ErosionOptions::planarity",
                options.planarity, "lie in [0, 1e-2]");
  require_field(options.meet > 0 && options.meet <= 1e-2, "ErosionOptions::meet", options.meet,
                "lie in (0, 1e-2]");
  require_field(options.deviation >= 0 && options.deviation <= 0.1, "ErosionOptions::deviation",
                options.deviation, "lie in [0, 0.1]");
  require_field(options.max_rounding > 0, "ErosionOptions::max_rounding", options.max_rounding, "be > 0 [m]");
  require_field(options.samples >= 1 && options.samples <= 100'000'000, "ErosionOptions::samples",
                options.samples, "lie in [1, 1e8]");

  ErosionResult result;
  if (!is_closed_oriented(solid) || !(signed_volume(solid) > 0)) {
    result.status = ErosionStatus::not_solid;
    result.reason = "not a solid: the surface is not closed, not oriented, or inside out";
    return result;
  }
  const double size = bounding_box(solid).diagonal();
  result.ideal = idealise(solid, std::min(options.planarity * size, 1e-3 * options.depth));
  if (const auto pairs = self_intersections(solid, 1); !pairs.empty()) {
    result.status = ErosionStatus::not_solid;
    result.place = centre_of(solid, pairs[0][0]);
    result.reason = "not a solid: triangles " + std::to_string(pairs[0][0]) + " and " +
                    std::to_string(pairs[0][1]) + " pass through each other" + place_text(result.place);
    return result;
  }

  const SurfaceTree tree(solid);
  Erosion erosion(solid, result.ideal, options);
  for (;;) {
    std::optional<Failure> failure = erosion.attempt();
    if (!failure) failure = check(solid, tree, erosion, options, result.complex);
    if (!failure) break;
    if (options.deviation > 0 && erosion.join_again(failure->regions)) continue;
    result.complex = {};
    refuse(result, solid, tree, *failure, options.depth);
    return result;
  }
  result.triangle_region = erosion.triangle_region;
  const SurfaceTree inner(result.complex);
  const auto rounded = rounded_parts(solid, result.ideal, erosion, options.depth);
  result.measures = measure(solid, result.complex, inner, options.depth, options.samples,
                            [&](int t, const Vec3& x, const SurfacePoint&) {
                              const auto region = result.ideal.triangle_region[std::size_t(t)];
                              return std::ranges::none_of(rounded[std::size_t(region)],
                                                          [&](const Rounded& r) { return within(r, x); });
                            });
  predict(solid, result.ideal, erosion, inner, options, result.measures);
  if (result.measures.rounding > options.max_rounding) {
    std::ostringstream text;
    text << "convex edges or corners would be rounded by " << result.measures.rounding << " m, more than "
         << options.max_rounding << " m";
    result.status = ErosionStatus::too_round;
    result.reason = text.str();
    result.complex = {};
    result.triangle_region.clear();
  }
  return result;
}

}  // namespace aussois
