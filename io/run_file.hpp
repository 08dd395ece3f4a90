// SPDX-License-Identifier: Apache-2.0
// Reads and writes run.h5: everything that happened in a run, one row per recorded step. doc/run_file.md has
// the layout; the types here are plain data, without a model or a scheme (io/record.hpp makes them from
// those).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "geometry/se3.hpp"

namespace aussois {

struct RunMesh {
  std::vector<Vec3> vertices{};             // frame of the mesh [m]
  std::vector<std::array<int, 3>> faces{};  // counter-clockwise seen from outside
  std::vector<std::array<int, 2>> wires{};  // edges that belong to no face; vertices in neither are points
};

struct RunBody {
  std::string name{};
  std::string mesh{};  // key of RunHeader::meshes, or empty
  SE3 g_bs{};          // mesh frame seen from the body frame
  bool fixed = false;
  double dilation = 0;          // of the mesh [m]
  double mass = 0;              // [kg]; 0 where it has no meaning
  Mat3 inertia = Mat3::Zero();  // about the centre of mass, body frame [kg m^2]
  int moving_vertices = 0;      // number of vertices of its mesh if it deforms: every step has them
                                // (RunStep::vertices)
  std::string field{};          // what every step has a number of at each of these vertices (RunStep::field);
                                // empty: none
  std::string field_unit{};
};

struct RunJointName {
  std::string name{}, kind{};       // to_string(JointKind)
  std::array<int, 2> pair{-1, -1};  // bodies A and B; -1: the world
};

/// A block of coordinates beside the bodies.
struct RunBlock {
  std::string name{};
  int size = 0;
};

/// What does not change during the run.
struct RunHeader {
  std::string title{};  // of the replay: the driver and its case
  std::string command_line{};
  std::string build{};                         // build_info() of the program
  std::map<std::string, std::string> notes{};  // anything else: options, seed, names of input files
  std::map<std::string, RunMesh> meshes{};     // by name
  std::vector<RunBody> bodies{};
  std::vector<RunJointName> joints{};
  std::vector<RunBlock> blocks{};
  std::vector<std::string> gauges{};  // columns of the recording's table, but for the time that passed
};

/// A contact that took part in the step, as it stood when it was found.
struct RunContact {
  std::array<int, 2> pair{-1, -1};              // bodies A and B
  std::array<std::array<int, 3>, 2> feature{};  // (dim, simplex, region) on A and on B
  Vec3 point = Vec3::Zero();                    // proximal point on A's dilated surface, world [m]
  Vec3 point_b = Vec3::Zero();                  // the same on B
  Vec3 normal = Vec3::UnitZ();                  // unit, world, from B to A
  Vec3 impulse = Vec3::Zero();                  // on A, world [N s]
  double gap = 0;                               // [m], negative where the dilated shapes overlap
};

/// A joint at the end of a step, and what it did on its body A, averaged over the step.
struct RunJoint {
  Vec3 coordinate = Vec3::Zero();  // of its free axes, turns counted [m, rad]; 0 where it has none
  Vec3 speed = Vec3::Zero();       // the same [m/s, rad/s]
  Vec3 force = Vec3::Zero();       // of what it locks, at the joint, world [N]
  Vec3 torque = Vec3::Zero();      // the same [N m]
  Vec3 effort = Vec3::Zero();      // along its axes: stops, dry friction, motors [N, N m]
  double translation_error = 0;    // how far it is off [m]
  double rotation_error = 0;       // [rad]
  // Work done in the step (JointWork) [J]
  double work_locked = 0, work_couplings = 0, work_stops = 0, work_friction = 0, work_motors = 0,
         work_springs = 0, work_supports = 0;
};

/// One recorded step; the first row of a run is usually its initial state with step = 0 and h = 0.
struct RunStep {
  std::int64_t step = 0;
  double time = 0;               // reached [s]
  std::vector<SE3> pose{};       // g_wb of every body at that time
  VecX velocity{};               // six per body: v_G in the world [m/s], omega in the body [rad/s]
  VecX q{};                      // of all blocks of coordinates, in order [units of the block]
  VecX q_speed{};                // [the same per second]
  std::vector<Vec3> vertices{};  // of the bodies that deform, one after the other, each in the frame of its
                                 // mesh [m]
  std::vector<double> field{};   // at the vertices of bodies with a field, one body after the other
  std::vector<RunJoint> joints{};
  std::vector<RunContact> contacts{};

