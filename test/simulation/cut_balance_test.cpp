// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/cut_balance.hpp"

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"

namespace polyscalpel {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kMassFloor = 0.02;  // the scene's default
const IsotropicMaterial kMaterial{2e4, 0.4, 1100};
const Vector3d kSize(0.2, 0.1, 0.1);

PolyhedralMesh makeBody(bool tetrahedra) {
  const Eigen::Vector3i counts(4, 2, 2);
  return tetrahedra ? makeTetBox(Vector3d::Zero(), kSize, counts)
                    : makeHexBox(Vector3d::Zero(), kSize, counts);
}

/// A body in motion, and what a cut did to it as counted over all of it.
struct Body {
  PolyhedralMesh mesh;
  Assembly assembly;
  SimulationState state;
  std::mt19937 random;
  CuttingConfig cutting;
  int num_cuts = 0;

  Body(bool tetrahedra, const ElementConfig& config, double mass_floor, unsigned seed)
      : mesh(makeBody(tetrahedra)),
        assembly(mesh, kMaterial, config, mass_floor),
        state(makeRestState(mesh, {})),
        random(seed) {
    for (double& x : state.positions.reshaped()) x += 0.004 * uniform();
    for (double& v : state.velocities.reshaped()) v = uniform();
  }

  double uniform() { return std::uniform_real_distribution<double>(-1, 1)(random); }
  Vector3d vector() { return {uniform(), uniform(), uniform()}; }
  PlaneCut randomPlane() { return {0.5 * kSize + 0.4 * kSize.cwiseProduct(vector()), vector().normalized()}; }

  Matrix3Xd momenta() const {
    Matrix3Xd result;
    assembly.multiplyMass(state.velocities, result);
    return result;
  }
  Vector3d momentum() const { return momenta().rowwise().sum(); }
  Vector3d angularMomentum() const {
    const Matrix3Xd p = momenta();
    Vector3d sum = Vector3d::Zero();
    for (Eigen::Index i = 0; i < p.cols(); ++i)
      sum += Vector3d(state.positions.col(i)).cross(Vector3d(p.col(i)));
    return sum;
  }
  double kineticEnergy() const { return 0.5 * momenta().cwiseProduct(state.velocities).sum(); }
  /// What all momenta could sum up to: the measure of rounding.
  double momentumScale() const { return momenta().colwise().norm().sum(); }

