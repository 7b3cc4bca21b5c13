// SPDX-License-Identifier: BSD-3-Clause
#include "support/plane_pieces.hpp"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include <Eigen/Geometry>

#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

using Eigen::Vector3d;

/// The part of a flat polygon where `sign * distance` is not negative.
std::vector<Vector3d> clip(const std::vector<Vector3d>& polygon, const std::vector<double>& distances,
                           int sign) {
  std::vector<Vector3d> kept;
  const std::size_t n = polygon.size();
  for (std::size_t i = 0; i < n; ++i) {
    const double here = sign * distances[i], next = sign * distances[(i + 1) % n];
    if (here >= 0) kept.push_back(polygon[i]);
    if ((here > 0 && next < 0) || (here < 0 && next > 0))
      kept.push_back(polygon[i] + here / (here - next) * (polygon[(i + 1) % n] - polygon[i]));
  }
  return kept;
}

Vector3d areaVector(const std::vector<Vector3d>& polygon) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    sum += 0.5 * (polygon[i] - polygon[0]).cross(polygon[i + 1] - polygon[0]);
  return sum;
}

int find(std::vector<int>& parents, int i) {
  while (parents[i] != i) i = parents[i] = parents[parents[i]];
  return i;
}

}  // namespace

std::vector<PlanePiece> clipByPlane(const PolyhedralMesh& mesh, const PlaneCut& plane) {
  const Vector3d normal = plane.normal_world.normalized();
  const auto distanceOf = [&](VertexId v) { return normal.dot(mesh.restPosition(v) - plane.point_world); };
  std::vector<PlanePiece> pieces;
  for (const int side : {-1, 1}) {
    const auto isBeyond = [&](VertexId v) { return side * distanceOf(v) > 0; };
    std::vector<int> parents(mesh.cellCapacity());
    std::iota(parents.begin(), parents.end(), 0);
    for (int i = 0; i < mesh.faceCapacity(); ++i) {
      const Face& face = mesh.face(FaceId(i));
      if (!face.isAlive() || face.isBoundary()) continue;
      if (std::any_of(face.loop.begin(), face.loop.end(), isBeyond))
        parents[find(parents, face.cells[0].index())] = find(parents, face.cells[1].index());
    }
    std::map<int, PlanePiece> by_root;
    std::map<int, Vector3d> open;  // area vector of what is kept of the cells' faces
    for (const CellId id : mesh.cells()) {
      const auto& vertices = mesh.cell(id).vertices;
      if (std::none_of(vertices.begin(), vertices.end(), isBeyond)) continue;
      const int root = find(parents, id.index());
      PlanePiece& piece = by_root[root];
      for (const VertexId v : vertices) {
        if (side * distanceOf(v) <= piece.thickness_m) continue;
        piece.thickness_m = side * distanceOf(v);
        piece.farthest = v;
      }
      for (const FaceId face_id : mesh.cell(id).faces) {
        const Face& face = mesh.face(face_id);
        std::vector<Vector3d> corners;
        std::vector<double> distances;
        for (const VertexId v : face.loop) {
          corners.push_back(mesh.restPosition(v));
          distances.push_back(distanceOf(v));
        }
        const std::vector<Vector3d> kept = clip(corners, distances, side);
        if (kept.size() < 3) continue;
        const Vector3d area = (face.cells[0] == id ? 1 : -1) * areaVector(kept);
        // Measured from a point of the plane, the part in the plane adds nothing to the volume.
        piece.volume_m3 += area.dot(kept[0] - plane.point_world) / 3;
        open.emplace(root, Vector3d::Zero()).first->second += area;
      }
    }
    for (auto& [root, piece] : by_root) {
      piece.cut_area_m2 = std::abs(normal.dot(open[root]));
      pieces.push_back(piece);
    }
  }
  return pieces;
}

PlaneComparison compareWithClipping(const PolyhedralMesh& cut_mesh, const std::vector<PlanePiece>& parts,
                                    double snap_distance_m) {
  const Pieces pieces = findPieces(cut_mesh);
  std::vector<double> volumes(pieces.count, 0);
  for (const CellId id : cut_mesh.cells())
    volumes[pieces.piece_of_cell[id.index()]] +=
        volume(makeCellSurface(cut_mesh, id, cut_mesh.restPositions()));
  PlaneComparison comparison;
  comparison.spurious = std::max(0, pieces.count - static_cast<int>(parts.size()));
  std::set<int> found;
  for (const PlanePiece& part : parts) {
    if (part.thickness_m <= snap_distance_m) continue;
    // The farthest vertex lies off the cut, so it has kept its id.
    const CellId cell = cut_mesh.face(cut_mesh.facesAround(part.farthest).front()).cells[0];
    const int piece = pieces.piece_of_cell[cell.index()];
    if (!found.insert(piece).second) {
      ++comparison.missing;
      continue;
    }
    const double allowed = snap_distance_m * part.cut_area_m2;
    if (allowed > 0)
      comparison.volume_error =
          std::max(comparison.volume_error, std::abs(volumes[piece] - part.volume_m3) / allowed);
  }
  return comparison;
}

}  // namespace polyscalpel
