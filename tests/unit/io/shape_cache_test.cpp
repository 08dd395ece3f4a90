// SPDX-License-Identifier: Apache-2.0
#include "io/shape_cache.hpp"

#include <cstring>
#include <functional>
#include <limits>
#include <unistd.h>

#include <sys/wait.h>

#include "geometry/fastener.hpp"
#include "io/hdf5_file.hpp"
#include "io/mapped_file.hpp"
#include "io/sealed_file.hpp"
#include "lmd/shape_levels.hpp"
#include "tests/support/change.hpp"
#include "tests/support/compound.hpp"
#include "tests/support/files.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/random_pair.hpp"

namespace aussois {
namespace {

template <class T>
bool same_bytes(std::span<const T> a, std::span<const T> b) {  // of types without gaps
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same(const Incidence& a, const Incidence& b) {
  return a.begin == b.begin && a.items == b.items;
}

bool same(const SimplicialComplex& a, const SimplicialComplex& b) {
  return same_bytes<Vec3>(a.vertices, b.vertices) && a.edges == b.edges && a.triangles == b.triangles &&
         a.triangle_edges == b.triangle_edges && same(a.edge_triangles, b.edge_triangles) &&
         same(a.vertex_edges, b.vertex_edges) && same(a.vertex_triangles, b.vertex_triangles) &&
         a.solid == b.solid;
}

bool same(const ConeTree& a, const ConeTree& b) {
  return std::ranges::equal(a.nodes, b.nodes, [](const ConeNode& x, const ConeNode& y) {
    return std::memcmp(&x, &y, offsetof(ConeNode, count) + sizeof x.count) == 0;  // the rest is no data
  });
}

/// Says the first table that is not the same bit for bit, or "".
std::string difference(const LmdShape& a, const LmdShape& b) {
  const auto vertex = [](const VertexLeaf& x, const VertexLeaf& y) {
    return x.vertex == y.vertex && x.first_ray == y.first_ray && x.ray_count == y.ray_count &&
           x.cyclic == y.cyclic && x.is_wide == y.is_wide;
  };
  const auto edge = [](const EdgeLeaf& x, const EdgeLeaf& y) {
    return x.first == y.first && x.last == y.last && x.conormals == y.conormals && x.path == y.path &&
           x.path_length == y.path_length && x.is_wide == y.is_wide;
  };
  if (!(a.straightened == b.straightened && a.misfits == b.misfits)) return "straightened";
  if (!same(a.complex, b.complex)) return "complex";
  if (a.radius != b.radius || a.bounding_radius != b.bounding_radius || a.tolerance != b.tolerance ||
      !same_bytes<Vec3>({&a.centre, 1}, {&b.centre, 1}))
    return "lengths";
  if (!same_bytes<RegionPlane>(a.regions, b.regions)) return "regions";
  if (a.triangle_region != b.triangle_region || a.triangle_sign != b.triangle_sign) return "triangles";
  if (!same_bytes<Vec3>(a.rays, b.rays) || a.paths != b.paths) return "rays or paths";
  if (!std::ranges::equal(a.vertices, b.vertices, vertex)) return "vertices";
  if (!std::ranges::equal(a.edges, b.edges, edge)) return "edges";
  if (a.faces != b.faces || !same_bytes<BaseSimplex>(a.rest, b.rest)) return "faces or rest";
  if (!same(a.vertex_tree, b.vertex_tree) || !same(a.wide_vertex_tree, b.wide_vertex_tree) ||
      !same(a.edge_tree, b.edge_tree) || !same(a.wide_edge_tree, b.wide_edge_tree) ||
      !same(a.face_tree, b.face_tree) || !same(a.rest_tree, b.rest_tree))
    return "trees";
  if (a.narrow_vertices != b.narrow_vertices || a.narrow_edges != b.narrow_edges ||
      a.flat_triangles != b.flat_triangles)
    return "counts";
  if (bool(a.levels) != bool(b.levels) || level_count(a) != level_count(b)) return "number of levels";
  for (int k = 1; k <= level_count(a); ++k) {
    if (level_off(a, k) != level_off(b, k)) return "off";
    const std::string of_level = difference(level_shape(a, k), level_shape(b, k));
    if (!of_level.empty()) return "level: " + of_level;
  }
  return "";
}

/// Of files without permission to write.
void replace(const std::filesystem::path& path, const std::string& bytes) {
  std::filesystem::remove(path);
  write_bytes(path, bytes);
}

/// A square, a wire that hangs on it, a wire alone, a point, and a triangle without area.
SimplicialComplex mixed_complex() {
  return make_complex({{0, 0, 0},
                       {1, 0, 0},
                       {1, 1, 0},
                       {0, 1, -0.0},
                       {0, 0, 1},
                       {3, 0, 0},
                       {3, 0.1, 0.5},
                       {3, 0.2, 1.5},
                       {-2, 0, 1.0 / 3},
                       {2, 0, 0}},
                      {{0, 1, 2}, {0, 2, 3}, {0, 1, 9}}, {{0, 4}, {5, 6}, {6, 7}});
}

/// A square whose lower side has a vertex 0.2 um inside: prepared, it stands on the side.
SimplicialComplex bent_square() {
  return make_complex({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 2e-7, 0}},
                      {{0, 4, 3}, {4, 2, 3}, {4, 1, 2}});
}

LmdShape levelled_shape() {
  return prepare(dilate(make_torus(0.3, 0.05, 80, 20), 1e-3), {.levels = 2});
}

LmdShape small_shape() {
  return prepare(dilate(mixed_complex(), 0.01));
}

}  // namespace

TEST(ShapeCache, IsFoundByTheMeshAsItWasBeforeItsChainsWereStraightened) {
  const auto folder = fresh_folder();
  const CachedShape made = prepare_cached(dilate(bent_square(), 0.01), {}, folder);
  const CachedShape again = prepare_cached(dilate(bent_square(), 0.01), {}, folder);
  EXPECT_TRUE(made.kept && again.loaded) << again.warning;
  EXPECT_EQ(again.shape->straightened.size(), 1U);
  EXPECT_EQ(difference(*made.shape, *again.shape), "");
}

TEST(ShapeCache, GivesEveryTableBackBitForBit) {
  const auto path = fresh_folder() / "shape.h5";
  std::vector<LmdShape> shapes = {small_shape(),
                                  prepare(dilate(make_bolt(), 1e-5)),
                                  prepare(dilate(make_point(), 0)),
                                  prepare(dilate(make_l_shape(1), 0.1)),
                                  prepare(dilate(bent_square(), 0.01)),
                                  levelled_shape(),
                                  prepare(dilate(make_point(), 0.1), {.levels = 2})};
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    const SimplicialComplex complex = random_shape(random);
    shapes.push_back(prepare(dilate(complex, random.uniform(0, 0.1)), {.planarity = 1e-4}));
  }
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    write_lmd_shape(path, shapes[i], i);
    EXPECT_EQ(difference(read_lmd_shape(path, i), shapes[i]), "") << "shape " << i;
  }
  EXPECT_EQ(shapes[4].straightened.size(), 1U);
  EXPECT_EQ(level_count(shapes[5]), 2);
  const LmdShape& small = shapes[0];  // the sample has every kind of table
  EXPECT_TRUE(!small.rays.empty() && !small.rest.empty() && small.flat_triangles == 1 &&
              !small.wide_edge_tree.nodes.empty() && !shapes[1].paths.empty() &&
              !shapes[1].edge_tree.nodes.empty() && shapes[1].complex.solid);
}

