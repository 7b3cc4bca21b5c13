// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/bench_cuts.hpp"

#include <vector>

#include "benchmark/timing.hpp"

namespace polyscalpel::bench {

using Eigen::Vector3d;

Eigen::AlignedBox3d boxOf(const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  return {Vector3d(positions.rowwise().minCoeff()), Vector3d(positions.rowwise().maxCoeff())};
}

Vector3d middleOf(const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  const Eigen::AlignedBox3d box = boxOf(positions);
  return box.center() + 0.013 * 0.5 * box.sizes();
}

double medianSize(const PolyhedralMesh& mesh) {
  std::vector<double> sizes;
  for (int i = 0; i < mesh.numVertices(); ++i) sizes.push_back(mesh.localSize(VertexId(i)));
  return report::median(std::move(sizes));
}

PolygonCut halfPlane(const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  const double reach = boxOf(positions).sizes().norm();
  const Vector3d along = Vector3d(0.31, 1, 0.07).normalized();
  const Vector3d up = Vector3d(0.05, -0.06, 1).cross(along).cross(along).normalized() * -1;
  const Vector3d middle = middleOf(positions);
  PolygonCut cut;
  cut.corners_world.resize(3, 4);
  cut.corners_world << middle - reach * along, middle + reach * along, middle + reach * (along + up),
      middle + reach * (up - along);
  return cut;
}

}  // namespace polyscalpel::bench
