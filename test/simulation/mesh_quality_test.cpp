// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/mesh_quality.hpp"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_editing.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "polyscalpel/simulation/piece_table.hpp"

namespace polyscalpel {
namespace {

using Eigen::Vector3d;

const IsotropicMaterial kMaterial{2e4, 0.4, 1100};

TEST(LargestValue, FollowsValuesThatComeChangeAndGo) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> number(0, 19), action(0, 3);
  std::uniform_real_distribution<double> uniform(0.1, 1);
  LargestValue largest;
  std::vector<double> values(20, 0);
  EXPECT_EQ(largest.get(), 0);
  for (int i = 0; i < 5000; ++i) {
    const int n = number(random);
    if (action(random) == 0) {
      values[n] = 0;
      largest.remove(n);
    } else {
      values[n] = uniform(random);
      largest.set(n, values[n]);
    }
    ASSERT_EQ(largest.get(), *std::max_element(values.begin(), values.end())) << i;
  }
}

/// The same straight from the mesh and the assembled matrix.
MeshQuality measureAnew(const PolyhedralMesh& mesh, Assembly& assembly) {
  MeshQuality quality{kInfinity, kInfinity, kInfinity, 0};
  for (const CellId cell : mesh.cells()) {
    double size = kInfinity;
    for (const VertexId v : mesh.cell(cell).vertices) size = std::min(size, mesh.localSize(v));
    const double relative = volume(makeCellSurface(mesh, cell, mesh.restPositions())) / (size * size * size);
    quality.smallest_cell_volume_relative = std::min(quality.smallest_cell_volume_relative, relative);
  }
  for (int f = 0; f < mesh.faceCapacity(); ++f) {
    const auto& loop = mesh.face(FaceId(f)).loop;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const VertexId a = loop[i], b = loop[(i + 1) % loop.size()];
      const double length = (mesh.restPosition(a) - mesh.restPosition(b)).norm();
      quality.shortest_edge_m = std::min(quality.shortest_edge_m, length);
      quality.shortest_edge_relative =
          std::min(quality.shortest_edge_relative, length / std::min(mesh.localSize(a), mesh.localSize(b)));
    }
  }
  assembly.lineariseAtRest();
  Blocks K;
  assembly.assemble(0, 1, K);
  for (int i = 0; i < mesh.numVertices(); ++i) {
    if (mesh.isRetired(VertexId(i))) continue;
    const double trace = K[assembly.pattern().column_start[i]].trace();
    quality.largest_stiffness_over_mass_1_s2 =
        std::max(quality.largest_stiffness_over_mass_1_s2, trace / (3 * assembly.vertexMasses()[i]));
  }
  return quality;
}

TEST(QualityMonitor, IsAsMeasuredAnewAfterEveryCutAndRemoval) {
  for (const bool tetrahedra : {true, false}) {
    PolyhedralMesh mesh = tetrahedra ? makeTetBox(Vector3d::Zero(), Vector3d(2, 1, 1), {4, 2, 2})
                                     : makeHexBox(Vector3d::Zero(), Vector3d(2, 1, 1), {4, 2, 2});
    Assembly assembly(mesh, kMaterial, ElementConfig(), 0.02);
    QualityMonitor monitor(mesh, assembly);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    int num_removed = 0;
    const auto expectExact = [&] {
      const MeshQuality found = monitor.quality(), expected = measureAnew(mesh, assembly);
      EXPECT_DOUBLE_EQ(found.shortest_edge_m, expected.shortest_edge_m);
      EXPECT_DOUBLE_EQ(found.shortest_edge_relative, expected.shortest_edge_relative);
      EXPECT_NEAR(found.smallest_cell_volume_relative, expected.smallest_cell_volume_relative,
                  1e-9 * expected.smallest_cell_volume_relative);
      EXPECT_NEAR(found.largest_stiffness_over_mass_1_s2, expected.largest_stiffness_over_mass_1_s2,
                  1e-9 * expected.largest_stiffness_over_mass_1_s2);
    };
    expectExact();
    for (int cut = 1; cut <= 8; ++cut) {
      const Vector3d normal(uniform(random), uniform(random), uniform(random));
      const Vector3d point =
          Vector3d(1, 0.5, 0.5) + 0.4 * Vector3d(2 * uniform(random), uniform(random), uniform(random));
      const CutResult result =
          cutMesh(mesh, mesh.restPositions(), PlaneCut{point, normal}, CuttingConfig(), cut);
      ASSERT_EQ(result.status, CutStatus::kCut) << result.message;
      assembly.update(mesh, result.change);
      monitor.update(mesh, assembly, result.change);
      expectExact();
      const Pieces pieces = findPieces(mesh);
      const std::vector<CellId> debris = findDebris(mesh, pieces, measurePieces(pieces, assembly), 0.02);
      if (debris.empty()) continue;
      ++num_removed;
      MeshEditor editor(mesh);
      editor.removeCells(debris);
      const MeshChange change = editor.commit();
      assembly.update(mesh, change);
      monitor.update(mesh, assembly, change);
      expectExact();
    }
    EXPECT_GT(num_removed, 0);
  }
}

TEST(QualityMonitor, BoundsTheLargestFrequency) {
  PolyhedralMesh mesh = makeHexBox(Vector3d::Zero(), Vector3d(2, 1, 1), {2, 1, 1});
  Assembly assembly(mesh, kMaterial, ElementConfig(), 0.02);
  QualityMonitor monitor(mesh, assembly);
  std::size_t most_vertices = 8;
  const auto expectBounds = [&] {
    Blocks K;
    assembly.lineariseAtRest();
    assembly.assemble(0, 1, K);
    const int n = 3 * mesh.numVertices();
    Eigen::MatrixXd scaled(n, n);
    for (int i = 0; i < n; ++i) {
      Eigen::Matrix3Xd unit = Eigen::Matrix3Xd::Zero(3, mesh.numVertices());
      unit.reshaped()[i] = 1 / std::sqrt(assembly.vertexMasses()[i / 3]);
      const Eigen::Matrix3Xd column = multiply(assembly.pattern(), K, unit);
      for (int j = 0; j < n; ++j)
        scaled(j, i) = column.reshaped()[j] / std::sqrt(assembly.vertexMasses()[j / 3]);
    }
    const double largest =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues()[n - 1];
    const double estimate = monitor.quality().largest_stiffness_over_mass_1_s2;
    EXPECT_GE(largest, estimate * (1 - 1e-12));
    EXPECT_LE(largest, 3 * static_cast<double>(most_vertices) * estimate);
  };
  expectBounds();
  const CutResult result =
      cutMesh(mesh, mesh.restPositions(), PlaneCut{{0.93, 0.52, 0.47}, {1, 0.4, 0.3}}, CuttingConfig(), 1);
  ASSERT_EQ(result.status, CutStatus::kCut);
  assembly.update(mesh, result.change);
  monitor.update(mesh, assembly, result.change);
  for (const CellId cell : mesh.cells())
    most_vertices = std::max(most_vertices, mesh.cell(cell).vertices.size());
  expectBounds();
}

}  // namespace
}  // namespace polyscalpel
