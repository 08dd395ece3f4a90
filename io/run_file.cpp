// SPDX-License-Identifier: Apache-2.0
#include "io/run_file.hpp"

#include <algorithm>
#include <stdexcept>
#include <tuple>
#include <type_traits>
#include <unordered_map>

#include "geometry/check.hpp"
#include "io/atomic_file.hpp"
#include "io/hdf5_file.hpp"
#include "mechanics/layout.hpp"

namespace aussois {
namespace {

constexpr const char* kRunFormat = "aussois-run";
constexpr const char* kRunVersion = "3";

/// One dataset and the member it holds.
template <class Row, class T>
struct Field {
  const char* name;
  T Row::*member;
  const char* unit;
};
template <class Row, class T>
Field(const char*, T Row::*, const char*) -> Field<Row, T>;

// The layout of the file, apart from poses, velocities and coordinates, whose rows depend on the model.
const auto kStepFields = std::tuple{
    Field{"/state/time", &RunStep::time, "s"},
    Field{"/state/step", &RunStep::step, ""},
    Field{"/step/status", &RunStep::status, ""},
    Field{"/step/h", &RunStep::h, "s"},
    Field{"/step/attempts", &RunStep::attempts, ""},
    Field{"/step/contacts_found", &RunStep::contacts_found, ""},
    Field{"/step/contacts_kept", &RunStep::contacts_kept, ""},
    Field{"/step/contacts_matched", &RunStep::contacts_matched, ""},
    Field{"/match/by_key", &RunStep::matched_by_key, ""},
    Field{"/match/by_adjacency", &RunStep::matched_by_adjacency, ""},
    Field{"/match/by_geometry", &RunStep::matched_by_geometry, ""},
    Field{"/match/unmatched", &RunStep::unmatched, ""},
    Field{"/match/inherited", &RunStep::inherited, ""},
    Field{"/step/certificate_rounds", &RunStep::certificate_rounds, ""},
    Field{"/step/threshold", &RunStep::threshold, "m"},
    Field{"/step/min_gap", &RunStep::min_gap, "m"},
    Field{"/step/min_base_distance", &RunStep::min_base_distance, "m"},
    Field{"/solver/status", &RunStep::solver_status, ""},
    Field{"/solver/iterations", &RunStep::iterations, ""},
    Field{"/solver/local_failures", &RunStep::local_failures, ""},
    Field{"/solver/local_fail_safes", &RunStep::local_fail_safes, ""},
    Field{"/solver/residual", &RunStep::residual, "1"},
    Field{"/energy/kinetic", &RunStep::kinetic, "J"},
    Field{"/energy/gravity", &RunStep::gravity, "J"},
    Field{"/energy/laws", &RunStep::laws, "J"},
    Field{"/energy/gravity_work", &RunStep::gravity_work, "J"},
    Field{"/energy/law_work", &RunStep::law_work, "J"},
    Field{"/energy/contact_work", &RunStep::contact_work, "J"},
    Field{"/energy/gyroscopic_work", &RunStep::gyroscopic_work, "J"},
    Field{"/energy/joint_work", &RunStep::joint_work, "J"},
    Field{"/energy/numerical_work", &RunStep::numerical_work, "J"},
    Field{"/energy/residual", &RunStep::energy_residual, "J"},
    Field{"/energy/impulse_gain", &RunStep::impulse_gain, "J"},
    Field{"/coupling/force", &RunStep::coupling_force, "N"},
    Field{"/coupling/torque", &RunStep::coupling_torque, "N m"},
    Field{"/timing/contact", &RunStep::seconds_contact, "s"},
    Field{"/timing/solve", &RunStep::seconds_solve, "s"},
    Field{"/timing/certificate", &RunStep::seconds_certificate, "s"},
    Field{"/timing/total", &RunStep::seconds_total, "s"},
};
const auto kContactFields = std::tuple{
    Field{"/contact/pair", &RunContact::pair, ""},
    Field{"/contact/feature", &RunContact::feature, ""},
    Field{"/contact/point", &RunContact::point, "m"},
    Field{"/contact/point_b", &RunContact::point_b, "m"},
    Field{"/contact/normal", &RunContact::normal, "1"},
    Field{"/contact/impulse", &RunContact::impulse, "N s"},
    Field{"/contact/gap", &RunContact::gap, "m"},
};
const auto kJointFields = std::tuple{
    Field{"/joint/coordinate", &RunJoint::coordinate, "m, rad"},
    Field{"/joint/speed", &RunJoint::speed, "m/s, rad/s"},
    Field{"/joint/force", &RunJoint::force, "N"},
    Field{"/joint/torque", &RunJoint::torque, "N m"},
    Field{"/joint/effort", &RunJoint::effort, "N, N m"},
    Field{"/joint/translation_error", &RunJoint::translation_error, "m"},
    Field{"/joint/rotation_error", &RunJoint::rotation_error, "rad"},
};
// Files of version 3 may lack these, together.
const auto kJointTime = Field{"/joint/time", &RunStep::joint_time, "s"};
const auto kJointWorkFields = std::tuple{
    Field{"/joint/work_locked", &RunJoint::work_locked, "J"},
    Field{"/joint/work_couplings", &RunJoint::work_couplings, "J"},
    Field{"/joint/work_stops", &RunJoint::work_stops, "J"},
    Field{"/joint/work_friction", &RunJoint::work_friction, "J"},
    Field{"/joint/work_motors", &RunJoint::work_motors, "J"},
    Field{"/joint/work_springs", &RunJoint::work_springs, "J"},
    Field{"/joint/work_supports", &RunJoint::work_supports, "J"},
};
constexpr const char* kPose = "/state/pose";
constexpr const char* kVelocity = "/state/velocity";
constexpr const char* kCoordinates = "/state/q";
constexpr const char* kCoordinateSpeeds = "/state/q_speed";
constexpr const char* kOffset = "/contact/offset";
constexpr const char* kMovingVertices = "/body/moving_vertices";  // files of version 3 may lack it
constexpr const char* kVertices = "/state/vertices";              // if there are any
constexpr const char* kFieldNames = "/body/field";                // files of version 3 may lack it
constexpr const char* kFieldUnits = "/body/field_unit";           // and this
constexpr const char* kField = "/state/field";                    // if there are any
constexpr const char* kGaugeNames = "/gauge/name";                // files of version 3 may lack it
constexpr const char* kGauges = "/gauge/value";                   // if there are any

template <class Fields, class F>
void for_each_field(const Fields& fields, const F& f) {
  std::apply([&f](const auto&... field) { (f(field), ...); }, fields);
}

using PoseRow = std::array<double, 7>;  // x y z qx qy qz qw
PoseRow to_row(const SE3& g) {
  return {g.p.x(), g.p.y(), g.p.z(), g.R.x(), g.R.y(), g.R.z(), g.R.w()};
}
SE3 from_row(const PoseRow& row) {
  return {Quat(row[6], row[3], row[4], row[5]), Vec3(row[0], row[1], row[2])};
}

std::size_t coordinate_count(const RunHeader& header) {
  std::size_t count = 0;
  for (const RunBlock& block : header.blocks) count += std::size_t(block.size);
  return count;
}

void write_bodies(hid_t file, const RunHeader& header) {
  std::vector<std::string> names, meshes, fields, field_units;
  std::vector<PoseRow> mesh_pose;
  std::vector<int> fixed, moving;
  std::vector<double> dilation, mass;
  std::vector<Mat3> inertia;
  for (const RunBody& body : header.bodies) {
    names.push_back(body.name);
    meshes.push_back(body.mesh);
    mesh_pose.push_back(to_row(body.g_bs));
    fixed.push_back(body.fixed ? 1 : 0);
    dilation.push_back(body.dilation);
    mass.push_back(body.mass);
    inertia.push_back(body.inertia);
    moving.push_back(body.moving_vertices);
    fields.push_back(body.field);
    field_units.push_back(body.field_unit);
  }
  write_texts(file, "/body/name", names);
  write_texts(file, "/body/mesh", meshes);
  write_rows(file, "/body/mesh_pose", mesh_pose, "m");
  write_rows(file, "/body/fixed", fixed);
  write_rows(file, "/body/dilation", dilation, "m");
  write_rows(file, "/body/mass", mass, "kg");
  write_rows(file, "/body/inertia", inertia, "kg m^2");
  write_rows(file, kMovingVertices, moving);
  write_texts(file, kFieldNames, fields);
  write_texts(file, kFieldUnits, field_units);
}

void write_header(hid_t file, const RunHeader& header) {
  write_text(file, "/", "format", kRunFormat);
  write_text(file, "/", "version", kRunVersion);
  write_text(file, "/", "units", "SI: m, kg, s, N, J, rad; impulses in N s");
  write_text(file, "/", "pose", "x y z qx qy qz qw: body frame seen from the world");
  write_text(file, "/", "velocity", "v_G in the world, omega in the body");
  write_text(file, "/", "title", header.title);
  write_text(file, "/", "command_line", header.command_line);
  write_text(file, "/", "build", header.build);
  make_group(file, "/notes");
  for (const auto& [name, text] : header.notes) write_text(file, "/notes", name, text);

  make_group(file, "/mesh");
  for (const auto& [name, mesh] : header.meshes) {
    write_rows(file, "/mesh/" + name + "/vertices", mesh.vertices, "m");
    write_rows(file, "/mesh/" + name + "/faces", mesh.faces);
    write_rows(file, "/mesh/" + name + "/wires", mesh.wires);
  }

  write_bodies(file, header);

  std::vector<std::string> joints, kinds, blocks;
  std::vector<std::array<int, 2>> pairs;
  std::vector<int> sizes;
  for (const RunJointName& joint : header.joints) {
    joints.push_back(joint.name);
    kinds.push_back(joint.kind);
    pairs.push_back(joint.pair);
  }
  for (const RunBlock& block : header.blocks) {
    blocks.push_back(block.name);
    sizes.push_back(block.size);
  }
  write_texts(file, "/joint/name", joints);
  write_texts(file, "/joint/kind", kinds);
  write_rows(file, "/joint/pair", pairs);
  write_texts(file, "/coordinates/name", blocks);
  write_rows(file, "/coordinates/size", sizes);
  write_texts(file, kGaugeNames, header.gauges);
}

/// The rows of a dataset that must have as many as there are bodies, steps or contacts.
template <class T>
std::vector<T> read_exactly(hid_t file, const std::string& name, std::size_t rows) {
  std::vector<T> values = read_rows<T>(file, name);
  if (values.size() != rows)
    fail_hdf5(file, name,
              "has " + std::to_string(values.size()) + " rows instead of " + std::to_string(rows));
  return values;
}

// Texts of every body; empty ones where the file has none.
std::vector<std::string> read_body_texts(hid_t file, const char* name, std::size_t bodies) {
  if (!has_link(file, name)) return std::vector<std::string>(bodies);
  std::vector<std::string> out = read_texts(file, name);
  if (out.size() != bodies) fail_hdf5(file, name, "does not have one row per body");
  return out;
}

RunHeader read_header(hid_t file) {
  check_format(file, kRunFormat, kRunVersion);
  RunHeader header;
  header.title = read_text(file, "/", "title");
  header.command_line = read_text(file, "/", "command_line");
  header.build = read_text(file, "/", "build");
  for (const std::string& name : attribute_names(file, "/notes"))
    header.notes[name] = read_text(file, "/notes", name);
  for (const std::string& name : group_names(file, "/mesh"))
    header.meshes[name] = {read_rows<Vec3>(file, "/mesh/" + name + "/vertices"),
                           read_rows<std::array<int, 3>>(file, "/mesh/" + name + "/faces"),
                           read_rows<std::array<int, 2>>(file, "/mesh/" + name + "/wires")};

  const std::vector<std::string> names = read_texts(file, "/body/name"),
                                 meshes = read_texts(file, "/body/mesh");
  if (meshes.size() != names.size()) fail_hdf5(file, "/body/mesh", "does not have one row per body");
  const auto mesh_pose = read_exactly<PoseRow>(file, "/body/mesh_pose", names.size());
  const auto fixed = read_exactly<int>(file, "/body/fixed", names.size());
  const auto dilation = read_exactly<double>(file, "/body/dilation", names.size());
  const auto mass = read_exactly<double>(file, "/body/mass", names.size());
  const auto inertia = read_exactly<Mat3>(file, "/body/inertia", names.size());
  const auto moving = has_link(file, kMovingVertices) ? read_exactly<int>(file, kMovingVertices, names.size())
                                                      : std::vector<int>(names.size(), 0);
  const auto fields = read_body_texts(file, kFieldNames, names.size()),
             field_units = read_body_texts(file, kFieldUnits, names.size());
  for (std::size_t i = 0; i < names.size(); ++i)
    header.bodies.push_back({names[i], meshes[i], from_row(mesh_pose[i]), fixed[i] != 0, dilation[i], mass[i],
                             inertia[i], moving[i], fields[i], field_units[i]});

  const std::vector<std::string> joints = read_texts(file, "/joint/name"),
                                 kinds = read_texts(file, "/joint/kind"),
                                 blocks = read_texts(file, "/coordinates/name");
  if (kinds.size() != joints.size()) fail_hdf5(file, "/joint/kind", "does not have one row per joint");
  const auto pairs = read_exactly<std::array<int, 2>>(file, "/joint/pair", joints.size());
  const auto sizes = read_exactly<int>(file, "/coordinates/size", blocks.size());
  for (std::size_t i = 0; i < joints.size(); ++i) header.joints.push_back({joints[i], kinds[i], pairs[i]});
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    if (sizes[i] < 1) fail_hdf5(file, "/coordinates/size", "is not positive at row " + std::to_string(i));
    header.blocks.push_back({blocks[i], sizes[i]});
  }
  if (has_link(file, kGaugeNames)) header.gauges = read_texts(file, kGaugeNames);
  return header;
}

}  // namespace

