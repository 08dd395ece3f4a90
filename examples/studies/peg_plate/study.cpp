// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/peg_plate/study.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <numeric>

#include "examples/common/random.hpp"
#include "geometry/check.hpp"
#include "geometry/parallel.hpp"
#include "geometry/settings.hpp"
#include "reduction/learned_selector.hpp"

namespace aussois {
namespace {

constexpr double kTrainShare = 0.7;
constexpr double kTilts = 0.5;  // of plates to train on besides [deg]

// Root of the mean square.
class Rms {
 public:
  void add(double x) {
    sum_ += x * x;
    ++count_;
  }
  double value() const { return count_ > 0 ? std::sqrt(sum_ / count_) : 0; }

 private:
  double sum_ = 0;
  int count_ = 0;
};

class Mean {
 public:
  void add(double x) {
    sum_ += x;
    ++count_;
  }
  double value() const { return count_ > 0 ? sum_ / count_ : 0; }

 private:
  double sum_ = 0;
  int count_ = 0;
};

const PegScore* find(const PegResult& result, const std::string& name) {
  const auto found = std::ranges::find(result.scores, name, &PegScore::name);
  return found == result.scores.end() ? nullptr : &*found;
}

// One more seed.
void count(PegVerdict& line, double x) {
  line.value = line.seeds == 0 ? x : line.at_least ? std::min(line.value, x) : std::max(line.value, x);
  line.met += line.at_least ? x >= line.bound : x <= line.bound;
  ++line.seeds;
}

// Collects one line of the verdict over all seeds of a set.
struct Judge {
  const std::vector<PegResult>& results;
  std::vector<PegVerdict> lines{};