TEST(ShapeCache, ContactsOfLoadedShapesAreTheSameBits) {
  const auto folder = fresh_folder();
  std::size_t found = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const RandomPair pair = random_pair(seed, 0.05);
    write_lmd_shape(folder / "a.h5", pair.a, 1);
    write_lmd_shape(folder / "b.h5", pair.b, 2);
    const LmdShape a = read_lmd_shape(folder / "a.h5", 1), b = read_lmd_shape(folder / "b.h5", 2);
    const LmdOptions options{.threshold = 0.3};
    const ContactSet fresh = find_contacts(pair.posed_a(), pair.posed_b(), options);
    const ContactSet loaded = find_contacts({&a, pair.g_a, 0}, {&b, pair.g_b, 1}, options);
    ASSERT_EQ(fresh.points.size(), loaded.points.size()) << "seed " << seed;
    for (std::size_t i = 0; i < fresh.points.size(); ++i) {
      const ContactPoint &x = fresh.points[i], &y = loaded.points[i];
      EXPECT_TRUE(x.gap == y.gap && x.normal == y.normal && x.x_a == y.x_a && x.x_b == y.x_b)
          << "seed " << seed;
    }
    found += fresh.points.size();
  }
  EXPECT_GT(found, 50U);
}

TEST(ShapeCache, KeysTellApartWhatAShapeFollowsFrom) {
  const DilatedShape shape = dilate(mixed_complex(), 0.01);
  std::vector<std::uint64_t> keys = {shape_key(shape), shape_key(shape, {.planarity = 2e-6}),
                                     shape_key(shape, {.levels = 1}),
                                     shape_key(dilate(shape.complex, std::nextafter(0.01, 1)))};
  const auto with = [&](const std::function<void(SimplicialComplex&)>& change) {
    DilatedShape changed = shape;
    change(changed.complex);
    keys.push_back(shape_key(changed));
  };
  const auto with_vertices = [&](const std::function<void(std::vector<Vec3>&)>& f) {
    with([&](SimplicialComplex& k) { change(k.vertices, f); });
  };
  const auto with_triangles = [&](const std::function<void(std::vector<std::array<int, 3>>&)>& f) {
    with([&](SimplicialComplex& k) { change(k.triangles, f); });
  };
  with_vertices([](auto& v) { v[7].z() = std::nextafter(1.5, 2); });
  with_vertices([](auto& v) { v[3].z() = 0.0; });  // was -0.0
  with_vertices([](auto& v) { std::swap(v[4], v[8]); });
  with_vertices([](auto& v) {  // half a turn about z: sign bits alone
    for (Vec3& x : v) x.head<2>() *= -1;
  });
  with_triangles([](auto& t) { std::swap(t[0], t[1]); });
  with_triangles([](auto& t) { std::swap(t[0][1], t[0][2]); });
  with([](SimplicialComplex& k) { k = make_complex(k.vertices, k.triangles, {{0, 4}, {5, 6}}); });
  with([](SimplicialComplex& k) { k.solid = true; });
  with([](SimplicialComplex& k) {
    change(k.vertices, [](auto& v) { v.push_back({0, 0, 9}); });
    k = make_complex(k.vertices, k.triangles);
  });
  EXPECT_EQ(shape_key(dilate(mixed_complex(), 0.01)), keys[0]);
  std::ranges::sort(keys);
  EXPECT_EQ(std::ranges::adjacent_find(keys), keys.end());
}

