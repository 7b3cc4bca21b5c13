// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "polyscalpel/core/types.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// Divides the outline of a cap into faces that are planar and convex in rest shape, so that a later cut
/// through them keeps the surface and with it the volume: a cap that is so itself is one face, any other the
/// triangulation that keeps the sub-tets on both sides large (least sum of inverse squares of their volumes,
/// by dynamic programming as of Gilbert 1979 and Klincsek 1980). Loops run as cap_loop does, which is
/// counter-clockwise seen from outside of the part that has its apex behind. apex_behind, apex_before: points
/// inside the two parts [m]. sides: empty, or one a corner: a triangle joins a positive to a negative one
/// only where none other is left.
std::vector<std::vector<VertexId>> makeCapFacets(const PolyhedralMesh& mesh,
                                                 const std::vector<VertexId>& cap_loop,
                                                 const Eigen::Vector3d& apex_behind,
                                                 const Eigen::Vector3d& apex_before,
                                                 const std::vector<int>& sides = {});

}  // namespace polyscalpel
