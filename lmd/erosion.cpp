// SPDX-License-Identifier: Apache-2.0
#include "lmd/erosion.hpp"

#include <algorithm>
#include <cmath>
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

/// One round of triangles about a vertex, counter-clockwise, and the planes in it. A vertex where several
/// rounds touch has as many fans; they part when eroded.
struct Fan {
  int vertex = 0;
  std::vector<VertexPlane> planes{};
  std::vector<int> regions{};   // of the planes
  std::vector<Corner> first{};  // the first triangle of each plane; its side leads along the spoke
  Mitre mitre{};
  int base = 0;        // index of its first eroded vertex
  bool whole = false;  // not to be split
};

struct Stars {
  std::vector<Fan> fans{};
  std::vector<std::array<int, 3>> fan{}, plane{};  // of each corner of each triangle
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
  out.plane.assign(k.triangles.size(), {0, 0, 0});
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
          const int along = k.triangles[c][std::size_t(round[i].side + 1) % 3];
          fan.planes.push_back(
              {ideal.region_normal[std::size_t(region(round[i]))],
               (k.vertices[std::size_t(along)] - k.vertices[std::size_t(v)]).stableNormalized()});
          fan.regions.push_back(region(round[i]));
          fan.first.push_back(round[i]);
        }
        out.plane[c][std::size_t(round[i].side)] = int(fan.planes.size()) - 1;
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

/// One attempt: positions, then faces.
class Erosion {
 public:
  Erosion(const SimplicialComplex& solid, const Idealisation& ideal, const ErosionOptions& options)
      : k_(solid), ideal_(ideal), options_(options), stars_(find_stars(solid, ideal)) {
    of_region_.resize(ideal.region_normal.size());
    for (std::size_t t = 0; t < k_.triangles.size(); ++t)
      of_region_[std::size_t(ideal.triangle_region[t])].push_back(int(t));
  }

  std::optional<Failure> attempt() {
    vertices.clear();
    triangles.clear();
    triangle_region.clear();
    if (auto failure = move_vertices()) return failure;
    if (auto failure = move_chains()) return failure;
    for (int r = 0; r < int(of_region_.size()); ++r)
      if (auto failure = make_faces(r)) return failure;
    drop_unused();
    return std::nullopt;
  }

  /// Takes back the splits around these regions; false if there are none.
  bool join_again(const std::vector<int>& regions) {
    bool any = false;
    for (Fan& fan : stars_.fans)
      if (!fan.whole && fan.mitre.points.size() > 1 &&
          std::ranges::any_of(fan.regions, [&](int r) { return std::ranges::count(regions, r) > 0; }))
        any = fan.whole = true;
    return any;
  }

  const std::vector<Fan>& fans() const { return stars_.fans; }
  /// Eroded ends of a chain, in its direction.
  std::array<Vec3, 2> chain_ends(const Chain& chain) const {
    return {vertices_all_[std::size_t(end_of(chain.first, chain.edges.front()))],
            vertices_all_[std::size_t(end_of(chain.last, chain.edges.back()))]};
  }

  std::vector<Vec3> vertices{};
  std::vector<std::array<int, 3>> triangles{};
  std::vector<int> triangle_region{};

 private:
  const Vec3& x(int vertex) const { return k_.vertices[std::size_t(vertex)]; }
  const Fan& fan(const Corner& c) const {
    return stars_.fans[std::size_t(stars_.fan[std::size_t(c.triangle)][std::size_t(c.side)])];
  }
  int plane(const Corner& c) const { return stars_.plane[std::size_t(c.triangle)][std::size_t(c.side)]; }
  const std::vector<int>& path(const Corner& c) const { return fan(c).mitre.of_plane[std::size_t(plane(c))]; }

  std::optional<Failure> move_vertices() {
    for (Fan& fan : stars_.fans) {
      const std::optional<Mitre> m =
          mitre(fan.planes, {options_.meet, options_.deviation, options_.split && !fan.whole});
      if (!m)
        return Failure{ErosionStatus::unsettled_vertex, x(fan.vertex),
                       "the " + std::to_string(fan.planes.size()) + " planes at vertex " +
                           std::to_string(fan.vertex) + " do not meet when moved, and no split is simple"};
      fan.mitre = *m;
      fan.base = int(vertices.size());
      for (const Vec3& p : m->points) vertices.push_back(x(fan.vertex) + options_.depth * p);
    }
    return std::nullopt;
  }

