// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies of a few cells of each kind, and ways to deform them.
#pragma once

#include <cmath>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"

namespace polyscalpel {

inline PolyhedralMesh makeTets() {
  return makeTetBox({0, 0, 0}, {0.2, 0.1, 0.1}, {4, 2, 2});
}
inline PolyhedralMesh makeHexes() {
  return makeHexBox({0, 0, 0}, {0.2, 0.1, 0.1}, {4, 2, 2});
}

/// A mesh of general polyhedra, and what the oblique cut that made it changed.
inline PolyhedralMesh makePolyhedra(MeshChange* change = nullptr) {
  PolyhedralMesh mesh = makeHexes();
  const PlaneCut plane{{0.093, 0.052, 0.047}, {1, 0.4, 0.3}};
  const CutResult result = cutMesh(mesh, mesh.restPositions(), plane, CuttingConfig(), 1);
  EXPECT_EQ(result.status, CutStatus::kCut) << result.message;
  if (change) *change = result.change;
  return mesh;
}

/// A beam along x, (4 n) x n x n cubes of five tets.
inline PolyhedralMesh makeTetBeam(int n) {
  return makeTetBox({0, 0, 0}, {0.4, 0.1, 0.1}, {4 * n, n, n});
}

/// A square blade of some place and direction in the box from 0 to `size` [m].
inline PolygonCut someSquare(std::mt19937& engine, const Eigen::Vector3d& size, double half_edge) {
  std::uniform_real_distribution<double> uniform(0, 1);
  Eigen::Vector3d centre;
  for (int c = 0; c < 3; ++c) centre[c] = size[c] * uniform(engine);
  double q[3];
  for (double& coordinate : q) coordinate = uniform(engine);
  const Eigen::Matrix3d turn = Eigen::Quaterniond(q[0], q[1], q[2], 1).normalized().matrix();
  PolygonCut square;
  square.corners_world.resize(3, 4);
  square.corners_world << -1, 1, 1, -1, -1, -1, 1, 1, 0, 0, 0, 0;
  square.corners_world = ((half_edge * turn * square.corners_world).colwise() + centre).eval();
  return square;
}

/// Every coordinate moved by up to the amplitude [m].
inline Eigen::Matrix3Xd shake(const Eigen::Ref<const Eigen::Matrix3Xd>& positions, double amplitude,
                              unsigned seed) {
  std::mt19937 engine(seed);
  std::uniform_real_distribution<double> uniform(-amplitude, amplitude);
  Eigen::Matrix3Xd shaken = positions;
  for (double& coordinate : shaken.reshaped()) coordinate += uniform(engine);
  return shaken;
}
inline Eigen::Matrix3Xd shake(const PolyhedralMesh& mesh, double amplitude, unsigned seed) {
  return shake(mesh.restPositions(), amplitude, seed);
}

/// A beam along x bent to a circle's arc about y, by `angle` from x = 0 to x = length.
inline Eigen::Matrix3Xd bend(const Eigen::Ref<const Eigen::Matrix3Xd>& positions, double length,
                             double angle) {
  Eigen::Matrix3Xd bent = positions;
  const double radius = length / angle;
  for (int i = 0; i < bent.cols(); ++i) {
    const double turn = positions(0, i) / radius, arm = radius + positions(2, i);
    bent(0, i) = arm * std::sin(turn);
    bent(2, i) = arm * std::cos(turn) - radius;
  }
  return bent;
}

inline Eigen::Matrix3d someRotation() {
  return Eigen::AngleAxisd(2.3, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
}

}  // namespace polyscalpel
