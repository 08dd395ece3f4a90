// SPDX-License-Identifier: Apache-2.0
// Where do two parts touch, or nearly touch? Finds all contacts at one pose, or along a path of poses.
//
// Theory   doc/theory/lmd.md (LMD-1) to (LMD-10), (KIN-1) to (KIN-3)
// Run      query_contacts --builtin box_on_plate --json out/contacts.json
//          query_contacts --builtin gear --threads 2 --picture out/gear.html
//          query_contacts --builtin bolt_nut --threshold 1e-4 --csv out/poses.csv --json out/poses.json
// Expect   four contacts of a box on a plate; no pose at which the bases touch or one part is inside the
//          other; at every pose, the smallest gap is the distance of the bases less the dilations (LMD-14)
#include <algorithm>
#include <cstdio>
#include <ctime>

#include "examples/common/driver.hpp"
#include "examples/common/progress.hpp"
#include "examples/drivers/contacts/contact_report.hpp"
#include "geometry/check.hpp"
#include "io/csv_table.hpp"
#include "io/pose_file.hpp"
#include "io/shape_cache.hpp"
#include "lmd/certificate.hpp"
#include "lmd/coverage.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::filesystem::path a{}, b{}, data{}, path{}, cache{}, json{}, csv{}, picture{};
  std::string pair{}, builtin{}, pose{};
  double scale = 1e-3, dilation_a = -1, dilation_b = -1, threshold = 0,
         alpha = LmdOptions{}.alpha * 180 / kPi, alpha_ee = LmdOptions{}.alpha_ee * 180 / kPi;
  int threads = 1, rows = 40, repeat = 1;
  bool unchecked = false, quiet = false;
  std::string command_line{};
};

double cpu_ms(std::clock_t begin, std::clock_t end) {
  return 1e3 * double(end - begin) / CLOCKS_PER_SEC;
}

ContactPair read_parts(const Arguments& a) {
  const bool files = !a.a.empty() || !a.b.empty();
  require(int(files) + int(!a.pair.empty()) + int(!a.builtin.empty()) == 1,
          "give one of: --a with --b; --data with --pair; --builtin");
  if (!a.builtin.empty()) return builtin_pair(a.builtin);
  if (files) {
    require(!a.a.empty() && !a.b.empty(), "--a and --b must be given together");
    ContactPair pair{.a = read_part(a.a, a.scale, {}, a.cache), .b = read_part(a.b, a.scale, {}, a.cache)};
    if (pair.a.name == pair.b.name) pair.a.name += "_a";
    pair.name = pair.a.name + "_on_" + pair.b.name;
    return pair;
  }
  require(!a.data.empty(), "--pair needs --data, the folder with meshes/ and assembly/");
  return contact_pair(read_assembly_pair(a.data, a.pair, a.scale, a.cache));
}

ContactPair read_pair(const Arguments& a) {
  require(a.pose.empty() || a.path.empty(), "give --pose or --path, not both");
  ContactPair pair = read_parts(a);
  if (!a.pose.empty()) pair.poses = {parse_pose(a.pose, a.scale)};
  if (!a.path.empty()) pair.poses = read_poses(a.path, a.scale).pose;
  require(!pair.poses.empty(), "give --pose, or --path with a file of poses");
  if (a.dilation_a >= 0) pair.dilation_a = a.dilation_a;
  if (a.dilation_b >= 0) pair.dilation_b = a.dilation_b;
  if (a.threshold > 0) pair.threshold = a.threshold;
  return pair;
}

ContactQuery ask(const ContactReport& report, const SE3& pose, const Pieces& pieces_a, const Pieces& pieces_b,
                 const Arguments& a) {
  ContactQuery query{.pose = pose};
  const PosedShape posed_a{report.a, pose, 0}, posed_b{report.b, {}, 1};
  std::vector<double> ms;
  for (int i = 0; i < a.repeat; ++i) {
    const std::clock_t begin = std::clock();
    query.contacts = find_contacts(posed_a, posed_b, report.options, &query.count);
    ms.push_back(cpu_ms(begin, std::clock()));
  }
  query.ms = quantiles_of(ms).median;
  query.contact_count = query.contacts.points.size();
  query.min_gap = smallest_gap(query.contacts);
  if (a.unchecked) return query;
  const LmdShape &shape_a = *report.a, &shape_b = *report.b;
  const double touching = 1e-9 * shape_a.bounding_radius, dilations = shape_a.radius + shape_b.radius,
               tolerance = coverage_tolerance(posed_a, posed_b),
               asked = dilations + report.options.threshold - tolerance;
  const double enough = std::min(asked, dilations + query.min_gap + 2 * tolerance);  // to see what is wrong
  const double distance = base_distance({&shape_a, {}, {.g = pose}}, {&shape_b, {}, {}},
                                        std::max(touching, enough), report.options.threads);
  query.bases_touch = distance < touching;
  if (*query.bases_touch) return query;
  query.nesting = find_nesting(posed_a, pieces_a, posed_b, pieces_b);
  if (distance < asked && !query.nesting)
    query.covered = is_covered_by(query.min_gap, posed_a, posed_b, distance);
  return query;
}

