// SPDX-License-Identifier: BSD-3-Clause
//
// The patch test of B. M. Irons on bodies that have been cut: a linear displacement field, held at the
// outside of the uncut body and loaded by its own tractions on the cut faces, must come out to rounding.
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "polyscalpel/simulation/static_solution.hpp"

namespace polyscalpel {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::Vector3i;

struct Body {
  std::string name;
  PolyhedralMesh mesh;
  int pieces = 0;
};

/// [0, 3]^3 cut by the first `planes` of three oblique planes through its inside: 2, 4 and 8 pieces.
Body cutBlock(bool tetrahedra, int planes) {
  const Vector3d size = Vector3d::Constant(3);
  const Vector3i counts = Vector3i::Constant(tetrahedra ? 2 : 3);
  Body body{tetrahedra ? "tets" : "hexes", tetrahedra ? makeTetBox(Vector3d::Zero(), size, counts)
                                                      : makeHexBox(Vector3d::Zero(), size, counts)};
  const Vector3d normals[] = {{1, 0.31, 0.17}, {-0.23, 1, 0.41}, {0.19, -0.37, 1}};
  for (int i = 0; i < planes; ++i) {
    const Matrix3Xd positions = body.mesh.restPositions();
    body.pieces = cutMesh(body.mesh, positions, PlaneCut{Vector3d(1.47, 1.58, 1.44), normals[i]}, {}, i + 1)
                      .pieces_after;
  }
  return body;
}

const IsotropicMaterial kMaterial{1.0, 0.3, 1.0};

class PatchTest : public testing::TestWithParam<std::tuple<bool, int>> {};

TEST_P(PatchTest, ALinearFieldComesOutOfACutBlockToRounding) {
  const auto [tetrahedra, quadrature_points] = GetParam();
  const Body body = cutBlock(tetrahedra, 3);
  const PolyhedralMesh& mesh = body.mesh;
  ASSERT_EQ(body.pieces, 8);
  ASSERT_TRUE(checkMesh(mesh).empty());
  ElementConfig config;
  config.quadrature_points = quadrature_points;
  config.strain = Strain::kLinear;
  Assembly assembly(mesh, kMaterial, config, 0);

  Matrix3d gradient;
  gradient << 0.011, -0.004, 0.007, 0.003, -0.009, 0.002, -0.005, 0.006, 0.008;
  const Matrix3Xd exact = gradient * mesh.restPositions();
  const Matrix3d strain = 0.5 * (gradient + gradient.transpose());
  const Matrix3d stress =
      lameLambda(kMaterial) * strain.trace() * Matrix3d::Identity() + 2 * shearModulus(kMaterial) * strain;

  // Tractions on the whole boundary; on the vertices that are held they do nothing.
  Matrix3Xd loads = Matrix3Xd::Zero(3, mesh.numVertices());
  for (int f = 0; f < mesh.faceCapacity(); ++f) {
    const Face& face = mesh.face(FaceId(f));
    if (!face.isAlive() || !face.isBoundary()) continue;
    for (int i = 0; i < numTriangles(face); ++i) {
      const Matrix3d corners = triangleCorners(face, i, mesh.restPositions());
      const Vector3d area_vector =
          0.5 * Vector3d(corners.col(1) - corners.col(0)).cross(Vector3d(corners.col(2) - corners.col(0)));
      for (const WeightedVertex& w : vertexWeights(face, i, Vector3d::Constant(1.0 / 3))) {
        loads.col(w.vertex.index()) += w.weight * (stress * area_vector);
      }
    }
  }

  std::vector<bool> held(mesh.numVertices());
  Matrix3Xd lift = Matrix3Xd::Zero(3, mesh.numVertices());
  int num_free = 0;
  for (int i = 0; i < mesh.numVertices(); ++i) {
    const Vector3d X = mesh.restPosition(VertexId(i));
    held[i] = X.minCoeff() < 1e-9 || X.maxCoeff() > 3 - 1e-9;
    if (held[i]) lift.col(i) = exact.col(i);
    num_free += !held[i];
  }
  ASSERT_GT(num_free, 20);
  Matrix3Xd lift_forces;
  assembly.internalForces(mesh.restPositions() + lift, lift_forces);
  const StaticSolution solution = solveStatic(mesh, assembly, held, loads - lift_forces);
  ASSERT_EQ(solution.status, SolveStatus::kSolved) << solution.message;
  const double error = (solution.displacements + lift - exact).norm() / exact.norm();
  EXPECT_LT(error, 1e-12) << body.name;
}

INSTANTIATE_TEST_SUITE_P(CutBlocks, PatchTest, testing::Combine(testing::Bool(), testing::Values(1, 4, 11)));

TEST(CutBody, StiffnessIsSymmetricSemidefiniteWithSixZeroModesAPiece) {
  for (const bool tetrahedra : {false, true}) {
    const Body body = cutBlock(tetrahedra, 2);
    ASSERT_EQ(body.pieces, 4);
    ElementConfig config;
    config.strain = Strain::kLinear;
    Assembly assembly(body.mesh, kMaterial, config, 0);
    // Column by column through the force, so that symmetry is a property and not the storage's.
    const int num_dofs = 3 * body.mesh.numVertices();
    const Matrix3Xd rest = body.mesh.restPositions();
    Eigen::MatrixXd K(num_dofs, num_dofs);
    Matrix3Xd forces;
    for (int j = 0; j < num_dofs; ++j) {
      Matrix3Xd moved = rest;
      moved.reshaped()[j] += 1;
      assembly.internalForces(moved, forces);
      K.col(j) = forces.reshaped();
    }
    const double scale = K.norm();
    EXPECT_LT((K - K.transpose()).norm(), 1e-13 * scale);
    const Eigen::VectorXd modes =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K, Eigen::EigenvaluesOnly).eigenvalues();
    EXPECT_GT(modes[0], -1e-12 * scale);
    EXPECT_LT(modes[6 * body.pieces - 1], 1e-12 * scale) << body.name;
    EXPECT_GT(modes[6 * body.pieces], 1e-6 * scale) << body.name;
  }
}

TEST(CutBody, RigidMotionByAnyAngleGivesNoForce) {
  for (const bool tetrahedra : {false, true}) {
    const Body body = cutBlock(tetrahedra, 3);
    Assembly assembly(body.mesh, kMaterial, {}, 0);
    Blocks stiffness;
    assembly.assemble(0, 1, stiffness);
    double stiffness_norm = 0;
    for (const Matrix3d& block : stiffness) stiffness_norm = std::max(stiffness_norm, block.norm());
    for (const double degrees : {0.0, 1.0, 30.0, 90.0, 135.0, 179.9, 180.0}) {
      const Matrix3d R =
          Eigen::AngleAxisd(degrees * EIGEN_PI / 180, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
      const Matrix3Xd moved = (R * body.mesh.restPositions()).colwise() + Vector3d(0.3, -7, 2);
      Matrix3Xd forces;
      assembly.linearise(moved);
      assembly.internalForces(moved, forces);
      EXPECT_LT(forces.norm(), 1e-12 * stiffness_norm * moved.norm()) << body.name << " " << degrees;
    }
  }
}

}  // namespace
}  // namespace polyscalpel
