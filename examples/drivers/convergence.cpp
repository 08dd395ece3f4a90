// SPDX-License-Identifier: Apache-2.0
// Does a scheme reach its order? Measures errors against exact motions at several step sizes, in norms that
// suit velocities that jump.
//
// Theory   doc/theory/convergence.md (CONV-1) to (CONV-10)
// Run      convergence --case forced_46
//          convergence --case free_top --theta 1 --levels 5 --phases 1
//          convergence --case forced_46 --certify 10
//          convergence --meshes
// Expect   the orders of theory, each with its reason: one across impacts, two at the midpoint for smooth
//          motion; exit code 0 if all are met
//
// convergence --meshes measures the orders of beams and solids over their meshes (doc/theory/orders.md).
//
// convergence --all computes the whole table. It can be interrupted at any time: the next call with the same
// -o continues. To share the work between machines, run --shard 1/4 to 4/4 with one folder, then once without
// --shard; with MPI, run mpirun -n 9 convergence --all --farm.
#include "examples/common/convergence.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <mutex>

#include "examples/common/gnuplot.hpp"
#include "examples/common/many_tasks.hpp"
#include "examples/common/progress.hpp"
#include "examples/common/scheme_flags.hpp"
#include "examples/common/task_farm.hpp"
#include "examples/scenes/shared_series.hpp"
#include "examples/studies/convergence/study_files.hpp"
#include "examples/studies/verification/mesh_study.hpp"
#include "geometry/check.hpp"
#include "geometry/parallel.hpp"
#include "io/atomic_file.hpp"
#include "io/build_info.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::string case_name{}, shard = "1/1";
  SchemeFlags scheme{};
  SaidSettings said{};  // of the study
  StudyOptions study{};
  WatchFlags watch{};  // but for the places of a study's certificates
  bool all = false, list = false, farm = false, meshes = false;
  ManyTasks tasks{};
};

/// One cell of the table.
struct Cell {
  const Case* scene = nullptr;
  SchemeVariant variant{};
  bool as_delivered = false;  // also the solver's tolerance
};

StudyOptions options_of(const Arguments& a, const Cell& cell) {
  StudyOptions out = a.study;
  if (cell.as_delivered) out.tolerance = SolverOptions{}.tolerance;
  return out;
}

std::string label_of(const Cell& cell) {
  const std::string name = label(cell.variant.name, cell.variant.options);
  return cell.as_delivered ? name + " default tolerance" : name;
}

std::vector<Cell> cells_of(const Arguments& a) {
  std::vector<Cell> out;
  for (const Case& c : cases()) {
    if (!a.case_name.empty() && c.name != a.case_name) continue;
    if (!a.all) {
      out.push_back({&c, {a.scheme.scheme, scheme_options(a.scheme)}});
      continue;
    }
    const auto add = [&](const SchemeVariant& variant, bool as_delivered) {
      if (applies(c, scheme_traits(variant.name, variant.options)))
        out.push_back({&c, variant, as_delivered});
    };
    for (const SchemeVariant& variant : scheme_variants()) add(variant, false);
    add({"moreau_jean", {}}, true);
  }
  return out;
}

/// Every n-th cell from the k-th on, for "k/n".
std::vector<Cell> part_of(const std::vector<Cell>& cells, const std::string& shard) {
  const auto [k, n] = shard_of(shard);
  std::vector<Cell> out;
  for (std::size_t i = std::size_t(k) - 1; i < cells.size(); i += std::size_t(n)) out.push_back(cells[i]);
  return out;
}

/// Studies of meshes of a name; of an empty one, all. Throws std::invalid_argument if there is none.
std::vector<const MeshStudy*> meshes_named(const std::string& name) {
  std::vector<const MeshStudy*> out;
  for (const MeshStudy& s : mesh_studies())
    if (name.empty() || s.name == name) out.push_back(&s);
  require(!out.empty(), "--meshes has no case '" + name + "'; --list shows all");
  return out;
}

