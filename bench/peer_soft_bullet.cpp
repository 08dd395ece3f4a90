// SPDX-License-Identifier: Apache-2.0
#include <btBulletDynamicsCommon.h>
#include <memory>

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btDeformableNeoHookeanForce.h>
#include <BulletSoftBody/btSoftBodyHelpers.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>

#include "bench/peer_soft.hpp"
#include "geometry/volume_primitives.hpp"

namespace aussois {
namespace {

const btVector3 kDown(0, 0, -9.81);

Vec3 from_bullet(const btVector3& x) {
  return {x.x(), x.y(), x.z()};
}

// Rigid capsules on ball joints, sequential impulses.
struct RopeWorld {
  btDefaultCollisionConfiguration configuration{};
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broad_phase{};
  btSequentialImpulseConstraintSolver solver{};
  btStaticPlaneShape plane{btVector3(0, 0, 1), 0};
  std::unique_ptr<btCapsuleShapeX> capsule{};
  std::vector<std::unique_ptr<btRigidBody>> bodies{};
  std::vector<std::unique_ptr<btTypedConstraint>> joints{};
  btDiscreteDynamicsWorld dynamics{&dispatcher, &broad_phase, &solver, &configuration};
  double h = 0, half = 0;

  RopeWorld(const RopeScene& scene, double step) : h(step), half(scene.length / scene.elements / 2) {
    dynamics.setGravity(kDown);
    capsule = std::make_unique<btCapsuleShapeX>(scene.radius, std::max(2 * half - 2 * scene.radius, 1e-4));
    const double mass = kPi * scene.radius * scene.radius * scene.density * 2 * half,
                 along = mass * scene.radius * scene.radius / 2,
                 across = mass * (half * half / 3 + scene.radius * scene.radius / 4);
    for (int i = 0; i < scene.elements; ++i) {
      add(mass, capsule.get(), btVector3(along, across, across),
          btVector3((2 * i + 1) * half, 0, scene.on_floor ? scene.radius + 1e-5 : 0), scene.mu);
      if (i > 0)
        join(std::make_unique<btPoint2PointConstraint>(*bodies[std::size_t(i) - 1], *bodies.back(),
                                                       btVector3(half, 0, 0), btVector3(-half, 0, 0)));
      else if (!scene.on_floor)
        join(std::make_unique<btPoint2PointConstraint>(*bodies.back(), btVector3(-half, 0, 0)));
    }
    if (scene.on_floor) add(0, &plane, btVector3(0, 0, 0), btVector3(0, 0, 0), scene.mu);
  }
  ~RopeWorld() {
    for (const auto& joint : joints) dynamics.removeConstraint(joint.get());
    for (const auto& body : bodies) dynamics.removeRigidBody(body.get());
  }
  RopeWorld(const RopeWorld&) = delete;
  RopeWorld& operator=(const RopeWorld&) = delete;

  void add(double mass, btCollisionShape* shape, const btVector3& inertia, const btVector3& at, double mu) {
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape, inertia);
    info.m_startWorldTransform = btTransform(btQuaternion::getIdentity(), at);
    info.m_friction = std::sqrt(mu);  // a pair has the product
    bodies.push_back(std::make_unique<btRigidBody>(info));
    bodies.back()->setActivationState(DISABLE_DEACTIVATION);
    dynamics.addRigidBody(bodies.back().get());
  }
  void join(std::unique_ptr<btTypedConstraint> joint) {
    dynamics.addConstraint(joint.get(), true);
    joints.push_back(std::move(joint));
  }
  std::vector<Vec3> points() const {
    std::vector<Vec3> out;
    for (std::size_t i = 0; i < bodies.size() && bodies[i]->getMass() > 0; ++i) {
      if (i == 0) out.push_back(from_bullet(bodies[i]->getWorldTransform() * btVector3(-half, 0, 0)));
      out.push_back(from_bullet(bodies[i]->getWorldTransform() * btVector3(half, 0, 0)));
    }
    return out;
  }
};

// Its deformable world: implicit, conjugate gradients.
struct BlockWorld {
  btSoftBodyRigidBodyCollisionConfiguration configuration{};
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broad_phase{};
  btDeformableBodySolver deformable{};
  btDeformableMultiBodyConstraintSolver solver{};
  btStaticPlaneShape plane{btVector3(0, 0, 1), 0};
  std::unique_ptr<btRigidBody> floor{};
  std::unique_ptr<btSoftBody> cube{};
  std::unique_ptr<btDeformableNeoHookeanForce> force{};
  std::unique_ptr<btDeformableMultiBodyDynamicsWorld> dynamics{};
  double h = 0;

