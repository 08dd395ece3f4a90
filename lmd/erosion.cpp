// SPDX-License-Identifier: Apache-2.0
#include "lmd/erosion.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include <Eigen/Geometry>

#include "geometry/named.hpp"
#include "geometry/self_intersections.hpp"
#include "lmd/erosion_attempt.hpp"
#include "lmd/erosion_measures.hpp"
#include "lmd/shared_settings.hpp"

namespace aussois {
namespace {

/// What convex chains and corners round off a region: everything within `reach` of a segment.
struct Rounded {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  double reach = 0;
};

/// How far the farthest piece goes that a vertex of the solid becomes.
std::vector<double> ways(const SimplicialComplex& solid, const std::vector<Fan>& fans,
                         const Wavefront& wave) {
  std::vector<double> way(solid.vertices.size(), 0);
  for (const WaveVertex& w : wave.vertices)
    for (int f : w.fans) {
      const auto v = std::size_t(fans[f].vertex);
      if (w.alive) way[v] = std::max(way[v], (w.to - solid.vertices[v]).norm());
    }
  return way;
}

std::vector<std::vector<Rounded>> rounded_parts(const SimplicialComplex& solid, const Idealisation& ideal,
                                                const std::vector<Fan>& fans, const Wavefront& wave,
                                                double depth) {
  const std::vector<double> way = ways(solid, fans, wave);
  std::vector<std::vector<Rounded>> parts(ideal.region_normal.size());
  for (const Chain& chain : ideal.chains) {
    const double psi = interior_angle(solid, ideal, chain);
    if (!(psi < kPi)) continue;
    const Vec3 &a = solid.vertices[chain.first], &b = solid.vertices[chain.last];
    for (int t : solid.edge_triangles[edges_of(ideal, chain).front()]) {
      auto& list = parts[ideal.triangle_region[t]];
      list.push_back({a, b, depth / std::tan(psi / 2)});
      list.push_back({a, a, way[chain.first]});
      list.push_back({b, b, way[chain.last]});
    }
  }
  for (const WaveVertex& w : wave.vertices) {  // new edges between split and merged vertices may be convex
    if (!w.alive) continue;
    for (int f : w.fans) {
      const Fan& fan = fans[f];
      const Vec3& x = solid.vertices[fan.vertex];
      const double far = way[fan.vertex];
      if (w.fans.size() > 1 || w.sectors.size() < fan.regions.size())
        for (int r : fan.regions) parts[r].push_back({x, x, far});
    }
    for (const WaveSector& s : w.sectors) {
      const WaveEdge& e = wave.edges[s.edge];
      if (e.chain >= 0 || &w != &wave.vertices[e.ends[0]]) continue;
      const WaveVertex& other = wave.vertices[e.ends[1]];
      double far = 0;
      for (const WaveVertex* end : {&w, &other})
        for (int f : end->fans) far = std::max(far, way[fans[f].vertex]);
      const auto before =
          &s == w.sectors.data() ? w.sectors.size() - 1 : std::size_t(&s - w.sectors.data()) - 1;
      for (int r : {s.region, w.sectors[before].region}) {
        const Vec3 up = depth * ideal.region_normal[r];
        parts[r].push_back({w.to + up, other.to + up, far});
      }
    }
  }
  return parts;
}

bool within(const Rounded& part, const Vec3& x) {
  const Vec3 along = part.to - part.from;
  const double length2 = along.squaredNorm();
  const double share = length2 > 0 ? std::clamp(along.dot(x - part.from) / length2, 0.0, 1.0) : 0;
  return (x - part.from - share * along).norm() <= part.reach * (1 + 1e-9);
}

void predict(const SimplicialComplex& solid, const Idealisation& ideal, const std::vector<Fan>& fans,
             const Wavefront& wave, const std::vector<int>& triangle_region, const SurfaceTree& eroded,
             const ErosionOptions& options, ErosionMeasures& out) {
  const double eps = options.depth;
  out.regions = int(ideal.region_normal.size());
  out.chains = int(ideal.chains.size());
  std::vector<char> convex_end(solid.vertices.size(), 0);
  for (const Chain& chain : ideal.chains) {
    const double psi = interior_angle(solid, ideal, chain);
    if (psi > kPi) ++out.concave_chains;
    if (!(psi < kPi)) continue;
    ++out.convex_chains;
    convex_end[chain.first] = convex_end[chain.last] = 1;
    const double reach = eps / std::sin(psi / 2);
    out.edge_rounding = std::max(out.edge_rounding, reach - eps);
    const WaveEdge& edge = wave.edges[&chain - ideal.chains.data()];
    if (!edge.alive || edge.chain < 0) continue;
    const std::array<Vec3, 2> ends = {wave.vertices[edge.ends[0]].to, wave.vertices[edge.ends[1]].to};
    const auto is_own = [&](int triangle) {
      return std::ranges::any_of(solid.edge_triangles[edges_of(ideal, chain).front()], [&](int t) {
        return ideal.triangle_region[t] == triangle_region[triangle];
      });
    };
    const Vec3& a = solid.vertices[chain.first];
    const double length = (solid.vertices[chain.last] - a).norm();
    const double flat = reach * std::cos(psi / 2);
    out.volume_lost += length * (flat * eps - 0.5 * (kPi - psi) * eps * eps);  // (ERO-9)
    for (int i = 1; i < 8; ++i) {
      const Vec3 inner = ends[0] + i / 8.0 * (ends[1] - ends[0]);
      const double along = chain.direction.dot(inner - a);
      if (along < 0 || along > length) continue;
      const Vec3 x = a + along * chain.direction;
      const SurfacePoint foot = eroded.nearest(x);
      if (is_own(foot.triangle) &&
          (foot.x - inner).norm() <= 0.01 * eps)  // else another face is nearer, and nothing is predicted
        out.edge_error = std::max(out.edge_error, std::abs(foot.distance - reach));
    }
  }
  std::vector<int> pieces(fans.size(), 0);
  std::vector<char> merged(fans.size(), 0);
  for (const WaveVertex& w : wave.vertices) {
    for (int f : w.fans) {
      pieces[f] += w.since == 0;
      merged[f] |= w.fans.size() > 1;
    }
    if (!w.alive) continue;
    out.deviating_vertices += w.deviation > options.meet;
    out.deviation = std::max(out.deviation, eps * w.deviation);
    for (int f : w.fans) {
      const auto v = std::size_t(fans[f].vertex);
      if (convex_end[v])
        out.rounding_bound = std::max(out.rounding_bound, (w.to - solid.vertices[v]).norm() - eps);
    }
  }
  out.split_vertices = int(std::ranges::count_if(pieces, [](int n) { return n > 1; }));
  out.merged_vertices = int(std::ranges::count(merged, 1));
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
       << result.ideal.triangle_region[thin.triangle] << ", which is not more than twice the depth, "
       << 2 * depth << " m: take a smaller dilation, or model a thin plate as a sheet";
  result.reason += text.str();
}

/// Rounded down.
double two_digits(double x) {
  const double power = std::floor(std::log10(x)) - 1;
  const double digits = std::floor(x * std::pow(10, -power) * (1 + 1e-12));
  return power < 0 ? digits / std::pow(10, -power) : digits * std::pow(10, power);
}

/// Keeps the measures.
ErosionResult give_up(ErosionResult result, ErosionStatus status, const std::string& reason) {
  result.status = status;
  result.reason = reason;
  result.complex = {};
  result.triangle_region.clear();
  return result;
}

}  // namespace

constexpr Named<ErosionStatus> kErosionStatuses[] = {{ErosionStatus::done, "done"},
                                                     {ErosionStatus::not_solid, "not_solid"},
                                                     {ErosionStatus::unsettled_vertex, "unsettled_vertex"},
                                                     {ErosionStatus::lost_edge, "lost_edge"},
                                                     {ErosionStatus::lost_face, "lost_face"},
                                                     {ErosionStatus::inside_out, "inside_out"},
                                                     {ErosionStatus::self_intersecting, "self_intersecting"},
                                                     {ErosionStatus::too_shallow, "too_shallow"},
                                                     {ErosionStatus::too_round, "too_round"}};

const char* to_string(ErosionStatus status) {
  return name_of(status, kErosionStatuses);
}

double interior_angle(const SimplicialComplex& k, const Idealisation& ideal, const Chain& chain) {
  const int edge = edges_of(ideal, chain).front();
  const auto both = k.edge_triangles[edge];
  const Vec3 &n = ideal.region_normal[ideal.triangle_region[both[0]]],
             &m = ideal.region_normal[ideal.triangle_region[both[1]]];
  const auto corner = corner_at(k, both[0], chain.first);
  const bool along = k.triangle_edges[both[0]][corner] == edge;
  return kPi - std::atan2(n.cross(m).dot(chain.direction) * (along ? 1 : -1), n.dot(m));
}

void describe(SettingVisitor& visit, ErosionOptions& o) {
  visit.begin("ErosionOptions");
  visit.number({.name = "depth",
                .what = "dilation of the part, and depth of its erosion",
                .unit = "m",
                .range = positive_range(),
                .flag = "--dilation"},
               o.depth);
  visit.number(planarity_setting(), o.planarity);
  visit.number({"meet", "distance of planes from a point at which they meet, in depths", "-",
                range_open_below(0, 1e-2)},
               o.meet);
  visit.number({.name = "deviation",
                .what = "largest distance of planes from a vertex that cannot be split, in depths; 0: refuse",
                .unit = "-",
                .range = {0, 0.1},
                .flag = "--deviation"},
               o.deviation);
  visit.toggle(
      {.name = "split",
       .what = "never split a vertex: fewer triangles on round surfaces, but up to --deviation of error",
       .flag = "--no-split=false"},
      o.split);
  visit.toggle({"contract", "let edges vanish that would turn around"}, o.contract);
  visit.number({.name = "max_rounding",
                .what = "largest rounding; an erosion that rounds by more is refused",
                .unit = "m",
                .range = range_above(0),
                .flag = "--max-rounding"},
               o.max_rounding);
  visit.count({.name = "samples",
               .what = "approximate number of sample points per surface for the measures",
               .unit = "",
               .range = {1, 1e8},
               .flag = "--samples"},
              o.samples);
}

ErosionResult erode(const SimplicialComplex& solid, const ErosionOptions& options) {
  check_ranges(options);
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
  const std::vector<Fan> fans = find_fans(solid, result.ideal);
  ErosionTrial attempt = attempt_erosion(solid, tree, result.ideal, fans, options);
  if (attempt.made.failure) {
    refuse(result, solid, tree, *attempt.made.failure, options.depth);
    return result;
  }
  result.complex = std::move(attempt.complex);
  const RegionOffset& made = attempt.made;
  result.triangle_region = made.triangle_region;
  const SurfaceTree inner(result.complex);
  const auto rounded = rounded_parts(solid, result.ideal, fans, made.wave, options.depth);
  result.measures = measure_erosion_where(
      solid, result.complex, inner, options.depth, options.samples,
      [&](int t, const Vec3& x, const SurfacePoint&) {
        const auto region = result.ideal.triangle_region[t];
        return std::ranges::none_of(rounded[region], [&](const Rounded& r) { return within(r, x); });
      });
  predict(solid, result.ideal, fans, made.wave, made.triangle_region, inner, options, result.measures);
  if (result.measures.shallow >
      options.depth - least_depth(made.wave, options, size) + 2 * result.ideal.tolerance) {
    std::ostringstream text;
    text << "the eroded surface would come closer than the depth to the solid's surface by "
         << result.measures.shallow << " m";
    return give_up(std::move(result), ErosionStatus::too_shallow, text.str());
  }
  if (result.measures.rounding > options.max_rounding) {
    std::ostringstream text;
    text << "convex edges or corners would be rounded by " << result.measures.rounding << " m, more than "
         << options.max_rounding << " m";
    return give_up(std::move(result), ErosionStatus::too_round, text.str());
  }
  return result;
}

std::optional<double> erodible_depth(const SimplicialComplex& solid, ErosionOptions options) {
  const auto works = [&](double depth) {
    options.depth = depth;
    return erode(solid, options).ok();
  };
  double high = options.depth, low = two_digits(high / 2);
  for (int halved = 1; !works(low); ++halved) {
    if (halved == 10) return std::nullopt;
    high = low;
    low = two_digits(low / 2);
  }
  for (double middle; (middle = two_digits(0.5 * (low + high))) > low;) (works(middle) ? low : high) = middle;
  return low;
}

}  // namespace aussois