  int status = 0;  // 0 ok, 1 refused, 2 not finite, 3 not solved
  double h = 0;    // length of the step [s]
  int attempts = 0, contacts_found = 0, contacts_kept = 0, contacts_matched = 0, certificate_rounds = 0;
  // Of the contacts found: recognised by their features, by incident features, by their place, or new.
  // Inherited: contacts that vanished and left their impulse to a neighbour.
  int matched_by_key = 0, matched_by_adjacency = 0, matched_by_geometry = 0, unmatched = 0, inherited = 0;
  double threshold = 0;             // search distance for contacts [m]
  double min_gap = kInf;            // of the contacts found, at the start of the step [m]
  double min_base_distance = kInf;  // lower bound over the step [m]

  int solver_status = 0;  // 0 converged, 1 stagnated, 2 max_iterations, 3 not finite, 4 at_rounding
  int iterations = 0, local_failures = 0, local_fail_safes = 0;
  double residual = 0;  // scaled [-]

  double kinetic = 0, gravity = 0, laws = 0;                // energies at the end of the step [J]
  double gravity_work = 0, law_work = 0, contact_work = 0;  // done in the step [J]
  double gyroscopic_work = 0, joint_work = 0;
  double numerical_work = 0;   // of the scheme itself
  double energy_residual = 0;  // of the discrete balance
  double impulse_gain = 0;     // work that contacts gave on their own
  double joint_time = 0;       // time that joint forces are means about [s]

  Vec3 coupling_force = Vec3::Zero();   // of the virtual coupling, on its body, world [N]
  Vec3 coupling_torque = Vec3::Zero();  // the same, body frame [N m]

  VecX gauges{};  // of the header; NaN in the initial state

  double seconds_contact = 0, seconds_solve = 0, seconds_certificate = 0,
         seconds_total = 0;  // elapsed [s]
};

struct RunData {
  RunHeader header{};
  std::vector<RunStep> steps{};
};

/// Appends steps to PATH.tmp in blocks, each flushed, and renames it to PATH at close(). If the process is
/// killed, PATH.tmp stays readable up to the last flushed block. No other run may write PATH.tmp meanwhile.
class RunWriter {
 public:
  // Steps per write: one at a time is fifty times slower (2000 frames, 3 bodies)
  static constexpr int kBlock = 64;

  /// Throws std::invalid_argument for an inconsistent header (a missing mesh, an index out of range, a mesh
  /// name with '/'), std::runtime_error if the file cannot be created or another run is writing it.
  RunWriter(std::filesystem::path path, const RunHeader& header);

  /// Reopens PATH.tmp, keeps its first `rows` steps and drops the rest; with what is appended then, it holds
  /// the same data as a run that was never interrupted. Throws std::runtime_error if PATH.tmp is missing,
  /// damaged or shorter, or if another run is writing it.
  static RunWriter resume(std::filesystem::path path, std::size_t rows);

  RunWriter(RunWriter&&) noexcept;
  RunWriter& operator=(RunWriter&&) noexcept;
  ~RunWriter();  // without close(): what was flushed stays in PATH.tmp

  /// Throws std::invalid_argument unless sizes fit the bodies, and step and time ascend.
  void append(RunStep step);
  void note(const std::string& name, const std::string& text);  // adds to the notes of the header
  void flush();  // to the disk; call it before a checkpoint counts the rows
  void close();
  std::size_t rows() const;  // appended so far, flushed or not

 private:
  struct Impl;
  explicit RunWriter(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Reads a run file in blocks: memory holds kBlock steps, however long the run is.
class RunReader {
 public:
  static constexpr std::size_t kBlock = RunWriter::kBlock;

  /// Throws as read_run does for what is wrong with the file or its header.
  explicit RunReader(const std::filesystem::path& path);
  RunReader(RunReader&&) noexcept;
  ~RunReader();

  const RunHeader& header() const;
  std::size_t steps() const;
  /// The row, valid until the next call. Throws as read_run does, and std::invalid_argument beyond the last
  /// row.
  const RunStep& step(std::size_t row);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads a whole run. Throws std::runtime_error "FILE: /dataset: what" for a file that is missing, truncated,
/// not a run, of another version, or inconsistent.
RunData read_run(const std::filesystem::path& path);

/// Lengths of RunStep::vertices and RunStep::field.
std::size_t moving_vertices(const RunHeader& header);
std::size_t field_values(const RunHeader& header);

/// Throws std::invalid_argument naming what does not fit together.
void validate(const RunHeader& header);
void validate(const RunHeader& header, const RunStep& step);

}  // namespace aussois
