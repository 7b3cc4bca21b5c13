// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/held_tetrahedra.hpp"

namespace polyscalpel::report {

std::vector<bool> heldPoints(const CutBody& body, const Tetrahedra& tetrahedra) {
  std::vector<bool> held = body.fixed;
  held.resize(tetrahedra.points.cols(), true);
  for (const std::array<int, 4>& cell : tetrahedra.cells)
    for (const int a : cell)
      for (const int b : cell)
        if (a >= body.mesh.numVertices() && b < body.mesh.numVertices() && !body.fixed[b]) held[a] = false;
  return held;
}

PolyhedralMesh toHeldMesh(const Tetrahedra& tetrahedra, std::vector<bool>& held) {
  PolyhedralMesh mesh = toMesh(tetrahedra);
  const auto points = mesh.restPositions();
  for (int copy = static_cast<int>(held.size()); copy < mesh.numVertices(); ++copy) {
    Eigen::Index original = 0;
    (points.leftCols(tetrahedra.points.cols()).colwise() - points.col(copy))
        .colwise()
        .squaredNorm()
        .minCoeff(&original);
    held.push_back(held[original]);
  }
  return mesh;
}

}  // namespace polyscalpel::report