ExitCode list() {
  std::printf("cases\n");
  for (const Case& c : cases())
    std::printf("  %-16s %s; %.3g s, %s\n", c.name.c_str(), c.what.c_str(), c.t_end,
                c.smooth ? "smooth" : "nonsmooth");
  std::printf("schemes\n");
  for (const SchemeVariant& v : scheme_variants()) {
    const SchemeTraits traits = scheme_traits(v.name, v.options);
    std::printf("  %-36s order %g, %g for smooth motion%s\n", label(v.name, v.options).c_str(),
                traits.nonsmooth, traits.smooth, traits.restitution ? "" : "; no restitution");
  }
  std::printf("cases of --meshes\n");
  for (const MeshStudy* s : meshes_named(""))
    std::printf("  %-24s %s; order %g\n", s->name.c_str(),
                (s->error_of + (s->setting.empty() ? "" : ", " + s->setting)).c_str(), s->order);
  return ExitCode::ok;
}

struct Results {
  std::vector<Study> done{};            // in the order of the cells
  std::vector<std::string> failures{};  // one line each
  int known = 0;                        // read from the folder
};

/// Calls of f(i) for all i in [0, n), on threads or elsewhere.
using ForAll = std::function<void(int n, const std::function<void(int)>& f)>;

/// Each cell is written when it is complete and read back by the next call.
Results run_cells(const Arguments& a, const std::vector<Cell>& cells, const ForAll& for_all) {
  const std::uint64_t program = program_digest();
  std::vector<Study> studies(cells.size());
  std::vector<std::string> failures(cells.size());
  Results out;
  std::mutex mutex;  // of progress and counts
  int levels_done = 0;
  Progress progress("convergence", double(cells.size()) * a.study.levels,
                    Progress::style_of_stderr(a.tasks.quiet));
  for_all(int(cells.size()), [&](int i) {
    const Cell& cell = cells[i];
    const auto& [scheme, options] = cell.variant;
    const Study wanted{
        .case_name = cell.scene->name, .scheme = label_of(cell), .options = options_of(a, cell)};
    const std::filesystem::path file = a.tasks.out / (stem_of(wanted) + ".json");
    const auto say = [&](int levels) {
      const std::lock_guard lock(mutex);
      progress.at(levels_done += levels, wanted.case_name + " " + wanted.scheme);
    };
    if (interrupted()) return;
    std::optional<Study> known;
    if (a.watch.dump.folder.empty()) known = read_study(file, wanted, program);  // else files are wanted
    if (known) {
      studies[i] = *known;
      say(a.study.levels);
      const std::lock_guard lock(mutex);
      ++out.known;
      return;
    }
    try {
      Study made = study(*cell.scene, scheme, options, wanted.options,
                         [&](int level) {
                           say(level <= a.study.levels);
                           return !interrupted();
                         },
                         {.flags = a.watch, .name = "convergence_" + stem_of(wanted)});
      if (int(made.h.size()) < a.study.levels || interrupted()) return;
      made.scheme = wanted.scheme;
      write_study(file, made, program);
      studies[i] = std::move(made);
    } catch (const NumericalFailure& failure) {
      failures[i] = failure.what();
    }
  });
  for (Study& s : studies)
    if (!s.h.empty()) out.done.push_back(std::move(s));
  for (std::string& text : failures)
    if (!text.empty()) out.failures.push_back(std::move(text));
  return out;
}

