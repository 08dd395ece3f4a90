// SPDX-License-Identifier: Apache-2.0
#include "examples/drivers/assembly/assembly_scene.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "examples/common/driver.hpp"
#include "geometry/check.hpp"
#include "geometry/settings.hpp"
#include "io/shape_cache.hpp"
#include "lmd/certificate.hpp"
#include "lmd/nesting.hpp"

namespace aussois {
namespace {

void note_cache(AssemblyScene& scene, const std::string& what, const CacheUse& use) {
  if (!use.warning.empty()) scene.warnings.push_back(use.warning);
  if (!use.file.empty()) scene.cache.push_back(what + ": " + to_string(use));
}

std::shared_ptr<const LmdShape> prepared(AssemblyScene& scene, const AssemblyPart& part, double dilation,
                                         const LmdShapeOptions& options, const std::filesystem::path& cache) {
  const CachedShape cached = prepare_cached({.complex = part.complex, .radius = dilation}, options, cache);
  note_cache(scene, part.name + (dilation > 0 ? ", dilated" : ""), cached);
  return cached.shape;
}

// Why the parts cannot stand in a pose; empty if they can. `cutoff` becomes their distance there if it is
// less.
class PoseCheck {
 public:
  PoseCheck(const AssemblyInput& input, const LmdShape& fixed, const LmdShape& moving, int threads)
      : input_(input),
        fixed_(fixed),
        moving_(moving),
        pieces_fixed_(connected_pieces(fixed.complex)),
        pieces_moving_(connected_pieces(moving.complex)),
        threads_(threads) {}

  std::string operator()(const SE3& pose, double& cutoff) const {
    const BaseDistance found =
        find_base_distance({&moving_, {}, {.g = pose}}, {&fixed_, {}, {}}, cutoff, threads_);
    if (found.distance > 0) {
      cutoff = found.distance;
      const auto nesting = find_nesting({&moving_, pose, 0}, pieces_moving_, {&fixed_, {}, 1}, pieces_fixed_);
      return nesting ? to_string(*nesting, input_.moving.name, input_.fixed.name) : std::string{};
    }
    std::ostringstream text;
    text << input_.moving.name << " and " << input_.fixed.name << " are in contact at (" << found.place.x()
         << ", " << found.place.y() << ", " << found.place.z() << ") m";
    return text.str();
  }

 private:
  const AssemblyInput& input_;
  const LmdShape &fixed_, &moving_;
  Pieces pieces_fixed_, pieces_moving_;
  int threads_;
};

double smallest_clearance(const AssemblyInput& input, bool at_start, const LmdShape& fixed,
                          const LmdShape& moving, int threads,
                          const std::function<void(int, int)>& progress) {
  const PoseCheck wrong_with(input, fixed, moving, threads);
  double clearance = kInf;  // two points have no size; else what is farther apart than that is no fit
  for (const AssemblyPart* part : {&input.fixed, &input.moving})
    if (const double size = part->report.box.diagonal(); size > 0)
      clearance = size;  // at last the moving one's
  std::string first;
  int more = 0;
  for (std::size_t i = 0; i < (at_start ? 1 : input.poses.size()); ++i) {
    if (progress) progress(int(i) + 1, int(input.poses.size()));
    const std::string wrong = wrong_with(input.poses[i], clearance);
    if (wrong.empty()) continue;
    if (first.empty())
      first = (input.place_of_pose.empty() ? "" : input.place_of_pose[i] + ": ") + "pose " +
              std::to_string(i) + " of the path: " + wrong;
    else
      ++more;
  }
  if (more > 0)
    first += "; " + std::to_string(more + 1) + " of " +
             counted_noun(std::int64_t(input.poses.size()), "pose") + " are wrong";
  if (!first.empty()) throw std::runtime_error(first);
  return clearance;
}

constexpr double kFrequency = 20;  // of parts that it holds up [Hz]

double default_frequency(double gravity, double radius) {
  return std::max(kFrequency, std::sqrt(gravity / (kArrival / 2 * radius)) / (2 * kPi));
}

// Poses in time such that no point of the part moves faster than `speed`.
Trajectory timed(const std::vector<SE3>& poses, double radius, double speed) {
  Trajectory path;
  double t = 0;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (i > 0) {
      const double length =
          (poses[i].p - poses[i - 1].p).norm() + radius * angle_between(poses[i - 1].R, poses[i].R);
      if (length < 1e-9 * radius) continue;  // the same pose again
      t += length / speed;
    }
    path.t.push_back(t);
    path.pose.push_back(poses[i]);
  }
  require(path.t.size() >= 2, "the path has no two different poses");
  return path;
}

}  // namespace

