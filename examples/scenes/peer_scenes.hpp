// SPDX-License-Identifier: Apache-2.0
// Scenes that every engine of rigid bodies can run, as plain data: shapes, masses, poses, friction, forces,
// and what is known of the motion (doc/theory/peer_scenes.md). Shared by examples, tests and benchmarks.
// Sources: rolling, bouncing, 666 and the building are those of SimBenchmark [Kang2018]; the tower, the
// heavy tower and the arch are ours.
#pragma once

#include <string>
#include <vector>

#include "integrators/scheme.hpp"

namespace aussois {

enum class PeerShapeKind { ball, box, prism };

struct PeerShape {
  PeerShapeKind kind = PeerShapeKind::box;
  Vec3 size = Vec3::Zero();     // box: its edges; ball: the radius in x; prism: its length in z [m]
  std::vector<Vec2> profile{};  // of a prism: convex, counter-clockwise in x and y, centroid at the origin
  double mass = 0;              // [kg]
  Mat3 inertia = Mat3::Zero();  // about the centre of mass, which is the origin [kg m^2]
};

/// Corners of a box or prism whose faces are moved in by `depth` [m].
std::vector<Vec3> corners(const PeerShape& shape, double depth);

struct PeerBody {
  ShapeId shape{0};
  bool fixed = false;
  double mu = 0;              // of a pair the smaller of the two [-]
  SE3 g{};                    // at the start
  Vec3 force = Vec3::Zero();  // constant, at the centre of mass, world [N]
};

/// What the scene is judged by, against what is exact.
enum class PeerMeasure {
  speed,         // of the body that is pushed: rms error over rms [-]
  energy,        // mean error over the energy at the start [-]
  overlap,       // deepest of two balls or a ball and the ground [m]
  displacement,  // largest of a centre of mass that should be at rest [m]
};

struct PeerScene {
  std::string name{}, what{};
  Table<ShapeId, PeerShape> shapes{};
  Table<BodyId, PeerBody> bodies{};  // the first is the ground, its top at z = 0
  Vec3 gravity{0, 0, -9.81};         // [m/s^2]
  double restitution = 0;            // of all pairs [-]
  PeerMeasure measure = PeerMeasure::displacement;
  double acceleration = 0;  // exact, of body 1 along its force; of the measure speed [m/s^2]
  double t_end = 1;         // [s]
};

PeerScene rolling_scene(const Vec2& direction);  // of the push, a unit vector
PeerScene bouncing_scene(double restitution);
PeerScene pile_666_scene(bool elastic);
PeerScene tower_scene(double top_mass);  // 8 kg: like the others [kg]
PeerScene kapla_scene();

/// Half a ring of prismatic stones on the ground, mean radius 1 m, 0.2 m wide, 1000 kg/m^3.
/// `describe` gives the ranges.
struct Arch {
  int stones = 25;
  double mu = 0.6;
  double thickness = 0.2;  // over the mean radius [-]
  double tilt = 0;         // of ground and arch, in the plane of the arch [rad]
  double scatter = 0;  // every stone is off its place by up to this along each axis, at random; so that none
                       // overlap, all are farther out by `spread` times as much per metre [m]
};
/// Opens the joints of n stones, pi / n m from each other, by more than two stones together may close them.
constexpr double arch_spread(const Arch& arch) {
  return 28 * arch.stones / 25.0;
}
void describe(SettingVisitor& visit, Arch& arch);
PeerScene arch_scene(const Arch& arch);  // throws std::invalid_argument: field, value, bound
BodyId crown(const PeerScene& arch);     // the stone in the middle

/// Those of the comparison with peers, by their names.
std::vector<std::string> peer_scene_names();
/// Throws std::invalid_argument naming those there are.
PeerScene peer_scene(const std::string& name);

/// How a scene looks to this kernel: boxes and prisms eroded by what they are dilated with, so that they
/// start exactly closed; balls are dilated points.
struct KernelScene {
  Model model{};
  State state{};
};
KernelScene kernel_scene(const PeerScene& scene);
/// The defaults, but for theta = 1 where nothing bounces, and Moreau's normal law where something does.
SchemeOptions kernel_options(const PeerScene& scene, double h);

/// Where the bodies of a scene are, in any engine.
struct PeerSample {
  double t = 0;
  PerBody<SE3> g{};   // poses of the centres of mass
  PerBody<Vec3> v{};  // their velocities, world [m/s]
};
PeerSample sample(const State& state);

/// How far one sample of a run is from what is exact.
struct PeerOff {
  double off = 0;           // by the measure of the scene
  double term = 0;          // of its sum over the samples: the square of `off` (speed) or `off` (energy)
  double scale = 0;         // of what that sum is relative to
  double fall_time = kInf;  // the time of the sample if a body is 0.1 m from its place [s]
};
/// `start`: the sample at the start of the run.
PeerOff off_exact(const PeerScene& scene, const PeerSample& start, const PeerSample& now);

/// Of all samples of a run, the start included.
struct PeerTotals {
  long samples = 0;
  double sum = 0, scale = 0, worst = 0, fall_time = kInf;
};
void add(const PeerOff& one, PeerTotals& totals);
/// The error of the run by the measure of the scene.
double error_of(const PeerScene& scene, const PeerTotals& totals);

/// Receives every step of a run, from the start on, and returns its error.
class PeerJudge {
 public:
  explicit PeerJudge(const PeerScene& scene) : scene_(scene) {}
  void see(const PeerSample& now);
  double error() const { return error_of(scene_, totals_); }
  double worst() const { return totals_.worst; }  // of a single step; of the measures speed and energy
  double fall_time() const {
    return totals_.fall_time;
  }  // when a body was 0.1 m from its place, or
     // infinity [s]

 private:
  const PeerScene& scene_;
  PeerSample start_{};
  PeerTotals totals_{};
};

}  // namespace aussois