// Pictures, tables and the verdict.
ExitCode conclude(const Arguments& a, const Results& results, std::size_t cells) {
  bool pictures = true;
  std::map<OrderVerdict, int> count;
  RunAudit audit;
  for (const Study& s : results.done) {
    if (!a.all && !a.tasks.quiet)
      std::printf("%s, %s\n%s", s.case_name.c_str(), s.scheme.c_str(), to_string(s).c_str());
    pictures = write_picture(a.tasks.out, s) && pictures;
    ++count[order_verdict(s)];
    add(s.audit, audit);
  }
  if (!a.tasks.json.empty())
    write_whole_file(a.tasks.json, a.all                  ? to_json(results.done, program_digest())
                                   : results.done.empty() ? ""
                                                          : to_json(results.done.front(), program_digest()));
  if (a.all) {
    const std::string table = order_table(results.done);
    write_whole_file(a.tasks.out / "convergence.md", table);
    std::printf("%s", table.c_str());
  }
  if (!pictures) tell_no_picture();
  for (const std::string& text : results.failures) std::fprintf(stderr, "convergence: %s\n", text.c_str());
  tell_known(results.known, cells, a.tasks.out);
  std::printf(
      "convergence: %d of %zu met the orders of theory, one or more; %d met less than one, as theory "
      "predicts; %d not judged; %d missed\n",
      count[OrderVerdict::met], cells, count[OrderVerdict::less], count[OrderVerdict::not_judged],
      count[OrderVerdict::missed]);
  print_profile(a.watch);
  Summary profile;
  set_profile(a.watch, profile);
  if (!profile.entries.empty()) write_summary(a.tasks.out / "profile.json", profile);
  const bool certified = print_findings(audit);
  if (!results.failures.empty()) return ExitCode::numerical;
  return certified && count[OrderVerdict::missed] + count[OrderVerdict::not_judged] == 0
             ? ExitCode::ok
             : ExitCode::not_accepted;
}

ExitCode run_meshes(const Arguments& a) {
  require(!a.all && !a.farm && a.shard == "1/1", "--meshes cannot be combined with --all, --farm or --shard");
  const std::vector<const MeshStudy*> studies = meshes_named(a.case_name);
  make_folders(a.tasks);
  const std::uint64_t program = program_digest();
  std::vector<MeshResult> results(studies.size());
  std::vector<std::string> failures(studies.size()), skipped(studies.size());
  std::mutex mutex;  // of progress and counts
  int done = 0, known = 0;
  Progress progress("meshes", double(studies.size()), Progress::style_of_stderr(a.tasks.quiet));
  parallel_for(int(studies.size()), a.tasks.threads, [&](int i) {
    if (interrupted()) return;
    const MeshStudy& study = *studies[i];
    const std::filesystem::path file = a.tasks.out / (stem_of(study) + ".json");
    std::optional<Convergence> result = read_mesh_study(file, study, program);
    const bool was_there = result.has_value();
    try {
      if (!result) {
        result = measured(study);
        write_mesh_study(file, study, *result, program);
      }
      results[i] = {&study, *result};
    } catch (const NumericalFailure& failure) {
      failures[i] = study.name + ": " + failure.what();
    } catch (const MissingData& missing) {
      skipped[i] = study.name + " is skipped: " + missing.what();
    }
    const std::lock_guard lock(mutex);
    known += was_there;
    progress.at(++done, study.name);
  });
  if (interrupted()) return ExitCode::interrupted;
  std::erase_if(results, [](const MeshResult& result) { return !result.study; });
  bool pictures = true;
  for (const auto& [study, errors] : results)
    pictures = write_picture(a.tasks.out, *study, errors) && pictures;
  const std::string table = mesh_table(results);
  write_whole_file(a.tasks.out / "meshes.md", table);
  if (!a.tasks.json.empty()) write_whole_file(a.tasks.json, to_json(results, program));
  std::printf("%s", table.c_str());
  for (const auto* texts : {&failures, &skipped})
    for (const std::string& text : *texts)
      if (!text.empty()) std::fprintf(stderr, "convergence: %s\n", text.c_str());
  if (!pictures) tell_no_picture();
  tell_known(known, studies.size(), a.tasks.out);
  const auto met = std::ranges::count_if(
      results, [](const MeshResult& result) { return reaches_its_order(*result.study, result.errors); });
  std::printf("convergence: %td of %zu met the orders of theory\n", met, results.size());
  if (results.empty() || std::ranges::any_of(failures, [](const auto& text) { return !text.empty(); }))
    return ExitCode::numerical;
  return std::size_t(met) == results.size() ? ExitCode::ok : ExitCode::not_accepted;
}