void print_parts(const ContactReport& report, bool quiet) {
  for (const AssemblyPart* part : {&report.pair->a, &report.pair->b})
    for (const std::string& note : part->notes) std::fprintf(stderr, "warning: %s\n", note.c_str());
  if (quiet) return;
  for (const auto& [letter, part, shape] :
       {std::tuple{'A', &report.pair->a, report.a}, std::tuple{'B', &report.pair->b, report.b}})
    std::printf("%c  %s: %s, %s, box %.4g x %.4g x %.4g mm, dilation %.4g um\n", letter, part->name.c_str(),
                counted_noun(part->report.triangles, "triangle").c_str(),
                part->complex.solid ? "solid" : "sheets",
                1e3 * (part->report.box.hi - part->report.box.lo).x(),
                1e3 * (part->report.box.hi - part->report.box.lo).y(),
                1e3 * (part->report.box.hi - part->report.box.lo).z(), 1e6 * shape->radius);
}

void print_cache(const std::string& name, const CacheUse& cached, bool quiet) {
  if (!cached.warning.empty()) std::fprintf(stderr, "warning: %s\n", cached.warning.c_str());
  if (!quiet) std::printf("cache: %s: %s\n", name.c_str(), to_string(cached).c_str());
}

// At how many poses something is the case, and at which first.
struct Found {
  std::size_t count = 0, first = 0;
  void add(bool is_so, std::size_t pose) {
    if (is_so && ++count == 1) first = pose;
  }
};

void print_answers(const ContactReport& report, const ContactPair& pair, int rows) {
  const ContactQuery& first = report.queries.front();
  if (pair.poses.size() > 1) {
    std::printf("%s", statistics_table(report).c_str());
    std::printf("%s: %s, contacts within %.4g um\n", pair.name.c_str(),
                counted_noun(std::int64_t(pair.poses.size()), "pose").c_str(),
                1e6 * report.options.threshold);
    return;
  }
  if (rows > 0) std::printf("%s", contact_table(report, first, rows).c_str());
  std::printf("%s: %s within %.4g um, %s, %.3g ms, %s, %s\n", pair.name.c_str(),
              counted_noun(std::int64_t(first.contact_count), "contact").c_str(),
              1e6 * report.options.threshold, gap_text(first.min_gap).c_str(), first.ms,
              counted_noun(first.count.node_pairs, "node pair").c_str(),
              counted_noun(first.count.leaf_pairs, "leaf pair").c_str());
}

void write_answers(const ContactReport& report, const Arguments& a) {
  if (!a.csv.empty()) {
    CsvTable csv(a.csv, {"pose", "contacts", "min_gap", "ms", "node_pairs", "leaf_pairs"});
    for (std::size_t i = 0; i < report.queries.size(); ++i) {
      const ContactQuery& q = report.queries[i];
      csv.add({double(i), double(q.contact_count), q.min_gap, q.ms, double(q.count.node_pairs),
               double(q.count.leaf_pairs)});
    }
    csv.close();
  }
  if (!a.json.empty()) write_contact_json(a.json, report);
  if (!a.picture.empty()) write_contact_page(a.picture, report);
}

// What no contact shows. True: nothing of the kind.
bool print_findings(const ContactReport& report, const ContactPair& pair) {
  Found touching, nested, bare;
  for (std::size_t i = 0; i < report.queries.size(); ++i) {
    const ContactQuery& query = report.queries[i];
    touching.add(query.bases_touch.value_or(false), i);
    nested.add(query.nesting.has_value(), i);
    bare.add(!query.covered.value_or(true), i);
  }
  const std::string poses = counted_noun(std::int64_t(pair.poses.size()), "pose");
  if (touching.count > 0)
    std::fprintf(stderr,
                 "the bases of %s and %s touch at %zu of %s, first at pose %zu: contacts are missing there\n",
                 pair.a.name.c_str(), pair.b.name.c_str(), touching.count, poses.c_str(), touching.first);
  if (nested.count > 0)
    std::fprintf(
        stderr,
        "%s at pose %zu, the first of %zu of %s with one part inside the other: contacts do not show this\n",
        to_string(*report.queries[nested.first].nesting, pair.a.name, pair.b.name).c_str(), nested.first,
        nested.count, poses.c_str());
  if (bare.count > 0)
    std::fprintf(stderr,
                 "the smallest gap is not the distance of the bases less the dilations at %zu of %s, first "
                 "at pose %zu\n",
                 bare.count, poses.c_str(), bare.first);
  return touching.count + nested.count + bare.count == 0;
}

