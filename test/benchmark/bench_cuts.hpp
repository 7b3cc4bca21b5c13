// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel::bench {

/// What cuts are placed by. positions: 3 x n [m].
Eigen::AlignedBox3d boxOf(const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

/// Near the middle of the box, on no vertex of a generated mesh.
Eigen::Vector3d middleOf(const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

/// Median local size of the vertices [m].
double medianSize(const PolyhedralMesh& mesh);

/// An oblique plane from above down to the middle of the body, along no face of a generated mesh.
PolygonCut halfPlane(const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

}  // namespace polyscalpel::bench
