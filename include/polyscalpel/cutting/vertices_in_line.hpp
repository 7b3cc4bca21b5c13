// SPDX-License-Identifier: BSD-3-Clause
//
// Vertices that edges have got where their neighbours were cut: they lie on the straight line between the
// edge's ends, and where both ends lie on a cut, so do they, though no edge may be crossed to tell.
#pragma once

#include <functional>
#include <vector>

#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// Whether all vertices lie on the straight line between two others in the rest shape, but for rounding.
bool areInLine(const PolyhedralMesh& mesh, VertexId from, const std::vector<VertexId>& between, VertexId to);

/// Vertices of a face that follow each other, and the two beside them.
struct LoopPart {
  VertexId from;
  std::vector<VertexId> between;
  VertexId to;
};

/// The parts of a face's loop between one vertex on the cut and the next other one.
std::vector<LoopPart> partsOffCut(const FaceLoop& loop, const std::function<bool(VertexId)>& is_on_cut);

}  // namespace polyscalpel
