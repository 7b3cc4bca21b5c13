// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/time_integration.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "support/small_bodies.hpp"

namespace polyscalpel {
namespace {

const IsotropicMaterial kMaterial{1e5, 0.4, 1000};

/// A contact in the middle of the first boundary face that satisfies `wanted`.
template <class Predicate>
LinearisedContact makeContact(const PolyhedralMesh& mesh, const Predicate& wanted,
                              const Eigen::Vector3d& force_0) {
  LinearisedContact contact;
  for (int f = 0; f < mesh.faceCapacity(); ++f) {
    const Face& face = mesh.face(FaceId(f));
    if (!face.isAlive() || !face.isBoundary() || !wanted(virtualVertex(face, mesh.restPositions()))) continue;
    contact.contact.face = FaceId(f);
    contact.contact.weights = vertexWeights(face, 0, {0.5, 0.3, 0.2});
    break;
  }
  EXPECT_FALSE(contact.contact.weights.empty());
  contact.contact.normal_world = -Eigen::Vector3d::UnitZ();
  contact.force_0 = force_0;
  contact.B = Eigen::Vector3d(0.2, 0.3, 2).asDiagonal();
  return contact;
}

const auto on_top = [](const Eigen::Vector3d& X) { return X.z() > 0.0999; };

// Without the solver's algebra: the step must satisfy
// M (v1 - v0) / h + a M v1 + f(x0 + (h + b) v1; R(x0)) = M g + contact forces at every free vertex.
TEST(ImplicitEuler, SatisfiesItsEquationOfMotion) {
  for (const bool consistent : {true, false}) {
    const PolyhedralMesh mesh = makePolyhedra();
    ElementConfig element;
    element.consistent_mass = consistent;
    Assembly assembly(mesh, kMaterial, element, 0.02);
    IntegrationConfig config;
    ImplicitEuler integrator(config);
    SimulationState state = makeRestState(mesh, {FixedBox{{0, 0, 0}, {0, 1, 1}}});
    const std::vector<LinearisedContact> contacts = {makeContact(mesh, on_top, {0.1, 0.2, -3})};
    const double h = config.time_step_s, a = config.mass_damping_per_s, b = config.stiffness_damping_s;
    for (int step = 0; step < 5; ++step) {
      const SimulationState before = state;
      const IntegrationResult result = integrator.step(state, assembly, contacts);
      ASSERT_EQ(result.status, SolveStatus::kSolved);
      EXPECT_LT(result.relative_residual, 1e-10);
      EXPECT_EQ(state.positions, before.positions + h * state.velocities);
      assembly.linearise(before.positions);
      Eigen::Matrix3Xd inertia, internal;
      assembly.multiplyMass(
          ((state.velocities - before.velocities) / h + a * state.velocities).colwise() - config.gravity_m_s2,
          inertia);
      assembly.internalForces(before.positions + (h + b) * state.velocities, internal);
      Eigen::Matrix3Xd unbalanced = inertia + internal;
      for (const WeightedVertex& w : contacts[0].contact.weights) {
        unbalanced.col(w.vertex.index()) -= w.weight * result.contact_forces[0];
      }
      for (int i = 0; i < mesh.numVertices(); ++i) {
        if (state.fixed[i]) {
          EXPECT_EQ(state.positions.col(i), before.positions.col(i));
          EXPECT_TRUE(state.velocities.col(i).isZero(0));
        } else {
          EXPECT_LT(unbalanced.col(i).norm(), 1e-9 * internal.norm()) << i;
        }
      }
    }
  }
}

TEST(ImplicitEuler, FreeBodyKeepsItsMomentum) {
  const PolyhedralMesh mesh = makeTetBall({0, 0, 0}, 0.05, 2);
  Assembly assembly(mesh, kMaterial, ElementConfig(), 0.02);
  IntegrationConfig config;
  config.gravity_m_s2.setZero();
  config.mass_damping_per_s = 0;
  ImplicitEuler integrator(config);
  SimulationState state = makeRestState(mesh, {});
  for (int i = 0; i < mesh.numVertices(); ++i) {
    const Eigen::Vector3d X = mesh.restPosition(VertexId(i));
    state.velocities.col(i) = Eigen::Vector3d(0.3, -0.2, 0.1) + Eigen::Vector3d(3, 1, -5).cross(X) + 4 * X;
  }
  const Eigen::Vector3d momentum = state.velocities * assembly.vertexMasses();
  for (int step = 0; step < 50; ++step) {
    ASSERT_EQ(integrator.step(state, assembly, {}).status, SolveStatus::kSolved);
    EXPECT_LT((state.velocities * assembly.vertexMasses() - momentum).norm(), 1e-11 * momentum.norm());
  }
}

TEST(ImplicitEuler, FreeBodyFallsAsAPoint) {
  const PolyhedralMesh mesh = makePolyhedra();
  Assembly assembly(mesh, kMaterial, ElementConfig(), 0.02);
  IntegrationConfig config;
  config.mass_damping_per_s = 0;
  ImplicitEuler integrator(config);
  SimulationState state = makeRestState(mesh, {});
  for (int step = 1; step <= 20; ++step) {
    ASSERT_EQ(integrator.step(state, assembly, {}).status, SolveStatus::kSolved);
    const Eigen::Vector3d fallen =
        config.gravity_m_s2 * config.time_step_s * config.time_step_s * step * (step + 1) / 2;
    EXPECT_LT(((state.positions - mesh.restPositions()).colwise() - fallen).norm(), 1e-10);
  }
}

// By conjugate gradients in single precision, slivers among them.
TEST(ImplicitEuler, LoosePiecesFallWithoutATurn) {
  PolyhedralMesh mesh = makeTetBox({0, 0, 0}, {0.1, 0.1, 0.1}, {3, 3, 3});
  std::mt19937 engine(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto someVector = [&] { return Eigen::Vector3d(uniform(engine), uniform(engine), uniform(engine)); };
  for (int k = 1; k <= 45; ++k) {
    const PlaneCut plane{0.05 * someVector() + Eigen::Vector3d(0.05, 0.05, 0.09), someVector()};
    ASSERT_NE(cutMesh(mesh, mesh.restPositions(), plane, CuttingConfig(), k).status, CutStatus::kRefused);
  }
  IntegrationConfig config;
  config.mass_damping_per_s = 0;
  SolverConfig solver;
  solver.tolerance = 1e-5;
  ImplicitEuler integrator(config, solver);
  Assembly assembly(mesh, kMaterial, ElementConfig(), 0);
  SimulationState state = makeRestState(mesh, {FixedBox{{0, 0, 0}, {1, 1, 0}}});
  constexpr int kSteps = 10;
  for (int step = 0; step < kSteps; ++step)
    ASSERT_EQ(integrator.step(state, assembly, {}).status, SolveStatus::kSolved);
  const Eigen::Vector3d fallen =
      config.gravity_m_s2 * config.time_step_s * config.time_step_s * kSteps * (kSteps + 1) / 2;
  const Pieces pieces = findPieces(mesh);
  std::vector<bool> is_held(pieces.count, false);
  for (const CellId cell : mesh.cells()) {
    for (const VertexId vertex : mesh.cell(cell).vertices) {
      if (state.fixed[vertex.index()]) is_held[pieces.piece_of_cell[cell.index()]] = true;
    }
  }
  EXPECT_GT(std::count(is_held.begin(), is_held.end(), false), 20);
  double farthest = 0;
  for (const CellId cell : mesh.cells()) {
    if (is_held[pieces.piece_of_cell[cell.index()]]) continue;
    for (const VertexId vertex : mesh.cell(cell).vertices) {
      const Eigen::Vector3d way = state.positions.col(vertex.index()) - mesh.restPosition(vertex);
      farthest = std::max(farthest, (way - fallen).norm());
    }
  }
  EXPECT_LT(farthest, 5e-5 * fallen.norm());
}

// Backward Euler takes energy out of every linear system, damped or not.
TEST(ImplicitEuler, EnergyOfALinearBodyDecays) {
  const PolyhedralMesh mesh = makePolyhedra();
  ElementConfig element;
  element.strain = Strain::kLinear;
  Assembly assembly(mesh, kMaterial, element, 0.02);
  IntegrationConfig config;
  config.mass_damping_per_s = 0;
  config.stiffness_damping_s = 0;
  ImplicitEuler integrator(config);
  SimulationState state = makeRestState(mesh, {FixedBox{{0, 0, 0}, {0, 1, 1}}});
  const auto energy = [&] {
    Eigen::Matrix3Xd momenta;
    assembly.multiplyMass(state.velocities, momenta);
    return 0.5 * momenta.cwiseProduct(state.velocities).sum() + assembly.elasticEnergy(state.positions) -
           assembly.vertexMasses().dot(state.positions.transpose() * config.gravity_m_s2);
  };
  const double first = energy();
  double last = first;
  for (int step = 0; step < 100; ++step) {
    ASSERT_EQ(integrator.step(state, assembly, {}).status, SolveStatus::kSolved);
    const double now = energy();
    EXPECT_LE(now, last + 1e-12 * std::abs(first));
    last = now;
  }
  EXPECT_LT(last, first);
}

// The factor of a linear body is kept between steps; contacts in between must not leave theirs behind.
TEST(ImplicitEuler, KeptFactorGivesTheSameBitsAsANewOne) {
  const PolyhedralMesh mesh = makePolyhedra();
  ElementConfig element;
  element.strain = Strain::kLinear;
  Assembly assembly(mesh, kMaterial, element, 0.02);
  ImplicitEuler keeping{IntegrationConfig()};
  SimulationState state = makeRestState(mesh, {FixedBox{{0, 0, 0}, {0, 1, 1}}});
  SimulationState other = state;
  const LinearisedContact contact = makeContact(mesh, on_top, {0, 0, -1});
  for (int step = 0; step < 9; ++step) {
    std::vector<LinearisedContact> contacts;
    if (step % 3 == 1) contacts.push_back(contact);
    ImplicitEuler anew{IntegrationConfig()};
    ASSERT_EQ(keeping.step(state, assembly, contacts).status, SolveStatus::kSolved);
    ASSERT_EQ(anew.step(other, assembly, contacts).status, SolveStatus::kSolved);
    EXPECT_EQ(state.positions, other.positions) << step;
    EXPECT_EQ(state.velocities, other.velocities) << step;
  }
}

TEST(ImplicitEuler, LetsGoOfAContactThatWouldPull) {
  const PolyhedralMesh mesh = makePolyhedra();
  Assembly assembly(mesh, kMaterial, ElementConfig(), 0.02);
  const SimulationState rest = makeRestState(mesh, {FixedBox{{0, 0, 0}, {0, 1, 1}}});
  const LinearisedContact pulling = makeContact(mesh, on_top, {0, 0, 5});
  const LinearisedContact pushing =
      makeContact(mesh, [](const Eigen::Vector3d& X) { return X.z() > 0.0999 && X.x() > 0.15; }, {0, 0, -5});

  IntegrationConfig config;
  SimulationState state = rest;
  IntegrationResult result = ImplicitEuler(config).step(state, assembly, {pulling, pushing});
  ASSERT_EQ(result.status, SolveStatus::kSolved);
  EXPECT_EQ(result.solves, 2);
  EXPECT_TRUE(result.contact_forces[0].isZero(0));
  EXPECT_LT(result.contact_forces[1].z(), 0);
  SimulationState without = rest;
  IntegrationResult alone = ImplicitEuler(config).step(without, assembly, {pushing});
  EXPECT_EQ(alone.solves, 1);
  EXPECT_EQ(state.positions, without.positions);
  EXPECT_EQ(result.contact_forces[1], alone.contact_forces[0]);

  config.contact_iterations = 1;  // no solve left to let go: acts as solved
  state = rest;
  result = ImplicitEuler(config).step(state, assembly, {pulling, pushing});
  ASSERT_EQ(result.status, SolveStatus::kSolved);
  EXPECT_EQ(result.solves, 1);
  EXPECT_GT(result.contact_forces[0].z(), 0);
}

// A spring of negative stiffness is held by the mass in short steps alone.
TEST(ImplicitEuler, AStepThatFailsIsMadeOfShorterOnes) {
  const PolyhedralMesh mesh = makePolyhedra();
  Assembly assembly(mesh, kMaterial, ElementConfig(), 0.02);
  IntegrationConfig config;
  config.stiffness_damping_s = 0;
  const SimulationState before = makeRestState(mesh, {FixedBox{{0, 0, 0}, {0, 1, 1}}});
  LinearisedContact negative = makeContact(mesh, on_top, {0, 0, -1});
  for (const SolverKind kind : {SolverKind::kDirect, SolverKind::kAuto}) {
    SolverConfig solver;
    solver.kind = kind;
    IntegrationResult result;
    SimulationState state;
    for (double stiffness = 1; stiffness < 1e4 && result.half_steps == 0; stiffness *= 1.1) {
      negative.B = -stiffness * Eigen::Matrix3d::Identity();
      state = before;
      result = ImplicitEuler(config, solver).step(state, assembly, {negative});
      ASSERT_EQ(result.status, SolveStatus::kSolved) << stiffness;
    }
    EXPECT_GE(result.half_steps, 2);
    EXPECT_TRUE(state.positions.allFinite());
    EXPECT_GT((state.positions - before.positions).norm(), 0);
  }
}

TEST(ImplicitEuler, StateStaysWhenTheSolverFails) {
  const PolyhedralMesh mesh = makePolyhedra();
  Assembly assembly(mesh, kMaterial, ElementConfig(), 0.02);
  IntegrationConfig config;
  SimulationState state = makeRestState(mesh, {FixedBox{{0, 0, 0}, {0, 1, 1}}});
  ImplicitEuler integrator(config);
  ASSERT_EQ(integrator.step(state, assembly, {}).status, SolveStatus::kSolved);
  const SimulationState before = state;

  LinearisedContact negative = makeContact(mesh, on_top, {0, 0, -1});
  negative.B = -1e6 * Eigen::Matrix3d::Identity();
  EXPECT_EQ(integrator.step(state, assembly, {negative}).status, SolveStatus::kNotPositiveDefinite);
  EXPECT_EQ(state.positions, before.positions);
  EXPECT_EQ(state.velocities, before.velocities);

  LinearisedContact endless = makeContact(mesh, on_top, {0, 0, -kInfinity});
  EXPECT_EQ(integrator.step(state, assembly, {endless}).status, SolveStatus::kNotFinite);
  EXPECT_EQ(state.positions, before.positions);
  EXPECT_EQ(state.velocities, before.velocities);

  // And goes on as if nothing had happened.
  SimulationState other = before;
  ASSERT_EQ(integrator.step(state, assembly, {}).status, SolveStatus::kSolved);
  ASSERT_EQ(ImplicitEuler(config).step(other, assembly, {}).status, SolveStatus::kSolved);
  EXPECT_EQ(state.positions, other.positions);
}

}  // namespace
}  // namespace polyscalpel
