// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "polyscalpel/mesh/polyhedral_mesh.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {

/// Every sub-tet (mean of a cell's vertices, surface triangle) must be larger than this times the cube of the
/// cell's local size or, where cuts have left less of it, of its extent: what is flatter than that drowns in
/// rounding. A small cell of good shape does not: its stiffness goes with its extent.
constexpr double kSmallestRelativeSubTet = 1e-8;

/// Volume [m^3] above which every sub-tet of a cell must be that has this surface in rest shape.
/// local_size_m: the smallest of the cell's vertices.
double smallestSubTetAllowed(const CellSurface& surface, double local_size_m);

/// Checks every invariant of the mesh; an empty result means valid. One line a violation, with the ids: every
/// cell closed (each directed edge of its faces met once by its reverse) and consistently oriented; every
/// face alive has one or two cells that list it; no vertex twice in a loop; incidence lists agree with the
/// loops; every vertex used, but those that have retired, which nothing uses; at every vertex the cells are
/// joined through faces (pieces do not hang together by a vertex or an edge); every sub-tet above
/// smallestSubTetAllowed().
std::vector<std::string> checkMesh(const PolyhedralMesh& mesh);

}  // namespace polyscalpel
