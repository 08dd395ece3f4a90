// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <ode/ode.h>

#include "bench/peer_engine.hpp"

namespace aussois {
namespace {

constexpr int kContactsOfAPair = 8;

struct World {
  dWorldID world = nullptr;
  dSpaceID space = nullptr;
  dJointGroupID contacts = nullptr;
  PerBody<dBodyID> bodies{};
  std::vector<double> mu{};
  PerBody<Vec3> force{};
  PerBody<SE3> start{};
  int steps = 1;
  double restitution = 0, h = 0, t = 0;  // h of one of its own steps

  World(const PeerScene& scene, double step, const PeerTuning& tuning)
      : steps(tuning.steps), restitution(scene.restitution), h(step / tuning.steps) {
    dInitODE2(0);
    world = dWorldCreate();
    dWorldSetQuickStepNumIterations(world, tuning.iterations * dWorldGetQuickStepNumIterations(world));
    space = dHashSpaceCreate(nullptr);
    contacts = dJointGroupCreate(0);
    dWorldSetGravity(world, scene.gravity.x(), scene.gravity.y(), scene.gravity.z());
    mu.reserve(scene.bodies.size());  // shapes point at theirs
    for (const BodyId b : scene.bodies.ids()) {
      const PeerBody& body = scene.bodies[b];
      const PeerShape& shape = scene.shapes[body.shape];
      const dGeomID geom = shape.kind == PeerShapeKind::ball
                               ? dCreateSphere(space, shape.size.x())
                               : dCreateBox(space, shape.size.x(), shape.size.y(), shape.size.z());
      bodies.push_back(body.fixed ? nullptr : dBodyCreate(world));
      mu.push_back(body.mu);
      dGeomSetData(geom, &mu.back());
      force.push_back(body.force);
      start.push_back(body.g);
      if (body.fixed) {
        dGeomSetPosition(geom, body.g.p.x(), body.g.p.y(), body.g.p.z());
        continue;
      }
      dMass mass;
      const Mat3& J = shape.inertia;
      dMassSetParameters(&mass, shape.mass, 0, 0, 0, J(0, 0), J(1, 1), J(2, 2), J(0, 1), J(0, 2), J(1, 2));
      dBodySetMass(bodies.back(), &mass);
      dGeomSetBody(geom, bodies.back());
      const dQuaternion R{body.g.R.w(), body.g.R.x(), body.g.R.y(), body.g.R.z()};
      dBodySetPosition(bodies.back(), body.g.p.x(), body.g.p.y(), body.g.p.z());
      dBodySetQuaternion(bodies.back(), R);
    }
  }
  ~World() {
    dJointGroupDestroy(contacts);
    dSpaceDestroy(space);
    dWorldDestroy(world);
    dCloseODE();
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  static void near(void* self, dGeomID a, dGeomID b) { static_cast<World*>(self)->touch(a, b); }
  void touch(dGeomID a, dGeomID b) {
    if (!dGeomGetBody(a) && !dGeomGetBody(b)) return;
    dContact found[kContactsOfAPair];
    const int count = dCollide(a, b, kContactsOfAPair, &found[0].geom, sizeof(dContact));
    const auto friction = [](dGeomID geom) { return *static_cast<const double*>(dGeomGetData(geom)); };
    for (int i = 0; i < count; ++i) {
      dSurfaceParameters& surface = found[i].surface;
      surface = {};
      surface.mode = dContactApprox1 | (restitution > 0 ? dContactBounce : 0);
      surface.mu = std::min(friction(a), friction(b));
      surface.bounce = restitution;
      dJointAttach(dJointCreateContact(world, contacts, &found[i]), dGeomGetBody(a), dGeomGetBody(b));
    }
  }

  void advance() {
    for (int k = 0; k < steps; ++k) advance_once();
  }
  void advance_once() {
    dSpaceCollide(space, this, &near);
    for (const BodyId b : bodies.ids())
      if (!force[b].isZero(0)) dBodyAddForce(bodies[b], force[b].x(), force[b].y(), force[b].z());
    dWorldQuickStep(world, h);
    dJointGroupEmpty(contacts);
    t += h;
  }
  PeerSample look() const {
    PeerSample out{.t = t, .g = start};
    for (const BodyId b : bodies.ids()) {
      out.v.push_back(Vec3::Zero());
      if (!bodies[b]) continue;
      const dReal *x = dBodyGetPosition(bodies[b]), *R = dBodyGetQuaternion(bodies[b]),
                  *v = dBodyGetLinearVel(bodies[b]);
      out.g[b] = {Quat(R[0], R[1], R[2], R[3]), Vec3(x[0], x[1], x[2])};
      out.v[b] = Vec3(v[0], v[1], v[2]);
    }
    return out;
  }
};

}  // namespace

PeerEngine ode_engine(const PeerTuning& tuning) {
  return {peer_name("ode", tuning), [tuning](const PeerScene& scene, double h) -> std::optional<EngineRun> {
            for (const PeerShape& shape : scene.shapes)
              if (shape.kind == PeerShapeKind::prism) return std::nullopt;
            const auto world = std::make_shared<World>(scene, h, tuning);
            return EngineRun{[world] { world->advance(); }, [world] { return world->look(); }};
          }};
}

}  // namespace aussois
