// SPDX-License-Identifier: Apache-2.0
#include "io/recording.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>

#include "geometry/check.hpp"
#include "geometry/settings.hpp"
#include "integrators/run.hpp"
#include "io/build_info.hpp"
#include "io/csv_table.hpp"
#include "io/record.hpp"

namespace aussois {
namespace {

double process_seconds() {
  return double(std::clock()) / CLOCKS_PER_SEC;
}

std::vector<std::string> columns_of(const std::vector<Gauge>& gauges) {
  std::vector<std::string> out;
  for (const Gauge& g : gauges)
    if (!g.column.empty()) out.push_back(g.column);
  return out;
}

void validate(const RecordingOptions& o, const std::vector<Gauge>& gauges) {
  check_ranges(o);
  for (std::size_t i = 0; i < gauges.size(); ++i) {
    const Gauge& g = gauges[i];
    require(bool(g.value), "Gauge " + g.column + g.total + ": value must be callable");
    require((g.keep == GaugeTotal::nothing) == g.total.empty(),
            "Gauge " + g.column + g.total + ": a total needs a name, and a name a total");
    for (std::size_t j = 0; j < i; ++j)
      require(g.total.empty() || g.total != gauges[j].total, "Gauge " + g.total + ": two have this total");
  }
}

}  // namespace

void describe(SettingVisitor& visit, RecordingOptions& o) {
  visit.begin("RecordingOptions");
  visit.count({"every", "record every n-th step", "", range_from(1), "--every"}, o.every);
  visit.number({.name = "checkpoint_every",
                .what = "wall time between checkpoints; 0: after every step",
                .unit = "s",
                .range = range_from(0),
                .flag = "--checkpoint-every",
                .changes_nothing = true},
               o.checkpoint_every);
  visit.count({"audit_samples",
               "number of places of the path of a step at which its certificate is checked",
               "",
               {0, 1000000}},
              o.audit_samples);
  visit.count({.name = "threads",
               .what = "number of threads of the audit",
               .unit = "",
               .range = range_from(1),
               .changes_nothing = true},
              o.threads);
}

struct Recording::Impl {
  const Model& model;
  std::vector<Gauge> gauges{};
  RecordingOptions options{};
  State start{}, before{};
  std::vector<double> total{};
  RunTotals totals{};
  std::int64_t steps = 0;
  double cpu_before = 0;  // of the processes that this run goes on from [s]
  double cpu_begin = process_seconds();
  std::string other_program{};
  RunWriter run;
  CsvTable table;
  std::time_t last_checkpoint = std::time(nullptr);

  std::filesystem::path checkpoint_file() const { return options.folder / "checkpoint.h5"; }
  double cpu() const { return cpu_before + process_seconds() - cpu_begin; }

