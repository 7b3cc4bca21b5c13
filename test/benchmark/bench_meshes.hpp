// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel::bench {

/// A body to measure on, made when it is first needed.
struct BenchMesh {
  std::string name;
  std::function<PolyhedralMesh()> make;
};

/// Balls of radius 50 mm of 8,640 and 40,000 tetrahedra. folder: of further meshes in files, each skipped
/// where it is not there (bunny8k.msh, the Stanford bunny of 8,275 tetrahedra); empty for none.
std::vector<BenchMesh> benchMeshes(const std::string& folder);

}  // namespace polyscalpel::bench
