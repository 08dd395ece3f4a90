// SPDX-License-Identifier: Apache-2.0
#include "io/record.hpp"

#include <algorithm>
#include <iterator>
#include <map>

#include "geometry/check.hpp"
#include "mechanics/surface.hpp"

namespace aussois {
namespace {

RunMesh run_mesh(const SimplicialComplex& complex) {
  RunMesh mesh{complex.vertices.to_vector(), complex.triangles.to_vector(), {}};
  for (std::size_t i = 0; i < complex.edges.size(); ++i)
    if (complex.edge_triangles[int(i)].empty()) mesh.wires.push_back(complex.edges[i]);
  return mesh;
}

// Where it is; what it did is in the report of a step.
RunJoint run_joint(const Model& model, const State& state, JointId joint) {
  RunJoint out;
  for (int axis = 0; axis < axis_count(model.joints[joint].kind); ++axis) {
    out.coordinate[axis] = joint_coordinate(model, state, joint, axis);
    out.speed[axis] = joint_speed(model, state, joint, axis);
  }
  const JointError off = joint_error(model, state, joint);
  out.translation_error = off.translation;
  out.rotation_error = off.rotation;
  return out;
}

// Numbers of the file: what is new comes last.
int status_code(SolveStatus status) {
  switch (status) {
    case SolveStatus::converged:
      return 0;
    case SolveStatus::stagnated:
      return 1;
    case SolveStatus::max_iterations:
      return 2;
    case SolveStatus::not_finite:
      return 3;
    case SolveStatus::at_rounding:
      return 4;
  }
  return -1;
}

}  // namespace

RunHeader run_header(const Model& model) {
  RunHeader header;
  std::map<ShapeId, std::string> mesh_of_shape;
  for (const RigidBody& body : model.bodies) {
    RunBody row{body.name, {},        body.g_bs,   std::holds_alternative<FixedMotion>(body.motion),
                0,         body.mass, body.inertia};
    if (body.shape) {
      const LmdShape& shape = *model.shapes[body.shape];
      const bool first = mesh_of_shape.emplace(body.shape, body.name).second;
      if (first) {
        require(header.meshes.count(body.name) == 0, "run_header: two bodies are named '" + body.name + "'");
        header.meshes[body.name] = run_mesh(shape.complex);
      }
      row.mesh = mesh_of_shape[body.shape];
      row.dilation = shape.radius;
      if (deforms(body)) row.moving_vertices = int(shape.complex.vertices.size());
      if (const VertexField& field = body.deformation.field; field.values)
        row.field = field.what, row.field_unit = field.unit;
    }
    header.bodies.push_back(std::move(row));
  }
  for (const Joint& joint : model.joints)
    header.joints.push_back(
        {joint.name, to_string(joint.kind), {joint.body_a.index(), joint.body_b.index()}});
  for (const Coordinates& block : model.coordinates) header.blocks.push_back({block.name, block.size});
  validate(header);
  return header;
}

RunStep run_step(std::int64_t step, const Model& model, const State& state, const CouplingWrench& coupling) {
  RunStep row;
  row.step = step;
  row.time = state.t;
  row.pose = state.g;
  const int of_bodies = first_velocity(state.g.next());
  row.velocity = state.v.head(of_bodies);
  row.q = state.q;
  row.q_speed = state.v.tail(state.v.size() - of_bodies);
  for (const BodyId b : model.bodies.ids())
    if (deforms(model.bodies[b])) {
      std::ranges::move(deformed_vertices(model, state, b), std::back_inserter(row.vertices));
      std::ranges::move(vertex_field(model, state, b), std::back_inserter(row.field));
    }
  for (const JointId i : model.joints.ids()) row.joints.push_back(run_joint(model, state, i));
  const Energy now = energy(model, state);
  row.kinetic = now.kinetic;
  row.gravity = now.gravity;
  row.laws = now.laws;
  row.coupling_force = coupling.force;
  row.coupling_torque = coupling.torque;
  return row;
}

RunStep run_step(std::int64_t step, const Model& model, const State& state, const StepReport& report,
                 const CouplingWrench& coupling) {
  RunStep row = run_step(step, model, state, coupling);
  for (const StepContact& contact : report.contacts)
    row.contacts.push_back(run_contact(contact.point, contact.impulse));
  for (const JointId i : report.joints.ids()) {
    const StepJoint& joint = report.joints[i];
    RunJoint& out = row.joints[i.index()];
    out.force = joint.force;
    out.torque = joint.torque;
    out.effort = joint.effort;
    out.work_locked = joint.work.locked;
    out.work_couplings = joint.work.couplings;
    out.work_stops = joint.work.stops;
    out.work_friction = joint.work.friction;
    out.work_motors = joint.work.motors;
    out.work_springs = joint.work.springs;
    out.work_supports = joint.work.supports;
  }
  row.joint_time = report.t_joints;
  row.status = int(report.status);
  row.h = report.h;
  row.attempts = report.attempts;
  row.contacts_found = report.contacts_found;
  row.contacts_kept = report.contacts_kept;
  row.contacts_matched = report.matches.matched();
  row.matched_by_key = report.matches.by_key;
  row.matched_by_adjacency = report.matches.by_adjacency;
  row.matched_by_geometry = report.matches.by_geometry;
  row.unmatched = report.matches.unmatched;
  row.inherited = report.matches.inherited;
  row.certificate_rounds = report.certificate_rounds;
  row.threshold = report.threshold;
  row.min_gap = report.min_gap;
  row.min_base_distance = report.min_base_distance;
  row.solver_status = status_code(report.solve.status);
  row.iterations = report.solve.iterations;
  row.local_failures = report.solve.local_failures;
  row.local_fail_safes = report.solve.local_fail_safes;
  row.residual = report.solve.residual;
  row.gravity_work = report.energy.gravity_work;
  row.law_work = report.energy.law_work;
  row.contact_work = report.energy.contact_work;
  row.gyroscopic_work = report.energy.gyroscopic_work;
  row.joint_work = report.energy.joint_work;
  row.numerical_work = report.energy.numerical_work;
  row.energy_residual = report.energy.residual();
  row.impulse_gain = report.impulse_gain;
  row.seconds_contact = seconds_of(report.stages, {Stage::broad_phase, Stage::search, Stage::reduction});
  row.seconds_solve = seconds_of(report.stages, {Stage::kinematics, Stage::assembly, Stage::solve});
  row.seconds_certificate = seconds_of(report.stages, {Stage::certificate});
  row.seconds_total = report.total.wall;
  return row;
}

RunContact run_contact(const ContactPoint& contact, const Vec3& impulse) {
  return {{contact.a.body.index(), contact.b.body.index()},
          {{{contact.a.dim, contact.a.simplex, contact.a.region},
            {contact.b.dim, contact.b.simplex, contact.b.region}}},
          contact.x_a,
          contact.x_b,
          contact.normal,
          impulse,
          contact.gap};
}

}  // namespace aussois