std::size_t moving_vertices(const RunHeader& header) {
  std::size_t count = 0;
  for (const RunBody& body : header.bodies) count += std::size_t(body.moving_vertices);
  return count;
}

std::size_t field_values(const RunHeader& header) {
  std::size_t count = 0;
  for (const RunBody& body : header.bodies)
    if (!body.field.empty()) count += std::size_t(body.moving_vertices);
  return count;
}

void validate(const RunHeader& header) {
  for (const auto& [name, mesh] : header.meshes) {
    require(!name.empty() && name != "." && name.find('/') == std::string::npos,
            "RunHeader::meshes: name '" + name + "' must be non-empty, without '/', and not '.'");
    const int count = int(mesh.vertices.size());
    const auto check = [&name = name, count](const auto& simplices, const char* kind) {
      for (std::size_t i = 0; i < simplices.size(); ++i)
        for (const int vertex : simplices[i]) {
          if (vertex >= 0 && vertex < count) continue;  // of millions, a text would take seconds
          throw std::invalid_argument("RunHeader: mesh " + name + ", " + kind + " " + std::to_string(i) +
                                      ": vertex " + std::to_string(vertex) + " must lie in [0, " +
                                      std::to_string(count) + ")");
        }
    };
    check(mesh.faces, "face");
    check(mesh.wires, "wire");
  }
  for (const RunBody& body : header.bodies) {
    require(body.mesh.empty() || header.meshes.count(body.mesh) == 1,
            "RunHeader: body " + body.name + ": there is no mesh '" + body.mesh + "'");
    const std::size_t count = body.mesh.empty() ? 0 : header.meshes.at(body.mesh).vertices.size();
    require(body.moving_vertices == 0 || std::size_t(body.moving_vertices) == count,
            "RunHeader: body " + body.name + ": moving_vertices = " + std::to_string(body.moving_vertices) +
                " must be 0 or the number of its mesh's, " + std::to_string(count));
    require(body.field.empty() || body.moving_vertices > 0,
            "RunHeader: body " + body.name + ": field '" + body.field + "' needs moving vertices");
  }
  for (const RunJointName& joint : header.joints)
    for (const int body : joint.pair)
      require(body >= -1 && body < int(header.bodies.size()),
              "RunHeader: joint " + joint.name + ": body " + std::to_string(body) + " must lie in [-1, " +
                  std::to_string(header.bodies.size()) + ")");
  for (const RunBlock& block : header.blocks)
    require(block.size >= 1, "RunHeader: block " + block.name + ": size = " + std::to_string(block.size) +
                                 " must be at least 1");
}

