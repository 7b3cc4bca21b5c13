// SPDX-License-Identifier: BSD-3-Clause
//
// All that is asked of Gmsh. Its state is global: not thread-safe.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "mesh_file_data.hpp"

namespace polyscalpel {

/// Volume cells and triangles of a file, either of which may be empty.
struct GmshData {
  VolumeData volume;
  SurfaceData surface;
};

/// Reads a file that Gmsh knows; its name's ending decides how. Coordinates are multiplied by scale.
/// Throws std::invalid_argument with Gmsh's words if it reports an error or a warning.
GmshData readWithGmsh(const std::string& path, double scale);

/// A closed surface in one part: triangles as indices into points.
using Shell = std::vector<std::array<int, 3>>;

/// Fills bodies with tetrahedra of edges about cell_size_m long; the triangles stay as they are. bodies: for
/// each its outer shell and then the shells of its cavities, oriented outward from the material. Throws
/// std::invalid_argument with Gmsh's words where it fails.
VolumeData fillWithTets(const Eigen::Matrix3Xd& points, const std::vector<std::vector<Shell>>& bodies,
                        double cell_size_m);

}  // namespace polyscalpel
