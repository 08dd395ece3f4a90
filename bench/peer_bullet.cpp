// SPDX-License-Identifier: Apache-2.0
#include <btBulletDynamicsCommon.h>

#include "bench/peer_engine.hpp"

namespace aussois {
namespace {

constexpr double kMargin = 1e-3;  // of hulls, inside their faces [m]

btVector3 to_bullet(const Vec3& x) {
  return {x.x(), x.y(), x.z()};
}
Vec3 from_bullet(const btVector3& x) {
  return {x.x(), x.y(), x.z()};
}

btScalar smaller_friction(const btCollisionObject* a, const btCollisionObject* b) {
  return std::min(a->getFriction(), b->getFriction());
}

std::unique_ptr<btCollisionShape> make_shape(const PeerShape& shape) {
  switch (shape.kind) {
    case PeerShapeKind::ball:
      return std::make_unique<btSphereShape>(shape.size.x());
    case PeerShapeKind::box:
      return std::make_unique<btBoxShape>(to_bullet(shape.size / 2));
    case PeerShapeKind::prism:
      break;
  }
  auto hull = std::make_unique<btConvexHullShape>();
  for (const Vec3& x : corners(shape, kMargin)) hull->addPoint(to_bullet(x));
  hull->setMargin(kMargin);
  return hull;
}

struct World {
  btDefaultCollisionConfiguration configuration{};
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broad_phase{};
  btSequentialImpulseConstraintSolver solver{};
  Table<ShapeId, std::unique_ptr<btCollisionShape>> shapes{};
  std::vector<std::unique_ptr<btRigidBody>> bodies{};
  std::vector<Vec3> force{};
  btDiscreteDynamicsWorld dynamics{&dispatcher, &broad_phase, &solver, &configuration};
  int steps = 1;
  double h = 0, t = 0;  // of one of its own steps

  World(const PeerScene& scene, double step, const PeerTuning& tuning)
      : steps(tuning.steps), h(step / tuning.steps) {
    dynamics.getSolverInfo().m_numIterations *= tuning.iterations;
    gCalculateCombinedFrictionCallback = smaller_friction;
    dynamics.setGravity(to_bullet(scene.gravity));
    for (const PeerShape& shape : scene.shapes) shapes.push_back(make_shape(shape));
    for (const PeerBody& body : scene.bodies) {
      const PeerShape& shape = scene.shapes[body.shape];
      btRigidBody::btRigidBodyConstructionInfo info(
          body.fixed ? 0 : shape.mass, nullptr, shapes[body.shape].get(),
          body.fixed ? btVector3(0, 0, 0) : to_bullet(shape.inertia.diagonal()));
      const Quat& R = body.g.R;
      info.m_startWorldTransform = btTransform(btQuaternion(R.x(), R.y(), R.z(), R.w()), to_bullet(body.g.p));
      info.m_friction = body.mu;
      info.m_restitution =
          scene.restitution > 0 ? std::sqrt(scene.restitution) : 0;  // a pair has the product
      bodies.push_back(std::make_unique<btRigidBody>(info));
      bodies.back()->setActivationState(DISABLE_DEACTIVATION);
      dynamics.addRigidBody(bodies.back().get());
      force.push_back(body.force);
    }
  }
  ~World() {
    for (const auto& body : bodies) dynamics.removeRigidBody(body.get());
    gCalculateCombinedFrictionCallback = nullptr;
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  void advance() {
    for (int k = 0; k < steps; ++k) advance_once();
  }
  void advance_once() {
    for (std::size_t b = 0; b < bodies.size(); ++b)
      if (!force[b].isZero(0)) bodies[b]->applyCentralForce(to_bullet(force[b]));
    dynamics.stepSimulation(h, 0);
    dynamics.clearForces();
    t += h;
  }
  PeerSample look() const {
    PeerSample out{.t = t};
    for (const auto& body : bodies) {
      const btQuaternion R = body->getWorldTransform().getRotation();
      out.g.push_back({Quat(R.w(), R.x(), R.y(), R.z()), from_bullet(body->getWorldTransform().getOrigin())});
      out.v.push_back(from_bullet(body->getLinearVelocity()));
    }
    return out;
  }
};

}  // namespace

PeerEngine bullet_engine(const PeerTuning& tuning) {
  return {peer_name("bullet", tuning),
          [tuning](const PeerScene& scene, double h) -> std::optional<EngineRun> {
            const auto world = std::make_shared<World>(scene, h, tuning);
            return EngineRun{[world] { world->advance(); }, [world] { return world->look(); }};
          }};
}

}  // namespace aussois
