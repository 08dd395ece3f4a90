// SPDX-License-Identifier: Apache-2.0
#include "lmd/wavefront.hpp"

#include <cmath>
#include <map>
#include <queue>
#include <set>
#include <tuple>

namespace aussois {
namespace {

constexpr double kShort = 1e-9;     // depths: an edge of no length
constexpr int kEventsPerEdge = 50;  // more than these would be no progress

class Front {
 public:
  Front(const Idealisation& ideal, const WaveOptions& options) : ideal_(ideal), o_(options) {}

  Wavefront wave{};

  void start(const SimplicialComplex& solid, const std::vector<Fan>& fans, const FanOptions& of_fan) {
    for (const Chain& chain : ideal_.chains)
      wave.edges.push_back({.direction = chain.direction, .chain = int(&chain - ideal_.chains.data())});
    std::map<int, int> loose;  // border edges of the solid that are no chain's, being shorter than rounding
    for (std::size_t f = 0; f < fans.size(); ++f) {
      const Fan& fan = fans[f];
      const Vec3& x = solid.vertices[fan.vertex];
      WaveVertex v{.fans = {int(f)}, .from = x};
      const std::size_t d = fan.regions.size();
      for (std::size_t s = 0; s < d && d > 1; ++s) {
        const Corner& c = fan.first[s];
        const int edge = solid.triangle_edges[c.triangle][c.side];
        const int chain = ideal_.edge_chain[edge];
        const int r = fan.regions[s];
        const auto [at, is_new] =
            chain >= 0 ? std::pair(loose.end(), false) : loose.try_emplace(edge, int(wave.edges.size()));
        if (is_new) wave.edges.push_back({});
        v.sectors.push_back({chain >= 0 ? chain : at->second, r, normal(r).dot(x)});
      }
      if (d < 2 || (d == 2 && v.sectors[0].edge == v.sectors[1].edge)) continue;  // inside a face or chain
      const int index = int(wave.vertices.size());
      for (const WaveSector& s : v.sectors) {
        WaveEdge& e = wave.edges[s.edge];
        const bool first = e.chain >= 0 ? ideal_.chains[e.chain].first == fan.vertex : e.ends[0] < 0;
        e.ends[first ? 0 : 1] = index;
      }
      wave.vertices.push_back(std::move(v));
    }
    for (const auto& [edge, index] : loose) {
      WaveEdge& e = wave.edges[index];
      e.direction = (vertex(e.ends[1]).from - vertex(e.ends[0]).from).stableNormalized();
    }
    std::map<int, std::vector<int>> groups;
    for (int v = 0; v < int(wave.vertices.size()); ++v) groups[of_fan.group[vertex(v).fans[0]]].push_back(v);
    for (const auto& [first, group] : groups) {
      std::set<int> inner, pending;  // edges
      for (int v : group)
        for (const WaveSector& s : vertex(v).sectors)
          if (std::ranges::binary_search(group, across(edge(s.edge), v))) inner.insert(s.edge);
      for (int e : inner)
        if (edge(e).alive) merge(group_of(e, inner), pending);
      for (const std::set<int> look = pending; int v : look) drop_lines(v, pending);
    }
    const int count = int(wave.vertices.size());
    for (int v = 0; v < count; ++v)
      if (vertex(v).alive) settle(v, o_.split && !of_fan.whole[vertex(v).fans[0]]);
    stamp_.assign(wave.edges.size(), 0);
    for (int e = 0; e < int(wave.edges.size()); ++e) await(e);
  }

  void run() {
    const std::size_t most = std::size_t(kEventsPerEdge) * wave.edges.size();
    while (!queue_.empty() && wave.events.size() < most) {
      const auto [time, edge, stamp] = queue_.top();
      queue_.pop();
      if (!is_due(edge, stamp)) continue;
      now_ = std::max(now_, time);
      wave.events.push_back(edge);
      std::vector<int> due{edge};  // with all that happen at the same time
      while (!queue_.empty() && std::get<0>(queue_.top()) <= now_ + o_.together * o_.depth) {
        const auto [time_too, edge_too, stamp_too] = queue_.top();
        queue_.pop();
        if (is_due(edge_too, stamp_too)) due.push_back(edge_too);
      }
      collapse(due);
    }
  }

 private:
  using Event = std::tuple<double, int, int>;  // depth, edge, stamp of the edge

  const Vec3& normal(int region) const { return ideal_.region_normal[region]; }
  WaveVertex& vertex(int i) { return wave.vertices[i]; }
  WaveEdge& edge(int i) { return wave.edges[i]; }

  Vec3 position(const WaveVertex& v, double at) const {
    const double way = o_.depth - v.since;
    return way > 0 ? Vec3(v.from + (at - v.since) / way * (v.to - v.from)) : v.to;
  }

