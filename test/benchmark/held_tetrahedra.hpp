// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "benchmark/cut_bodies.hpp"
#include "benchmark/retessellation.hpp"

namespace polyscalpel::report {

/// Which points of a cut body's tetrahedra are held: its own as they were, a new one inside an edge, a face
/// or a cell where all old ones that it shares a cell with are.
std::vector<bool> heldPoints(const CutBody& body, const Tetrahedra& tetrahedra);

/// Tetrahedra as a mesh that can step. held: of heldPoints(); longer afterwards where tetrahedra hang
/// together by a vertex alone, since the mesh gives them copies of it.
PolyhedralMesh toHeldMesh(const Tetrahedra& tetrahedra, std::vector<bool>& held);

}  // namespace polyscalpel::report