TEST(ShapeCache, AFileIsMappedUnlessItMayBeWrittenTo) {
  const auto path = fresh_folder() / "shape.h5";
  const LmdShape shape = small_shape();
  write_lmd_shape(path, shape, 1);
  EXPECT_TRUE(bytes_of_file(path).mapped);
  std::filesystem::permissions(path, std::filesystem::perms::owner_write, std::filesystem::perm_options::add);
  const LmdShape copied = read_lmd_shape(path, 1);
  std::filesystem::resize_file(path, 0);
  EXPECT_EQ(difference(copied, shape), "");
  write_lmd_shape(path, shape, 1);  // another file of that name
  EXPECT_TRUE(bytes_of_file(path).mapped);
}

TEST(ShapeCache, AnotherKeyIsRefusedNamingBoth) {
  const auto path = fresh_folder() / "shape.h5";
  write_lmd_shape(path, small_shape(), 0xfedcba9876543210U);
  const std::string message = message_of<std::runtime_error>([&] { read_lmd_shape(path, 1); });
  EXPECT_NE(message.find("shape.h5: /@key: is fedcba9876543210"), std::string::npos) << message;
  EXPECT_NE(message.find("0000000000000001"), std::string::npos) << message;
}

TEST(ShapeCache, AnotherFormatOrVersionIsRefused) {
  const auto path = fresh_folder() / "shape.h5";
  const auto refusal = [&](const char* format, const char* version) {
    {
      std::filesystem::remove(path);
      const Hdf5Id file = create_hdf5(path);
      write_text(file, "/", "format", format);
      write_text(file, "/", "version", version);
    }
    seal(path);
    return message_of<std::runtime_error>([&] { read_lmd_shape(path, 1); });
  };
  EXPECT_NE(refusal("aussois-checkpoint", "1").find("is not 'aussois-lmd-shape'"), std::string::npos);
  EXPECT_NE(refusal("aussois-lmd-shape", "0").find("/@version: is 0"), std::string::npos);
  EXPECT_NE(message_of<std::runtime_error>([&] {
              read_lmd_shape(path.parent_path() / "none.h5", 1);
            }).find("none.h5: missing"),
            std::string::npos);
}

