// SPDX-License-Identifier: Apache-2.0
// How long does a tick of a session take? A scripted hand leads a part along its path, there and back, with a
// wobble of three clearances and a tremor; percentiles of CPU and wall time, the part of real time that a
// session keeps up with, contacts and allocations. On a noisy machine it says so.
//
// Theory   doc/theory/sessions.md (SES-1)
// Run      bench_latency --builtin bolt_nut
//          bench_latency --data DIR --pair own_tslot --tick 1e-3 --seconds 20 --json out/latency.json
// Expect   p99 of the CPU time, and the ratio of its tick to the mean wall time
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <new>

#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "examples/common/progress.hpp"
#include "examples/common/quantile.hpp"
#include "examples/drivers/station/station_setup.hpp"
#include "geometry/check.hpp"
#include "io/atomic_file.hpp"

namespace {
std::atomic<std::int64_t> allocations = 0;
}  // namespace

// All of the process, which has one thread while ticks are timed.
[[gnu::noinline]] void* operator new(std::size_t size) {
  allocations.fetch_add(1, std::memory_order_relaxed);
  if (void* place = std::malloc(size)) return place;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* place) noexcept {
  std::free(place);
}
[[gnu::noinline]] void operator delete(void* place, std::size_t) noexcept {
  std::free(place);
}

using namespace aussois;

