// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/vertices_in_line.hpp"

#include <algorithm>
#include <cstddef>

#include <Eigen/Geometry>

namespace polyscalpel {
namespace {

/// Distance from the line, in localSize, that rounding explains.
constexpr double kInLine = 1e-9;

}  // namespace

bool areInLine(const PolyhedralMesh& mesh, VertexId from, const std::vector<VertexId>& between, VertexId to) {
  const Eigen::Vector3d start = mesh.restPosition(from);
  const Eigen::Vector3d along = (mesh.restPosition(to) - start).normalized();
  return std::all_of(between.begin(), between.end(), [&](VertexId v) {
    return along.cross(mesh.restPosition(v) - start).norm() <= kInLine * mesh.localSize(v);
  });
}

std::vector<LoopPart> partsOffCut(const FaceLoop& loop, const std::function<bool(VertexId)>& is_on_cut) {
  std::vector<LoopPart> parts;
  const std::size_t n = loop.size();
  for (std::size_t start = 0; start < n; ++start) {
    if (!is_on_cut(loop[start])) continue;
    std::size_t end = start + 1;
    while (end < start + n && !is_on_cut(loop[end % n])) ++end;
    if (end == start + 1 || end == start + n) continue;
    LoopPart part{loop[start], {}, loop[end % n]};
    for (std::size_t i = start + 1; i < end; ++i) part.between.push_back(loop[i % n]);
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace polyscalpel