  CutBalance cut(const CutOperation& operation, bool corrects = true) {
    const CutResult result = cutMesh(mesh, state.positions, operation, cutting, ++num_cuts);
    EXPECT_EQ(result.status, CutStatus::kCut) << result.message;
    const CutLedger ledger(state, assembly, result.change, corrects);
    applyMeshChange(state, result.change);
    assembly.update(mesh, result.change);
    return ledger.settle(mesh, result.change, assembly, state);
  }
};

TEST(CutBalance, EveryCutKeepsTheMomentumAndRaisesNoKineticEnergy) {
  for (const bool tetrahedra : {true, false}) {
    for (const bool consistent : {false, true}) {
      for (const double floor : {0.0, kMassFloor, 0.3}) {
        ElementConfig config;
        config.consistent_mass = consistent;
        Body body(tetrahedra, config, floor, 3);
        for (int i = 0; i < 6; ++i) {
          const Vector3d momentum = body.momentum(), angular = body.angularMomentum();
          const double kinetic = body.kineticEnergy(), scale = body.momentumScale();
          const double elastic = body.assembly.elasticEnergy(body.state.positions);
          const CutBalance balance = body.cut(body.randomPlane());
          EXPECT_LT((body.momentum() - momentum).norm(), 1e-12 * scale) << i;
          EXPECT_LE(body.kineticEnergy(), kinetic * (1 + 1e-12)) << i;
          EXPECT_GT(body.kineticEnergy(), 0.5 * kinetic) << i;
          // What it tells is what has happened.
          EXPECT_LT((balance.momentum_change - (body.momentum() - momentum)).norm(), 1e-12 * scale);
          EXPECT_LT((balance.angular_momentum_change - (body.angularMomentum() - angular)).norm(),
                    1e-12 * scale * kSize.norm());
          EXPECT_NEAR(balance.kinetic_energy_change_j, body.kineticEnergy() - kinetic, 1e-12 * kinetic);
          EXPECT_NEAR(balance.elastic_energy_after_j - balance.elastic_energy_before_j,
                      body.assembly.elasticEnergy(body.state.positions) - elastic, 1e-11 * elastic);
        }
      }
    }
  }
}

TEST(CutBalance, LinearTetsNeedNoCorrectionAndKeepTheirElasticEnergy) {
  for (const bool consistent : {false, true}) {
    ElementConfig config;
    config.consistent_mass = consistent;
    config.quadrature_points = 11;
    Body body(true, config, 0, 5), uncorrected(true, config, 0, 5);
    const Vector3d momentum = body.momentum();
    const double scale = body.momentumScale(), kinetic = body.kineticEnergy();
    const PlaneCut plane{{0.093, 0.052, 0.047}, {1, 0.4, 0.3}};
    const CutBalance balance = body.cut(plane);
    uncorrected.cut(plane, false);
    EXPECT_NEAR(balance.elastic_energy_after_j, balance.elastic_energy_before_j,
                1e-11 * balance.elastic_energy_before_j);
    EXPECT_GT(balance.elastic_energy_before_j, 0);
    EXPECT_LT((uncorrected.momentum() - momentum).norm(), 1e-12 * scale) << consistent;
    EXPECT_LE(uncorrected.kineticEnergy(), kinetic * (1 + 1e-12)) << consistent;
    EXPECT_LT((uncorrected.state.velocities - body.state.velocities).norm(),
              1e-11 * body.state.velocities.norm());
  }
}

TEST(CutBalance, ABodyThatMovesAsOneKeepsMovingAsOne) {
  for (const bool tetrahedra : {true, false}) {
    Body body(tetrahedra, ElementConfig(), kMassFloor, 7);
    // Flat caps, or cutting them again would change the volume, and with it the mass.
    body.state.positions = body.mesh.restPositions();
    body.cutting.snap_tolerance = 1e-6;
    const Vector3d velocity(3, -2, 5);
    body.state.velocities.colwise() = velocity;
    for (int i = 0; i < 4; ++i) body.cut(body.randomPlane());
    EXPECT_LT((body.state.velocities.colwise() - velocity).colwise().norm().maxCoeff(), 1e-11);
  }
}

TEST(CutBalance, EachPieceKeepsItsOwnMomentum) {
  Body body(false, ElementConfig(), kMassFloor, 9);
  body.cut(PlaneCut{{0.093, 0, 0}, {1, 0, 0}});
  const auto momentumLeft = [&] {
    const Matrix3Xd p = body.momenta();
    const Pieces pieces = findPieces(body.mesh);
    std::vector<char> is_left(body.mesh.numVertices(), 0);
    for (const CellId cell : body.mesh.cells()) {
      double x = 0;
      for (const VertexId v : body.mesh.cell(cell).vertices) x += body.mesh.restPosition(v).x() - 0.093;
      for (const VertexId v : body.mesh.cell(cell).vertices) is_left[v.index()] = x < 0;
    }
    Vector3d sum = Vector3d::Zero();
    for (int i = 0; i < body.mesh.numVertices(); ++i)
      if (is_left[i]) sum += p.col(i);
    return sum;
  };
  for (int i = 0; i < body.mesh.numVertices(); ++i)
    body.state.velocities.col(i).x() += body.state.positions(0, i) < 0.093 ? -10 : 10;
  const Vector3d left = momentumLeft();
  body.cut(PlaneCut{{0.1, 0.052, 0.047}, {0.1, 0.4, 1}});  // through both
  EXPECT_LT((momentumLeft() - left).norm(), 1e-12 * left.norm());
}

TEST(CutBalance, WhereVerticesAreHeldTheEnergyDoesNotRiseAndTheyStayAtRest) {
  for (const bool tetrahedra : {true, false}) {
    Body body(tetrahedra, ElementConfig(), kMassFloor, 11);
    for (int i = 0; i < body.mesh.numVertices(); ++i) {
      if (body.mesh.restPosition(VertexId(i)).z() > 0) continue;
      body.state.fixed[i] = true;
      body.state.velocities.col(i).setZero();
    }
    for (int i = 0; i < 6; ++i) {
      const double kinetic = body.kineticEnergy();
      body.cut(body.randomPlane());
      EXPECT_LE(body.kineticEnergy(), kinetic * (1 + 1e-12));
      for (int v = 0; v < body.mesh.numVertices(); ++v) {
        if (!body.state.fixed[v]) continue;
        EXPECT_TRUE(body.state.velocities.col(v).isZero(0));
      }
    }
  }
}

// Fast vertices beside the cut alone: a high mass floor brings mass to the vertices that it makes among them.
TEST(CutBalance, WhereTheKineticEnergyWouldRiseItIsTakenFromTheDifferencesOfVelocity) {
  for (const bool consistent : {false, true}) {
    ElementConfig config;
    config.consistent_mass = consistent;
    int num_rising = 0;
    for (unsigned seed = 1; seed <= 20; ++seed) {
      Body body(false, config, 0.5, seed), uncorrected(false, config, 0.5, seed);
      const PlaneCut plane = body.randomPlane();
      for (Body* b : {&body, &uncorrected}) {
        for (int i = 0; i < b->mesh.numVertices(); ++i) {
          const double distance =
              plane.normal_world.dot(Vector3d(b->state.positions.col(i)) - plane.point_world);
          b->state.velocities.col(i) = std::exp(-std::pow(distance / 0.01, 2)) * Vector3d(1, 2, 3);
        }
      }
      const Vector3d momentum = body.momentum();
      const double kinetic = body.kineticEnergy(), scale = body.momentumScale();
      uncorrected.cut(plane, false);
      num_rising += uncorrected.kineticEnergy() > 1.01 * kinetic;
      const CutBalance balance = body.cut(plane);
      EXPECT_LE(body.kineticEnergy(), kinetic * (1 + 1e-12)) << seed;
      EXPECT_NEAR(balance.kinetic_energy_change_j, body.kineticEnergy() - kinetic, 1e-12 * kinetic) << seed;
      EXPECT_LT((body.momentum() - momentum).norm(), 1e-12 * scale) << seed;
    }
    EXPECT_GT(num_rising, 0) << consistent;
  }
}

// The hexahedron's and its two parts' energies as quadratic forms of the hexahedron's displacements: same
// zeros, and a ratio between the extremes of their common eigenvalues. Over these planes, some as near to a
// vertex as the snap distance lets them be, the worst displacements have ratios of 0.55 and 10.9.
TEST(CutBalance, TheElasticEnergyOfAHexahedronsPartsIsBounded) {
  std::mt19937 random(13);
  std::uniform_real_distribution<double> uniform(-1, 1);
  ElementConfig config;
  config.strain = Strain::kLinear;
  double lowest = kInfinity, highest = 0;
  for (int i = 0; i < 100; ++i) {
    PolyhedralMesh mesh = makeHexBox(Vector3d::Zero(), Vector3d::Ones(), Eigen::Vector3i::Ones());
    const Vector3d point =
        Vector3d::Constant(0.5) + 0.45 * Vector3d(uniform(random), uniform(random), uniform(random));
    const Vector3d normal(uniform(random), uniform(random), uniform(random));
    const Eigen::MatrixXd K_before = [&] {
      const Assembly whole(mesh, kMaterial, config, 0);
      return stiffness(whole.elementMatrices(CellId(0)), kMaterial);
    }();
    const CutResult result = cutMesh(mesh, mesh.restPositions(), PlaneCut{point, normal}, CuttingConfig(), 1);
    if (result.cells_split == 0) continue;  // along a face
    Eigen::MatrixXd P = Eigen::MatrixXd::Zero(3 * mesh.numVertices(), 24);
    P.topRows(24).setIdentity();
    for (const NewVertex& v : result.change.new_vertices) {
      for (const auto& [parent, weight] :
           {std::pair(v.parents[0], 1 - v.weight), std::pair(v.parents[1], v.weight)})
        P.middleRows<3>(3 * v.vertex.index()) += weight * P.middleRows<3>(3 * parent.index());
    }
    const Assembly parts(mesh, kMaterial, config, 0);
    Eigen::MatrixXd K_after = Eigen::MatrixXd::Zero(24, 24);
    for (const CellId cell : mesh.cells()) {
      std::vector<int> rows;
      for (const VertexId v : mesh.cell(cell).vertices)
        for (int c = 0; c < 3; ++c) rows.push_back(3 * v.index() + c);
      const Eigen::MatrixXd local = P(rows, Eigen::all);
      K_after += local.transpose() * stiffness(parts.elementMatrices(cell), kMaterial) * local;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(K_before);
    EXPECT_LT(eigen.eigenvalues()[5], 1e-10 * eigen.eigenvalues()[23]);  // six rigid motions
    const Eigen::MatrixXd rigid = eigen.eigenvectors().leftCols(6);
    EXPECT_LT((K_after * rigid).norm(), 1e-10 * K_after.norm());
    const Eigen::MatrixXd scaled = eigen.eigenvectors().rightCols(18) *
                                   eigen.eigenvalues().tail(18).cwiseSqrt().cwiseInverse().asDiagonal();
    const Eigen::VectorXd ratios =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled.transpose() * K_after * scaled).eigenvalues();
    lowest = std::min(lowest, ratios[0]);
    highest = std::max(highest, ratios[17]);
  }
  EXPECT_GT(lowest, 0.5);
  EXPECT_LT(highest, 16);
}

}  // namespace
}  // namespace polyscalpel