  // The eroded vertex in which a border edge ends that leaves the vertex.
  int end_of(int vertex, int edge) const {
    for (int t : k_.edge_triangles[edge]) {
      const Corner c{t, int(corner_at(k_, t, vertex))};
      if (k_.triangle_edges[std::size_t(t)][std::size_t(c.side)] == edge)
        return fan(c).base + path(c).front();
    }
    return -1;  // not reached: both directions of an edge of a solid exist
  }

  // Vertices inside a chain keep their shares of its length, so none passes an end.
  std::optional<Failure> move_chains() {
    vertices_all_ = vertices;
    for (std::size_t c = 0; c < ideal_.chains.size(); ++c) {
      const Chain& chain = ideal_.chains[c];
      const std::array<Vec3, 2> ends = chain_ends(chain);
      const Vec3 before = x(chain.last) - x(chain.first), after = ends[1] - ends[0];
      if (!(after.dot(chain.direction) > 0)) {
        std::ostringstream text;
        text << "the edge of length " << before.norm() << " m at vertex " << chain.first << " would vanish";
        return Failure{ErosionStatus::lost_edge, 0.5 * (x(chain.first) + x(chain.last)), text.str(),
                       regions_at(chain)};
      }
      for (std::size_t i = 1; i + 1 < chain.vertices.size(); ++i) {
        const int index = end_of(chain.vertices[i], chain.edges[i]);
        const double share = chain.direction.dot(x(chain.vertices[i]) - x(chain.first)) / before.norm();
        vertices_all_[std::size_t(index)] = ends[0] + share * after;
      }
    }
    vertices = vertices_all_;
    return std::nullopt;
  }

  std::vector<int> regions_at(const Chain& chain) const {
    std::vector<int> regions;
    for (int t : k_.edge_triangles[chain.edges.front()])
      regions.push_back(ideal_.triangle_region[std::size_t(t)]);
    return regions;
  }

