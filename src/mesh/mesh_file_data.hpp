// SPDX-License-Identifier: BSD-3-Clause
//
// What mesh files hold, before it is checked and becomes a PolyhedralMesh.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// Volume cells as a file has them.
struct VolumeData {
  Eigen::Matrix3Xd points;                ///< 3 x n, one column per node [m], ascending node numbers
  std::vector<std::size_t> node_numbers;  ///< the file's number of each point
  std::vector<PolyhedralMesh::CellLoops>
      cells;                              ///< ascending cell numbers; loops outward unless a cell is inverted
  std::vector<std::size_t> cell_numbers;  ///< the file's number of each cell
  std::vector<int> regions;               ///< one a cell
  std::map<std::string, int> region_names;     ///< of regions that have a name
  std::vector<int> volumes_of_several_groups;  ///< their cells took the smallest group for their region
  std::vector<std::size_t> prisms;             ///< indices of the cells that are prisms
  bool has_higher_order = false;               ///< cells had nodes besides their corners, which were left out
};

/// Triangles as a file has them.
struct SurfaceData {
  Eigen::Matrix3Xd points;                    ///< 3 x n, one column per point [m]
  std::vector<std::array<int, 3>> triangles;  ///< indices into points; polygons are divided as fans
};

}  // namespace polyscalpel
