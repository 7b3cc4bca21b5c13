// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/bullet_body.hpp"

#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableGravityForce.h>
#include <BulletSoftBody/btDeformableLinearElasticityForce.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletCollisionCommon.h>

namespace polyscalpel::report {
namespace {

btVector3 toBullet(const Eigen::Vector3d& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}

/// Bullet keeps the limits of its iterations to itself and its heirs.
class TunedSolver : public btDeformableBodySolver {
 public:
  explicit TunedSolver(const BulletSettings& settings) {
    m_maxNewtonIterations = settings.newton_iterations;
    m_newtonTolerance = 0;
    m_cg.m_maxIterations = settings.cg_iterations;
    m_cg.m_tolerance = static_cast<btScalar>(settings.cg_tolerance);
  }
};

}  // namespace

// In the order of construction: what comes later refers to what came before, and goes first.
struct BulletBody::Impl {
  Impl(const BulletSettings& settings, const IsotropicMaterial& material, const btVector3& gravity_m_s2)
      : dispatcher(&configuration),
        solver(settings),
        world(&dispatcher, &broadphase, &constraints, &configuration, &solver),
        elasticity(static_cast<btScalar>(shearModulus(material)), static_cast<btScalar>(lameLambda(material)),
                   0, 0),
        gravity(const_cast<btVector3&>(gravity_m_s2)) {}

  btSoftBodyRigidBodyCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher;
  btDbvtBroadphase broadphase;
  TunedSolver solver;
  btDeformableMultiBodyConstraintSolver constraints;
  btDeformableMultiBodyDynamicsWorld world;
  btDeformableLinearElasticityForce elasticity;
  btDeformableGravityForce gravity;
  std::unique_ptr<btSoftBody> body;
};

BulletBody::BulletBody(const Tetrahedra& tetrahedra, const Eigen::VectorXd& masses,
                       const std::vector<bool>& fixed, const IsotropicMaterial& material,
                       const Eigen::Vector3d& gravity_m_s2, const BulletSettings& settings) {
  const btVector3 gravity = toBullet(gravity_m_s2);
  impl_ = std::make_unique<Impl>(settings, material, gravity);
  impl_->constraints.setDeformableSolver(&impl_->solver);
  impl_->world.setGravity(gravity);
  btSoftBodyWorldInfo& info = impl_->world.getWorldInfo();
  info.m_gravity = gravity;
  info.m_maxDisplacement = 1000;  // a limit in a step, out of the way

  std::vector<btVector3> points;
  for (Eigen::Index i = 0; i < tetrahedra.points.cols(); ++i)
    points.push_back(toBullet(tetrahedra.points.col(i)));
  impl_->body = std::make_unique<btSoftBody>(&info, static_cast<int>(points.size()), points.data(), nullptr);
  btSoftBody& body = *impl_->body;
  for (const auto& [a, b, c, d] : tetrahedra.cells) body.appendTetra(a, b, c, d);
  body.initializeDmInverse();
  body.m_tetraScratches.resize(body.m_tetras.size());
  body.m_tetraScratchesTn.resize(body.m_tetras.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    body.setMass(static_cast<int>(i),
                 fixed[i] ? 0 : static_cast<btScalar>(masses[static_cast<Eigen::Index>(i)]));
  body.m_cfg.collisions = 0;
  body.m_cfg.drag = 0;
  body.m_cfg.kDP = 0;
  body.m_cfg.m_maxStress = 0;
  body.m_sleepingThreshold = 0;
  body.setSelfCollision(false);
  body.setActivationState(DISABLE_DEACTIVATION);
  impl_->world.addSoftBody(&body);
  impl_->world.addForce(&body, &impl_->elasticity);
  impl_->world.addForce(&body, &impl_->gravity);
  impl_->world.setImplicit(true);
  impl_->world.setLineSearch(false);
  // The other choice, Lagrange multipliers, divides by the masses of fixed vertices, which are zero.
  impl_->world.setUseProjection(true);
}

BulletBody::~BulletBody() {
  if (impl_) impl_->world.removeSoftBody(impl_->body.get());
}
BulletBody::BulletBody(BulletBody&&) noexcept = default;
BulletBody& BulletBody::operator=(BulletBody&&) noexcept = default;

void BulletBody::step(double time_step_s) {
  const auto h = static_cast<btScalar>(time_step_s);
  impl_->world.stepSimulation(h, 1, h);
}

Eigen::Matrix3Xd BulletBody::positions() const {
  const auto& nodes = impl_->body->m_nodes;
  Eigen::Matrix3Xd positions(3, nodes.size());
  for (int i = 0; i < nodes.size(); ++i)
    positions.col(i) = Eigen::Vector3d(nodes[i].m_x.x(), nodes[i].m_x.y(), nodes[i].m_x.z());
  return positions;
}

std::string BulletBody::version() {
  const int number = btGetVersion();
  return "Bullet " + std::to_string(number / 100) + "." + std::to_string(number % 100) +
         (sizeof(btScalar) == 4 ? ", single precision" : ", double precision");
}

}  // namespace polyscalpel::report
