// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// How a file becomes a mesh.
struct MeshFileConfig {
  std::string path;  ///< .msh .vtk .mesh .stl .ply .obj .off ...
  double scale = 1;  ///< file units to metres, > 0
  double cell_size_m =
      0;  ///< edge length of the tets that fill a closed surface; 0: the surface's mean edge length
};

/// What was read, and what a user should know about it (for example "2 unconnected bodies").
struct MeshFile {
  PolyhedralMesh mesh;
  std::vector<std::string> remarks;
  /// Names of Gmsh's physical groups that have one, with the number that is Cell::region.
  std::map<std::string, int> region_names;
};

/// Reads a volume mesh (tets, hexes, prisms, pyramids become polyhedra as they are; Gmsh's physical groups
/// become regions), or fills a closed surface with tetrahedra. Not thread-safe: Gmsh keeps global state.
/// Throws std::invalid_argument naming the file and what is wrong: missing, empty, truncated, unknown type,
/// no volume cells and no closed surface, inverted or zero-volume cells (with the first one's number and
/// volume), duplicate vertices (with the first pair).
MeshFile readMesh(const MeshFileConfig& config);

}  // namespace polyscalpel