namespace {

constexpr double kNoisy = 1.1;                        // wall over CPU time, at the median
constexpr double kWobble = 3, kTremor = 0.2;          // of the hand, in clearances
constexpr double kWobbleRate = 1.3, kTremorRate = 8;  // [Hz]

struct Arguments {
  StationFlags station{};
  double seconds = 5;
  std::filesystem::path json{};
  CommonOptions common{};
};

struct TickCost {
  double wall = 0, cpu = 0;  // [s]
  std::int64_t allocations = 0, switches = 0;
  int contacts = 0, steps = 0;
  bool whole = true;
};

double seconds_on(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}
std::int64_t switches() {
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  return usage.ru_nvcsw + usage.ru_nivcsw;
}

// Along the path and back, across it by the wobble, and shaking.
PortTarget hand_at(const Station& station, double t) {
  const Trajectory& path = station.scene.path;
  const double whole = path.t.back(), there = std::fmod(t, 2 * whole);
  PortTarget out{.mode = PortTarget::Mode::pose,
                 .pose = trajectory_point(path, std::min(there, 2 * whole - there)).pose};
  const Vec3 aside = Vec3(1, 1, 1).normalized();
  out.pose.p +=
      station.scene.clearance * (kWobble * std::sin(2 * kPi * kWobbleRate * t) * aside +
                                 kTremor * std::sin(2 * kPi * kTremorRate * t) * aside.unitOrthogonal());
  return out;
}

TickCost tick(SessionStage& stage, const PortTarget& target) {
  const std::int64_t before = allocations, switched = switches();
  const double wall = seconds_on(CLOCK_MONOTONIC), cpu = seconds_on(CLOCK_THREAD_CPUTIME_ID);
  const TickReport report = stage.advance(target);
  TickCost out{.wall = seconds_on(CLOCK_MONOTONIC) - wall, .cpu = seconds_on(CLOCK_THREAD_CPUTIME_ID) - cpu};
  out.allocations = allocations - before;
  out.switches = switches() - switched;
  out.steps = int(report.steps.size());
  for (const StepReport& step : report.steps) out.contacts = std::max(out.contacts, step.contacts_found);
  out.whole = report.whole();
  return out;
}

template <class Get>
std::vector<double> all(const std::vector<TickCost>& costs, Get get) {
  std::vector<double> out;
  for (const TickCost& cost : costs) out.push_back(double(get(cost)));
  return out;
}

constexpr std::pair<const char*, double> kParts[] = {
    {"p50", 0.5}, {"p90", 0.9}, {"p99", 0.99}, {"p999", 0.999}, {"max", 1}};

void print_row(const char* name, const std::vector<double>& values, double scale) {
  std::printf("%-12s", name);
  for (const auto& [part, share] : kParts) std::printf("  %s %9.4g", part, scale * quantile(values, share));
  std::printf("\n");
}
nlohmann::ordered_json json_row(const std::vector<double>& values, double scale) {
  nlohmann::ordered_json out;
  for (const auto& [part, share] : kParts) out[part] = scale * quantile(values, share);
  return out;
}

ExitCode bench(const Arguments& a) {
  require(a.common.threads == 1, "--threads must be 1: one thread is timed");
  const Station station = set_up(a.station, 1, a.common.quiet);
  print_warnings(station.input, station.scene);
  std::printf("%s\n", to_string(station).c_str());
  SessionStage stage(station.make, station.parameters, station.options);
  const auto ticks = std::max<std::int64_t>(10, std::int64_t(a.seconds / station.parameters.tick));
  Progress progress("bench_latency", double(ticks), Progress::style_of_stderr(a.common.quiet));
  std::vector<TickCost> costs;
  for (std::int64_t k = 0; k < ticks && !interrupted(); ++k) {
    costs.push_back(tick(stage, hand_at(station, double(k + 1) * station.parameters.tick)));
    progress.at(double(k + 1));
  }
  if (interrupted()) return ExitCode::interrupted;
  const auto cpu = all(costs, [](const TickCost&c) { return c.cpu; }),
             wall = all(costs, [](const TickCost&c) { return c.wall; });
  const auto contacts = all(costs, [](const TickCost&c) { return c.contacts; }),
             news = all(costs, [](const TickCost&c) { return c.allocations; });
  const auto steps = all(costs, [](const TickCost&c) { return c.steps; }),
             switched = all(costs, [](const TickCost&c) { return c.switches; });
  double sum = 0;
  for (const double w : wall) sum += w;
  const double pace = station.parameters.tick * double(ticks) / sum,
               noise = quantile(wall, 0.5) / quantile(cpu, 0.5);
  const auto refused = std::ranges::count_if(costs, [](const TickCost& c) { return !c.whole; });
  print_row("CPU [ms]", cpu, 1e3);
  print_row("wall [ms]", wall, 1e3);
  print_row("contacts", contacts, 1);
  print_row("steps", steps, 1);
  print_row("allocations", news, 1);
  print_row("switches", switched, 1);
  std::printf("%s, %s: %lld ticks of %.4g ms, %.3g of real time, %lld refused%s\n",
              station.input.name.c_str(), station.options.scheme.c_str(), static_cast<long long>(ticks),
              1e3 * station.parameters.tick, pace, static_cast<long long>(refused),
              noise > kNoisy ? ", noisy" : "");
  if (!a.json.empty())
    write_whole_file(a.json, nlohmann::ordered_json{{"scene", station.input.name},
                                                    {"scheme", station.options.scheme},
                                                    {"tick_s", station.parameters.tick},
                                                    {"ticks", ticks},
                                                    {"real_time", pace},
                                                    {"noisy", noise > kNoisy},
                                                    {"refused", refused},
                                                    {"cpu_ms", json_row(cpu, 1e3)},
                                                    {"wall_ms", json_row(wall, 1e3)},
                                                    {"contacts", json_row(contacts, 1)},
                                                    {"steps", json_row(steps, 1)},
                                                    {"allocations", json_row(news, 1)},
                                                    {"switches", json_row(switched, 1)}}
                                     .dump(1) +
                                 '\n');
  return refused == 0 ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli("bench_latency", "Percentiles of the time that a tick of a session takes, with a scripted hand.");
  add_options(cli, a.station);
  cli.group("benchmark");
  cli.option("--seconds", a.seconds, "simulated time", "s", {0.01, 1e5});
  cli.option("--json", a.json, "file of the figures");
  cli.common(a.common);
  cli.example("bench_latency --builtin bolt_nut", "a nut on its bolt");
  cli.example("bench_latency --data DIR --pair alpha20 --scheme passive_midpoint", "as with a haptic device");
  return run_driver(cli, argc, argv, [&] { return bench(a); });
}