  CouplingWrench pull(const State& state) const {
    return options.pull ? options.pull(state) : CouplingWrench{};
  }
};

namespace {

bool is_in_run(const Gauge& gauge) {
  return !gauge.column.empty() && !gauge.clock;
}

RunWriter open_run(const RecordingOptions& o, RunHeader header, const std::vector<Gauge>& gauges,
                   const Checkpoint& from) {
  const std::filesystem::path path = o.folder / "run.h5";
  for (const Gauge& g : gauges)
    if (is_in_run(g)) header.gauges.push_back(g.column);
  return o.resume ? RunWriter::resume(path, std::size_t(checkpoint_count(from, "run_rows")))
                  : RunWriter(path, header);
}

CsvTable open_table(const RecordingOptions& o, const std::vector<Gauge>& gauges, const Checkpoint& from) {
  const std::filesystem::path path = o.folder / "steps.csv";
  return o.resume
             ? CsvTable::resume(path, columns_of(gauges), std::size_t(checkpoint_count(from, "csv_rows")))
             : CsvTable(path, columns_of(gauges));
}

}  // namespace

Recording::Recording(const Model& model, const RunHeader& header, std::vector<Gauge> gauges,
                     const RecordingOptions& options, const State& start) {
  validate(options, gauges);
  Checkpoint from{.state = start};
  if (options.resume) {
    from = read_checkpoint(options.folder / "checkpoint.h5", options.fingerprint, options.other);
    validate(model, from.state);
  }
  const State& state = from.state;
  RunWriter run = open_run(options, header, gauges, from);
  CsvTable table = open_table(options, gauges, from);
  impl_ = std::make_unique<Impl>(Impl{.model = model,
                                      .gauges = std::move(gauges),
                                      .options = options,
                                      .start = start,
                                      .before = state,
                                      .totals = run_totals(model, state, options.audit_samples),
                                      .run = std::move(run),
                                      .table = std::move(table)});
  for (const Gauge& g : impl_->gauges)
    impl_->total.push_back(options.resume && !g.total.empty() ? checkpoint_number(from, "total:" + g.total)
                                                              : total_of_nothing(g.keep));
  if (!options.resume) {
    RunStep first = run_step(0, model, state, impl_->pull(state));
    first.gauges = VecX::Constant(std::ranges::count_if(impl_->gauges, is_in_run), std::nan(""));
    impl_->run.append(std::move(first));
    return;
  }
  impl_->totals = run_totals_of(from, options.audit_samples);
  impl_->steps = from.step;
  impl_->cpu_before = checkpoint_number(from, "cpu_s");
  if (from.program == program_version()) return;
  impl_->other_program = from.program;
  impl_->run.note("continued_by",
                  program_version() + " after step " + std::to_string(from.step) + " of " + from.program);
}

Recording::Recording(Recording&&) noexcept = default;
Recording::~Recording() = default;

void Recording::add(const State& state, const StepReport& report) {
  Impl& r = *impl_;
  const Frame frame{r.model, r.start, r.before, state, report, ++r.steps};
  add_frame(frame, r.options.threads, r.totals);
  const bool recorded = r.steps % r.options.every == 0;
  std::vector<double> row, in_run;
  for (std::size_t i = 0; i < r.gauges.size(); ++i) {
    const Gauge& g = r.gauges[i];
    const bool in_row = recorded && !g.column.empty();
    if (!in_row && g.keep == GaugeTotal::nothing) continue;
    const double value = g.value(frame);
    if (in_row) row.push_back(value);
    if (in_row && is_in_run(g)) in_run.push_back(value);
    r.total[i] = next_total(g.keep, r.total[i], value);
  }
  if (recorded) {
    RunStep step = run_step(r.steps, r.model, state, report, r.pull(state));
    step.gauges = Eigen::Map<const VecX>(in_run.data(), Eigen::Index(in_run.size()));
    r.run.append(std::move(step));
    r.table.add(row);
  }
  r.before = state;
  if (double(std::time(nullptr) - r.last_checkpoint) >= r.options.checkpoint_every) checkpoint();
}

void Recording::checkpoint() {
  Impl& r = *impl_;
  r.run.flush();
  r.table.flush();
  Checkpoint out{
      .fingerprint = r.options.fingerprint,
      .step = r.steps,
      .state = r.before,
      .numbers = {{"cpu_s", r.cpu()}},
      .counts = {{"csv_rows", std::int64_t(r.table.rows())}, {"run_rows", std::int64_t(r.run.rows())}}};
  for (std::size_t i = 0; i < r.gauges.size(); ++i)
    if (!r.gauges[i].total.empty()) out.numbers["total:" + r.gauges[i].total] = r.total[i];
  keep_totals(r.totals, out);
  write_checkpoint(r.checkpoint_file(), out);
  r.last_checkpoint = std::time(nullptr);
}

void Recording::close() {
  impl_->table.close();
  impl_->run.close();
  std::filesystem::remove(impl_->checkpoint_file());
}

const State& Recording::state() const {
  return impl_->before;
}

std::int64_t Recording::steps() const {
  return impl_->steps;
}

double Recording::total(const std::string& name) const {
  const auto found = std::ranges::find(impl_->gauges, name, &Gauge::total);
  require(!name.empty() && found != impl_->gauges.end(), "Recording::total: no gauge keeps '" + name + "'");
  return impl_->total[found - impl_->gauges.begin()];
}

const RunTotals& Recording::totals() const {
  return impl_->totals;
}

double Recording::cpu_seconds() const {
  return impl_->cpu();
}

const std::string& Recording::other_program() const {
  return impl_->other_program;
}

void Recording::set(Summary& summary) const {
  summary.set("steps", impl_->steps);
  for (std::size_t i = 0; i < impl_->gauges.size(); ++i)
    if (const Gauge& g = impl_->gauges[i]; !g.total.empty())
      summary.set(g.total,
                  g.whole ? SummaryValue(std::int64_t(impl_->total[i])) : SummaryValue(impl_->total[i]));
  set_totals(impl_->totals, impl_->model, summary);
}

StepReport record_run(const Scheme& scheme, State& state, double t_end, Recording& recording,
                      const std::function<bool(const StepReport&)>& go_on) {
  return run(scheme, state, t_end, [&](const StepReport& report) {
    if (report.moved()) recording.add(state, report);
    return !go_on || go_on(report);
  });
}

}  // namespace aussois
