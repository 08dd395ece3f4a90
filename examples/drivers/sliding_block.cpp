// SPDX-License-Identifier: Apache-2.0
// A block slides on an incline and comes to rest. Measures the order of the scheme across the change from
// slip to stick.
//
// Theory   doc/theory/moreau_jean.md (MJ-2), (MJ-8): order one at theta = 1, the default here. At theta = 1/2
//          the error is far smaller but jumps with the phase of the last step, so it shows no order. There,
//          and with other schemes, the driver only prints the order and does not judge it.
// Run      sliding_block
//          sliding_block --angle 10 --speed 0.5
//          sliding_block --levels 4 --certify 20
// Expect   observed order of at least 0.95 at theta = 1; exit code 0
//
// It can be interrupted at any time: the next call with the same -o continues.
#include <cmath>
#include <cstdio>
#include <optional>

#include <nlohmann/json.hpp>

#include "examples/common/convergence.hpp"
#include "examples/common/many_tasks.hpp"
#include "examples/common/progress.hpp"
#include "examples/common/run_watch.hpp"
#include "examples/common/scheme_flags.hpp"
#include "examples/studies/convergence/slid_level.hpp"
#include "geometry/check.hpp"
#include "geometry/primitives.hpp"
#include "integrators/run.hpp"
#include "io/build_info.hpp"
#include "io/summary.hpp"

using namespace aussois;

namespace {

constexpr double kSide = 0.1, kRadius = 1e-3, kDensity = 1000;  // SI units

struct Arguments {
  double mu = 0.3, angle = 0, speed = 1, h0 = 1e-2;
  int levels = 7;
  SchemeFlags scheme{};
  WatchFlags watch{};
  CommonOptions common{};
  std::string said{};  // of the scene
};

double deceleration(const Arguments& a) {
  const double slope = a.angle * kPi / 180;
  return kGravity * (a.mu * std::cos(slope) - std::sin(slope));
}

SchemeOptions options_of(const Arguments& a, double h) {
  SchemeOptions options = scheme_options(a.scheme);
  options.step.h = h;
  options.step.threads = a.common.threads;
  return options;
}

/// Nothing: it was interrupted.
std::optional<SlidLevel> simulated(const Arguments& a, double h, const std::string& name) {
  // 1. The scene: a plate in the plane of the slope, a block on it, gravity tilted.
  const double slope = a.angle * kPi / 180;
  const double plate_side = 4 * (kSide + a.speed * a.speed / (2 * deceleration(a)));
  Model model;
  model.gravity = kGravity * Vec3(std::sin(slope), 0, -std::cos(slope));
  model.contact_law = {.mu = a.mu, .restitution = 0};
  const SimplicialComplex box = make_box(kSide, kSide, kSide);
  const auto plate = add(model, prepare(dilate(make_plate(plate_side, plate_side), kRadius)));
  const auto cube = add(model, prepare(dilate(box, kRadius)));
  add(model, fixed_body("slope", plate));
  const auto block = add(model, solid_body("block", cube, mass_properties(box, kDensity)));

  // 2. The start: the dilated surfaces just touch, the block slides down.
  State state = rest_state(model);
  pose(state, block).p.z() = kSide / 2 + 2 * kRadius;
  twist(state, block)[0] = a.speed;

  // 3. Until it has rested for a while.
  RunWatch watch(a.watch, name, a.common.threads);
  SchemeOptions options = options_of(a, h);
  watch.set_options(options.step);
  const Scheme scheme = watch.watched(model, make_scheme(a.scheme.scheme, model, options));
  const StepReport last = run(scheme, state, 1.5 * a.speed / deceleration(a),
                              [](const StepReport& report) { return report.ok() && !interrupted(); });
  if (!last.ok()) throw NumericalFailure("t = " + std::to_string(state.t) + " s: " + last.reason);
  if (interrupted()) return {};
  return SlidLevel{pose(state, block).p.x(), watch.audit()};
}

/// Level 1 is kept in OUT/results/level_1.json, with what it depends on, and read from there.
class Levels {
 public:
  explicit Levels(const Arguments& a) : a_(a), folder_(a.common.out / "results") {
    std::filesystem::create_directories(folder_);
  }

