// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/assembly.hpp"

#include <algorithm>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "support/dense_matrices.hpp"
#include "support/small_bodies.hpp"

namespace polyscalpel {
namespace {

const IsotropicMaterial kMaterial{2e4, 0.4, 1100};

TEST(Assembly, SumsTheCellsMatricesAndForces) {
  for (const PolyhedralMesh& mesh : {makeTets(), makeHexes(), makePolyhedra()}) {
    for (const Strain strain : {Strain::kCorotated, Strain::kLinear}) {
      ElementConfig config;
      config.strain = strain;
      config.exact_force = false;
      Assembly assembly(mesh, kMaterial, config, 0);
      const Eigen::Matrix3Xd positions = someRotation() * shake(mesh, 0.005, 1);
      Eigen::MatrixXd matrix;
      Eigen::VectorXd expected;
      assembleDense(mesh, kMaterial, config, positions, matrix, expected);
      assembly.linearise(positions);
      Blocks blocks;
      assembly.assemble(0, 1, blocks);
      Eigen::Matrix3Xd forces;
      assembly.internalForces(positions, forces);
      EXPECT_LT((toDense(assembly.pattern(), blocks) - matrix).norm(), 1e-12 * matrix.norm());
      EXPECT_LT((forces.reshaped() - expected).norm(), 1e-12 * matrix.norm() * positions.norm());
    }
  }
}

TEST(Assembly, RigidMotionGivesNoForceAndNoEnergy) {
  const Eigen::Vector3d far_away(1e3, -2e3, 5e2);
  for (const PolyhedralMesh& mesh : {makeTets(), makePolyhedra()}) {
    Assembly assembly(mesh, kMaterial, ElementConfig(), 0);
    Blocks blocks;
    assembly.assemble(0, 1, blocks);
    const double scale = toDense(assembly.pattern(), blocks).norm();
    for (const Eigen::Vector3d& shift : {Eigen::Vector3d(0.3, 0.1, -0.2), far_away}) {
      const Eigen::Matrix3Xd positions = (someRotation() * mesh.restPositions()).colwise() + shift;
      const double rounding = 1e-15 * (shift.norm() + positions.norm());
      Eigen::Matrix3Xd forces;
      assembly.linearise(positions);
      assembly.internalForces(positions, forces);
      EXPECT_LT(forces.norm(), 100 * scale * rounding);
      EXPECT_LT(assembly.elasticEnergy(positions), 100 * scale * rounding * rounding);
      EXPECT_GE(assembly.elasticEnergy(positions), 0);
    }
  }
}

TEST(Assembly, ForceIsLinearInPositionsUnderHeldRotations) {
  const PolyhedralMesh mesh = makePolyhedra();
  Assembly assembly(mesh, kMaterial, ElementConfig(), 0);
  const Eigen::Matrix3Xd a = shake(mesh, 0.01, 2), b = shake(mesh, 0.01, 3);
  assembly.linearise(a);
  Blocks blocks;
  assembly.assemble(0, 1, blocks);
  Eigen::Matrix3Xd force_a, force_b;
  assembly.internalForces(a, force_a);
  assembly.internalForces(b, force_b);
  const Eigen::Matrix3Xd expected = multiply(assembly.pattern(), blocks, b - a);
  EXPECT_LT((force_b - force_a - expected).norm(), 1e-12 * expected.norm());
}

TEST(Assembly, LinearEnergyIsTheQuadraticForm) {
  ElementConfig config;
  config.strain = Strain::kLinear;
  const PolyhedralMesh mesh = makePolyhedra();
  Assembly assembly(mesh, kMaterial, config, 0);
  const Eigen::Matrix3Xd positions = shake(mesh, 0.01, 4), u = positions - mesh.restPositions();
  Blocks blocks;
  assembly.assemble(0, 1, blocks);
  const double expected = 0.5 * u.cwiseProduct(multiply(assembly.pattern(), blocks, u)).sum();
  EXPECT_NEAR(assembly.elasticEnergy(positions), expected, 1e-12 * expected);
}

TEST(Assembly, MassSumsToDensityTimesVolume) {
  for (const PolyhedralMesh& mesh : {makeTets(), makePolyhedra()}) {
    for (const bool consistent : {true, false}) {
      ElementConfig config;
      config.consistent_mass = consistent;
      Assembly assembly(mesh, kMaterial, config, 0);
      const double total = 1100 * 0.2 * 0.1 * 0.1;
      EXPECT_NEAR(assembly.vertexMasses().sum(), total, 1e-12 * total);
      EXPECT_EQ(assembly.movedMass_kg(), 0);
      Eigen::Matrix3Xd product;
      assembly.multiplyMass(Eigen::Matrix3Xd::Ones(3, mesh.numVertices()), product);
      EXPECT_LT((product.row(1).transpose() - assembly.vertexMasses()).norm(), 1e-12 * total);
      Blocks blocks;
      assembly.assemble(1, 0, blocks);
      const Eigen::Matrix3Xd values = Eigen::Matrix3Xd::Random(3, mesh.numVertices());
      assembly.multiplyMass(values, product);
      EXPECT_LT((multiply(assembly.pattern(), blocks, values) - product).norm(),
                1e-14 * total * values.norm());
    }
  }
}

TEST(Assembly, FollowsACutAsIfMadeAnew) {
  for (const bool tetrahedra : {true, false}) {
    for (const bool consistent : {true, false}) {
      ElementConfig config;
      config.consistent_mass = consistent;
      PolyhedralMesh mesh = tetrahedra ? makeTets() : makeHexes();
      Assembly assembly(mesh, kMaterial, config, 0);
      const PlaneCut planes[] = {{{0.093, 0.052, 0.047}, {1, 0.4, 0.3}},
                                 {{0.1, 0.048, 0.05}, {0.2, 1, -0.3}}};
      int cut = 0;
      for (const PlaneCut& plane : planes) {
        const CutResult result = cutMesh(mesh, mesh.restPositions(), plane, CuttingConfig(), ++cut);
        ASSERT_EQ(result.status, CutStatus::kCut) << result.message;
        assembly.update(mesh, result.change);
      }
      Assembly anew(mesh, kMaterial, config, 0);
      EXPECT_EQ(assembly.pattern().row, anew.pattern().row);
      EXPECT_EQ(assembly.pattern().column_start, anew.pattern().column_start);
      EXPECT_EQ(assembly.vertexMasses(), anew.vertexMasses());
      const Eigen::Matrix3Xd positions = shake(mesh, 0.003, 5);
      assembly.linearise(positions);
      anew.linearise(positions);
      Blocks blocks, blocks_anew;
      assembly.assemble(2, 3, blocks);
      anew.assemble(2, 3, blocks_anew);
      EXPECT_EQ(blocks, blocks_anew);
      Eigen::Matrix3Xd forces, forces_anew;
      assembly.internalForces(positions, forces);
      anew.internalForces(positions, forces_anew);
      EXPECT_EQ(forces, forces_anew);
    }
  }
}

TEST(Assembly, FollowsManySmallCutsAsIfMadeAnew) {
  // Room that cells have left behind is used up again and again on the way.
  PolyhedralMesh mesh = makeTets();
  Assembly assembly(mesh, kMaterial, {}, 0);
  std::mt19937 engine(9);
  int num_cuts = 0;
  for (int i = 0; i < 30; ++i) {
    const PolygonCut square = someSquare(engine, {0.2, 0.1, 0.1}, 0.04);
    const CutResult result = cutMesh(mesh, mesh.restPositions(), square, CuttingConfig(), i + 1);
    if (result.status != CutStatus::kCut) continue;
    ++num_cuts;
    assembly.update(mesh, result.change);
    const Eigen::Matrix3Xd positions = shake(mesh, 1e-4, i);
    assembly.linearise(positions);
    Blocks blocks, blocks_anew;
    assembly.assemble(2, 3, blocks);
    Eigen::Matrix3Xd forces, forces_anew;
    assembly.internalForces(positions, forces);
    Assembly anew(mesh, kMaterial, {}, 0);
    anew.linearise(positions);
    anew.assemble(2, 3, blocks_anew);
    anew.internalForces(positions, forces_anew);
    ASSERT_EQ(assembly.pattern().row, anew.pattern().row);
    ASSERT_EQ(blocks, blocks_anew) << i;
    ASSERT_EQ(forces, forces_anew) << i;
    ASSERT_EQ(assembly.vertexMasses(), anew.vertexMasses());
    ASSERT_EQ(assembly.elasticEnergy(positions), anew.elasticEnergy(positions));
  }
  EXPECT_GT(num_cuts, 15);
}

TEST(Assembly, ACutKeepsTheKindOfItsCells) {
  PolyhedralMesh mesh = makeHexes();
  const auto kindAt = [&](CellId cell) {
    double x = 0;
    const std::vector<VertexId>& vertices = mesh.cell(cell).vertices;
    for (const VertexId vertex : vertices) x += mesh.restPosition(vertex).x();
    return x < 0.1 * static_cast<double>(vertices.size()) ? 0 : 1;
  };
  CellKinds kinds;
  kinds.kinds = {{kMaterial, {}}, {{1e6, 0.3, 3000}, {}}};
  kinds.kinds[1].element.formulation = Formulation::kVirtual;
  kinds.of_cell.resize(mesh.cellCapacity());
  for (const CellId cell : mesh.cells()) kinds.of_cell[cell.index()] = kindAt(cell);
  Assembly assembly(mesh, kinds, 0);
  const double mass = assembly.vertexMasses().sum();
  EXPECT_NEAR(mass, 0.5 * (1100 + 3000) * 0.2 * 0.1 * 0.1, 1e-12);
  const PlaneCut planes[] = {{{0.093, 0.052, 0.047}, {1, 0.4, 0.3}}, {{0.1, 0.048, 0.05}, {0.2, 1, -0.3}}};
  int cut = 0;
  for (const PlaneCut& plane : planes) {
    const CutResult result = cutMesh(mesh, mesh.restPositions(), plane, CuttingConfig(), ++cut);
    ASSERT_EQ(result.status, CutStatus::kCut) << result.message;
    assembly.update(mesh, result.change);
  }
  int in_second = 0;
  for (const CellId cell : mesh.cells()) {
    EXPECT_EQ(assembly.kindOf(cell), kindAt(cell));  // no cell crosses the border at x = 0.1
    in_second += assembly.kindOf(cell);
  }
  EXPECT_GT(in_second, 8);
  EXPECT_NEAR(assembly.vertexMasses().sum(), mass, 1e-12);
}

std::vector<bool> touchedBy(const MeshChange& change, const PolyhedralMesh& mesh) {
  std::vector<bool> touched(mesh.numVertices(), false);
  const auto touch = [&](CellId cell) {
    for (const VertexId vertex : mesh.cell(cell).vertices) touched[vertex.index()] = true;
  };
  for (const NewCell& cell : change.new_cells) touch(cell.cell);
  for (const CellId cell : change.changed_cells) touch(cell);
  return touched;
}

TEST(Assembly, MassFloorHoldsWhereACutHasBeenAndNowhereElse) {
  constexpr double kFloor = 0.2;  // high, so that some of the cut's vertices are below it
  PolyhedralMesh mesh = makeTets();
  Assembly assembly(mesh, kMaterial, ElementConfig(), kFloor), plain(mesh, kMaterial, ElementConfig(), 0);
  const Eigen::VectorXd masses_before = assembly.vertexMasses();
  EXPECT_EQ(masses_before, plain.vertexMasses());
  std::vector<double> sorted(masses_before.begin(), masses_before.end());
  std::sort(sorted.begin(), sorted.end());
  const double lowest = kFloor * sorted[sorted.size() / 2];

  const CutResult result =
      cutMesh(mesh, mesh.restPositions(), PlaneCut{{0.06, 0, 0}, {1, 0.1, 0.05}}, CuttingConfig(), 1);
  ASSERT_EQ(result.status, CutStatus::kCut) << result.message;
  assembly.update(mesh, result.change);
  plain.update(mesh, result.change);
  const std::vector<bool> touched = touchedBy(result.change, mesh);
  EXPECT_LT(plain.vertexMasses().minCoeff(), lowest);  // or the floor has nothing to do
  for (int i = 0; i < mesh.numVertices(); ++i) {
    if (touched[i]) {
      EXPECT_GE(assembly.vertexMasses()[i], lowest * (1 - 1e-12));
    } else {
      EXPECT_EQ(assembly.vertexMasses()[i], masses_before[i]);
    }
  }
  EXPECT_GT(assembly.movedMass_kg(), 0);
}

// Also where a sliver of a piece has less in all than the floor would want of it.
TEST(Assembly, MassFloorKeepsTheMassOfEveryPiece) {
  for (const double floor : {0.0, 0.02, 0.3, 1.0}) {
    PolyhedralMesh mesh = makeHexes();
    Assembly assembly(mesh, kMaterial, ElementConfig(), floor);
    const PlaneCut planes[] = {{{0.093, 0.052, 0.047}, {1, 0.4, 0.3}},
                               {{0.096, 0.052, 0.047}, {1, 0.4, 0.3}},
                               {{0.1, 0.048, 0.05}, {0.2, 1, -0.3}}};
    int cut = 0;
    for (const PlaneCut& plane : planes) {
      const CutResult result = cutMesh(mesh, mesh.restPositions(), plane, CuttingConfig(), ++cut);
      ASSERT_EQ(result.status, CutStatus::kCut) << result.message;
      assembly.update(mesh, result.change);
    }
    const Pieces pieces = findPieces(mesh);
    ASSERT_EQ(pieces.count, 6);
    std::vector<double> expected(pieces.count, 0), found(pieces.count, 0);
    std::vector<int> piece_of_vertex(mesh.numVertices(), -1);
    for (const CellId cell : mesh.cells()) {
      const int piece = pieces.piece_of_cell[cell.index()];
      expected[piece] += kMaterial.density_kg_m3 * volume(makeCellSurface(mesh, cell, mesh.restPositions()));
      for (const VertexId vertex : mesh.cell(cell).vertices) piece_of_vertex[vertex.index()] = piece;
    }
    for (int i = 0; i < mesh.numVertices(); ++i) {
      found[piece_of_vertex[i]] += assembly.vertexMasses()[i];
      EXPECT_GT(assembly.vertexMasses()[i], 0);
    }
    for (int piece = 0; piece < pieces.count; ++piece) {
      EXPECT_NEAR(found[piece], expected[piece], 1e-12 * expected[piece]) << floor << ", piece " << piece;
    }
  }
}

TEST(Assembly, RefusesBadConfig) {
  const PolyhedralMesh mesh = makeHexes();
  EXPECT_THROW(Assembly(mesh, {-1, 0.4, 1000}, ElementConfig(), 0), std::invalid_argument);
  EXPECT_THROW(Assembly(mesh, kMaterial, ElementConfig(), -0.1), std::invalid_argument);
  EXPECT_THROW(Assembly(mesh, kMaterial, ElementConfig(), 1.1), std::invalid_argument);
  ElementConfig config;
  config.quadrature_points = 7;
  EXPECT_THROW(Assembly(mesh, kMaterial, config, 0), std::invalid_argument);
}

}  // namespace
}  // namespace polyscalpel