void describe(SettingVisitor& visit, AssemblyOptions& o) {
  visit.begin("AssemblyOptions");
  const auto number = [&](double& value, const char* name, const char* what, const char* unit, Range range,
                          const char* flag) {
    visit.number({name, what, unit, range, flag}, value);
  };
  number(o.dilation, "dilation", "dilation of each part; 0: three tenths of the smallest clearance", "m",
         {0, 1}, "--dilation");
  visit.number(setting_of<ContactLaw>("mu"), o.mu);
  visit.number(setting_of<ContactLaw>("restitution"), o.restitution);
  number(o.density, "density", "density of the moving part", "kg/m^3", kPartDensity, "--density");
  number(o.mass, "mass", "mass of the moving part; 0: from density and volume", "kg", kPartMass, "--mass");
  number(o.speed, "speed", "speed of the part's farthest point along the path", "m/s", {1e-6, 1e3},
         "--speed");
  number(o.stride, "stride", "largest motion per step, relative to the sum of the two dilations", "-",
         {1e-3, 1e4}, "--stride");
  number(o.h, "h", "largest step; 0: from --stride and --speed", "s",
         or_zero(setting_of<StepOptions>("h").range), "--h");
  number(o.frequency, "frequency",
         "frequency of the part on its coupling; 0: 20, or more if its weight would pull it off the path",
         "Hz", {0, 1e5}, "--frequency");
  visit.number(setting_of<VirtualCouplingOptions>("damping_ratio"), o.damping_ratio);
  visit.number(setting_of<VirtualCouplingOptions>("force_limit"), o.force_limit);
  visit.number(setting_of<VirtualCouplingOptions>("torque_limit"), o.torque_limit);
  number(o.hold, "hold", "time to hold the part at the end of the path", "s", {0, 1e4}, "--hold");
  number(o.misalignment, "misalignment", "offset of the coupling's target along (1, 1, 1), in clearances",
         "-", {-1e6, 1e6}, "--misalignment");
}

AssemblyScene make_assembly_scene(const AssemblyInput& input, const AssemblyOptions& options, int threads,
                                  const std::function<void(int, int)>& progress) {
  check_ranges(options);
  require(options.gravity.allFinite(), "AssemblyOptions::gravity must be finite [m/s^2]");
  AssemblyScene scene;
  for (const AssemblyPart* part : {&input.fixed, &input.moving})
    note_cache(scene, part->name + ", mesh", part->cache);
  const auto shape = [&](const AssemblyPart& part, double dilation, int levels) {
    return prepared(scene, part, dilation, {.levels = levels, .threads = threads}, options.cache);
  };
  {
    const auto fixed = shape(input.fixed, 0, 0), moving = shape(input.moving, 0, 0);
    scene.clearance =
        smallest_clearance(input, options.clearance_at_start, *fixed, *moving, threads, progress);
  }
  scene.dilation = options.dilation > 0 ? options.dilation : 0.3 * scene.clearance;
  std::ostringstream text;
  text << "--dilation = " << scene.dilation << " m must be less than half of the smallest clearance, "
       << scene.clearance << " m";
  require(2 * scene.dilation < scene.clearance, text.str());

  Model& model = scene.model;
  model.gravity = options.gravity;
  model.contact_law = {.mu = options.mu, .restitution = options.restitution};
  model.shapes.push_back(shape(input.fixed, scene.dilation, options.levels));
  model.shapes.push_back(shape(input.moving, scene.dilation, options.levels));
  const PartMass mass = part_mass(input.moving, scene.dilation, options.density, options.mass);
  scene.mass_source = mass.source;
  scene.fixed = add(model, fixed_body(input.fixed.name, 0));
  scene.moving = add(model, solid_body(input.moving.name, 1, mass.properties));

  const SE3 body_in_mesh = inverse(model.bodies[scene.moving].g_bs);
  for (const SE3& pose : input.poses) scene.poses.push_back(pose * body_in_mesh);
  scene.radius = std::max(radius_about(input.moving.complex, mass.properties.centre), scene.dilation);
  scene.path = timed(scene.poses, scene.radius, options.speed);
  scene.h = options.h > 0 ? options.h : options.stride * 2 * scene.dilation / options.speed;

  scene.target = scene.path;
  scene.misalignment = options.misalignment * scene.clearance;
  for (SE3& pose : scene.target.pose) pose.p += scene.misalignment * Vec3(1, 1, 1).normalized();
  const double gravity = options.gravity.norm();
  scene.frequency = options.frequency > 0 ? options.frequency : default_frequency(gravity, scene.radius);
  const double omega = 2 * kPi * scene.frequency;
  scene.sag = gravity / (omega * omega);
  scene.coupling = {.stiffness = mass.properties.mass * omega * omega,
                    .rotation_stiffness = mass.properties.inertia.trace() / 3 * omega * omega,
                    .damping_ratio = options.damping_ratio,
                    .force_limit = options.force_limit,
                    .torque_limit = options.torque_limit};
  add(model, virtual_coupling(model, scene.moving, scene.target, scene.coupling));
  return scene;
}

State start_of(const AssemblyScene& scene) {
  State state = rest_state(scene.model);
  pose(state, scene.moving) = scene.path.pose.front();
  for (const auto& [body, at] : scene.clips) pose(state, body) = at;
  for (const Cable& cable : scene.cables) lay(cable, state);
  return state;
}

}  // namespace aussois