  bool is_due(int e, int stamp) { return edge(e).alive && stamp == stamp_[e]; }

  // Puts the depth at which an edge will have shrunk to nothing into the queue (ERO-10).
  void await(int index) {
    const WaveEdge& e = edge(index);
    const int stamp = ++stamp_[index];
    const WaveVertex &a = vertex(e.ends[0]), &b = vertex(e.ends[1]);
    const double last = e.direction.dot(b.to - a.to);
    if (last > kShort * o_.depth) return;
    const double first = e.direction.dot(position(b, now_) - position(a, now_));
    const double time = first > 0 ? now_ + (o_.depth - now_) * first / (first - std::min(last, 0.0)) : now_;
    queue_.emplace(std::min(time, o_.depth), index, stamp);
  }

  // The ends of the edges that are due meet; what is left around them are new vertices.
  void collapse(const std::vector<int>& due) {
    const std::set<int> all_due(due.begin(), due.end());
    std::set<int> pending, changed;
    for (int e : due)
      if (edge(e).alive) merge(group_of(e, all_due), pending);
    for (const std::set<int> look = pending; int v : look) drop_lines(v, pending);
    for (int v : pending)
      if (vertex(v).alive) {
        const auto first_new = wave.edges.size();
        settle(v, o_.split);
        for (auto e = first_new; e < wave.edges.size(); ++e) changed.insert(int(e));
      }
    stamp_.resize(wave.edges.size(), 0);
    for (int v : touched_)
      for (const WaveSector& s : vertex(v).sectors) changed.insert(s.edge);
    touched_.clear();
    for (int e : changed)
      if (edge(e).alive) await(e);
  }

  // The vertices joined by edges that are due, one of them this one.
  std::vector<int> group_of(int start, const std::set<int>& due) {
    std::vector<int> group{edge(start).ends[0]};
    for (std::size_t i = 0; i < group.size(); ++i)
      for (const WaveSector& s : vertex(group[i]).sectors)
        if (due.contains(s.edge)) {
          const int other = across(edge(s.edge), group[i]);
          if (std::ranges::find(group, other) == group.end()) group.push_back(other);
        }
    return group;
  }

  // Each way around the rim of the group becomes a vertex; regions and edges inside are gone.
  void merge(const std::vector<int>& group, std::set<int>& pending) {
    WaveVertex made{.since = now_};
    for (int v : group) {
      made.from += position(vertex(v), now_) / double(group.size());
      made.fans.insert(made.fans.end(), vertex(v).fans.begin(), vertex(v).fans.end());
    }
    std::ranges::sort(made.fans);
    made.fans.erase(std::unique(made.fans.begin(), made.fans.end()), made.fans.end());
    const auto in_group = [&](int v) { return std::ranges::find(group, v) != group.end(); };
    std::set<std::pair<int, int>> seen;
    std::vector<WaveVertex> rims;
    for (int v : group)
      for (int s = 0; s < int(vertex(v).sectors.size()); ++s) {
        if (in_group(across(edge(vertex(v).sectors[s].edge), v)) || seen.contains({v, s})) continue;
        rims.push_back(made);
        for (int at = v, i = s; !seen.contains({at, i});) {
          seen.insert({at, i});
          rims.back().sectors.push_back(vertex(at).sectors[i]);
          for (;;) {
            i = (i + 1) % int(vertex(at).sectors.size());
            const int e = vertex(at).sectors[i].edge, other = across(edge(e), at);
            if (!in_group(other)) break;
            at = other;
            i = sector_of(vertex(at), e);
          }
        }
      }
    for (int v : group) {
      vertex(v).alive = false;
      for (const WaveSector& s : vertex(v).sectors)
        if (in_group(across(edge(s.edge), v))) inner_.push_back(s.edge);
    }
    for (int e : inner_) edge(e).alive = false;
    inner_.clear();
    for (WaveVertex& rim : rims) {
      const int index = int(wave.vertices.size());
      for (const WaveSector& s : rim.sectors)
        for (int& end : edge(s.edge).ends)
          if (in_group(end)) end = index;
      pending.insert(index);
      wave.vertices.push_back(std::move(rim));
    }
  }

  // Faces between two edges that join the same two vertices are lines: they vanish, and the edges are one.
  void drop_lines(int index, std::set<int>& pending) {
    for (std::size_t i = 0; vertex(index).alive && i < vertex(index).sectors.size();) {
      std::vector<WaveSector>& here = vertex(index).sectors;
      const std::size_t after = (i + 1) % here.size();
      const int e = here[i].edge, f = here[after].edge, other = across(edge(e), index);
      const int region = here[i].region;
      std::vector<WaveSector>& there = vertex(other).sectors;
      const auto k = std::size_t(sector_of(vertex(other), f));
      const bool line = e != f && other != index && across(edge(f), index) == other &&
                        there[k].region == region && there[(k + 1) % there.size()].edge == e;
      if (!line) {
        ++i;
        continue;
      }
      here[after].edge = e;
      here.erase(here.begin() + long(i));
      there.erase(there.begin() + long(k));
      edge(f).alive = false;
      edge(e).chain = -1;
      if (pending.insert(other).second) restart(vertex(other));
      if (here.size() < 2) vertex(index).alive = vertex(other).alive = edge(e).alive = false;
      i = 0;
    }
  }

