// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <vector>

#include "polyscalpel/cutting/crossings.hpp"
#include "polyscalpel/mesh/mesh_editing.hpp"

namespace polyscalpel {

/// What a round of splitting did.
struct SplitCounts {
  int cells_split = 0;
  double cap_area_m2 = 0;  ///< rest shape
  std::vector<CellId> left_whole;
};

/// Whether the caps and the faces that lie in the slit are opened.
enum class Slit { kOpen, kClosed };

/// Splits every cell that `is_ready` and whose vertices the crossings disconnect, opens the new caps and the
/// faces that lie in the slit, and gives the separated sides vertices of their own. Each cell is split by
/// itself: the smaller component of its vertices gets the faces it reaches, the border over these faces is
/// the cap. Before that, a component that the blade passes within snap_tolerance h joins the cut, unless the
/// slit stays closed, and a cell all of whose components lie on one side is none to be split. A split that
/// would leave a cell (or a touched neighbour) with a sub-tet not above smallestSubTetAllowed() is undone;
/// then vertices that lie in an edge between two corners of the cut join it, then a thin component, at most 4
/// vertices or all of a flat one within half of snap_tolerance h of the cut; then the cell is divided across
/// the cut and its parts are split; then both once more with a component within snap_tolerance h, and within
/// twice that; then the cell is left whole and counted. Vertices that hang in one straight edge, crossed on
/// both sides of them, are no component: no cap could part them from the cell.
SplitCounts splitCells(MeshEditor& editor, Crossings& crossings, const std::function<bool(CellId)>& is_ready,
                       double snap_tolerance, int cut, Slit slit = Slit::kOpen);

}  // namespace polyscalpel