void validate(const RunHeader& header, const RunStep& step) {
  const int bodies = int(header.bodies.size());
  require_field(int(step.pose.size()) == bodies, "RunStep::pose: size", step.pose.size(),
                "be the number of bodies");
  require_field(step.velocity.size() == first_velocity(BodyId::at(bodies)), "RunStep::velocity: size",
                step.velocity.size(), "be six times the number of bodies");
  require_field(step.joints.size() == header.joints.size(), "RunStep::joints: size", step.joints.size(),
                "be the number of joints");
  for (const VecX* values : {&step.q, &step.q_speed})
    require_field(std::size_t(values->size()) == coordinate_count(header), "RunStep::q, q_speed: size",
                  values->size(), "be the sum of the sizes of the blocks");
  require_field(step.vertices.size() == moving_vertices(header), "RunStep::vertices: size",
                step.vertices.size(), "be the number of vertices of the bodies that deform");
  require_field(step.field.size() == field_values(header), "RunStep::field: size", step.field.size(),
                "be the number of vertices of the bodies with a field");
  require_field(std::size_t(step.gauges.size()) == header.gauges.size(), "RunStep::gauges: size",
                step.gauges.size(), "be the number of gauges");
  for (const RunContact& contact : step.contacts)
    for (const int body : contact.pair)
      require_field(body >= 0 && body < bodies, "RunContact::pair", body, "be the index of a body");
}