TEST(ShapeCache, TruncatedAnywhereIsAnErrorThatNamesTheFile) {
  const auto folder = fresh_folder();
  write_lmd_shape(folder / "whole.h5", small_shape(), 7);
  const std::string whole = content_of(folder / "whole.h5");
  for (int part = 0; part < 20; ++part) {
    write_bytes(folder / "cut.h5", whole.substr(0, whole.size() * std::size_t(part) / 20));
    const std::string message = message_of<std::runtime_error>([&] { read_lmd_shape(folder / "cut.h5", 7); });
    EXPECT_NE(message.find("cut.h5: missing, truncated or damaged"), std::string::npos) << part << message;
  }
}

// Tables whose checksum is right, as a faulty program may write them: each is refused by its name.
TEST(ShapeCache, TablesThatNoSearchCouldWalkAreRefusedByName) {
  const auto path = fresh_folder() / "shape.h5";
  const double nan = std::numeric_limits<double>::quiet_NaN();
  LmdShape good = prepare(dilate(make_bolt(), 1e-5));
  const LmdShape mixed = small_shape();
  good.rest = mixed.rest;  // a bolt and a little of everything
  good.rest_tree = mixed.rest_tree;
  write_lmd_shape(path, good, 1);
  ASSERT_NO_THROW(read_lmd_shape(path, 1));
  const auto refused = [&](const char* table, const std::function<void(LmdShape&)>& damage) {
    LmdShape shape = good;
    damage(shape);
    write_lmd_shape(path, shape, 1);
    const std::string message = message_of<std::runtime_error>([&] { read_lmd_shape(path, 1); });
    EXPECT_NE(message.find(std::string("shape.h5: ") + table + ": "), std::string::npos)
        << table << " / " << message;
  };
  const auto bad = [&](const char* table, auto LmdShape::*array, const auto& damage) {
    refused(table, [&](LmdShape& s) { change(s.*array, damage); });
  };
  const auto tree = [&](const char* table, ConeTree LmdShape::*which, const auto& damage) {
    refused(table, [&](LmdShape& s) { change((s.*which).nodes, damage); });
  };
  const auto mesh = [&](const char* table, auto SimplicialComplex::*array, const auto& damage) {
    refused(table, [&](LmdShape& s) { change(s.complex.*array, damage); });
  };
  const auto incidence = [&](const char* table, Incidence SimplicialComplex::*rows,
                             SharedArray<int> Incidence::*array, const auto& damage) {
    refused(table, [&](LmdShape& s) { change(s.complex.*rows.*array, damage); });
  };
  mesh("/mesh/triangles", &SimplicialComplex::triangles, [&](auto& v) { v[3][1] = 1 << 30; });
  mesh("/mesh/vertices", &SimplicialComplex::vertices, [&](auto& v) { v[3].x() = nan; });
  mesh("/mesh/vertices", &SimplicialComplex::vertices, [&](auto& v) { v.clear(); });
  mesh("/mesh/triangles", &SimplicialComplex::triangles, [&](auto& v) { v[3][1] = v[3][0]; });
  mesh("/mesh/edges", &SimplicialComplex::edges, [&](auto& v) { std::swap(v[2], v[3]); });
  mesh("/mesh/edges", &SimplicialComplex::edges, [&](auto& v) { std::swap(v[2][0], v[2][1]); });
  mesh("/mesh/triangle_edges", &SimplicialComplex::triangle_edges, [&](auto& v) { v.pop_back(); });
  mesh("/mesh/triangle_edges", &SimplicialComplex::triangle_edges, [&](auto& v) { std::swap(v[2], v[90]); });
  incidence("/mesh/edge_triangles", &SimplicialComplex::edge_triangles, &Incidence::begin,
            [&](auto& v) { v.back() -= 1; });
  incidence("/mesh/edge_triangles", &SimplicialComplex::edge_triangles, &Incidence::items,
            [&](auto& v) { v[0] = -1; });
  incidence("/mesh/vertex_edges", &SimplicialComplex::vertex_edges, &Incidence::begin,
            [&](auto& v) { std::swap(v[1], v[2]); });
  incidence("/mesh/vertex_triangles", &SimplicialComplex::vertex_triangles, &Incidence::items,
            [&](auto& v) { std::swap(v[0], v[1]); });
  refused("/mesh/solid", [&](LmdShape& s) {
    s.complex = inside_out(s.complex);
    s.complex.solid = true;
  });
  refused("/radius", [&](LmdShape& s) { s.radius = -1; });
  refused("/bounding_radius", [&](LmdShape& s) { s.centre.y() = nan; });
  refused("/bounding_radius", [&](LmdShape& s) { s.bounding_radius = kInf; });
  refused("/tolerance", [&](LmdShape& s) { s.tolerance = nan; });
  bad("/straightened", &LmdShape::straightened, [&](auto& v) { v.push_back({-1, Vec3::Zero()}); });
  bad("/regions", &LmdShape::regions, [&](auto& v) { v.back().normal.z() = nan; });
  bad("/regions", &LmdShape::regions, [&](auto& v) { v.back().offset = kInf; });
  bad("/triangle_region", &LmdShape::triangle_region, [&](auto& v) { v[5] = int(good.regions.size()); });
  bad("/triangle_region", &LmdShape::triangle_region, [&](auto& v) { v.pop_back(); });
  bad("/triangle_sign", &LmdShape::triangle_sign, [&](auto& v) { v = std::vector<std::int8_t>(v.size()); });
  bad("/rays", &LmdShape::rays, [&](auto& v) { v[2].x() = nan; });
  bad("/paths", &LmdShape::paths, [&](auto& v) { v[0] = -1; });
  bad("/vertices", &LmdShape::vertices, [&](auto& v) { v[0].vertex = -1; });
  bad("/vertices", &LmdShape::vertices, [&](auto& v) { v[0].first_ray = int(good.rays.size()) - 1; });
  bad("/edges", &LmdShape::edges, [&](auto& v) { v[0].last = int(good.complex.vertices.size()); });
  bad("/edges", &LmdShape::edges, [&](auto& v) { v[0].conormals[1] = std::numeric_limits<int>::min(); });
  bad("/edges", &LmdShape::edges, [&](auto& v) { v[0].path_length = 0; });
  bad("/edges", &LmdShape::edges, [&](auto& v) { v[0].path_length = 0x7fffffffU; });
  bad("/faces", &LmdShape::faces, [&](auto& v) { v[0] = int(good.complex.triangles.size()); });
  bad("/flat_triangles", &LmdShape::faces, [&](auto& v) { v.pop_back(); });
  bad("/rest", &LmdShape::rest, [&](auto& v) { v[0].dim = 3; });
  bad("/rest", &LmdShape::rest, [&](auto& v) { v[0].vertex[0] = -1; });
  refused("/narrow_vertices", [&](LmdShape& s) { s.narrow_vertices = int(s.vertices.size()) + 1; });
  refused("/narrow_edges", [&](LmdShape& s) { s.narrow_edges = -1; });
  tree("/tree/vertex", &LmdShape::vertex_tree, [&](auto& v) { v[0].child[0] = 0; });  // its own child
  tree("/tree/vertex", &LmdShape::vertex_tree, [&](auto& v) { v.clear(); });
  tree("/tree/edge", &LmdShape::edge_tree, [&](auto& v) { v.back().count[0] = kBucket + 1; });
  tree("/tree/edge", &LmdShape::edge_tree, [&](auto& v) { v.back().child[0] = 0xffffffffU; });
  tree("/tree/face", &LmdShape::face_tree, [&](auto& v) { v.back().child[0] = 0; });  // twice
  tree("/tree/face", &LmdShape::face_tree, [&](auto& v) { v[0].r[1] = -1; });         // a branch is lost
  tree("/tree/rest", &LmdShape::rest_tree, [&](auto& v) { v[0].u[1][2][3] = float(nan); });
}

