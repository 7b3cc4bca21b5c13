// SPDX-License-Identifier: BSD-3-Clause
//
// How near a blade is to cells. Distances are those of points, so they do not depend on how body and blade
// lie along the axes; boxes only tell what need not be looked at.
#pragma once

#include <unordered_set>
#include <vector>

#include <Eigen/Geometry>

#include "polyscalpel/mesh/cell_tree.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// Whether the segment p-q [m] passes through the inside of a cell, whose faces are taken as planes (M.
/// Cyrus, J. Beck, "Generalized two- and three-dimensional clipping", 1978). positions: 3 x n [m].
bool meetsCell(const PolyhedralMesh& mesh, CellId cell, const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
               const Eigen::Vector3d& p, const Eigen::Vector3d& q);

/// Whether the polyline `blade_world` (3 x k [m]) is within margin * localSize(cell) of the cell.
bool isBladeAt(const PolyhedralMesh& mesh, CellId cell, const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
               const Eigen::Ref<const Eigen::Matrix3Xd>& blade_world, double margin);

/// All cells for which isBladeAt holds. The tree is fitted to the positions; it decides nothing, the answer
/// is the same with an empty tree, by which every cell is looked at.
std::unordered_set<CellId> cellsAtBlade(const PolyhedralMesh& mesh, const CellTree& tree,
                                        const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                        const Eigen::Ref<const Eigen::Matrix3Xd>& blade_world, double margin);

/// Vertices of slits at which a polyline stands, ascending: of their walls those nearer to it than
/// wall_tolerance * localSize, of their fronts (crack_front.hpp) those nearer than front_tolerance *
/// localSize, which is no less.
std::vector<VertexId> slitAtBlade(const PolyhedralMesh& mesh, const CellTree& tree,
                                  const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                  const Eigen::Ref<const Eigen::Matrix3Xd>& blade_world,
                                  double wall_tolerance, double front_tolerance);

/// A distance [m] by so much larger that rounding, of points with coordinates up to largest_coordinate [m],
/// takes none away that is within it.
double atLeast(double distance, double largest_coordinate);

/// Whether any segment of the polyline comes nearer to the box than `distance` [m] along some axis; true
/// wherever a point of the box is within `distance` of it, but for rounding (atLeast()).
bool meets(Eigen::AlignedBox3d box, const Eigen::Ref<const Eigen::Matrix3Xd>& blade, double distance);

}  // namespace polyscalpel