namespace {

struct ColumnPlan {
  std::string name{};
  hid_t type = -1;
  std::vector<hsize_t> row_shape{};
  hsize_t chunk_rows = kHdf5ChunkRows;
  std::string unit{};
};

template <class Row, class T>
ColumnPlan plan_of(const Field<Row, T>& field, hsize_t chunk_rows = kHdf5ChunkRows) {
  return {field.name, Hdf5Row<T>::type(), Hdf5Row<T>::shape(), chunk_rows, field.unit};
}

// A row holds a field of every joint.
template <class T>
std::vector<hsize_t> joint_shape(const Field<RunJoint, T>&, std::size_t joints) {
  std::vector<hsize_t> shape = Hdf5Row<T>::shape();
  shape.insert(shape.begin(), joints);
  return shape;
}

std::vector<ColumnPlan> step_columns(const RunHeader& header, bool with_joint_work = true) {
  const std::size_t bodies = header.bodies.size(), joints = header.joints.size();
  const std::size_t coordinates = coordinate_count(header);
  constexpr hsize_t kRows = RunWriter::kBlock;  // written together, so that each chunk is packed once
  std::vector<ColumnPlan> plans;
  for_each_field(kStepFields, [&](const auto& field) { plans.push_back(plan_of(field, kRows)); });
  plans.push_back({kPose, H5T_NATIVE_DOUBLE, {bodies, 7}, kRows, "m"});
  plans.push_back({kVelocity, H5T_NATIVE_DOUBLE, {bodies, 6}, kRows, "m/s, rad/s"});
  plans.push_back({kCoordinates, H5T_NATIVE_DOUBLE, {coordinates}, kRows, ""});
  plans.push_back({kCoordinateSpeeds, H5T_NATIVE_DOUBLE, {coordinates}, kRows, ""});
  if (const std::size_t moving = moving_vertices(header); moving > 0)
    plans.push_back({kVertices, H5T_NATIVE_DOUBLE, {moving, 3}, kRows, "m"});
  if (const std::size_t values = field_values(header); values > 0)
    plans.push_back({kField, H5T_NATIVE_DOUBLE, {values}, kRows, ""});
  if (!header.gauges.empty())
    plans.push_back({kGauges, H5T_NATIVE_DOUBLE, {header.gauges.size()}, kRows, ""});
  const auto of_joints = [&](const auto& field) {
    plans.push_back({field.name, H5T_NATIVE_DOUBLE, joint_shape(field, joints), kRows, field.unit});
  };
  for_each_field(kJointFields, of_joints);
  if (with_joint_work) {
    for_each_field(kJointWorkFields, of_joints);
    plans.push_back(plan_of(kJointTime, kRows));
  }
  return plans;
}

std::vector<ColumnPlan> contact_columns() {
  std::vector<ColumnPlan> plans;
  for_each_field(kContactFields, [&](const auto& field) { plans.push_back(plan_of(field)); });
  return plans;
}

// What the rows of a run depend on.
RunHeader rows_of(const RunHeader& header) {
  return {.bodies = header.bodies, .joints = header.joints, .blocks = header.blocks, .gauges = header.gauges};
}

const ColumnPlan kOffsetColumn = {kOffset, H5T_NATIVE_UINT64, {}, kHdf5ChunkRows, ""};

}  // namespace

