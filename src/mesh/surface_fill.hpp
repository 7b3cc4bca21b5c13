// SPDX-License-Identifier: BSD-3-Clause
//
// From the triangles of a file to a volume: welding, checking and refining a closed surface, and filling it.
#pragma once

#include <string>
#include <vector>

#include "mesh_file_data.hpp"

namespace polyscalpel {

/// Fills a closed surface with tetrahedra. cell_size_m: their edge length, 0 for the surface's mean edge
/// length; longer edges of the surface are halved without a change of shape, shorter ones stay. Equal points
/// are joined; shells inside others are cavities. Appends what a user should know to remarks. Throws
/// std::invalid_argument if the surface is open, not oriented alike everywhere or cuts itself.
VolumeData fillClosedSurface(SurfaceData surface, double cell_size_m, std::vector<std::string>& remarks);

}  // namespace polyscalpel
