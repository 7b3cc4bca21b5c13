// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/corotated_body.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "polyscalpel/elements/assembly.hpp"
#include "support/dense_matrices.hpp"
#include "support/small_bodies.hpp"

namespace polyscalpel {
namespace {

const IsotropicMaterial kMaterial{2e4, 0.4, 1100};

ElementConfig withMass(bool consistent) {
  ElementConfig config;
  config.consistent_mass = consistent;
  return config;
}

struct Shape {
  std::string name;
  Eigen::Matrix3Xd positions;
};

/// Deformations from mild to absurd.
std::vector<Shape> makeShapes(const PolyhedralMesh& mesh) {
  std::vector<Shape> shapes = {{"rest", mesh.restPositions()},
                               {"shaken", someRotation() * shake(mesh, 0.005, 1)},
                               {"partly inverted", someRotation() * shake(mesh, 0.04, 2)},
                               {"mirrored", someRotation() * shake(mesh, 0.003, 3)},
                               {"flat", shake(mesh, 0.005, 4)},
                               {"stretched", shake(mesh, 0.005, 5)}};
  shapes[3].positions.row(1) *= -1;
  shapes[4].positions.row(2).setConstant(0.1);
  shapes[5].positions.row(0) *= 100;
  return shapes;
}

/// The same cell by cell. rotations: of mesh.cells() in their order.
void sumCells(const PolyhedralMesh& mesh, const Assembly& assembly, const Eigen::Matrix3Xd& positions,
              const Eigen::Matrix3Xd& ahead, bool exact_force, Eigen::Matrix3Xd& forces,
              std::vector<Eigen::Matrix3d>& rotations) {
  forces.setZero(3, mesh.numVertices());
  rotations.clear();
  for (const CellId id : mesh.cells()) {
    const ElementMatrices& element = assembly.elementMatrices(id);
    const std::vector<int> vertices = indicesOf(mesh.cell(id).vertices);
    const CellView cell{element.volume,
                        {lameLambda(kMaterial), shearModulus(kMaterial)},
                        element.mean_gradient,
                        element.stabilisation.isEmpty() ? nullptr : &element.stabilisation};
    CellWorkspace work(static_cast<int>(vertices.size()));
    const Eigen::Vector3d origin = positions.col(vertices.front());
    const Eigen::Matrix3Xd x = positions(Eigen::all, vertices).colwise() - origin;
    const Eigen::Matrix3Xd x_ahead = ahead(Eigen::all, vertices).colwise() - origin;
    const CellLinearisation linearisation = linearise(corotatedStrain(), cell, x, exact_force, work);
    Eigen::Matrix3Xd own = Eigen::Matrix3Xd::Zero(3, x.cols());
    addForces(linearisation, cell, x_ahead, work, own);
    forces(Eigen::all, vertices) += own;
    rotations.push_back(linearisation.R);
  }
}

TEST(CorotatedBody, ForcesAndRotationsAreThoseOfTheCells) {
  for (const PolyhedralMesh& mesh : {makeTets(), makeHexes(), makePolyhedra()}) {
    Assembly assembly(mesh, kMaterial, {}, 0);
    CorotatedBody& body = *assembly.corotatedBody();
    for (const bool exact_force : {true, false}) {
      for (const Shape& shape : makeShapes(mesh)) {
        const Eigen::Matrix3Xd ahead = shake(shape.positions, 0.002, 9);
        Eigen::Matrix3Xd expected, forces;
        std::vector<Eigen::Matrix3d> rotations;
        sumCells(mesh, assembly, shape.positions, ahead, exact_force, expected, rotations);
        body.linearise(shape.positions, exact_force);
        body.internalForces(ahead, forces);
        EXPECT_LT((forces - expected).norm(), 1e-11 * expected.norm()) << shape.name << exact_force;
        std::size_t k = 0;
        for (const CellId cell : mesh.cells())
          EXPECT_LT((body.rotationOf(cell) - rotations[k++]).norm(), 1e-11) << shape.name;
      }
    }
  }
}

TEST(CorotatedBody, LinearisesAndSumsForcesInOneGo) {
  for (const PolyhedralMesh& mesh : {makeTets(), makeHexes(), makePolyhedra()}) {
    Assembly assembly(mesh, kMaterial, {}, 0);
    CorotatedBody at_once = *assembly.corotatedBody(), one_by_one = at_once;
    for (const bool exact_force : {true, false}) {
      for (const Shape& shape : makeShapes(mesh)) {
        const Eigen::Matrix3Xd ahead = shake(shape.positions, 0.002, 9);
        Eigen::Matrix3Xd forces, forces_at_once;
        one_by_one.linearise(shape.positions, exact_force);
        one_by_one.internalForces(ahead, forces);
        at_once.lineariseWithForces(shape.positions, ahead, exact_force, forces_at_once);
        EXPECT_EQ(forces_at_once, forces) << shape.name;
        for (const CellId cell : mesh.cells())
          EXPECT_EQ(at_once.rotationOf(cell), one_by_one.rotationOf(cell));
        DifferenceMatrix<float> matrix, matrix_at_once;
        one_by_one.assemble(assembly.vertexMasses(), 2, 3, matrix);
        at_once.assemble(assembly.vertexMasses(), 2, 3, matrix_at_once);
        EXPECT_EQ(matrix_at_once.blocks, matrix.blocks) << shape.name;
      }
    }
  }
}

TEST(CorotatedBody, AssemblesTheSumOfItsCells) {
  for (const PolyhedralMesh& mesh : {makeTets(), makeHexes(), makePolyhedra()}) {
    for (const bool consistent : {true, false}) {
      const ElementConfig config = withMass(consistent);
      Assembly assembly(mesh, kMaterial, config, 0);
      CorotatedBody& body = *assembly.corotatedBody();
      const Eigen::MatrixXd M = massDense(mesh, kMaterial, config);
      for (const Shape& shape : makeShapes(mesh)) {
        Eigen::MatrixXd K;
        Eigen::VectorXd forces;
        assembleDense(mesh, kMaterial, config, shape.positions, K, forces);
        body.linearise(shape.positions, true);
        // Either part alone, and both as a step weighs them.
        for (const auto& [mass_scale, stiffness_scale] : {std::pair{1.0, 0.0}, {0.0, 1.0}, {1.1, 3e-4}}) {
          const Eigen::MatrixXd expected = mass_scale * M + stiffness_scale * K;
          DifferenceMatrix<double> matrix;
          body.assemble(assembly.vertexMasses(), mass_scale, stiffness_scale, matrix);
          EXPECT_LT((toDense(body.pattern(), matrix) - expected).norm(), 1e-12 * expected.norm())
              << shape.name;
        }
      }
    }
  }
}

TEST(CorotatedBody, SinglePrecisionIsTheSameButForRounding) {
  for (const PolyhedralMesh& mesh : {makeTets(), makeHexes(), makePolyhedra()}) {
    Assembly assembly(mesh, kMaterial, withMass(true), 0);
    CorotatedBody& body = *assembly.corotatedBody();
    for (const Shape& shape : makeShapes(mesh)) {
      body.linearise(shape.positions, true);
      DifferenceMatrix<double> matrix;
      DifferenceMatrix<float> single;
      body.assemble(assembly.vertexMasses(), 1.1, 3e-4, matrix);
      body.assemble(assembly.vertexMasses(), 1.1, 3e-4, single);
      constexpr double kRounding = std::numeric_limits<float>::epsilon();
      for (int i = 0; i < mesh.numVertices(); ++i) {
        EXPECT_NEAR(single.masses[i], matrix.masses[i], kRounding * matrix.masses[i]);
        // A block's terms cancel in part; the largest of a row tells how large they are.
        const RowPattern::Row& row = body.pattern().rows[i];
        double largest = 0;
        for (int k = row.first; k < row.first + row.count; ++k)
          largest = std::max(largest, blockOf(matrix, k).norm());
        for (int k = row.first; k < row.first + row.count; ++k)
          EXPECT_LT((blockOf(single, k) - blockOf(matrix, k)).norm(), 5 * kRounding * largest) << shape.name;
      }
    }
  }
}

template <class Scalar>
void expectSymmetric(const RowPattern& pattern, const DifferenceMatrix<Scalar>& matrix) {
  for (int i = 0; i < pattern.numVertices(); ++i) {
    const RowPattern::Row& row = pattern.rows[i];
    for (int k = row.first; k < row.first + row.count; ++k) {
      EXPECT_EQ(pattern.mirror[k], pattern.find(pattern.column[k], i));
      EXPECT_EQ(pattern.mirror[pattern.mirror[k]], k);
      EXPECT_EQ(pattern.column[k] > i, k >= row.first_above);
      EXPECT_TRUE(k == row.first || pattern.column[k] > pattern.column[k - 1]);
      EXPECT_EQ(blockOf(matrix, pattern.mirror[k]), blockOf(matrix, k).transpose());
    }
  }
}

/// All that a body tells, of two bodies that have the same cells.
void expectSame(Assembly& assembly, Assembly& expected, const Eigen::Matrix3Xd& positions) {
  CorotatedBody &body = *assembly.corotatedBody(), &anew = *expected.corotatedBody();
  const RowPattern &rows = body.pattern(), &rows_anew = anew.pattern();
  ASSERT_EQ(rows.numVertices(), rows_anew.numVertices());
  Eigen::Matrix3Xd forces, forces_anew;
  body.lineariseWithForces(positions, positions, true, forces);
  anew.lineariseWithForces(positions, positions, true, forces_anew);
  EXPECT_LT((forces - forces_anew).norm(), 1e-12 * forces_anew.norm());
  DifferenceMatrix<double> matrix, matrix_anew;
  body.assemble(assembly.vertexMasses(), 2, 3, matrix);
  anew.assemble(expected.vertexMasses(), 2, 3, matrix_anew);
  expectSymmetric(rows, matrix);
  for (int i = 0; i < rows.numVertices(); ++i) {
    EXPECT_EQ(matrix.masses[i], matrix_anew.masses[i]);
    const RowPattern::Row &row = rows.rows[i], &row_anew = rows_anew.rows[i];
    ASSERT_EQ(std::vector<int>(&rows.column[row.first], &rows.column[row.first] + row.count),
              std::vector<int>(&rows_anew.column[row_anew.first],
                               &rows_anew.column[row_anew.first] + row_anew.count));
    for (int k = row_anew.first; k < row_anew.first + row_anew.count; ++k) {
      const Eigen::Matrix3d block = blockOf(matrix_anew, k);
      EXPECT_LT((blockOf(matrix, rows.find(i, rows_anew.column[k])) - block).norm(), 1e-12 * block.norm());
    }
  }
  std::vector<float> rotations, rotations_anew;
  body.vertexRotations(rotations);
  anew.vertexRotations(rotations_anew);
  EXPECT_EQ(rotations, rotations_anew);
  Eigen::Matrix3Xd momenta, momenta_anew;
  assembly.multiplyMass(positions, momenta);
  expected.multiplyMass(positions, momenta_anew);
  EXPECT_LT((momenta - momenta_anew).norm(), 1e-12 * momenta_anew.norm());
}

TEST(CorotatedBody, FollowsCutsAsIfMadeAnew) {
  for (const bool tetrahedra : {true, false}) {
    PolyhedralMesh mesh = tetrahedra ? makeTets() : makeHexes();
    Assembly assembly(mesh, kMaterial, withMass(!tetrahedra), 0);
    std::mt19937 engine(tetrahedra ? 21 : 22);
    int num_cuts = 0, num_packed = 0;
    for (int cut = 1; cut <= 25; ++cut) {
      const PolygonCut square = someSquare(engine, {0.2, 0.1, 0.1}, 0.05);
      const CutResult result = cutMesh(mesh, mesh.restPositions(), square, CuttingConfig(), cut);
      if (result.status != CutStatus::kCut) continue;
      ++num_cuts;
      const int capacity = assembly.corotatedBody()->pattern().capacity();
      assembly.update(mesh, result.change);
      if (assembly.corotatedBody()->pattern().capacity() < capacity) ++num_packed;
      Assembly anew(mesh, kMaterial, withMass(!tetrahedra), 0);
      expectSame(assembly, anew, shake(mesh, 1e-4, cut));
      if (HasFailure()) FAIL() << "cut " << cut;
    }
    EXPECT_GT(num_cuts, 12);
    EXPECT_GT(num_packed, 0);  // or nothing tells that rows find back to each other after it
  }
}

TEST(CorotatedBody, TakesCellsOutAndPutsThemInAgain) {
  for (const PolyhedralMesh& mesh : {makeTets(), makePolyhedra()}) {
    Assembly assembly(mesh, kMaterial, withMass(true), 0), untouched = assembly;
    std::vector<CellId> out;
    std::vector<CorotatedBody::Cell> in;
    std::vector<bool> is_left(mesh.numVertices(), false);
    for (const CellId id : mesh.cells()) {
      if (mesh.restPosition(mesh.cell(id).vertices.front()).x() > 0.04) {
        out.push_back(id);
        in.push_back({id,
                      &mesh.cell(id).vertices,
                      &assembly.elementMatrices(id),
                      {lameLambda(kMaterial), shearModulus(kMaterial)},
                      kMaterial.density_kg_m3});
      } else {
        for (const int i : indicesOf(mesh.cell(id).vertices)) is_left[i] = true;
      }
    }
    CorotatedBody& body = *assembly.corotatedBody();
    body.update(mesh.numVertices(), out, {});
    const Eigen::Matrix3Xd positions = someRotation() * shake(mesh, 0.002, 6);
    Eigen::Matrix3Xd forces;
    body.lineariseWithForces(positions, positions, true, forces);
    std::vector<float> rotations;
    body.vertexRotations(rotations);
    EXPECT_EQ(std::count(is_left.begin(), is_left.end(), false) > 0, true);
    for (int i = 0; i < mesh.numVertices(); ++i) {
      const Eigen::Matrix3f R = Eigen::Map<const Eigen::Matrix3f>(&rotations[9 * i]);
      EXPECT_LT((R.transpose() * R - Eigen::Matrix3f::Identity()).norm(), 1e-5F) << i;
      EXPECT_EQ(body.pattern().rows[i].count > 0, is_left[i]);
      EXPECT_EQ(forces.col(i).isZero(0), !is_left[i]);
    }
    body.update(mesh.numVertices(), {}, in);
    expectSame(assembly, untouched, positions);
  }
}

std::vector<Eigen::Matrix3d> vertexRotationsOf(CorotatedBody& body) {
  std::vector<float> numbers;
  body.vertexRotations(numbers);
  std::vector<Eigen::Matrix3d> rotations;
  for (std::size_t k = 0; k < numbers.size(); k += 9)
    rotations.push_back(Eigen::Map<const Eigen::Matrix3f>(&numbers[k]).cast<double>());
  return rotations;
}

TEST(CorotatedBody, VertexRotationsAreRotationsAndFollowTheBody) {
  for (const PolyhedralMesh& mesh : {makeTets(), makeHexes(), makePolyhedra()}) {
    Assembly assembly(mesh, kMaterial, {}, 0);
    CorotatedBody& body = *assembly.corotatedBody();
    for (const Shape& shape : makeShapes(mesh)) {
      body.linearise(shape.positions, true);
      for (const Eigen::Matrix3d& R : vertexRotationsOf(body)) {
        EXPECT_LT((R.transpose() * R - Eigen::Matrix3d::Identity()).norm(), 1e-5) << shape.name;
        EXPECT_GT(R.determinant(), 0) << shape.name;
      }
    }
    const Eigen::Matrix3Xd positions = shake(mesh, 0.005, 7);
    body.linearise(positions, true);
    const std::vector<Eigen::Matrix3d> before = vertexRotationsOf(body);
    body.linearise(someRotation() * positions, true);
    const std::vector<Eigen::Matrix3d> after = vertexRotationsOf(body);
    for (std::size_t i = 0; i < before.size(); ++i)
      EXPECT_LT((after[i] - someRotation() * before[i]).norm(), 1e-5);
    body.linearise(someRotation() * mesh.restPositions(), true);
    for (const Eigen::Matrix3d& R : vertexRotationsOf(body)) EXPECT_LT((R - someRotation()).norm(), 1e-5);
    body.lineariseAtRest();
    for (const Eigen::Matrix3d& R : vertexRotationsOf(body))
      EXPECT_LT((R - Eigen::Matrix3d::Identity()).norm(), 1e-6);
  }
}

TEST(CorotatedBody, AnyNumberOfThreadsGivesTheSameBits) {
  for (const PolyhedralMesh& mesh : {makeTetBeam(8), makeHexBox({0, 0, 0}, {0.4, 0.1, 0.1}, {32, 8, 8})}) {
    ASSERT_GT(mesh.numVertices(), 2000);  // several chunks of vertices and of cells
    Assembly assembly(mesh, kMaterial, withMass(true), 0);
    const Eigen::Matrix3Xd positions = shake(mesh, 0.003, 8), ahead = shake(positions, 0.001, 9);
    Eigen::Matrix3Xd expected_forces, expected_momenta;
    DifferenceMatrix<double> expected;
    std::vector<float> expected_rotations;
    for (const int threads : {1, 2, 3}) {
      Assembly copy = assembly;
      CorotatedBody& body = *copy.corotatedBody();
      body.setThreads(threads);
      Eigen::Matrix3Xd forces, momenta;
      body.lineariseWithForces(positions, ahead, true, forces);
      copy.multiplyMass(positions, momenta);
      DifferenceMatrix<double> matrix;
      body.assemble(copy.vertexMasses(), 2, 3, matrix);
      std::vector<float> rotations;
      body.vertexRotations(rotations);
      if (threads == 1) {
        expected_forces = forces;
        expected_momenta = momenta;
        expected = matrix;
        expected_rotations = rotations;
      }
      EXPECT_EQ(forces, expected_forces) << threads;
      EXPECT_EQ(momenta, expected_momenta) << threads;
      EXPECT_EQ(matrix.blocks, expected.blocks) << threads;
      EXPECT_EQ(matrix.masses, expected.masses) << threads;
      EXPECT_EQ(rotations, expected_rotations) << threads;
    }
  }
}

TEST(CorotatedBody, AMatrixOfAnotherShapeLeavesTheLinearisationAsItIs) {
  for (const PolyhedralMesh& mesh : {makeTets(), makePolyhedra()}) {
    Assembly assembly(mesh, kMaterial, {}, 0);
    CorotatedBody& body = *assembly.corotatedBody();
    CorotatedBody untouched = body;
    const Eigen::Matrix3Xd positions = someRotation() * shake(mesh, 0.01, 10);
    const Eigen::Matrix3Xd others = someRotation() * shake(mesh, 0.01, 11);
    std::vector<char> still(mesh.numVertices(), 0);
    still[0] = 1;
    body.setStill(still);
    untouched.setStill(still);
    Eigen::Matrix3Xd forces, expected;
    body.lineariseWithForces(positions, positions, true, forces);
    untouched.lineariseWithForces(positions, positions, true, expected);
    DifferenceMatrix<double> at_rest, at_others;
    std::vector<float> rotations, expected_rotations;
    body.assembleAtRest(assembly.vertexMasses(), 2, 3, {}, at_rest);
    body.assembleAt(others, assembly.vertexMasses(), 2, 3, {}, at_others, rotations);
    body.internalForces(positions, forces);
    EXPECT_EQ(forces, expected);
    DifferenceMatrix<float> single, expected_single;
    body.assemble(assembly.vertexMasses(), 2, 3, single);
    untouched.assemble(assembly.vertexMasses(), 2, 3, expected_single);
    EXPECT_EQ(single.blocks, expected_single.blocks);
    DifferenceMatrix<double> matrix, expected_matrix;
    body.assemble(assembly.vertexMasses(), 2, 3, matrix);
    untouched.assemble(assembly.vertexMasses(), 2, 3, expected_matrix);
    EXPECT_EQ(matrix.blocks, expected_matrix.blocks);
    untouched.setStill({});
    untouched.lineariseAtRest();
    untouched.assemble(assembly.vertexMasses(), 2, 3, expected_matrix);
    EXPECT_EQ(at_rest.blocks, expected_matrix.blocks);
    EXPECT_EQ(at_rest.masses, expected_matrix.masses);
    untouched.linearise(others, true);
    untouched.assemble(assembly.vertexMasses(), 2, 3, expected_matrix);
    untouched.vertexRotations(expected_rotations);
    EXPECT_EQ(at_others.blocks, expected_matrix.blocks);
    EXPECT_EQ(rotations, expected_rotations);
  }
}

TEST(CorotatedBody, WhatMovesFeelsNothingOfWhatIsStillBeingLeftOut) {
  const double kUntouched = 123;
  for (const PolyhedralMesh& mesh : {makeTetBeam(4), makeHexes(), makePolyhedra()}) {
    Assembly assembly(mesh, kMaterial, withMass(true), 0);
    CorotatedBody body = *assembly.corotatedBody(), whole = body;
    const Eigen::Matrix3Xd positions = shake(mesh, 0.003, 8), ahead = shake(positions, 0.001, 9);
    const RowPattern& pattern = body.pattern();
    const double middle = mesh.restPositions().row(0).mean();
    std::vector<char> still(mesh.numVertices());
    for (int i = 0; i < mesh.numVertices(); ++i) still[i] = mesh.restPositions()(0, i) < middle ? 1 : 0;
    still[mesh.numVertices() / 2] ^= 1;  // one alone
    body.setStill(still);
    Eigen::Matrix3Xd forces, expected_forces;
    body.lineariseWithForces(positions, ahead, true, forces);
    whole.lineariseWithForces(positions, ahead, true, expected_forces);
    DifferenceMatrix<double> matrix, expected;
    matrix.resize(pattern);
    std::fill(matrix.masses.begin(), matrix.masses.end(), kUntouched);
    std::fill(matrix.blocks.begin(), matrix.blocks.end(), kUntouched);
    body.assemble(assembly.vertexMasses(), 2, 3, matrix);
    whole.assemble(assembly.vertexMasses(), 2, 3, expected);
    std::vector<float> rotations, expected_rotations;
    body.vertexRotations(rotations);
    whole.vertexRotations(expected_rotations);
    int num_left_out = 0;
    for (int i = 0; i < mesh.numVertices(); ++i) {
      if (still[i] != 0) {
        EXPECT_EQ(forces.col(i), Eigen::Vector3d::Zero());
        num_left_out += matrix.masses[i] == kUntouched ? 1 : 0;
        continue;
      }
      EXPECT_EQ(forces.col(i), expected_forces.col(i));
      EXPECT_EQ(matrix.masses[i], expected.masses[i]);
      const RowPattern::Row& row = pattern.rows[i];
      for (int k = 9 * row.first; k < 9 * (row.first + row.count); ++k)
        EXPECT_EQ(matrix.blocks[k], expected.blocks[k]);
      for (int k = 9 * i; k < 9 * (i + 1); ++k) EXPECT_EQ(rotations[k], expected_rotations[k]);
    }
    EXPECT_GT(num_left_out, 0);
    body.setStill({});
    body.lineariseWithForces(positions, ahead, true, forces);
    EXPECT_EQ(forces, expected_forces);
    matrix = {};
    body.assemble(assembly.vertexMasses(), 2, 3, matrix);
    EXPECT_EQ(matrix.blocks, expected.blocks);
  }
}

}  // namespace
}  // namespace polyscalpel