struct RunWriter::Impl {
  std::filesystem::path path{};
  RunHeader header{};  // what rows depend on: bodies, joints, blocks, gauges
  Hdf5Id file{};
  std::unordered_map<std::string, Hdf5Column> columns{};  // looked up by name, never iterated
  std::vector<RunStep> pending{};
  std::size_t rows = 0;  // written
  std::uint64_t contacts = 0;
  std::int64_t last_step = -1;
  double last_time = -kInf;

  void create(const ColumnPlan& plan) {
    columns[plan.name] = Hdf5Column(file, plan.name, plan.type, plan.row_shape, plan.chunk_rows, plan.unit);
  }
  void reopen(const ColumnPlan& plan, hsize_t kept) {
    columns[plan.name] = Hdf5Column::open(file, plan.name, plan.type, plan.row_shape);
    columns[plan.name].truncate(kept);
  }

  // The field of all items; a row of the column is one item, or those of one step.
  template <class Row, class T>
  void append(const Field<Row, T>& field, const std::vector<Row>& items, std::size_t column_rows) {
    std::vector<T> values;
    values.reserve(items.size());
    for (const Row& item : items) values.push_back(item.*field.member);
    columns.at(field.name).append(values.data(), column_rows);
  }

  void write_pending() {
    const Hdf5Silence silence;
    std::vector<PoseRow> pose;
    std::vector<double> velocity, q, q_speed, gauges, of_vertices;
    std::vector<RunJoint> joint;
    std::vector<RunContact> contact;
    std::vector<std::uint64_t> offset;
    std::vector<Vec3> vertices;
    for (const RunStep& step : pending) {
      vertices.insert(vertices.end(), step.vertices.begin(), step.vertices.end());
      of_vertices.insert(of_vertices.end(), step.field.begin(), step.field.end());
      for (const SE3& g : step.pose) pose.push_back(to_row(g));
      velocity.insert(velocity.end(), step.velocity.begin(), step.velocity.end());
      q.insert(q.end(), step.q.begin(), step.q.end());
      q_speed.insert(q_speed.end(), step.q_speed.begin(), step.q_speed.end());
      gauges.insert(gauges.end(), step.gauges.begin(), step.gauges.end());
      joint.insert(joint.end(), step.joints.begin(), step.joints.end());
      contact.insert(contact.end(), step.contacts.begin(), step.contacts.end());
      offset.push_back(contacts + contact.size());
    }
    for_each_field(kContactFields, [&](const auto& field) { append(field, contact, contact.size()); });
    for_each_field(kStepFields, [&](const auto& field) { append(field, pending, pending.size()); });
    const auto of_joints = [&](const auto& field) { append(field, joint, pending.size()); };
    for_each_field(kJointFields, of_joints);
    for_each_field(kJointWorkFields, of_joints);
    append(kJointTime, pending, pending.size());
    columns.at(kPose).append(pose.data(), pending.size());
    columns.at(kVelocity).append(velocity.data(), pending.size());
    columns.at(kCoordinates).append(q.data(), pending.size());
    columns.at(kCoordinateSpeeds).append(q_speed.data(), pending.size());
    if (!gauges.empty()) columns.at(kGauges).append(gauges.data(), pending.size());
    if (!vertices.empty()) columns.at(kVertices).append(vertices.data(), pending.size());
    if (!of_vertices.empty()) columns.at(kField).append(of_vertices.data(), pending.size());
    columns.at(kOffset).append(offset.data(), offset.size());
    rows += pending.size();
    contacts += contact.size();
    pending.clear();
    flush_hdf5(file);
  }
};