TEST(ShapeCache, LevelsAreCheckedAsShapesAre) {
  const auto path = fresh_folder() / "shape.h5";
  const LmdShape good = levelled_shape();
  const auto refused = [&](const char* table, const std::function<void(ShapeLevel&)>& damage) {
    LmdShape shape = good;
    ShapeLevels levels = *good.levels;
    damage(levels.coarse[1]);
    shape.levels = std::make_shared<const ShapeLevels>(std::move(levels));
    write_lmd_shape(path, shape, 1);
    const std::string message = message_of<std::runtime_error>([&] { read_lmd_shape(path, 1); });
    EXPECT_NE(message.find(std::string("shape.h5: ") + table + ": "), std::string::npos) << message;
  };
  refused("/level/2/off", [](ShapeLevel& level) { level.off = -1; });
  refused("/level/2/off", [](ShapeLevel& level) { level.off = kInf; });
  refused("/level/2/off", [](ShapeLevel& level) { level.shape.radius -= level.off; });
  refused("/level/2/faces",
          [](ShapeLevel& level) { change(level.shape.faces, [](auto& v) { v[0] = 1 << 30; }); });
}

TEST(ShapeCache, RefusesAFileWithAnyBitChanged) {
  const auto folder = fresh_folder();
  write_lmd_shape(folder / "whole.h5", small_shape(), 7);
  const std::string whole = content_of(folder / "whole.h5");
  Random random(20);
  for (int i = 0; i < 300; ++i) {
    std::string bytes = whole;
    const std::size_t at = std::size_t(random.index(int(bytes.size())));
    bytes[at] = char(bytes[at] ^ (1 << random.index(8)));
    write_bytes(folder / "damaged.h5", bytes);
    EXPECT_THROW(read_lmd_shape(folder / "damaged.h5", 7), std::runtime_error) << "seed 20, flip " << i;
  }
}

