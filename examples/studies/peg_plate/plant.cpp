// SPDX-License-Identifier: Apache-2.0
#include "examples/studies/peg_plate/plant.hpp"

#include <algorithm>
#include <cmath>

#include "examples/common/random.hpp"
#include "geometry/check.hpp"
#include "geometry/settings.hpp"

namespace aussois {
namespace {

constexpr double kDegree = kPi / 180;
// The robot behind the flange and its impedance [Kim2019], rotations about the axes of the tool.
constexpr double kRobotMass = 4;                    // reflected [kg]
const Vec3 kRobotInertia(0.06, 0.06, 0.03);         // [kg m^2]
constexpr double kStiffness = 800, kDamping = 250;  // [N/m], [N s/m]
const Vec3 kTurnStiffness(150, 400, 50);            // [N m/rad]
const Vec3 kTurnDamping(15, 30, 15);                // [N m s/rad]
// The way of the set-point: from above the plate to below it.
constexpr double kClearance = 2e-3, kDepth = 25e-3, kRest = 0.7, kStaticAfter = 0.4;  // [m], [m], [s], [s]
// The face as made.
constexpr int kRings = 9, kSectors = 24, kRimNodes = 120;
constexpr double kChamfer = 0.5e-3, kCrown = 4e-6, kWaviness = 1.5e-6, kRoughness = 0.5e-6;  // [m]
constexpr double kFaceStiffness = 1e9;                                                       // [N/m^3]
constexpr double kNodeStiffness = 1e6;  // of one node of the rim [N/m]
constexpr double kHuntCrossley = 20;    // [s/m]
constexpr double kTangential = 0.8;     // stiffness of bristles over that of patches
constexpr double kBristleTime = 5e-4;   // damping of bristles over their stiffness [s]
// Sensors.
constexpr double kGain = 1.005;  // of the flange's over the plate's
constexpr double kForceNoise = 0.05, kTorqueNoise = 1e-3, kSpeedNoise = 1e-4, kTurnNoise = 5e-4;
constexpr double kPlaceNoise = 5e-6, kAngleNoise = 20e-6;
constexpr double kMeanOver = 1e-3;   // forces are means over this time after the sample [s]
constexpr double kContactForce = 2;  // a sample counts from here on [N]

using Array = Eigen::ArrayXd;

struct Bristles {
  Array x{}, y{};  // their deflections [m]
};

struct Wrench {
  Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
};

// Force of the plate on the patches, about the peg's centre of mass, in the plate's frame (PEG-4), (PEG-5).
// `a` turns body into plate, `place` and `v` are those of the centre of mass in the plate's frame, omega the
// body's.
Wrench patch_forces(const Plant& plant, const Mat3& a, const Vec3& place, const Vec3& v, const Vec3& omega,
                    double h, Bristles& bristles) {
  const Array rx = a(0, 0) * plant.x + a(0, 1) * plant.y + a(0, 2) * plant.z;
  const Array ry = a(1, 0) * plant.x + a(1, 1) * plant.y + a(1, 2) * plant.z;
  const Array rz = a(2, 0) * plant.x + a(2, 1) * plant.y + a(2, 2) * plant.z;
  const Array depth = -(place.z() + rz);
  if (depth.maxCoeff() <= 0) {
    bristles.x.setZero();
    bristles.y.setZero();
    return {};
  }
  const Vec3 w = a * omega;
  const Array ux = v.x() + w.y() * rz - w.z() * ry, uy = v.y() + w.z() * rx - w.x() * rz,
              uz = v.z() + w.x() * ry - w.y() * rx;
  const Array normal = (plant.stiffness * depth.max(0.0) * (1 - kHuntCrossley * uz)).max(0.0);

  const Array k = kTangential * plant.stiffness;
  Array fx = -k * (bristles.x + (h + kBristleTime) * ux), fy = -k * (bristles.y + (h + kBristleTime) * uy);
  const Array size = (fx.square() + fy.square()).sqrt().max(1e-300);
  const Array scale = (plant.mu * normal / size).min(1.0);
  fx *= scale;
  fy *= scale;
  bristles.x = (depth > 0).select(-fx / k - kBristleTime * ux, 0.0);
  bristles.y = (depth > 0).select(-fy / k - kBristleTime * uy, 0.0);
  return {Vec3(fx.sum(), fy.sum(), normal.sum()),
          Vec3((ry * normal - rz * fy).sum(), (rz * fx - rx * normal).sum(), (rx * fy - ry * fx).sum())};
}

// Peg and robot as one rigid body, its centre of mass `centre` above the peg's (PEG-2).
struct Tool {
  Peg peg{};
  double mass = 0, centre = 0;
  Vec3 inertia = Vec3::Zero();
};
Tool make_tool() {
  Tool tool;
  const Peg& peg = tool.peg;
  tool.mass = peg.mass + kRobotMass;
  tool.centre = kRobotMass * peg.flange / tool.mass;
  const double across = peg.mass * tool.centre * tool.centre +
                        kRobotMass * (peg.flange - tool.centre) * (peg.flange - tool.centre);
  tool.inertia = peg.inertia + kRobotInertia + Vec3(across, across, 0);
  return tool;
}

struct SetPoint {
  Vec3 start = Vec3::Zero(), way = Vec3::Zero();  // of the flange [m], [m/s]
  double until = 0;                               // it stands still [s]
  Quat R = Quat::Identity();
};
// The nominal peg's lowest point is at the origin when the set-point touches.
SetPoint make_set_point(const PegCase& which, const Quat& R) {
  const Peg peg;
  const double reach = std::cos(which.lean) * peg.half_length + std::sin(which.lean) * peg.radius;
  const Vec3 lowest = R * Vec3(which.lean > 0 ? peg.radius : 0, 0, -peg.half_length);
  const Vec3 flange = R * Vec3(0, 0, peg.flange);
  const Vec3 touching(flange.x() - lowest.x(), flange.y() - lowest.y(), reach + flange.z());
  SetPoint out{.way = which.speed * Vec3(std::cos(which.incidence), 0, -std::sin(which.incidence)), .R = R};
  const double fall = -out.way.z();
  out.start = touching - kClearance / fall * out.way;
  out.until = (kClearance + kDepth) / fall;
  return out;
}

// Noise on what was measured (PEG-6).
PegSample as_measured(PegSample s, Random& random) {
  s.g.p += kPlaceNoise * random.normal_vector();
  s.g.R = s.g.R * exp_so3(kAngleNoise * random.normal_vector());
  s.v += kSpeedNoise * random.normal_vector();
  s.omega += kTurnNoise * random.normal_vector();
  const Vec3 weight(0, 0, -Peg().mass * kPegGravity);
  s.force = weight + kGain * (s.force - weight) + kForceNoise * random.normal_vector();
  s.torque = kGain * s.torque + kTorqueNoise * random.normal_vector();
  s.plate_force += kForceNoise * random.normal_vector();
  return s;
}

void add_patch(std::vector<Vec3>& places, std::vector<double>& stiffness, double radius, double angle,
               double z, double k) {
  places.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  stiffness.push_back(k);
}

}  // namespace

void describe(SettingVisitor& visit, PlantOptions& o) {
  visit.begin("PlantOptions");
  visit.choice({"scenario", "what of the peg touches the plate"}, o.scenario, kPegScenarios);
  visit.number({"tilt", "tilt of the plate", "deg", {0, 1}}, o.tilt);
  visit.number({"tilts", "largest random tilt of the plate from case to case", "deg", {0, 1}}, o.tilts);
  visit.number({"scatter", "largest random turn of the set-point from case to case", "deg", {0, 1}},
               o.scatter);
  visit.number({"step", "time step of the reference", "s", {1e-6, 5e-5}, "--step"}, o.step);
  visit.number({"sample", "time between samples", "s", range_from(kMeanOver)}, o.sample);
  visit.count(
      {"count", "number of incidences and of speeds; edge sets use half as many", "", {1, 100}, "--count"},
      o.count);
  visit.count({"leans", "number of lean angles of edge sets", "", {1, 100}, "--leans"}, o.leans);
  visit.seed({"seed", "seed of the plant and its noise"}, o.seed);
}

Plant make_plant(const PlantOptions& options) {
  check_ranges(options);
  const Peg peg;
  Random random(options.seed);
  Plant plant{.options = options};
  std::vector<Vec3> places;
  std::vector<double> stiffness;
  double mean_mu = 0.15;
  if (options.scenario == PegScenario::surface) {
    const double R = peg.radius - kChamfer, width = R / kRings, phase = random.uniform(0, 2 * kPi);
    for (int i = 0; i < kRings; ++i)
      for (int j = 0; j < kSectors; ++j) {
        const double r = (i + 0.5) * width, angle = 2 * kPi * j / kSectors,
                     area = 2 * kPi * r * width / kSectors;
        const double bump = kCrown * (r * r / (R * R)) + kWaviness * (r / R) * std::cos(3 * angle + phase) +
                            kRoughness * random.normal();
        add_patch(places, stiffness, r, angle, -peg.half_length + bump, kFaceStiffness * area);
      }
  } else {
    mean_mu = 0.19;
    for (const double inset : {0.0, kChamfer})  // the two edges of the chamfer
      for (int j = 0; j < kRimNodes; ++j)
        add_patch(places, stiffness, peg.radius - inset, 2 * kPi * j / kRimNodes,
                  -peg.half_length + kChamfer - inset + kRoughness * random.normal(), kNodeStiffness);
  }
  const Eigen::Index n = Eigen::Index(places.size());
  plant.x.resize(n);
  plant.y.resize(n);
  plant.z.resize(n);
  plant.mu.resize(n);
  plant.stiffness = Eigen::Map<const Array>(stiffness.data(), n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3& at = places[i];
    plant.x[i] = at.x();
    plant.y[i] = at.y();
    plant.z[i] = at.z();
    plant.mu[i] = mean_mu * (1 + 0.1 * random.normal());
  }
  return plant;
}

namespace {

// The rotation of the plate to the world, whose z is the normal.
Mat3 plate_rotation(const PlantOptions& options, Random& random) {
  Vec3 tilt = kDegree * options.tilt * Vec3(1, -0.7, 0);
  if (options.tilts > 0)
    for (const int i : {0, 1}) tilt[i] += kDegree * options.tilts * random.uniform(-1, 1);
  return exp_so3(tilt).toRotationMatrix();
}

// One of `count` that sensors take the mean of: Newton and Euler on the peg alone.
void add_mean(const Peg& peg, const Vec3& a, const Vec3& alpha, const Vec3& omega, const Wrench& plate,
              int count, PegSample& mean) {
  mean.force += (peg.mass * a - plate.force) / count;
  mean.torque +=
      (peg.inertia.cwiseProduct(alpha) + omega.cross(peg.inertia.cwiseProduct(omega)) - plate.torque) / count;
  mean.plate_force += plate.force / count;
}

}  // namespace

std::vector<PegSample> peg_samples(const Plant& plant, const PegCase& which, int index) {
  const Tool tool = make_tool();
  const Vec3 centre(0, 0, tool.centre), to_flange(0, 0, tool.peg.flange - tool.centre);
  Random random(plant.options.seed * 1000003 + std::uint64_t(index) + 1);
  const double about_y = random.normal(), about_x = random.normal(),
               scatter = plant.options.scatter * kDegree;
  const Mat3 R_wp = plate_rotation(plant.options, random);
  const SetPoint target =
      make_set_point(which, exp_so3(Vec3(0, which.lean, 0)) * exp_so3(scatter * Vec3(about_x, about_y, 0)));

  const double h = plant.options.step;
  const int per_sample = int(std::lround(plant.options.sample / h)),
            in_mean = int(std::lround(kMeanOver / h));
  Quat R = target.R;
  Vec3 p = target.start - R * to_flange, v = target.way, omega = Vec3::Zero();  // of the tool's centre
  Bristles bristles{Array::Zero(plant.x.size()), Array::Zero(plant.x.size())};
  std::vector<PegSample> out;
  PegSample now;
  for (int k = 0; k < int((target.until + kRest) / h); ++k) {
    const double t = k * h, travelled = std::min(t, target.until);
    const Mat3 R_wb = R.toRotationMatrix();
    const Vec3 v_peg = v - R_wb * omega.cross(centre);
    const Mat3 R_pb = R_wp.transpose() * R_wb;
    const Wrench contact = patch_forces(plant, R_pb, R_wp.transpose() * (p - R_wb * centre),
                                        R_wp.transpose() * v_peg, omega, h, bristles);
    const Vec3 plate_force = R_wp * contact.force, plate_torque = R_pb.transpose() * contact.torque;

    const Vec3 pull =
        kStiffness * (target.start + travelled * target.way - p - R_wb * to_flange) +
        kDamping * ((t < target.until ? target.way : Vec3::Zero()) - v - R_wb * omega.cross(to_flange));
    const Vec3 twist =
        kTurnStiffness.cwiseProduct(log_so3(R.conjugate() * target.R)) - kTurnDamping.cwiseProduct(omega);
    const Vec3 a = (pull + plate_force) / tool.mass;  // (PEG-3): the robot carries the weight
    const Vec3 torque = twist + to_flange.cross(R_wb.transpose() * pull) + plate_torque -
                        centre.cross(R_wb.transpose() * plate_force);
    const Vec3 alpha = (torque - omega.cross(tool.inertia.cwiseProduct(omega))).cwiseQuotient(tool.inertia);

    const int phase = k % per_sample;
    if (phase == 0)
      now = {.t = t,
             .is_static = t >= target.until + kStaticAfter,
             .g = {R, p - R_wb * centre},
             .v = v_peg,
             .omega = omega};
    if (phase < in_mean) {
      const Vec3 a_peg = a - R_wb * (alpha.cross(centre) + omega.cross(omega.cross(centre)));
      add_mean(tool.peg, a_peg, alpha, omega, {plate_force, plate_torque}, in_mean, now);
    }
    if (phase == in_mean - 1)
      if (const PegSample seen = as_measured(now, random); seen.plate_force.norm() > kContactForce)
        out.push_back(seen);

    v += h * a;
    omega += h * alpha;
    p += h * v;
    R = (R * exp_so3(h * omega)).normalized();
  }
  return out;
}

}  // namespace aussois