RunWriter::RunWriter(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RunWriter::RunWriter(RunWriter&&) noexcept = default;
RunWriter& RunWriter::operator=(RunWriter&&) noexcept = default;

RunWriter::RunWriter(std::filesystem::path path, const RunHeader& header) : impl_(std::make_unique<Impl>()) {
  validate(header);
  const Hdf5Silence silence;
  impl_->path = std::move(path);
  impl_->header = rows_of(header);
  const std::filesystem::path growing = growing_name(impl_->path);
  WriterLock left(growing);
  left.remove_file();
  impl_->file = create_hdf5(growing);
  write_header(impl_->file, header);
  for (const ColumnPlan& plan : step_columns(header)) impl_->create(plan);
  for (const ColumnPlan& plan : contact_columns()) impl_->create(plan);
  impl_->create(kOffsetColumn);
  const std::uint64_t none = 0;
  impl_->columns.at(kOffset).append(&none, 1);
  flush_hdf5(impl_->file);
}

RunWriter RunWriter::resume(std::filesystem::path path, std::size_t rows) {
  const Hdf5Silence silence;
  auto impl = std::make_unique<Impl>();
  impl->path = std::move(path);
  const std::filesystem::path growing = growing_name(impl->path);
  { const WriterLock nobody_else(growing); }  // HDF5, which locks it next, would call the file damaged
  impl->file = open_hdf5(growing, Hdf5Access::write);
  impl->header = rows_of(read_header(impl->file));
  impl->rows = rows;
  impl->reopen(kOffsetColumn, rows + 1);
  impl->contacts = read_rows<std::uint64_t>(impl->file, kOffset).back();
  for (const ColumnPlan& plan : step_columns(impl->header)) impl->reopen(plan, rows);
  for (const ColumnPlan& plan : contact_columns()) impl->reopen(plan, impl->contacts);
  if (rows > 0) {
    impl->last_step = read_rows<std::int64_t>(impl->file, "/state/step").back();
    impl->last_time = read_rows<double>(impl->file, "/state/time").back();
  }
  return RunWriter(std::move(impl));
}

RunWriter::~RunWriter() {
  if (!impl_ || impl_->file < 0) return;
  try {
    impl_->write_pending();
  } catch (const std::runtime_error&) {  // cannot be reported here: what was flushed before is still there
  }
}

void RunWriter::append(RunStep step) {
  require(impl_->file >= 0, "RunWriter::append: the run is closed");
  validate(impl_->header, step);
  require_field(step.step > impl_->last_step, "RunStep::step", step.step, "be larger than the one before");
  require_field(step.time >= impl_->last_time, "RunStep::time", step.time,
                "not be smaller than the one before");
  impl_->last_step = step.step;
  impl_->last_time = step.time;
  impl_->pending.push_back(std::move(step));
  if (impl_->pending.size() >= std::size_t(kBlock)) impl_->write_pending();
}

void RunWriter::note(const std::string& name, const std::string& text) {
  require(impl_->file >= 0, "RunWriter::note: the run is closed");
  const Hdf5Silence silence;
  H5Adelete_by_name(impl_->file, "/notes", name.c_str(), H5P_DEFAULT);  // an older one, if any
  write_text(impl_->file, "/notes", name, text);
}

void RunWriter::flush() {
  if (impl_->file < 0) return;
  impl_->write_pending();
  sync_to_disk(growing_name(impl_->path));
}

void RunWriter::close() {
  if (impl_->file < 0) return;
  impl_->write_pending();
  impl_->columns.clear();  // datasets first: an open one keeps the file open
  impl_->file = Hdf5Id();
  publish_file(growing_name(impl_->path), impl_->path);
}

std::size_t RunWriter::rows() const {
  return impl_->rows + impl_->pending.size();
}

namespace {

VecX row_of(const std::vector<double>& values, std::size_t row, std::size_t width) {
  return Eigen::Map<const VecX>(values.data() + row * width, Eigen::Index(width));
}

}  // namespace

struct RunReader::Impl {
  std::filesystem::path path{};
  Hdf5Id file{};
  RunHeader header{};
  bool with_joint_work = false;
  std::vector<std::uint64_t> offset{};                    // of the contacts of each step
  std::unordered_map<std::string, Hdf5Column> columns{};  // looked up by name, never iterated
  std::size_t first = 0;                                  // row of the first step of the block
  std::vector<RunStep> block{};

  template <class Row, class T>
  void read(const Field<Row, T>& field, std::size_t from, std::vector<Row>& rows) const {
    std::vector<T> values(rows.size());
    columns.at(field.name).read(values.data(), from, rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].*field.member = values[i];
  }
  /// Rows of a shape that depends on the model, one after the other.
  std::vector<double> read_wide(const char* name, std::size_t width) const {
    std::vector<double> values(block.size() * width);
    if (width > 0) columns.at(name).read(values.data(), first, block.size());
    return values;
  }
  /// A field of every joint at every step.
  template <class T>
  void read_joints(const Field<RunJoint, T>& field) {
    constexpr std::size_t kNumber = sizeof(double), kWidth = sizeof(T) / kNumber;
    const std::vector<double> values = read_wide(field.name, header.joints.size() * kWidth);
    const double* next = values.data();
    for (RunStep& step : block)
      for (RunJoint& joint : step.joints) {
        if constexpr (std::is_same_v<T, double>)
          joint.*field.member = *next++;
        else
          joint.*field.member = Vec3(next[0], next[1], next[2]), next += 3;
      }
  }
  void open(const std::vector<ColumnPlan>& plans, std::size_t rows);
  void read_states();
  void read_contacts();
  void read_block(std::size_t row);
};

/// All columns must have so many rows; no memory for them is asked for yet.
void RunReader::Impl::open(const std::vector<ColumnPlan>& plans, std::size_t rows) {
  for (const ColumnPlan& plan : plans) {
    Hdf5Column column = Hdf5Column::open(file, plan.name, plan.type, plan.row_shape);
    if (column.rows() != rows)
      fail_hdf5(file, plan.name,
                "has " + std::to_string(column.rows()) + " rows instead of " + std::to_string(rows));
    columns[plan.name] = std::move(column);
  }
}

void RunReader::Impl::read_states() {
  const std::size_t bodies = header.bodies.size(), coordinates = coordinate_count(header),
                    moving = moving_vertices(header), field_width = field_values(header);
  const std::vector<double> pose = read_wide(kPose, 7 * bodies),
                            velocity = read_wide(kVelocity, std::size_t(first_velocity(BodyId::at(bodies)))),
                            q = read_wide(kCoordinates, coordinates),
                            q_speed = read_wide(kCoordinateSpeeds, coordinates),
                            gauges = read_wide(kGauges, header.gauges.size()),
                            vertices = read_wide(kVertices, 3 * moving),
                            field = read_wide(kField, field_width);
  for (std::size_t k = 0; k < block.size(); ++k) {
    RunStep& step = block[k];
    for (std::size_t i = 0; i < bodies; ++i) {
      PoseRow row{};
      std::copy_n(pose.data() + 7 * (k * bodies + i), 7, row.begin());
      step.pose.push_back(from_row(row));
    }
    for (std::size_t i = 0; i < moving; ++i)
      step.vertices.emplace_back(vertices.data() + 3 * (k * moving + i));
    const auto values = field.begin() + std::ptrdiff_t(k * field_width);
    step.field.assign(values, values + std::ptrdiff_t(field_width));
    step.velocity = row_of(velocity, k, std::size_t(first_velocity(BodyId::at(bodies))));
    step.q = row_of(q, k, coordinates);
    step.q_speed = row_of(q_speed, k, coordinates);
    step.gauges = row_of(gauges, k, header.gauges.size());
  }
}

void RunReader::Impl::read_contacts() {
  const std::uint64_t begin = offset[first], end = offset[first + block.size()];
  std::vector<RunContact> contacts(end - begin);
  for_each_field(kContactFields, [&](const auto& field) { read(field, begin, contacts); });
  for (std::size_t k = 0; k < block.size(); ++k)
    block[k].contacts.assign(contacts.begin() + std::ptrdiff_t(offset[first + k] - begin),
                             contacts.begin() + std::ptrdiff_t(offset[first + k + 1] - begin));
}

void RunReader::Impl::read_block(std::size_t row) {
  const Hdf5Silence silence;
  first = row / kBlock * kBlock;
  block.assign(std::min(kBlock, offset.size() - 1 - first), {});
  for_each_field(kStepFields, [&](const auto& field) { read(field, first, block); });
  for (RunStep& step : block) step.joints.resize(header.joints.size());
  const auto of_joints = [&](const auto& field) { read_joints(field); };
  for_each_field(kJointFields, of_joints);
  if (with_joint_work) {
    for_each_field(kJointWorkFields, of_joints);
    read(kJointTime, first, block);
  }
  read_states();
  read_contacts();
  try {
    for (const RunStep& step : block) validate(header, step);
  } catch (const std::invalid_argument& wrong) {
    throw std::runtime_error(path.string() + ": " + wrong.what());
  }
}

RunReader::RunReader(RunReader&&) noexcept = default;
RunReader::~RunReader() = default;

RunReader::RunReader(const std::filesystem::path& path) : impl_(std::make_unique<Impl>()) {
  const Hdf5Silence silence;
  Impl& r = *impl_;
  r.path = path;
  r.file = open_hdf5(path, Hdf5Access::read);
  r.header = read_header(r.file);
  r.with_joint_work = has_link(r.file, kJointTime.name);
  r.offset = read_rows<std::uint64_t>(r.file, kOffset);
  if (r.offset.empty() || r.offset.front() != 0) fail_hdf5(r.file, kOffset, "does not begin with 0");
  for (std::size_t k = 0; k + 1 < r.offset.size(); ++k)
    if (r.offset[k] > r.offset[k + 1])
      fail_hdf5(r.file, kOffset, "does not ascend at row " + std::to_string(k));
  r.open(contact_columns(), r.offset.back());
  r.open(step_columns(r.header, r.with_joint_work), steps());
  try {
    validate(r.header);
  } catch (const std::invalid_argument& wrong) {
    throw std::runtime_error(path.string() + ": " + wrong.what());
  }
}

const RunHeader& RunReader::header() const {
  return impl_->header;
}

std::size_t RunReader::steps() const {
  return impl_->offset.size() - 1;
}

const RunStep& RunReader::step(std::size_t row) {
  require_field(row < steps(), "RunReader::step: row", row, ("be below " + std::to_string(steps())).c_str());
  Impl& r = *impl_;
  if (row < r.first || row >= r.first + r.block.size()) r.read_block(row);
  return r.block[row - r.first];
}

RunData read_run(const std::filesystem::path& path) {
  RunReader reader(path);
  RunData run{reader.header(), {}};
  run.steps.reserve(reader.steps());
  for (std::size_t row = 0; row < reader.steps(); ++row) run.steps.push_back(reader.step(row));
  return run;
}

}  // namespace aussois