  std::optional<Failure> make_faces(int region) {
    const Vec3& n = ideal_.region_normal[std::size_t(region)];
    std::vector<std::array<int, 3>> moved;
    for (int t : of_region_[std::size_t(region)]) {
      std::array<int, 3> corners{};
      for (int side = 0; side < 3; ++side) {
        if (path({t, side}).size() != 1) return cut_face(region);
        corners[std::size_t(side)] = fan({t, side}).base + path({t, side})[0];
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

  // The region anew from its moved border, where vertices were split or its inner vertices were passed.
  std::optional<Failure> cut_face(int region) {
    const Vec3& n = ideal_.region_normal[std::size_t(region)];
    const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
    const Vec3 origin = x(k_.triangles[std::size_t(of_region_[std::size_t(region)][0])][0]);
    const auto flat = [&](const Vec3& p) { return Vec2(u.dot(p - origin), v.dot(p - origin)); };
    std::vector<Vec2> before, after;
    std::vector<int> vertex;  // of the points in `after`
    std::vector<std::vector<int>> loops;
    std::vector<std::array<char, 3>> seen(k_.triangles.size() ? of_region_[std::size_t(region)].size() : 0);
    bool simple = true;
    int outer = 0;
    const auto place = [&](int t) {
      const auto& list = of_region_[std::size_t(region)];
      return std::size_t(std::lower_bound(list.begin(), list.end(), t) - list.begin());
    };
    for (int t : of_region_[std::size_t(region)])
      for (int side = 0; side < 3; ++side) {
        if (seen[place(t)][std::size_t(side)] || !on_border({t, side})) continue;
        std::vector<int> old_loop, loop;
        for (Corner c{t, side}; !seen[place(c.triangle)][std::size_t(c.side)];) {
          seen[place(c.triangle)][std::size_t(c.side)] = 1;
          const Corner end{c.triangle, (c.side + 1) % 3};
          const Fan& f = fan(end);
          old_loop.push_back(int(before.size()));
          before.push_back(flat(x(f.vertex)));
          const std::vector<int>& points = path(end);
          for (auto p = points.rbegin(); p != points.rend(); ++p) {
            loop.push_back(int(after.size()));
            vertex.push_back(f.base + *p);
            after.push_back(flat(vertices[std::size_t(vertex.back())]));
          }
          c = f.first[std::size_t(plane(end))];
        }
        const bool is_outer = twice_area(before, old_loop) > 0;
        simple = simple && is_outer == (twice_area(after, loop) > 0);
        outer += is_outer;
        loops.insert(is_outer ? loops.begin() : loops.end(), std::move(loop));
      }
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
  std::vector<std::vector<int>> of_region_{};
  std::vector<Vec3> vertices_all_{};  // of all fans, before unused ones are dropped
};

Vec3 centre_of(const SimplicialComplex& k, int t) {
  const auto& [a, b, c] = k.triangles[std::size_t(t)];
  return (k.vertices[std::size_t(a)] + k.vertices[std::size_t(b)] + k.vertices[std::size_t(c)]) / 3;
}

/// Builds the complex of an attempt and looks whether it is an eroded solid.
std::optional<Failure> check(const SimplicialComplex& solid, const SurfaceTree& tree, const Erosion& made,
                             const ErosionOptions& options, SimplicialComplex& out) {
  out = make_complex(made.vertices, made.triangles);
  if (!is_closed_oriented(out))
    return Failure{ErosionStatus::self_intersecting, solid.vertices[0], "parts of the surface would touch"};
  if (!(signed_volume(out) > 0))
    return Failure{ErosionStatus::inside_out, solid.vertices[0], "nothing would be left"};
  out.solid = true;
  const double size = bounding_box(solid).diagonal();
  double deviation = 0;
  for (const Fan& fan : made.fans()) deviation = std::max(deviation, fan.mitre.deviation);
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

/// Interior dihedral angle of a chain, psi in (ERO-5).
double interior_angle(const SimplicialComplex& k, const Idealisation& ideal, const Chain& chain) {
  const int edge = chain.edges.front();
  const auto both = k.edge_triangles[edge];
  const Vec3 &n = ideal.region_normal[std::size_t(ideal.triangle_region[std::size_t(both[0])])],
             &m = ideal.region_normal[std::size_t(ideal.triangle_region[std::size_t(both[1])])];
  const auto corner = corner_at(k, both[0], chain.vertices[0]);
  const bool along = k.triangle_edges[std::size_t(both[0])][corner] == edge;
  return kPi - std::atan2(n.cross(m).dot(chain.direction) * (along ? 1 : -1), n.dot(m));
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
  for (const Fan& fan : made.fans()) {
    const Mitre& m = fan.mitre;
    out.split_vertices += m.points.size() > 1;
    out.deviating_vertices += m.deviation > options.meet;
    out.deviation = std::max(out.deviation, eps * m.deviation);
    if (convex_end[std::size_t(fan.vertex)])
      for (const Vec3& p : m.points) out.rounding_bound = std::max(out.rounding_bound, eps * (p.norm() - 1));
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

ErosionMeasures measure_erosion(const SimplicialComplex& solid, const SimplicialComplex& eroded, double depth,
                                int samples) {
  const SurfaceTree outer(solid), inner(eroded);
  ErosionMeasures out;
  std::vector<char> round_edge(eroded.edges.size(), 0), round_vertex(eroded.vertices.size(), 0);
  for (std::size_t e = 0; e < eroded.edges.size(); ++e)
    if (eroded.edge_triangles[int(e)].size() == 2 && bend(eroded, inner, int(e)) > 0) {
      round_edge[e] = 1;
      for (int v : eroded.edges[e]) round_vertex[std::size_t(v)] = 1;
    }
  out.rounding = -kInf;
  out.samples += for_samples(solid, samples, [&](int, const Vec3& x) {
    const SurfacePoint foot = inner.nearest(x);
    const double off = foot.distance - depth;
    out.rounding = std::max(out.rounding, off);
    const bool round = (foot.dim == 1 && round_edge[std::size_t(foot.simplex)]) ||
                       (foot.dim == 0 && round_vertex[std::size_t(foot.simplex)]);
    out.face_error = std::max(out.face_error, round ? -off : std::abs(off));
  });
  const auto dilated_to_solid = [&](const Vec3& x, const Vec3& direction) {
    out.hausdorff = std::max(out.hausdorff, outer.nearest(x + depth * direction).distance);
  };
  out.samples += for_samples(eroded, samples, [&](int, const Vec3& x) {
    out.shallow = std::max(out.shallow, depth + outer.signed_distance(x));
  });
  for (std::size_t e = 0; e < eroded.edges.size(); ++e)  // the middle of the round of each convex edge
    if (round_edge[e]) {
      const auto both = eroded.edge_triangles[int(e)];
      const auto& [a, b] = eroded.edges[e];
      dilated_to_solid(0.5 * (eroded.vertices[std::size_t(a)] + eroded.vertices[std::size_t(b)]),
                       (inner.normal(both[0]) + inner.normal(both[1])).stableNormalized());
    }
  out.hausdorff = std::max(out.hausdorff, out.rounding);
  out.thickness = smallest_thickness(eroded, inner, 1).value;
  return out;
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
  result.measures = measure_erosion(solid, result.complex, options.depth, options.samples);
  predict(solid, result.ideal, erosion, SurfaceTree(result.complex), options, result.measures);
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