  BlockWorld(const BlockScene& scene, double step) : h(step) {
    solver.setDeformableSolver(&deformable);
    dynamics = std::make_unique<btDeformableMultiBodyDynamicsWorld>(&dispatcher, &broad_phase, &solver,
                                                                    &configuration, &deformable);
    dynamics->setGravity(kDown);
    dynamics->getWorldInfo().m_gravity = kDown;
    dynamics->setImplicit(true);
    btRigidBody::btRigidBodyConstructionInfo info(0, nullptr, &plane);
    info.m_friction = scene.mu;
    floor = std::make_unique<btRigidBody>(info);
    dynamics->addRigidBody(floor.get());
    const VolumeMesh mesh =
        make_box_mesh(Vec3::Constant(scene.side), {scene.cells, scene.cells, scene.cells});
    btAlignedObjectArray<btVector3> places;
    for (const Vec3& x : mesh.points) places.push_back({x.x(), x.y(), x.z() + 0.6 * scene.side + 1e-3});
    cube = std::make_unique<btSoftBody>(&dynamics->getWorldInfo(), places.size(), &places[0], nullptr);
    for (const auto& t : mesh.tets) {
      cube->appendTetra(t[0], t[1], t[2], t[3]);
      for (int a = 0; a < 4; ++a)  // its trees are built along links
        for (int b = 0; b < a; ++b) cube->appendLink(t[a], t[b], nullptr, true);
    }
    for (const auto& f : boundary_triangles(mesh)) cube->appendFace(f[0], f[1], f[2]);
    cube->initializeDmInverse();
    cube->m_tetraScratches.resizeNoInitialize(cube->m_tetras.size());
    cube->m_tetraScratchesTn.resizeNoInitialize(cube->m_tetras.size());
    cube->getCollisionShape()->setMargin(1e-3);
    cube->setTotalMass(scene.density * scene.side * scene.side * scene.side);
    cube->m_cfg.kDF = scene.mu;
    cube->m_cfg.collisions = btSoftBody::fCollision::SDF_RD;
    cube->m_sleepingThreshold = 0;
    const double mu = scene.young / (2 * (1 + scene.poisson)),
                 lambda = scene.young * scene.poisson / ((1 + scene.poisson) * (1 - 2 * scene.poisson));
    force = std::make_unique<btDeformableNeoHookeanForce>(mu, lambda, 0);
    dynamics->addSoftBody(cube.get());
    dynamics->addForce(cube.get(), force.get());
  }
  ~BlockWorld() {
    dynamics->removeForce(cube.get(), force.get());
    dynamics->removeSoftBody(cube.get());
    dynamics->removeRigidBody(floor.get());
  }
  BlockWorld(const BlockWorld&) = delete;
  BlockWorld& operator=(const BlockWorld&) = delete;

  std::vector<Vec3> points() const {
    std::vector<Vec3> out;
    for (int i = 0; i < cube->m_nodes.size(); ++i) out.push_back(from_bullet(cube->m_nodes[i].m_x));
    return out;
  }
};

}  // namespace

SoftEngine bullet_soft_engine() {
  return {"bullet",
          [](const RopeScene& scene, double h) -> std::optional<SoftRun> {
            const auto world = std::make_shared<RopeWorld>(scene, h);
            return SoftRun{[world] { world->dynamics.stepSimulation(world->h, 0); },
                           [world] { return world->points(); }};
          },
          [](const BlockScene& scene, double h) -> std::optional<SoftRun> {
            const auto world = std::make_shared<BlockWorld>(scene, h);
            return SoftRun{[world] { world->dynamics->stepSimulation(world->h, 0); },
                           [world] { return world->points(); }};
          }};
}

}  // namespace aussois