  // `value` gives the figure of one seed, negative where there is none.
  template <class Value>
  void line(const std::string& what, const std::string& set, double bound, bool at_least, bool four_of_five,
            const Value& value) {
    PegVerdict out{.what = what + ", " + set, .bound = bound, .at_least = at_least};
    for (const PegResult& result : results)
      if (const double x = result.set == set ? value(result) : -1; x >= 0) count(out, x);
    out.needed = four_of_five ? (4 * out.seeds + 4) / 5 : out.seeds;
    if (out.seeds > 0) lines.push_back(out);
  }
  void still(const std::string& item, const std::string& name, const std::string& set, double bound,
             bool four_of_five = false) {
    line(item + " " + name + ", static size", set, bound, false, four_of_five, [&](const PegResult& r) {
      const PegScore* s = find(r, name);
      return s ? s->still_size : -1;
    });
  }
  template <class Quotient>
  void ratio(const std::string& what, const std::string& a, const std::string& b, const std::string& set,
             double bound, bool at_least, bool four_of_five, const Quotient& quotient) {
    line(what, set, bound, at_least, four_of_five, [&](const PegResult& r) {
      const PegScore *x = find(r, a), *y = find(r, b);
      return x && y ? quotient(*x, *y) : -1;
    });
  }
};

std::vector<PegCase> cases_of(const PlantOptions& plant) {
  return peg_cases(plant.scenario, plant.count, plant.leans);
}
int own_cases(const PlantOptions& plant) {
  return int(cases_of(plant).size());
}
bool with_tilted(const PegStudyOptions& options) {
  return options.tilted && options.plant.scenario == PegScenario::surface;
}

double still_ratio(const PegScore& a, const PegScore& b) {
  return a.still_size / b.still_size;
}

}  // namespace

const std::vector<PegSet>& peg_sets() {
  static const std::vector<PegSet> sets{{"surface_0.1", PegScenario::surface, 0.1, 0.05},
                                        {"surface_0.3", PegScenario::surface, 0.3, 0.15},
                                        {"surface_0", PegScenario::surface, 0, 0},
                                        {"edge_0.1", PegScenario::edge, 0.1, 0.05},
                                        {"edge_0.3", PegScenario::edge, 0.3, 0.3}};
  return sets;
}

void describe(SettingVisitor& visit, PegStudyOptions& o) {
  visit.begin("PegStudyOptions");
  visit.group("plant", o.plant);
  visit.group("view", o.view);
  visit.group("training", o.training);
  const auto stride = [&](const char* name, const char* what, int& value) {
    visit.count({name, what, "", range_from(1)}, value);
  };
  stride("static_stride", "stride of the static samples of a case for training", o.static_stride);
  stride("moving_stride", "stride of the other samples of a case for training", o.moving_stride);
  stride("moving_scored", "number of those samples that are scored", o.moving_scored);
  stride("dear_stride", "stride of scored samples for expensive methods", o.dear_stride);
  visit.toggle({.name = "tilted",
                .what = "train surface sets on as many cases again, with plates tilted by up to 0.5 degrees",
                .flag = "--tilted"},
               o.tilted);
  visit.count({.name = "threads",
               .what = "number of threads; does not affect the results",
               .unit = "",
               .range = {1, 256},
               .flag = "--threads",
               .changes_nothing = true},
              o.threads);
}

int case_count(const PegStudyOptions& options) {
  return (with_tilted(options) ? 2 : 1) * own_cases(options.plant);
}

std::vector<PegSample> peg_samples(const PegStudyOptions& options, int index) {
  const std::vector<PegCase> cases = cases_of(options.plant);
  PlantOptions plant = options.plant;
  if (index >= int(cases.size())) {
    plant.tilt = 0;
    plant.tilts = kTilts;
  }
  return peg_samples(make_plant(plant), cases[std::size_t(index) % cases.size()], index);
}

PegData generate(const PegStudyOptions& options) {
  PegData data(case_count(options));
  parallel_for(int(data.size()), options.threads, [&](int i) { data[i] = peg_samples(options, i); });
  return data;
}

PegSplit split_cases(int cases, std::uint64_t seed) {
  require_field(cases >= 2, "cases", cases, "be at least 2, to train on some and test on others");
  std::vector<int> order(static_cast<std::size_t>(cases));
  std::iota(order.begin(), order.end(), 0);
  Random random(seed);
  for (int i = cases - 1; i > 0; --i) std::swap(order[i], order[random.index(i + 1)]);
  const auto middle = order.begin() + std::clamp(std::lround(kTrainShare * cases), 1L, cases - 1L);
  PegSplit split{{order.begin(), middle}, {middle, order.end()}};
  std::ranges::sort(split.train);
  std::ranges::sort(split.test);
  return split;
}

PegSplit split_cases(const PegStudyOptions& options) {
  const int own = own_cases(options.plant);
  PegSplit split = split_cases(own, options.plant.seed);
  for (int i = own; i < case_count(options); ++i) split.train.push_back(i);
  return split;
}

Lessons make_lessons(const PegData& data, const PegSplit& split, const PegStudyOptions& options,
                     const std::function<void(double)>& progress) {
  check_ranges(options);
  std::vector<PegSample> samples;
  for (const int i : split.train) {
    int still = 0, moving = 0;
    for (const PegSample& s : data[i])
      if (s.is_static ? still++ % options.static_stride == 0 : moving++ % options.moving_stride == 0)
        samples.push_back(s);
  }
  require(!samples.empty(), "make_lessons: the training cases have no sample in contact");
  Lessons out{.X = MatX(kLoadInputs, samples.size())};
  for (std::size_t i = 0; i < samples.size(); ++i) out.X.col(Eigen::Index(i)) = input_of(load_of(samples[i]));
  std::mutex mutex;
  int done = 0;
  out.errors = choice_errors(options.view, options.plant.scenario, samples, options.threads, [&] {
    const std::lock_guard lock(mutex);
    if (progress) progress(double(++done) / double(samples.size()));
  });
  return out;
}

Training train(const Lessons& lessons, LabelMode mode, const PegStudyOptions& options,
               const std::function<bool(int, double)>& progress) {
  const PegScenario scenario = options.plant.scenario;
  const std::vector<std::vector<int>> choices = peg_choices(scenario);
  const int outputs = scenario == PegScenario::surface ? int(face_places().size()) : int(choices.size());
  return train(lessons.X, targets(lessons.errors, choices, outputs, {.mode = mode}), options.training,
               progress);
}

LessonsLearnt learnt_from(const Lessons& lessons, PegScenario scenario) {
  LessonsLearnt out{.best_choice = ranking(lessons.errors, LabelOptions{}.delta).front()};
  if (scenario == PegScenario::edge) {
    const std::vector<int> labels = chosen_labels(lessons.errors, {.mode = LabelMode::argmin});
    out.upright_share = double(std::ranges::count(labels, kUprightNormal)) / double(labels.size());
  }
  return out;
}

std::vector<NamedMethod> all_methods(const PegStudyOptions& options, const LessonsLearnt& learnt,
                                     const std::vector<Network>& networks) {
  const PegScenario scenario = options.plant.scenario;
  std::vector<NamedMethod> methods = untrained_methods(scenario, options.view, options.plant.seed);
  methods.push_back(fixed_method("best_fixed", scenario, peg_choices(scenario)[learnt.best_choice]));
  for (std::size_t i = 0; i < networks.size(); ++i)
    methods.push_back(learned_method(std::string("mlc_") + to_string(kLabelModes[i]), scenario, networks[i]));
  methods.push_back(oracle_method(scenario, options.view));
  return methods;
}

PegScore score(const NamedMethod& method, const PegData& data, const std::vector<int>& cases,
               const PegStudyOptions& options) {
  check_ranges(options);
  const int dear = method.dear ? options.dear_stride : 1;
  const PegMethod contacts_of = method.make();
  Rms still_size, still, moving_size, moving;
  Mean chatter, of_cases;
  PegScore out{.name = method.name};
  for (const int i : cases) {
    Rms of_case;
    int still_seen = 0, moving_seen = 0;
    bool first = true, has_before = false;
    Vec3 before = Vec3::Zero(), before_e = Vec3::Zero();
    for (const PegSample& s : data[i]) {
      const int seen = s.is_static ? still_seen++ : moving_seen++;
      if (seen % (s.is_static ? dear : dear * options.moving_scored) != 0) continue;
      const Vec3 F = plate_force(options.view, s, contacts_of(s, first)), F_e = s.plate_force;
      first = false;
      const double size = F_e.norm(), of_size = (F.norm() - size) / size, of_vector = (F - F_e).norm() / size;
      (s.is_static ? still_size : moving_size).add(of_size);
      (s.is_static ? still : moving).add(of_vector);
      if (!s.is_static) continue;
      of_case.add(of_size);
      if (has_before) chatter.add(((F - before) - (F_e - before_e)).norm());
      before = F;
      before_e = F_e;
      has_before = true;
    }
    of_cases.add(of_case.value());
    out.case_worst = std::max(out.case_worst, of_case.value());
  }
  out.still_size = still_size.value();
  out.still = still.value();
  out.moving_size = moving_size.value();
  out.moving = moving.value();
  out.chatter = chatter.value();
  out.case_mean = of_cases.value();
  return out;
}

std::vector<PegScore> score_all(const std::vector<NamedMethod>& methods, const PegData& data,
                                const PegStudyOptions& options,
                                const std::function<bool(const std::string&)>& progress) {
  const PegSplit split = split_cases(options);
  std::vector<PegScore> out(methods.size());
  parallel_for(int(methods.size()), options.threads, [&](int i) {
    const NamedMethod& method = methods[i];
    if (!progress || progress(method.name)) out[i] = score(method, data, split.test, options);
  });
  return out;
}

std::vector<PegVerdict> verdicts(const std::vector<PegResult>& results,
                                 const std::vector<TrainingCheck>& checks) {
  Judge judge{results};
  for (const std::string set : {"surface_0.1", "surface_0.3"}) {
    for (const char* name : {"full", "hull_exact", "extreme_points"}) judge.still("A-1", name, set, 0.01);
    judge.still("A-1", "mlc_ranked", set, 0.015, true);
    judge.ratio("A-1 mlc_ranked / kmcw", "mlc_ranked", "kmcw", set, set == "surface_0.1" ? 0.5 : 0.25, false,
                true, still_ratio);
    judge.ratio(
        "A-1 kmc / kmcw, or its inverse", "kmc", "kmcw", set, 1.33, false, false,
        [](const PegScore& a, const PegScore& b) { return std::max(still_ratio(a, b), still_ratio(b, a)); });
    judge.ratio("A-1 chatter of kmc / kmcw", "kmc", "kmcw", set, 4, true, false,
                [](const PegScore& a, const PegScore& b) { return a.chatter / b.chatter; });
  }
  for (const std::string set : {"edge_0.1", "edge_0.3"}) {
    judge.ratio("A-2 mlc_soft / upright, static size", "mlc_soft", "upright", set, 0.6, false, false,
                still_ratio);
    const auto share = [](const PegResult& r) { return r.upright_share; };
    judge.line("A-2 share of the upright normal", set, 0.3, true, false, share);
    judge.line("A-2 share of the upright normal", set, 0.8, false, false, share);
  }
  for (const char* name : {"full", "kmc", "kmcw", "mlc_ranked"}) judge.still("A-3", name, "surface_0", 0.01);
  for (const std::string set : {"surface_0.1", "surface_0.3", "surface_0"})
    judge.still("A-4", "load_carrier", set, 0.01);
  if (checks.empty()) return judge.lines;
  PegVerdict gradient{.what = "A-5 gradient against differences", .bound = 1e-7},
      bits{.what = "A-5 weights that differ, trained again", .bound = 0},
      loss{.what = "A-5 loss off that of another library", .bound = 0.05};
  for (const TrainingCheck& check : checks) {
    count(gradient, check.gradient);
    count(bits, check.weights_that_differ);
    count(loss, check.loss_error());
  }
  for (PegVerdict line : {gradient, bits, loss}) {
    line.needed = line.seeds;
    judge.lines.push_back(line);
  }
  return judge.lines;
}

std::string to_string(const std::vector<PegVerdict>& verdicts) {
  std::string out;
  char line[160];
  for (const PegVerdict& v : verdicts) {
    std::snprintf(line, sizeof line, "%-58s %8.3g  %s %-6g %d of %d seeds  %s\n", v.what.c_str(), v.value,
                  v.at_least ? ">=" : "<=", v.bound, v.met, v.seeds, v.accepted() ? "met" : "MISSED");
    out += line;
  }
  return out;
}

std::string score_table(const std::vector<PegResult>& results) {
  std::string out;
  std::vector<std::string> sets;
  for (const PegResult& r : results)
    if (std::ranges::find(sets, r.set) == sets.end()) sets.push_back(r.set);
  for (const std::string& set : sets) {
    out += "\n" + set +
           ": synthetic reference, rms errors in %\n\n"
           "| method | static size | (largest) | static vector | moving size | moving vector | chatter [N] | "
           "worst case |\n"
           "|---|---|---|---|---|---|---|---|\n";
    const auto first = std::ranges::find(results, set, &PegResult::set);
    for (const PegScore& named : first->scores) {
      Mean still_size, still, moving_size, moving, chatter;
      double largest = 0, worst = 0;
      for (const PegResult& r : results) {
        const PegScore* s = r.set == set ? find(r, named.name) : nullptr;
        if (!s) continue;
        still_size.add(s->still_size);
        still.add(s->still);
        moving_size.add(s->moving_size);
        moving.add(s->moving);
        chatter.add(s->chatter);
        largest = std::max(largest, s->still_size);
        worst = std::max(worst, s->case_worst);
      }
      char line[200];
      std::snprintf(line, sizeof line, "| %s | %.2f | %.2f | %.2f | %.2f | %.2f | %.3f | %.2f |\n",
                    named.name.c_str(), 100 * still_size.value(), 100 * largest, 100 * still.value(),
                    100 * moving_size.value(), 100 * moving.value(), chatter.value(), 100 * worst);
      out += line;
    }
  }
  return out;
}

PegStudyOptions options_for(const PegSet& set, PegStudyOptions options) {
  options.plant.scenario = set.scenario;
  options.plant.tilt = set.tilt;
  options.plant.scatter = set.scatter;
  return options;
}

PegResult run_study(const PegSet& set, const PegStudyOptions& of_study) {
  PegStudyOptions options = options_for(set, of_study);
  options.training.seed = options.plant.seed;
  const PegData data = generate(options);
  const Lessons lessons = make_lessons(data, split_cases(options), options);
  const LessonsLearnt learnt = learnt_from(lessons, set.scenario);
  std::vector<Network> networks;
  for (const LabelMode mode : kLabelModes) networks.push_back(train(lessons, mode, options).network);
  return {.set = set.name,
          .seed = options.plant.seed,
          .scores = score_all(all_methods(options, learnt, networks), data, options),
          .upright_share = learnt.upright_share};
}

}  // namespace aussois
