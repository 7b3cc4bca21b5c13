// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/crack_front.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include <Eigen/Geometry>

#include "polyscalpel/mesh/mesh_editing.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

using Eigen::Vector3d;

/// Outward normals of the two sides of a slit have at most minus this as their cosine.
constexpr double kBackToBack = 0.99;
/// And no side lies behind the other by more than this sine, as the faces of a sharp wedge do.
constexpr double kSmallestWedge = 0.02;

/// From the middle of the edge a-b into the face, across the edge, of length 1.
Vector3d directionInto(const PolyhedralMesh& mesh, FaceId face, VertexId a, VertexId b) {
  const Vector3d along = (mesh.restPosition(b) - mesh.restPosition(a)).normalized();
  const Vector3d inwards = virtualVertex(mesh.face(face), mesh.restPositions()) - mesh.restPosition(a);
  return (inwards - along.dot(inwards) * along).normalized();
}

Vector3d normalOf(const PolyhedralMesh& mesh, FaceId face) {
  return planeOf(mesh.face(face), mesh.restPositions()).second.normalized();
}

/// The two sides of a slit that meet at the edge.
std::optional<std::pair<FaceId, FaceId>> findSides(const PolyhedralMesh& mesh, VertexId a, VertexId b) {
  std::vector<FaceId> faces;
  for (const FaceId id : mesh.facesAround(a)) {
    const Face& face = mesh.face(id);
    if (face.cut > 0 && face.isBoundary() && hasEdge(face, a, b)) faces.push_back(id);
  }
  std::sort(faces.begin(), faces.end());
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Vector3d normal = normalOf(mesh, faces[i]);
    for (std::size_t k = i + 1; k < faces.size(); ++k) {
      if (normal.dot(normalOf(mesh, faces[k])) < -kBackToBack &&
          normal.dot(directionInto(mesh, faces[k], a, b)) > -kSmallestWedge)
        return std::make_pair(faces[i], faces[k]);
    }
  }
  return std::nullopt;
}

}  // namespace

bool isOnCrackFront(const PolyhedralMesh& mesh, VertexId a, VertexId b) {
  return findSides(mesh, a, b).has_value();
}

bool isOnCrackFront(const PolyhedralMesh& mesh, VertexId vertex) {
  for (const FaceId id : mesh.facesAround(vertex)) {
    const Face& face = mesh.face(id);
    if (face.cut == 0 || !face.isBoundary()) continue;
    const std::size_t n = face.loop.size(), i = findInLoop(face, vertex);
    if (isOnCrackFront(mesh, vertex, face.loop[(i + 1) % n]) ||
        isOnCrackFront(mesh, vertex, face.loop[(i + n - 1) % n]))
      return true;
  }
  return false;
}

CellFront findFront(const PolyhedralMesh& mesh, CellId cell) {
  CellFront front;
  for (const VertexId v : mesh.cell(cell).vertices) {
    if (isOnCrackFront(mesh, v)) front.vertices.push_back(v);
  }
  if (front.vertices.size() < 2) return front;
  double longest = 0;
  for (const Edge& edge : mesh.edges(cell)) {
    const auto sides = findSides(mesh, edge.first, edge.second);
    if (!sides) continue;
    const Face &first = mesh.face(sides->first), &second = mesh.face(sides->second);
    // The two cells beside the slit end there too, but the crack does not go on into them.
    if (first.cells[0] == cell || second.cells[0] == cell) continue;
    const int slit = std::min(first.cut, second.cut);
    front.slit = front.slit == 0 ? slit : std::min(front.slit, slit);
    const double length = (mesh.restPosition(edge.second) - mesh.restPosition(edge.first)).norm();
    if (length <= longest) continue;
    longest = length;
    front.edge = edge;
  }
  return front;
}

bool isNearFront(const PolyhedralMesh& mesh, CellId cell) {
  std::set<VertexId> around;
  for (const VertexId v : mesh.cell(cell).vertices) {
    for (const CellId other : cellsAround(mesh, v))
      around.insert(mesh.cell(other).vertices.begin(), mesh.cell(other).vertices.end());
  }
  return std::any_of(around.begin(), around.end(), [&](VertexId v) { return isOnCrackFront(mesh, v); });
}

}  // namespace polyscalpel