TEST(PrepareCached, PreparesOnceThenLoadsTheSameBits) {
  const auto folder = fresh_folder() / "made" / "on the way";
  const DilatedShape shape = dilate(make_bolt(), 1e-5);
  const CachedShape first = prepare_cached(shape, {}, folder), second = prepare_cached(shape, {}, folder);
  EXPECT_TRUE(!first.loaded && first.kept && first.warning.empty());
  EXPECT_TRUE(second.loaded && second.kept && second.warning.empty());
  EXPECT_EQ(difference(*first.shape, prepare(shape)), "");
  EXPECT_EQ(difference(*second.shape, *first.shape), "");
  EXPECT_EQ(to_string(first), "prepared, kept in " + first.file.string());
  EXPECT_EQ(to_string(second), "loaded from " + first.file.string());
  EXPECT_FALSE(prepare_cached(shape, {.planarity = 1e-5}, folder).loaded);
  EXPECT_FALSE(prepare_cached(dilate(shape.complex, 2e-5), {}, folder).loaded);
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    files += entry.path().extension() == ".h5";
  EXPECT_EQ(files, 3U);
}

TEST(PrepareCached, ReplacesAFileThatCannotBeUsedAndSaysSo) {
  const auto folder = fresh_folder();
  const DilatedShape shape = dilate(mixed_complex(), 0.01);
  const CachedShape first = prepare_cached(shape, {}, folder);
  const std::string whole = content_of(first.file);
  const LmdShape other = prepare(dilate(make_box(1, 1, 1), 0.01));
  const std::vector<std::pair<std::string, std::function<void()>>> damages = {
      {"truncated or damaged", [&] { replace(first.file, whole.substr(0, 1000)); }},
      {"truncated or damaged", [&] { replace(first.file, "none"); }},
      {"/@key", [&] { write_lmd_shape(first.file, other, 1); }},
      {"another one with the same key", [&] { write_lmd_shape(first.file, other, shape_key(shape)); }}};
  for (const auto& [reason, damage] : damages) {
    damage();
    const CachedShape again = prepare_cached(shape, {}, folder);
    EXPECT_TRUE(!again.loaded && again.kept);
    EXPECT_NE(again.warning.find(first.file.string()), std::string::npos) << again.warning;
    EXPECT_NE(again.warning.find(reason), std::string::npos) << again.warning;
    EXPECT_EQ(difference(*again.shape, *first.shape), "");
    EXPECT_TRUE(prepare_cached(shape, {}, folder).loaded);
  }
}

