// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// Every sub-tet (mean of a cell's vertices, surface triangle) must be larger than this times the cell's
/// local size cubed: below it the geometry drowns in rounding.
constexpr double kSmallestRelativeSubTet = 1e-8;

/// Checks every invariant of the mesh; an empty result means valid. One line a violation, with the ids: every
/// cell closed (each directed edge of its faces met once by its reverse) and consistently oriented; every
/// face alive has one or two cells that list it; no vertex twice in a loop; incidence lists agree with the
/// loops; every vertex used, but those that have retired, which nothing uses; at every vertex the cells are
/// joined through faces (pieces do not hang together by a vertex or an edge); every sub-tet above
/// kSmallestRelativeSubTet * h^3, h the smallest localSize of the cell's vertices.
std::vector<std::string> checkMesh(const PolyhedralMesh& mesh);

}  // namespace polyscalpel
