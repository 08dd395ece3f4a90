// SPDX-License-Identifier: Apache-2.0
// Each defect is made by hand on a mesh that has none, so what the repair must do is known.
#include "geometry/mesh_repair.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include <gtest/gtest.h>

#include "geometry/fastener.hpp"
#include "geometry/primitives.hpp"
#include "geometry/repair_steps.hpp"
#include "tests/support/compound.hpp"
#include "tests/support/mesh_damage.hpp"
#include "tests/support/message_of.hpp"

namespace aussois {
namespace {

using Triangle = std::array<int, 3>;
using Triangles = std::vector<Triangle>;
using Places = std::vector<std::array<std::array<double, 3>, 3>>;

bool same_bits(const SimplicialComplex& a, const SimplicialComplex& b) {
  return a.vertices == b.vertices && a.triangles == b.triangles && a.edges == b.edges;
}

// Triangles by the places of their corners, the smallest first, sorted: a mesh without its numbering.
Places places_of(const SimplicialComplex& complex) {
  Places places;
  for (const Triangle& triangle : complex.triangles) {
    std::array<std::array<double, 3>, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& x = complex.vertices[triangle[k]];
      corners[k] = {x.x(), x.y(), x.z()};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    places.push_back(corners);
  }
  std::ranges::sort(places);
  return places;
}

SimplicialComplex soup_of(const SimplicialComplex& complex, double jiggle, Random& random) {
  return complex_of(soup_of(loose(complex), jiggle, random));
}

// The box [-1, 1]^3 whose face x = 1 has the edge y = 1 in `pieces`, while the face y = 1 keeps it whole:
// open by T-junctions only.
SimplicialComplex box_with_t_junctions(int pieces) {
  SimplicialComplex box = make_box(2, 2, 2);
  std::vector<Vec3> vertices = box.vertices.to_vector();
  const auto find = [&](double x, double y, double z) {
    return int(std::ranges::find(vertices, Vec3(x, y, z)) - vertices.begin());
  };
  const int lower = find(1, 1, -1), upper = find(1, 1, 1);
  Triangles triangles;
  for (const Triangle& t : box.triangles) {
    const bool on_face = std::ranges::all_of(t, [&](int v) { return vertices[v].x() == 1; });
    const bool at_edge = std::ranges::count(t, lower) + std::ranges::count(t, upper) == 2;
    if (!on_face || !at_edge) {
      triangles.push_back(t);
      continue;
    }
    const auto k =
        std::size_t(std::ranges::find_if(t, [&](int v) { return v != lower && v != upper; }) - t.begin());
    const int apex = t[k], from = t[(k + 1) % 3], to = t[(k + 2) % 3];
    int last = from;
    for (int i = 1; i <= pieces; ++i) {
      const double s = double(i) / pieces;
      const Vec3 x = (1 - s) * vertices[from] + s * vertices[to];
      const int next = i == pieces ? to : int(vertices.size());
      if (i < pieces) vertices.push_back(x);
      triangles.push_back({apex, last, next});
      last = next;
    }
  }
  return make_complex(vertices, triangles);
}

TEST(MeshRepair, GivesBackWhatNeedsNoneBitForBit) {
  const std::vector<SimplicialComplex> clean = {
      make_box(1, 2, 3),
      make_cylinder(1, 2, 24),
      make_sphere(1, 3),
      make_torus(2, 0.5, 20, 12),
      make_bolt(),
      make_nut(),
      make_plate(1, 1, 3, 4),
      make_segment(1),
      make_point(),
      make_polyline({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}),
      merged({make_box(1, 1, 1), moved(make_box(1, 1, 1), 2, 0, 0)})};
  for (const SimplicialComplex& complex : clean) {
    const RepairedMesh repaired = repair_mesh(complex);
    EXPECT_TRUE(same_bits(repaired.complex, complex));
    EXPECT_FALSE(repaired.report.changed());
    EXPECT_EQ(to_string(repaired.report), "");
    EXPECT_EQ(repaired.complex.solid, is_closed_oriented(complex));
    EXPECT_EQ(repaired.report.reason.empty(), repaired.complex.solid);
    for (std::size_t i = 0; i < complex.vertices.size(); ++i) EXPECT_EQ(repaired.vertex[i], int(i));
  }
}

TEST(MeshRepair, RejectsAToleranceOutOfRange) {
  const SimplicialComplex box = make_box(1, 1, 1);
  EXPECT_NE(message_of([&] { repair_mesh(box, {.relative_tolerance = 0.1}); }).find("0.1"),
            std::string::npos);
  EXPECT_NE(message_of([&] { repair_mesh(box, {.largest_tolerance = -1}); }).find("largest_tolerance = -1"),
            std::string::npos);
}

TEST(MeshRepair, WeldsASoupToTheSolidItWasCutFrom) {
  Random random(1);
  for (const SimplicialComplex& whole : {make_box(1, 2, 3), make_cylinder(1, 2, 24), make_bolt()}) {
    const SimplicialComplex soup = soup_of(whole, 0, random);
    const RepairedMesh repaired = repair_mesh(soup);
    EXPECT_TRUE(repaired.complex.solid) << repaired.report.reason;
    EXPECT_EQ(places_of(repaired.complex), places_of(whole));
    EXPECT_EQ(repaired.report.welded_same.count, int(soup.vertices.size() - whole.vertices.size()));
    EXPECT_EQ(repaired.report.welded_near.count, 0);
    for (std::size_t i = 0; i < soup.vertices.size(); ++i)
      EXPECT_EQ(repaired.complex.vertices[repaired.vertex[i]], soup.vertices[i]);
  }
}

TEST(MeshRepair, WeldsWithinTheToleranceAndMovesNothingFarther) {
  Random random(2);
  for (const SimplicialComplex& whole : {make_box(1, 2, 3), make_cylinder(1, 2, 24), make_bolt()}) {
    const double tau = 1e-6 * bounding_box(whole).diagonal();
    const SimplicialComplex soup = soup_of(whole, 0.5 * tau, random);  // so that all are in reach of each
    const RepairedMesh repaired = repair_mesh(soup);
    EXPECT_TRUE(repaired.complex.solid) << repaired.report.reason;
    EXPECT_EQ(repaired.complex.triangles.size(), whole.triangles.size());
    EXPECT_EQ(repaired.report.welded_near.count, int(soup.vertices.size() - whole.vertices.size()));
    EXPECT_GT(repaired.report.welded_near.distance, 0.3 * tau) << "the sample is hollow";
    double farthest = 0;
    for (std::size_t i = 0; i < soup.vertices.size(); ++i)
      farthest =
          std::max(farthest, (repaired.complex.vertices[repaired.vertex[i]] - soup.vertices[i]).norm());
    EXPECT_LE(farthest, repaired.report.tolerance);
    EXPECT_DOUBLE_EQ(farthest, repaired.report.welded_near.distance);
  }
}

TEST(MeshRepair, KeepsApartWhatTheCallerBoundsTheToleranceBelow) {
  SimplicialComplex box = make_box(1, 1, 1);
  Random random(3);
  const SimplicialComplex soup = soup_of(box, 5e-7, random);
  EXPECT_TRUE(repair_mesh(soup).complex.solid);
  const RepairedMesh bounded = repair_mesh(soup, {.largest_tolerance = 1e-9});
  EXPECT_FALSE(bounded.complex.solid);
  EXPECT_TRUE(same_bits(bounded.complex, soup));
  EXPECT_EQ(bounded.report.tolerance, 1e-9);
  EXPECT_EQ(bounded.report.after.border_edges, 36);
}

TEST(MeshRepair, DropsDuplicatesOfEitherWinding) {
  SimplicialComplex box = make_box(1, 1, 1);
  Triangles triangles = box.triangles.to_vector();
  const Triangle t = triangles[3], u = triangles[7];
  triangles.push_back({t[1], t[2], t[0]});
  triangles.push_back({u[0], u[2], u[1]});
  triangles.insert(triangles.begin(), {u[2], u[1], u[0]});  // the first of its three, and the wrong way round
  const RepairedMesh repaired = repair_mesh(make_complex(box.vertices, triangles));
  EXPECT_TRUE(repaired.complex.solid) << repaired.report.reason;
  EXPECT_EQ(repaired.report.duplicate_triangles.count, 3);
  EXPECT_EQ(repaired.report.turned_triangles.count, 1);
  EXPECT_EQ(places_of(repaired.complex), places_of(box));
}

TEST(MeshRepair, FlipsTheTrianglesThatPlugTJunctions) {
  // Closed by a chain of `pieces` triangles of no area, as CAD kernels write them.
  for (const int pieces : {2, 3, 7}) {
    const SimplicialComplex open = box_with_t_junctions(pieces);
    Triangles triangles = open.triangles.to_vector();
    const auto at = [&](double z) {
      return int(std::ranges::find_if(
                     open.vertices,
                     [&](const Vec3& x) { return x.x() == 1 && x.y() == 1 && std::abs(x.z() - z) < 1e-12; }) -
                 open.vertices.begin());
    };
    for (int i = 1; i < pieces; ++i)  // a fan from the lower end
      triangles.push_back({at(-1), at(-1 + 2.0 * (i + 1) / pieces), at(-1 + 2.0 * i / pieces)});
    const SimplicialComplex plugged = make_complex(open.vertices, triangles);
    const MeshReport before = report_mesh(plugged);
    ASSERT_TRUE(before.closed);
    ASSERT_EQ(before.degenerate_triangles, pieces - 1);
    ASSERT_GT(before.self_intersections, 0);
    const RepairedMesh repaired = repair_mesh(plugged);
    EXPECT_TRUE(repaired.complex.solid) << repaired.report.reason;
    EXPECT_GE(repaired.report.flipped_slivers.count, pieces - 1);
    EXPECT_EQ(repaired.report.slivers_left, 0);
    EXPECT_EQ(repaired.report.after.triangles, before.triangles) << "flipped, not deleted";
    EXPECT_EQ(repaired.report.after.degenerate_triangles, 0);
    EXPECT_NEAR(signed_volume(repaired.complex), 8, 1e-12);
  }
}

TEST(MeshRepair, DropsASliverOnlyWhereOtherTrianglesHaveItsEdges) {
  // A sliver over the edge of two triangles that no third one shares.
  const std::vector<Vec3> x = {{0, 0, 0}, {2, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 1, 0}, {1, 1, 0}};
  const Triangles sheet = {{0, 2, 3}, {2, 1, 4}};
  Triangles with_sliver = sheet;
  with_sliver.push_back({0, 1, 2});
  const RepairedMesh repaired = repair_mesh(make_complex(x, with_sliver));
  EXPECT_EQ(repaired.report.dropped_slivers.count, 1);
  EXPECT_EQ(repaired.complex.triangles, sheet);
  EXPECT_EQ(repaired.complex.vertices, x) << "the isolated point stays";

  const SimplicialComplex alone = make_complex({x[0], x[1], x[2]}, {{0, 1, 2}});
  const RepairedMesh kept = repair_mesh(alone);
  EXPECT_TRUE(same_bits(kept.complex, alone)) << "dropping it would lose a segment of the shape";
  EXPECT_EQ(kept.report.slivers_left, 1);
}

TEST(MeshRepair, ClosesTJunctionsOfAnyNumber) {
  for (const int pieces : {2, 3, 8, 100}) {
    const SimplicialComplex open = box_with_t_junctions(pieces);
    ASSERT_EQ(report_mesh(open).border_edges, pieces + 1);
    const RepairedMesh repaired = repair_mesh(open);
    EXPECT_TRUE(repaired.complex.solid) << repaired.report.reason;
    EXPECT_EQ(repaired.report.split_edges.count, pieces - 1);
    EXPECT_EQ(repaired.report.after.triangles, 12 + 2 * (pieces - 1));
    EXPECT_EQ(repaired.complex.vertices, open.vertices) << "no vertex moves";
    EXPECT_NEAR(signed_volume(repaired.complex), 8, 1e-12);
  }
}

// Both sides of an edge are cut, one at thirds and one at quarters: all five points go into both.
TEST(MeshRepair, ClosesTJunctionsFromBothSides) {
  std::vector<Vec3> x = {{0, 0, 0}, {12, 0, 0}, {6, 6, 0}, {6, -6, 0}};
  Triangles triangles;
  const auto fan = [&](int apex, const std::vector<double>& at, bool reversed) {
    int last = 0;
    for (const double s : at) {
      int next = 1;
      if (s < 12) next = int(x.size()), x.push_back({s, 0, 0});
      triangles.push_back(reversed ? Triangle{apex, next, last} : Triangle{apex, last, next});
      last = next;
    }
  };
  fan(2, {4, 8, 12}, false);
  fan(3, {3, 6, 9, 12}, true);
  const RepairedMesh repaired = repair_mesh(make_complex(x, triangles));
  EXPECT_EQ(repaired.report.after.border_edges, 4);
  EXPECT_EQ(repaired.report.after.misoriented_edges, 0);
  EXPECT_EQ(repaired.report.split_edges.count, 5);
  EXPECT_EQ(repaired.complex.triangles.size(), 12U);
  EXPECT_EQ(repaired.report.after.self_intersections, 0);
}

TEST(MeshRepair, SplitsOnAllSidesOfATriangle) {
  // The outer triangle shares its three sides with three strips, each in other pieces.
  Random random(4);
  const std::vector<Vec3> corner = {{0, 0, 0}, {1, 0, 0}, {0.3, 0.8, 0}};
  std::vector<Vec3> x = corner;
  Triangles triangles = {{0, 1, 2}};
  for (int k = 0; k < 3; ++k) {
    const Vec3 &a = corner[k], &b = corner[(k + 1) % 3];
    const int apex = int(x.size());
    x.push_back(a + b - (corner[0] + corner[1] + corner[2]) / 3);
    int last = k;
    for (int i = 1; i <= k + 2; ++i) {
      int next = (k + 1) % 3;
      if (i < k + 2)
        next = int(x.size()), x.push_back(a + (i + 0.4 * random.uniform(-1, 1)) / (k + 2) * (b - a));
      triangles.push_back({apex, next, last});
      last = next;
    }
  }
  const RepairedMesh repaired = repair_mesh(make_complex(x, triangles));
  EXPECT_EQ(repaired.report.split_edges.count, 1 + 2 + 3);
  EXPECT_EQ(repaired.report.after.border_edges, 6);
  EXPECT_EQ(repaired.report.after.self_intersections, 0);
  EXPECT_EQ(repaired.report.after.misoriented_edges, 0);
  EXPECT_EQ(repaired.complex.triangles.size(), triangles.size() + 6);
}

TEST(MeshRepair, LeavesAVertexThatOnlyTouchesAnEdge) {
  // Two sheets meet in one point: nothing would be closed by a split.
  const SimplicialComplex sheets = make_complex(
      {{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, -1, 0.5}, {2, -1, 0.5}}, {{0, 1, 2}, {3, 4, 5}});
  EXPECT_TRUE(same_bits(repair_mesh(sheets).complex, sheets));
}

TEST(MeshRepair, TurnsTheFewestTrianglesToAgree) {
  SimplicialComplex bolt = make_bolt();
  Triangles triangles = bolt.triangles.to_vector();
  Random random(5);
  int wrong = 0;
  for (Triangle& t : triangles)
    if (random.uniform() < 0.3) std::swap(t[0], t[1]), ++wrong;
  const RepairedMesh repaired = repair_mesh(make_complex(bolt.vertices, triangles));
  EXPECT_TRUE(repaired.complex.solid) << repaired.report.reason;
  EXPECT_EQ(repaired.report.turned_triangles.count, wrong);
  EXPECT_EQ(repaired.report.turned_shells.count, 0);
  EXPECT_EQ(places_of(repaired.complex), places_of(bolt));
}

TEST(MeshRepair, TurnsAShellThatFacesInwards) {
  const SimplicialComplex box = make_box(1, 1, 1);
  const RepairedMesh repaired = repair_mesh(merged({box, inside_out(moved(box, 3, 0, 0))}));
  EXPECT_TRUE(repaired.complex.solid);
  EXPECT_EQ(repaired.report.shells, 2);
  EXPECT_EQ(repaired.report.turned_shells.count, 1);
  EXPECT_EQ(repaired.report.turned_triangles.count, 0);
  EXPECT_NEAR(signed_volume(repaired.complex), 2, 1e-14);
}

TEST(MeshRepair, FacesNestedShellsInAndOutByTurns) {
  // A hollow box with a hollow ball in its cavity, and a box beside; whatever way the five shells are given.
  const std::vector<SimplicialComplex> shells = {make_box(4, 4, 4), make_box(3, 3, 3), make_sphere(1, 2),
                                                 make_sphere(0.5, 2), moved(make_box(1, 1, 1), 4, 0, 0)};
  const std::vector<double> sign = {1, -1, 1, -1, 1};
  double volume = 0;
  for (std::size_t i = 0; i < 5; ++i) volume += sign[i] * signed_volume(shells[i]);
  for (unsigned given = 0; given < 32; ++given) {
    std::vector<SimplicialComplex> parts;
    int wrong = 0;
    for (std::size_t i = 0; i < 5; ++i) {
      const bool inwards = (given >> i & 1U) != 0;
      parts.push_back(inwards ? inside_out(shells[i]) : shells[i]);
      wrong += inwards == (sign[i] > 0);
    }
    const RepairedMesh repaired = repair_mesh(merged(parts));
    EXPECT_TRUE(repaired.complex.solid) << repaired.report.reason;
    EXPECT_EQ(repaired.report.turned_shells.count, wrong);
    EXPECT_NEAR(signed_volume(repaired.complex), volume, 1e-12);
  }
}

TEST(MeshRepair, NeverCallsASolidWhatIsNone) {
  struct Case {
    SimplicialComplex complex{};
    std::string reason{};
  };
  SimplicialComplex box = make_box(1, 1, 1);
  Triangles hole = box.triangles.to_vector();
  hole.pop_back();
  Triangles fin = box.triangles.to_vector();
  std::vector<Vec3> fin_vertices = box.vertices.to_vector();
  fin_vertices.push_back({3, 3, 3});
  fin.push_back({box.triangles[0][0], box.triangles[0][1], 8});
  const Triangles moebius = {{0, 1, 2}, {1, 3, 2}, {2, 3, 4}, {3, 5, 4}, {4, 5, 1}, {5, 0, 1}};
  std::vector<Vec3> ring;
  for (int k = 0; k < 3; ++k)
    for (const double side : {-1.0, 1.0}) {
      const double angle = 2 * kPi * k / 3, turn = kPi * k / 3;
      const double r = 3 + side * std::cos(turn);
      ring.push_back({r * std::cos(angle), r * std::sin(angle), side * std::sin(turn)});
    }
  SimplicialComplex flagged = make_complex(box.vertices, hole);
  flagged.solid = true;  // the word of the caller is not taken
  const std::vector<Case> cases = {
      {make_complex(box.vertices, hole), "3 border edges"},
      {flagged, "3 border edges"},
      {make_complex(fin_vertices, fin), "2 border edges, 1 edge with three or more triangles"},
      {merged({box, moved(make_box(1, 1, 1), 0.5, 0.25, 0.125)}), "self-intersecting pair"},
      {make_complex(ring, moebius), "1 piece without an orientation"},
      {make_complex(box.vertices, box.triangles, {{0, 6}}), "1 edge without a triangle"},
      {inside_out(make_complex({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                               {{0, 1, 2}, {0, 2, 3}, {1, 0, 3}, {1, 3, 2}})),
       "1 shell without a volume"}};
  for (const Case& c : cases) {
    const RepairedMesh repaired = repair_mesh(c.complex);
    EXPECT_FALSE(repaired.complex.solid) << c.reason;
    EXPECT_NE(repaired.report.reason.find(c.reason), std::string::npos) << repaired.report.reason;
    EXPECT_EQ(repaired.complex.triangles.size(), c.complex.triangles.size()) << c.reason;
  }
}

// Every edge still parts inside from outside, whether the corner is one vertex or two.
TEST(MeshRepair, AcceptsSolidsThatTouchInACorner) {
  const SimplicialComplex boxes = merged({make_box(1, 1, 1), moved(make_box(1, 1, 1), 1, 1, 1)});
  const SimplicialComplex welded = weld_vertices(boxes, 0).complex;
  ASSERT_EQ(welded.vertices.size(), 15U);
  EXPECT_TRUE(repair_mesh(boxes).complex.solid);
  EXPECT_TRUE(repair_mesh(welded).complex.solid);
}

TEST(MeshRepair, KeepsWiresAndPoints) {
  SimplicialComplex box = make_box(1, 1, 1);
  Random random(6);
  SimplicialComplex soup = soup_of(box, 1e-7, random);
  std::vector<Vec3> x = soup.vertices.to_vector();
  const int n = int(x.size());
  x.insert(x.end(), {{2, 0, 0}, {3, 0, 0}, {3, 1e-8, 0}, {5, 5, 5}, {5, 5, 5}});
  const RepairedMesh repaired =
      repair_mesh(make_complex(x, soup.triangles, {{0, n}, {n, n + 1}, {n + 1, n + 2}}));
  EXPECT_EQ(repaired.complex.vertices.size(), 8U + 3U);
  EXPECT_EQ(wires_of(repaired.complex).size(), 2U);
  EXPECT_EQ(repaired.report.collapsed_wires.count, 1);
  EXPECT_EQ(repaired.report.after.isolated_vertices, 1);
  EXPECT_EQ(repaired.report.after.border_edges, 0);
}

TEST(MeshRepair, DoesNotDependOnTheOrderOfTheFile) {
  Random random(7);
  const double tau = 1e-6 * bounding_box(make_nut()).diagonal();
  for (const SimplicialComplex& mesh :
       {soup_of(make_nut(), 0.5 * tau, random), box_with_t_junctions(5), make_cylinder(1, 1, 12)}) {
    const RepairedMesh first = repair_mesh(mesh), again = repair_mesh(mesh);
    EXPECT_TRUE(same_bits(first.complex, again.complex));
    for (int sample = 0; sample < 5; ++sample) {
      std::vector<int> order(mesh.vertices.size());
      std::iota(order.begin(), order.end(), 0);
      for (std::size_t i = order.size(); i-- > 1;) std::swap(order[i], order[random.index(int(i) + 1)]);
      std::vector<Vec3> x(order.size());
      for (std::size_t i = 0; i < order.size(); ++i) x[order[i]] = mesh.vertices[i];
      Triangles triangles = mesh.triangles.to_vector();
      for (Triangle& t : triangles)
        for (int& v : t) v = order[v];
      for (std::size_t i = triangles.size(); i-- > 1;)
        std::swap(triangles[i], triangles[random.index(int(i) + 1)]);
      const RepairedMesh other = repair_mesh(make_complex(x, triangles));
      EXPECT_EQ(places_of(other.complex), places_of(first.complex));
      EXPECT_EQ(other.complex.solid, first.complex.solid);
    }
  }
}

TEST(MeshRepair, SaysWhatItDidAndWhere) {
  const RepairedMesh repaired = repair_mesh(box_with_t_junctions(2));
  EXPECT_EQ(to_string(repaired.report), "1 vertex inserted into an open edge, first at (1000, 1000, 0) mm\n");
}

TEST(MeshRepair, RestoresASolidFromRandomDamage) {
  int split = 0, flipped = 0, dropped = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const SimplicialComplex box = make_box(1, 1, 1, 1 + random.index(3));
    const double jiggle = seed % 2 == 0 ? 0 : 1e-7;
    LooseMesh mesh = loose(box);
    for (int i = 0; i < 30; ++i)
      cut_a_side(mesh, random.uniform() < 0.5 ? Cut::plugged : Cut::t_junction, 0.02, jiggle, random);
    for (int i = 0; i < 10; ++i) {
      const auto k = std::size_t(random.index(int(mesh.triangles.size())));
      const Triangle t = mesh.triangles[k];
      if (random.uniform() < 0.3) mesh.triangles[k] = {t[0], t[2], t[1]};
      if (random.uniform() < 0.3) mesh.triangles.push_back({t[1], t[2], t[0]});
    }
    const RepairedMesh repaired = repair_mesh(complex_of(soup_of(mesh, jiggle, random)));
    const RepairReport& report = repaired.report;
    EXPECT_TRUE(repaired.complex.solid) << report.reason << '\n' << to_string(report);
    EXPECT_NEAR(signed_volume(repaired.complex), 1, jiggle > 0 ? 6e-6 : 1e-12);  // six faces moved by tau
    split += report.split_edges.count;
    flipped += report.flipped_slivers.count;
    dropped += report.dropped_slivers.count;
  }
  EXPECT_GT(split, 1000) << "the sample is hollow";
  EXPECT_GT(flipped, 1000) << "the sample is hollow";
  EXPECT_GT(dropped, 100) << "the sample is hollow";
}

// Random heaps of triangles, edges on common lines, equal and nearly equal places: it ends, moves nothing
// farther than the tolerance, and repairing twice changes nothing more.
TEST(MeshRepair, SettlesAnyHeapOfTriangles) {
  int split = 0, flipped = 0, turned = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const int grid = 2 + random.index(3);
    std::vector<Vec3> x;
    for (int i = 0; i < 4 + random.index(40); ++i) {
      const Eigen::Vector3i node{random.index(grid), random.index(grid), random.index(2)};
      x.push_back(node.cast<double>() + 1e-7 * random.vector());
    }
    Triangles triangles;
    for (int i = 0; i < 60; ++i) {
      const Triangle t = {random.index(int(x.size())), random.index(int(x.size())),
                          random.index(int(x.size()))};
      if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) triangles.push_back(t);
    }
    const SimplicialComplex heap = make_complex(x, triangles);
    const RepairedMesh once = repair_mesh(heap);
    for (std::size_t i = 0; i < x.size(); ++i)
      EXPECT_LE((once.complex.vertices[once.vertex[i]] - x[i]).norm(), once.report.tolerance);
    EXPECT_EQ(once.complex.solid, once.report.reason.empty());
    const WeldedComplex welded = weld_vertices(once.complex, once.report.tolerance);
    EXPECT_EQ(welded.vertices.count, 0);
    EXPECT_EQ(once.report.after.duplicate_vertices, 0);
    split += once.report.split_edges.count;
    flipped += once.report.flipped_slivers.count + once.report.dropped_slivers.count;
    turned += once.report.turned_triangles.count;
  }
  EXPECT_GT(split, 20) << "the sample is hollow";
  EXPECT_GT(flipped, 3) << "the sample is hollow";
  EXPECT_GT(turned, 200) << "the sample is hollow";
}

}  // namespace
}  // namespace aussois