  std::optional<SlidLevel> operator()(int number, double h) {
    const std::string name = "level_" + std::to_string(number);
    const std::filesystem::path path = folder_ / (name + ".json");
    const nlohmann::ordered_json key{{"program", program_digest()},
                                     {"scene", a_.said},
                                     {"scheme", choice_text(a_.scheme, options_of(a_, h))},
                                     {"h_s", h},
                                     {"certify", a_.watch.certify}};
    if (a_.watch.dump.folder.empty())  // else files of problems are wanted
      if (std::optional<SlidLevel> kept = read_level(path, key)) {
        ++known_;
        return kept;
      }
    std::optional<SlidLevel> made = simulated(a_, h, "sliding_block_" + name);
    if (made) write_level(path, key, *made);
    return made;
  }

  void tell_known(int all) const { aussois::tell_known(known_, std::size_t(all), folder_, "levels"); }

 private:
  const Arguments& a_;
  std::filesystem::path folder_{};
  int known_ = 0;
};

ExitCode slide(const Arguments& a) {
  require_field(deceleration(a) > 0, "--angle", a.angle,
                "be below the friction angle [deg], or the block never stops");
  const double exact = a.speed * a.speed / (2 * deceleration(a));
  make_folders(a.common);
  Progress progress("sliding_block", a.levels, Progress::style_of_stderr(a.common.quiet));
  Levels levels(a);
  const std::vector<double> steps = step_sizes(a.h0, a.levels);
  std::vector<double> errors;
  RunAudit audit;
  for (const double h : steps) {
    const std::optional<SlidLevel> level = levels(int(errors.size()) + 1, h);
    if (!level) return ExitCode::interrupted;
    errors.push_back(std::abs(level->travel - exact));
    add(level->audit, audit);
    progress.at(double(errors.size()));
  }
  const Convergence study = convergence_study(steps, errors);
  levels.tell_known(a.levels);
  if (!a.common.quiet) std::printf("%s", to_string(study, "travel error [m]").c_str());
  write_convergence(a.common.out, "sliding_block", study, {.error = "error of the distance slid [m]"});
  if (!a.common.summary.empty()) {
    Summary summary;
    summary.set("order", study.order);
    summary.set("exact_travel", exact);
    summary.set("smallest_error", study.error.back());
    set_audit(audit, summary);
    set_profile(a.watch, summary);
    write_summary(a.common.summary, summary);
  }
  print_profile(a.watch);
  const SchemeOptions chosen = scheme_options(a.scheme);
  std::printf("sliding_block: exact travel %.6g m, observed order %.4f by %s\n", exact, study.order,
              label(a.scheme.scheme, chosen).c_str());
  const bool judged = a.scheme.scheme == "moreau_jean" && chosen.moreau_jean.theta == 1;
  return print_findings(audit) && (!judged || study.order >= 0.95) ? ExitCode::ok : ExitCode::not_accepted;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  Cli cli("sliding_block",
          "Measures the order of convergence on a block that slides to rest under Coulomb friction.");
  cli.group("scene");
  cli.option(setting_of<ContactLaw>("mu"), a.mu);
  cli.option("--angle", a.angle, "slope of the plate", "deg", {0, 80});
  cli.option("--speed", a.speed, "initial speed down the slope", "m/s", {1e-3, 10});
  cli.group("stepping");
  cli.option("--h0", a.h0, "largest step", "s", setting_of<StepOptions>("h").range);
  cli.option("--levels", a.levels, "number of step sizes, each about half the one before", "", {3, 16});
  start_from_theta(a.scheme.options, 1);  // whose order shows
  a.scheme.options.step.solver.tolerance = 1e-12;
  add_options(cli, a.scheme);
  add_options(cli, a.watch, "levels");
  cli.common(a.common, Cli::Restart::by_itself);
  cli.example("sliding_block -o out", "a table of errors and orders; out/sliding_block.csv and .gp");
  cli.example("sliding_block --angle 10 --speed 0.5", "on a slope");
  return run_driver(cli, argc, argv, [&] {
    refuse_unread_flags(cli, a.scheme);
    check(cli, a.watch.dump, a.scheme.scheme);
    a.said = cli.values("scene");
    return slide(a);
  });
}