ExitCode run(Arguments a) {
  if (a.list) return list();
  if (a.meshes) return run_meshes(a);
  require(a.all || !a.case_name.empty(), "give --case NAME, --all, --meshes or --list");
  require(a.all || a.shard == "1/1", "--shard " + a.shard + " needs --all");
  require(!a.farm || has_task_farm(), "--farm needs a build configured with -DAUSSOIS_WITH_MPI=ON");
  if (!a.case_name.empty()) case_named(a.case_name);
  validate(a.study);
  const std::vector<Cell> cells = part_of(cells_of(a), a.shard);
  if (!a.all) {  // refused before a folder is made
    const SchemeVariant& variant = cells.front().variant;
    const Case* scene = cells.front().scene;
    require_applies(*scene, variant.name, variant.options);
    const double min_h = variant.options.step.advancement.min_h;
    require_field(min_h <= step_sizes(a.study.h > 0 ? a.study.h : scene->h, a.study.levels).back(),
                  "AdvancementOptions::min_h", min_h, "not exceed the shortest step of the study [s]");
  }
  make_folders(a.tasks);

  if (a.farm) {
    Arguments of_rank = a;
    of_rank.tasks.quiet = true;
    bool goes_on = true;
    run_cells(of_rank, cells, [&](int n, const auto& f) { goes_on = farm_out(n, f); });
    if (!goes_on) return interrupted() ? ExitCode::interrupted : ExitCode::ok;
  }
  const Results results =
      run_cells(a, cells, [&](int n, const auto& f) { parallel_for(n, a.tasks.threads, f); });
  if (interrupted()) return ExitCode::interrupted;
  return conclude(a, results, cells.size());
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli("convergence",
          "Measures the order of convergence of time-stepping schemes against exact motions with impacts and "
          "friction.");
  cli.group("scene");
  cli.option("--case", a.case_name, "case to run; --list shows all");
  cli.flag("--list", a.list, "list cases and schemes, then exit");
  cli.flag("--all", a.all, "run all cases, or that of --case, with all schemes and settings");
  cli.flag("--meshes", a.meshes,
           "run the studies of beams and solids over their meshes, or that of --case; without the shared "
           "data, those that need none");
  cli.option("--shard", a.shard, "k/n: run only the k-th of n parts of --all");
  cli.flag("--farm", a.farm,
           "share the work under mpirun: rank 0 distributes it to the other ranks; needs MPI");
  cli.group("stepping");
  add_flags(cli, a.study, a.said);
  std::erase(a.scheme.schemes, "event_driven");
  a.scheme.not_offered =
      "not event_driven: its errors depend on its tolerances, not on h, see doc/theory/event_driven.md";
  a.scheme.left_out.emplace_back("--tolerance");
  add_options(cli, a.scheme);
  add_certify(cli, a.study.certify, "studies");
  add_profile(cli, a.watch.profile, "studies");
  add_options(cli, a.watch.dump);
  add_options(cli, a.tasks, "studies", "all numbers");
  cli.example("convergence --case ball_e05 --theta 1 --normal-law combined",
              "open out/ball_e05_moreau_jean_theta_1_combined.png");
  cli.example("convergence --meshes -o meshes", "orders of elements; see meshes/meshes.md");
  cli.example("convergence --all -o table", "every scheme on every case; see table/convergence.md");
  return run_driver(cli, argc, argv, [&] {
    for (const char* group : {"scheme", "solver"})
      for (const std::string& flag : cli.given(group))
        require(!a.all,
                flag + " cannot be combined with --all, which runs every scheme with its own settings");
    for (const char* group : {"stepping", "scheme", "solver", "run", "problems"})
      for (const std::string& flag : cli.given(group))
        require(!a.meshes, flag + " cannot be combined with --meshes, whose studies take their own steps");
    refuse_unread_flags(cli, a.scheme);
    check(cli, a.watch.dump, a.scheme.scheme);
    take(a.said, a.study);
    if (!a.all) a.study.settings = cli.values("scheme") + cli.values("solver");
    return run(a);
  });
}
