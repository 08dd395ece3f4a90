// SPDX-License-Identifier: Apache-2.0
#include "lmd/erosion_attempt.hpp"

#include <algorithm>
#include <numeric>

#include "geometry/self_intersections.hpp"

namespace aussois {
namespace {

/// Events within this many depths are one. One by one they are exact; all at once what is in a cluster is
/// forgotten, also what would have met something beyond its neighbours on its way.
constexpr std::array<double, 2> kTogether = {1e-6, 1};
struct Tries {
  std::size_t way = 0;  // of kTogether
  int count = 0;
};
constexpr std::array<Tries, 4> kTries = {
    {{0, 1}, {1, 1}, {0, 3}, {1, 3}}};  // unjoined first; numbers are taste

// Where more than two triangles of a surface meet in an edge.
Failure touching(const SimplicialComplex& solid, const RegionOffset& made, const SimplicialComplex& surface) {
  Failure out{ErosionStatus::self_intersecting, solid.vertices[0], "parts of the surface would touch"};
  for (int e = 0; e < int(surface.edges.size()); ++e)
    if (surface.edge_triangles[e].size() > 2) {
      const auto& [a, b] = surface.edges[e];
      out.place = surface.vertices[a];
      const int v = made.wave_vertex[a], w = made.wave_vertex[b];
      if (v >= 0 && w >= 0) out.crossing.push_back({std::vector{v}, std::vector{w}});
    }
  return out;
}

// What has become of every vertex of the solid.
std::vector<std::vector<int>> wave_of_vertices(const SimplicialComplex& solid, const std::vector<Fan>& fans,
                                               const RegionOffset& made) {
  std::vector<std::vector<int>> out(solid.vertices.size());
  for (int w = 0; w < int(made.wave.vertices.size()); ++w)
    if (made.wave.vertices[w].alive)
      for (int f : made.wave.vertices[w].fans) out[fans[f].vertex].push_back(w);
  return out;
}

/// Builds the complex of an attempt and looks whether it is an eroded solid.
std::optional<Failure> check(const SimplicialComplex& solid, const SurfaceTree& tree,
                             const std::vector<Fan>& fans, const RegionOffset& made,
                             const ErosionOptions& options, double tolerance, SimplicialComplex& out) {
  if (made.triangles.empty())
    return Failure{ErosionStatus::inside_out, solid.vertices[0], "nothing would be left", {}};
  out = make_complex(made.vertices, made.triangles);
  if (!is_closed_oriented(out)) return touching(solid, made, out);
  if (!(signed_volume(out) > 0))
    return Failure{ErosionStatus::inside_out, solid.vertices[0], "nothing would be left", {}};
  out.solid = true;
  const double least = least_depth(made.wave, options, bounding_box(solid).diagonal());
  const double flat = 2 * tolerance;  // how far the solid is from its regions, between their corners
  const auto refuse = [&](ErosionStatus status, int triangle, const std::string& what) {
    const int region = made.triangle_region[triangle];
    return Failure{status, centre_of(out, triangle), what + " at region " + std::to_string(region), {region}};
  };
  const auto corners = [&](int triangle) {
    std::vector<int> all;
    for (int v : out.triangles[triangle])
      if (const int w = made.wave_vertex[v]; w >= 0) all.push_back(w);
    return all;
  };
  const std::vector<std::vector<int>> of_vertex = wave_of_vertices(solid, fans, made);
  std::optional<Failure> shallow;
  for (int t = 0; t < int(out.triangles.size()); ++t) {
    const auto at = [&](int corner) { return out.vertices[out.triangles[t][corner % 3]]; };
    for (int i = 0; i < 3; ++i)
      for (const bool middle : {false, true})
        if (const Vec3 x = middle ? Vec3(0.5 * (at(i) + at(i + 1))) : at(i);
            !(-tree.signed_distance(x) >= least - (middle ? flat : 0))) {
          if (!shallow)
            shallow = refuse(ErosionStatus::too_shallow, t,
                             "the eroded surface would come closer than the depth to the solid's surface");
          shallow->regions.push_back(made.triangle_region[t]);
          std::vector<int> near;  // what the vertices of the solid have become that are too near
          for (int v : solid.triangles[tree.nearest(x).triangle])
            near.insert(near.end(), of_vertex[v].begin(), of_vertex[v].end());
          const int corner = made.wave_vertex[out.triangles[t][i]];
          shallow->crossing.push_back({middle || corner < 0 ? corners(t) : std::vector{corner}, near});
        }
  }
  if (shallow) return shallow;
  const auto pairs = self_intersections(out, 100);
  if (!pairs.empty()) {
    Failure failure = refuse(ErosionStatus::self_intersecting, pairs[0][0],
                             "parts of the surface would pass through each other");
    failure.regions.push_back(made.triangle_region[pairs[0][1]]);
    for (const auto& [t, u] : pairs) failure.crossing.push_back({corners(t), corners(u)});
    return failure;
  }
  return std::nullopt;
}

}  // namespace

double least_depth(const Wavefront& wave, const ErosionOptions& options, double size) {
  double deviation = 0;
  for (const WaveVertex& v : wave.vertices)
    if (v.alive) deviation = std::max(deviation, v.deviation);
  const double missed = std::max(2 * std::max(deviation, options.meet), options.deviation);
  return options.depth * (1 - missed) - 1e-12 * size;
}

ErosionTrial attempt_erosion(const SimplicialComplex& solid, const SurfaceTree& tree,
                             const Idealisation& ideal, const std::vector<Fan>& fans,
                             const ErosionOptions& options) {
  std::optional<Failure> first;
  FanOptions each{.whole = std::vector<char>(fans.size(), 0), .group = std::vector<int>(fans.size())};
  std::iota(each.group.begin(), each.group.end(), 0);
  for (const bool deviate : {false, true}) {  // vertices that may deviate are taken whole around what failed
    if (deviate && options.deviation == 0) break;
    std::array<FanOptions, 2> of_way{each, each};
    std::array<bool, 2> again{true, true};
    for (const auto& [way, count] : kTries)
      for (int i = 0; i < count && again[way]; ++i) {
        FanOptions& of_fan = of_way[way];
        ErosionTrial attempt{.made = offset_regions(solid, ideal, fans, of_fan, options, kTogether[way])};
        std::optional<Failure> failure = attempt.made.failure;
        if (!failure)
          failure = check(solid, tree, fans, attempt.made, options, ideal.tolerance, attempt.complex);
        if (!failure) return attempt;
        if (!first) first = failure;
        again[way] =
            (deviate && keep_whole(solid, ideal, fans, failure->regions, options, of_fan)) ||
            (options.contract && options.split && join_crossing(*failure, ideal, attempt.made.wave, of_fan));
      }
  }
  return {.made = {.failure = first}};
}

}  // namespace aussois
