// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// Names the first piece that its fixed vertices do not hold, because they are fewer than three or in line:
/// it can move as a rigid body, and has no static equilibrium. Empty where every piece is held.
std::string findLoosePiece(const PolyhedralMesh& mesh, const std::vector<bool>& fixed);

}  // namespace polyscalpel