  void restart(WaveVertex& v) {
    v.from = position(v, now_);
    v.since = now_;
  }

  std::vector<VertexPlane> planes_of(const WaveVertex& v) {
    const double way = o_.depth - v.since;
    std::vector<VertexPlane> planes;
    for (const WaveSector& s : v.sectors) {
      const WaveEdge& e = edge(s.edge);
      const double sense = &v == &vertex(e.ends[0]) ? 1 : -1;
      planes.push_back({normal(s.region), sense * e.direction,
                        (s.offset - normal(s.region).dot(v.from)) / way - o_.depth / way});
    }
    return planes;
  }

  // Where a new vertex goes; it becomes several if its planes require it.
  void settle(int index, bool split) {
    touched_.push_back(index);
    const double way = o_.depth - vertex(index).since;
    if (!(way > kShort * o_.depth)) {
      vertex(index).to = vertex(index).from;
      return;
    }
    const std::vector<VertexPlane> planes = planes_of(vertex(index));
    const double scale = o_.depth / way;  // tolerances are lengths
    const std::optional<Mitre> m = mitre(planes, {o_.meet * scale, o_.deviation * scale, split});
    if (m && m->points.size() > 1) return part(index, *m);
    const Vec3 p = m ? m->points[0] : least_mitre(planes);
    WaveVertex& v = vertex(index);
    v.to = v.from + way * p;
    v.deviation = 0;
    for (const VertexPlane& plane : planes)
      v.deviation = std::max(v.deviation, std::abs(plane.normal.dot(p) - plane.offset) / scale);
  }

  // The vertex becomes the points of a mitre, joined by edges where two follow each other on a plane.
  void part(int index, const Mitre& m) {
    const WaveVertex old = vertex(index);
    vertex(index).alive = false;
    const double way = o_.depth - old.since;
    const int base = int(wave.vertices.size());
    for (const Vec3& p : m.points)
      wave.vertices.push_back({.fans = old.fans,
                               .since = old.since,
                               .from = old.from,
                               .to = old.from + way * p,
                               .deviation = m.deviation * way / o_.depth});
    std::map<std::pair<int, int>, int> between;
    const auto edge_between = [&](int p, int q) {
      const auto [at, is_new] = between.try_emplace(std::minmax(p, q), int(wave.edges.size()));
      if (is_new) {
        const Vec3 d = m.points[q] - m.points[p];
        wave.edges.push_back({.ends = {base + p, base + q}, .direction = d.stableNormalized()});
      }
      return at->second;
    };
    // The sectors at each point; each ends with the edge that starts the next.
    std::vector<std::vector<std::pair<WaveSector, int>>> at(m.points.size());
    const std::size_t d = old.sectors.size();
    for (std::size_t i = 0; i < d; ++i) {
      const std::vector<int>& path = m.of_plane[i];
      WaveSector s = old.sectors[i];
      for (int& end : edge(s.edge).ends)
        if (end == index) end = base + path.front();
      for (std::size_t k = 0; k < path.size(); ++k) {
        const int next =
            k + 1 < path.size() ? edge_between(path[k], path[k + 1]) : old.sectors[(i + 1) % d].edge;
        at[path[k]].emplace_back(s, next);
        s.edge = next;
      }
    }
    for (std::size_t p = 0; p < at.size(); ++p) {
      std::vector<WaveSector>& sectors = vertex(base + int(p)).sectors;
      int next = at[p][0].first.edge;
      for (std::size_t n = 0; n < at[p].size(); ++n)
        for (const auto& [s, after] : at[p])
          if (s.edge == next) {
            sectors.push_back(s);
            next = after;
            break;
          }
      touched_.push_back(base + int(p));
    }
  }

  const Idealisation& ideal_;
  const WaveOptions& o_;
  double now_ = 0;  // depth [m]
  std::vector<int> stamp_{};
  std::vector<int> touched_{}, inner_{};
  std::priority_queue<Event, std::vector<Event>, std::greater<>> queue_{};
};

}  // namespace

Wavefront move_planes(const SimplicialComplex& solid, const Idealisation& ideal, const std::vector<Fan>& fans,
                      const FanOptions& of_fan, const WaveOptions& options) {
  Front front(ideal, options);
  front.start(solid, fans, of_fan);
  front.run();
  return std::move(front.wave);
}

}  // namespace aussois
