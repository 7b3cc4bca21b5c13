// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/mesh/mesh_change.hpp"

#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {

void extendByNewVertices(const std::vector<NewVertex>& new_vertices, Eigen::Matrix3Xd& values) {
  Eigen::Index column = values.cols();
  values.conservativeResize(Eigen::NoChange, column + static_cast<Eigen::Index>(new_vertices.size()));
  for (const NewVertex& origin : new_vertices) {
    POLYSCALPEL_ASSERT(origin.vertex.index() == column);
    const auto first = values.col(origin.parents[0].index()), second = values.col(origin.parents[1].index());
    if (origin.parents[0] == origin.parents[1]) {
      values.col(column++) = first;
    } else {
      values.col(column++) = (1 - origin.weight) * first + origin.weight * second;
    }
  }
}

}  // namespace polyscalpel
