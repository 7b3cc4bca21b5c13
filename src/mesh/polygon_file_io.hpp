// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "mesh_file_data.hpp"

namespace polyscalpel {

/// Reads the polygons of an .obj or .off file. Coordinates are multiplied by scale.
/// Throws std::invalid_argument if the file cannot be read to its end.
SurfaceData readPolygonFile(const std::string& path, double scale);

}  // namespace polyscalpel