TEST(PrepareCached, DoesWithoutACacheThatCannotBeWritten) {
  const auto folder = fresh_folder();
  const DilatedShape shape = dilate(make_point(), 0.01);
  const CachedShape none = prepare_cached(shape, {}, {});
  EXPECT_TRUE(none.shape && !none.loaded && !none.kept && none.file.empty() && none.warning.empty());
  write_bytes(folder / "taken", "no folder");
  const CachedShape taken = prepare_cached(shape, {}, folder / "taken");
  EXPECT_TRUE(taken.shape && !taken.loaded && !taken.kept);
  EXPECT_NE(taken.warning.find("not kept"), std::string::npos) << taken.warning;
  EXPECT_EQ(to_string(taken), "prepared");
  const std::filesystem::path name = prepare_cached(shape, {}, folder / "good").file.filename();
  std::filesystem::create_directories(folder / "cache" / name / "inside");
  const CachedShape blocked = prepare_cached(shape, {}, folder / "cache");  // a folder has the file's name
  EXPECT_TRUE(blocked.shape && !blocked.kept && !blocked.warning.empty());
  for (const auto& entry : std::filesystem::directory_iterator(folder / "cache"))
    EXPECT_NE(entry.path().extension(), ".tmp");
  EXPECT_THROW(prepare_cached({}, {}, folder), std::invalid_argument);  // as prepare does
}

// Four processes write one file again and again; a reader finds it whole at any time.
TEST(PrepareCached, ManyProcessesMayWriteTheSameFile) {
  const auto path = fresh_folder() / "shape.h5";
  const LmdShape shape = small_shape();
  write_lmd_shape(path, shape, 1);
  std::vector<pid_t> writers;
  for (int i = 0; i < 4; ++i) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
      try {
        for (int k = 0; k < 20; ++k) write_lmd_shape(path, shape, 1);
      } catch (...) {
        _exit(1);
      }
      _exit(0);
    }
    writers.push_back(child);
  }
  for (int k = 0; k < 40; ++k) EXPECT_EQ(difference(read_lmd_shape(path, 1), shape), "");
  for (const pid_t writer : writers) {
    int status = 0;
    ASSERT_EQ(waitpid(writer, &status, 0), writer);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  }
  for (const auto& entry : std::filesystem::directory_iterator(path.parent_path()))
    EXPECT_EQ(entry.path().filename(), "shape.h5");
}

}  // namespace aussois
