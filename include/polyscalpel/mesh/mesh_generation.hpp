// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// Box from lowest to lowest + size [m], divided into counts(0) x counts(1) x counts(2) hexahedra.
/// Throws std::invalid_argument for sizes <= 0 or counts < 1.
PolyhedralMesh makeHexBox(const Eigen::Vector3d& lowest, const Eigen::Vector3d& size,
                          const Eigen::Vector3i& counts);

/// The same box, each cube divided into five tetrahedra, mirrored so that neighbours conform: the central one
/// joins the four corners with even i + j + k. 32 x 8 x 8 gives 2673 vertices and 10,240 tets.
PolyhedralMesh makeTetBox(const Eigen::Vector3d& lowest, const Eigen::Vector3d& size,
                          const Eigen::Vector3i& counts);

/// Ball of tetrahedra around centre [m]: a tet box of 2n cubes an edge (n = half_count), mapped continuously
/// from the cube to the ball, so the number of tets is 5 (2n)^3. All volumes positive. Throws
/// std::invalid_argument for radius_m <= 0 or half_count < 1.
PolyhedralMesh makeTetBall(const Eigen::Vector3d& centre, double radius_m, int half_count);

}  // namespace polyscalpel