ExitCode query(const Arguments& a) {
  require_field(a.alpha_ee >= a.alpha, "--alpha-ee", a.alpha_ee,
                ("be at least --alpha = " + number_text(a.alpha) + " [deg]").c_str());
  ContactPair pair = read_pair(a);
  const LmdShapeOptions options{.threads = a.threads};
  const CachedShape cached_a = prepare_cached(dilate(pair.a.complex, pair.dilation_a), options, a.cache),
                    cached_b = prepare_cached(dilate(pair.b.complex, pair.dilation_b), options, a.cache);
  const LmdShape &shape_a = *cached_a.shape, &shape_b = *cached_b.shape;
  note_straightened(pair.a, shape_a);
  note_straightened(pair.b, shape_b);
  ContactReport report{.pair = &pair, .a = &shape_a, .b = &shape_b, .command_line = a.command_line};
  report.options = {.threshold = pair.threshold > 0 ? pair.threshold : 0.01 * shape_a.bounding_radius,
                    .alpha = a.alpha * kPi / 180,
                    .alpha_ee = a.alpha_ee * kPi / 180,
                    .threads = a.threads};
  validate(report.options);
  for (const std::filesystem::path& file : {a.json, a.csv, a.picture})
    if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path());
  print_parts(report, a.quiet);
  if (!a.cache.empty()) {
    for (const AssemblyPart* part : {&pair.a, &pair.b})
      if (!part->cache.file.empty()) print_cache(part->name + ", mesh", part->cache, a.quiet);
    print_cache(pair.a.name, cached_a, a.quiet);
    print_cache(pair.b.name, cached_b, a.quiet);
  }

  Progress progress("query_contacts", double(pair.poses.size()),
                    Progress::style_of_stderr(a.quiet || pair.poses.size() == 1));
  const Pieces pieces_a = connected_pieces(shape_a.complex), pieces_b = connected_pieces(shape_b.complex);
  for (const SE3& pose : pair.poses) {
    report.queries.push_back(ask(report, pose, pieces_a, pieces_b, a));
    if (pair.poses.size() > 1 && a.picture.empty()) report.queries.back().contacts = {};
    progress.at(double(report.queries.size()));
    if (interrupted()) return ExitCode::interrupted;
  }
  print_answers(report, pair, a.rows);
  write_answers(report, a);
  return print_findings(report, pair) ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  a.command_line = command_line(argc, argv);
  Cli cli("query_contacts", "Finds all contacts of two parts at a pose, or along a path of poses.");
  cli.group("scene");
  cli.input("--a", a.a, "mesh of part A (OBJ, STL, PLY, OFF)");
  cli.input("--b", a.b, "mesh of part B, placed at the origin");
  cli.input("--data", a.data, "folder with meshes/ and assembly/");
  cli.option("--pair", a.pair, "pair in assembly/pairs.csv: its moving part is A, its path gives the poses");
  std::string names;
  for (const std::string& name : kBuiltinPairs) names += (names.empty() ? "" : ", ") + name;
  cli.option("--builtin", a.builtin, "built-in pair: " + names);
  cli.option("--pose", a.pose,
             "pose of A in the frame of B: x,y,z,qw,qx,qy,qz, with x,y,z in units of the mesh files");
  cli.input("--path", a.path, "CSV file of many such poses, with the header x,y,z,qw,qx,qy,qz");
  cli.option("--scale", a.scale, "length of one unit of the files", "m", kMeshScale);
  cli.option("--dilation-a", a.dilation_a, "dilation of A; negative: that of --builtin, otherwise none", "m",
             {-1, 1});
  cli.option("--dilation-b", a.dilation_b, "dilation of B; negative: that of --builtin, otherwise none", "m",
             {-1, 1});
  cli.option("--cache", a.cache,
             "folder that keeps repaired meshes and prepared shapes for later runs, created if missing; "
             "empty: none");
  cli.group("search");
  cli.option("--threshold", a.threshold,
             "largest gap of a contact; 0: that of --builtin, otherwise 0.01 of A's bounding radius", "m",
             {0, 1e3});
  cli.option("--alpha", a.alpha, setting_of<LmdOptions>("alpha").what, "deg",
             in_degrees(setting_of<LmdOptions>("alpha")).range);
  cli.option("--alpha-ee", a.alpha_ee, "the same for edge against edge; must be at least --alpha", "deg",
             in_degrees(setting_of<LmdOptions>("alpha_ee")).range);
  cli.option("--threads", a.threads, "number of threads; does not affect the contacts", "", kThreads);
  cli.option("--repeat", a.repeat, "number of times to query each pose; the median time is reported", "",
             {1, 1e6});
  cli.flag(
      "--unchecked", a.unchecked,
      "skip the check that the bases are apart and outside each other; it may take longer than the query");
  cli.group("output");
  cli.option("--rows", a.rows, "maximum number of contacts in the table of one pose; 0: no table", "",
             {0, 1e9});
  cli.option("--json", a.json,
             "write all contacts of one pose, or the numbers of all poses, to this JSON file");
  cli.option("--csv", a.csv, "write one row of numbers per pose to this CSV file");
  cli.option("--picture", a.picture, "write a page with both parts and their contacts to this HTML file");
  cli.flag("--quiet", a.quiet, "omit progress and the lines about the parts; still print warnings");
  cli.example("query_contacts --builtin peg --picture out/peg.html", "a peg in its hole; open out/peg.html");
  cli.example(
      "query_contacts --a nut.obj --b bolt.obj --pose 0,0,2,1,0,0,0 --threshold 1e-4 --json out/nut.json",
      "files in millimetres, one pose");
  return run_driver(cli, argc, argv, [&] { return query(a); });
}
