// SPDX-License-Identifier: Apache-2.0
// A robot presses a peg on a plate: which contacts must a simulator keep to predict the force? Compares
// reducers, clusterings and a small network on a synthetic reference. It can be interrupted at any time: the
// next call with the same -o continues.
//
// Theory   doc/theory/peg_plate.md (PEG-1) to (PEG-17), [Kim2019]
// Run      peg_plate generate train evaluate --count 4 --set surface_0.3
// Expect   verdicts on one set of a few cases. With --seeds 5 and no other option it is the whole study (20
//          minutes on one core): reducers that keep the hull reach the sensors' floor, means of clusters do
//          not; exit code 0 if all verdicts are met
#include <algorithm>
#include <cstdio>
#include <mutex>
#include <thread>

#include "examples/common/driver.hpp"
#include "examples/common/gnuplot.hpp"
#include "examples/common/progress.hpp"
#include "examples/common/setting_flags.hpp"
#include "examples/studies/peg_plate/study_files.hpp"
#include "geometry/check.hpp"
#include "geometry/parallel.hpp"
#include "io/atomic_file.hpp"
#include "io/network_file.hpp"

using namespace aussois;

namespace {

struct Arguments {
  std::vector<std::filesystem::path> stages{};
  std::string set = "all";
  int seed = 1, seeds = 1;
  PegStudyOptions study{};
  SaidSettings said{};  // of the study
  std::filesystem::path out = "out";
  bool quiet = false;
};

/// One set with one seed.
struct Job {
  PegSet set{};
  PegStudyOptions options{};
  std::filesystem::path folder{};
  std::string name() const { return set.name + " seed " + std::to_string(options.plant.seed); }
  std::filesystem::path network(LabelMode mode) const {
    return folder / (std::string("mlc_") + to_string(mode) + ".txt");
  }
};

std::vector<Job> jobs_of(const Arguments& a) {
  std::vector<Job> jobs;
  for (int seed = a.seed; seed < a.seed + a.seeds; ++seed)
    for (const PegSet& set : peg_sets()) {
      if (a.set != "all" && a.set != set.name) continue;
      Job job{.set = set, .options = options_for(set, a.study)};
      job.options.plant.seed = job.options.training.seed = std::uint64_t(seed);
      if (set.scenario == PegScenario::edge)
        job.options.plant.count = std::max(1, (a.study.plant.count + 1) / 2);
      job.folder = a.out / ("seed_" + std::to_string(seed)) / set.name;
      jobs.push_back(job);
    }
  return jobs;
}

void generate(const Job& job, bool quiet) {
  claim_folder(job.folder, job.options);
  const int cases = case_count(job.options);
  Progress progress("generate " + job.name(), double(cases), Progress::style_of_stderr(quiet));
  std::mutex mutex;
  int done = 0;
  parallel_for(cases, job.options.threads, [&](int i) {
    const std::filesystem::path file = samples_file(job.folder, i);
    if (!interrupted() && !std::filesystem::exists(file)) write_samples(file, peg_samples(job.options, i));
    const std::lock_guard lock(mutex);
    progress.at(++done);
  });
}

void train(const Job& job, bool quiet) {
  claim_folder(job.folder, job.options);
  const std::filesystem::path lessons_file = job.folder / "lessons.json";
  const auto is_there = [&](LabelMode mode) { return std::filesystem::exists(job.network(mode)); };
  if (read_lessons(lessons_file, job.set.scenario) && std::ranges::all_of(kLabelModes, is_there)) return;

  const PegData data = read_data(job.folder, case_count(job.options));
  Progress progress("train " + job.name(), 4, Progress::style_of_stderr(quiet));
  const Lessons lessons = make_lessons(data, split_cases(job.options), job.options,
                                       [&](double part) { progress.at(part, "labels"); });
  int done = 0;
  for (const LabelMode mode : kLabelModes) {
    ++done;
    const Training made = train(lessons, mode, job.options, [&](int k, double) {
      progress.at(done + double(k) / job.options.training.iterations, to_string(mode));
      return !interrupted();
    });
    if (interrupted()) return;
    if (job.set.scenario == PegScenario::surface)
      write_selector(job.network(mode), {.network = made.network, .places = face_places()});
    else
      write_network(job.network(mode), made.network);
    if (!quiet)
      std::printf("%s, %s labels: loss %.4f after %s\n", job.name().c_str(), to_string(mode), made.loss,
                  counted_noun(made.iterations, "iteration").c_str());
  }
  write_lessons(lessons_file, learnt_from(lessons, job.set.scenario));
}

std::optional<PegResult> known_result(const Job& job) {
  return read_result(job.folder / "result.json", job.set.name, job.options.plant.seed);
}

/// True: the pictures are there.
bool evaluate(const Job& job, bool quiet) {
  claim_folder(job.folder, job.options);
  if (known_result(job)) return true;
  const std::optional<LessonsLearnt> learnt = read_lessons(job.folder / "lessons.json", job.set.scenario);
  if (!learnt) throw std::runtime_error(job.folder.string() + "/lessons.json is missing: train first");
  const PegData data = read_data(job.folder, case_count(job.options));
  std::vector<Network> networks;
  for (const LabelMode mode : kLabelModes) networks.push_back(read_network(job.network(mode)));
  const std::vector<NamedMethod> methods = all_methods(job.options, *learnt, networks);

  Progress progress("evaluate " + job.name(), double(methods.size()), Progress::style_of_stderr(quiet));
  std::mutex mutex;
  int begun = 0;
  const PegResult result{.set = job.set.name,
                         .seed = job.options.plant.seed,
                         .scores = score_all(methods, data, job.options,
                                             [&](const std::string& method) {
                                               const std::lock_guard lock(mutex);
                                               progress.at(begun++, method);
                                               return !interrupted();
                                             }),
                         .upright_share = learnt->upright_share};
  if (interrupted()) return true;
  const LabelMode shown = job.set.scenario == PegScenario::surface ? LabelMode::ranked : LabelMode::soft;
  const bool drawn = write_pictures(job.folder, data, split_cases(job.options).test, methods,
                                    read_network(job.network(shown)), job.options);
  write_result(job.folder / "result.json", result);
  return drawn;
}

/// A-5, once per seed.
std::vector<TrainingCheck> check_trainings(const Arguments& a) {
  std::vector<TrainingCheck> out;
  for (int seed = a.seed; seed < a.seed + a.seeds; ++seed) {
    const std::filesystem::path file = a.out / ("seed_" + std::to_string(seed)) / "training.json";
    std::optional<TrainingCheck> check = read_training_check(file, std::uint64_t(seed));
    if (!check) write_training_check(file, *(check = check_training(std::uint64_t(seed))));
    out.push_back(*check);
  }
  return out;
}

ExitCode evaluate_jobs(const Arguments& a, const std::vector<Job>& jobs) {
  std::vector<PegResult> results;
  for (const Job& job : jobs)
    if (const std::optional<PegResult> result = known_result(job)) results.push_back(*result);
  const std::vector<PegVerdict> lines = verdicts(results, check_trainings(a));
  const std::string table = score_table(results), verdict = to_string(lines);
  write_whole_file(a.out / "scores.md", table);
  write_whole_file(a.out / "verdicts.txt", verdict);
  std::printf("%s\n%s", table.c_str(), verdict.c_str());
  return std::ranges::all_of(lines, &PegVerdict::accepted) ? ExitCode::ok : ExitCode::not_accepted;
}

ExitCode run(const Arguments& a) {
  for (const std::filesystem::path& stage : a.stages)
    require(stage == "generate" || stage == "train" || stage == "evaluate",
            "stage " + stage.string() + " must be generate, train or evaluate");
  const auto asked = [&](const char* stage) { return std::ranges::find(a.stages, stage) != a.stages.end(); };
  const std::vector<Job> jobs = jobs_of(a);
  bool drawn = true;
  for (const Job& job : jobs) {
    if (asked("generate")) generate(job, a.quiet);
    if (asked("train") && !interrupted()) train(job, a.quiet);
    if (asked("evaluate") && !interrupted()) drawn = evaluate(job, a.quiet) && drawn;
    if (interrupted()) return ExitCode::interrupted;
  }
  if (!drawn) tell_no_picture();
  return asked("evaluate") ? evaluate_jobs(a, jobs) : ExitCode::ok;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  a.study.threads = int(std::max(1u, std::thread::hardware_concurrency()));
  std::vector<std::string> sets{"all"};
  for (const PegSet& set : peg_sets()) sets.push_back(set.name);
  Cli cli("peg_plate",
          "Compares ways to choose contacts by the force that one solve predicts for a peg on a plate, "
          "against a synthetic reference.");
  cli.files(a.stages, "stages to run: generate, train, evaluate; always in this order");
  cli.group("reference");
  cli.choice("--set", a.set, "data set: scenario and tilt of the plate in degrees", sets);
  cli.option("--seed", a.seed, "seed of the plant, the split of the cases and the initial weights", "",
             {0, 1e6});
  cli.option("--seeds", a.seeds, "number of seeds, the first of which is --seed", "", {1, 100});
  const std::vector<OfferedSetting> study = offered(a.study, a.said);
  add_flags(cli, study, a.said, {"--count", "--leans", "--step"});
  cli.group("solver");
  add_flags(cli, study, a.said, {"--rho", "--reading"});
  cli.group("training");
  add_flags(cli, study, a.said, {"--tilted", "--hidden", "--iterations"});
  cli.group("output");
  cli.option("-o,--out", a.out, "folder for the study, created if missing; results already in it are reused");
  add_flags(cli, study, a.said, {"--threads"});
  cli.flag("--quiet", a.quiet, "omit progress and details; still print warnings and the result");
  cli.example("peg_plate generate train evaluate --count 4 --set surface_0.3",
              "a small study; open out/seed_1/surface_0.3/forces.png");
  cli.example("peg_plate generate train evaluate --seeds 5 -o study", "the whole study; see study/scores.md");
  return run_driver(cli, argc, argv, [&] {
    take(a.said, a.study);
    return run(a);
  });
}
