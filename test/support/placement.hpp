// SPDX-License-Identifier: BSD-3-Clause
//
// A body and a blade in another place, turned, or as their mirror image.
#pragma once

#include <algorithm>
#include <vector>

#include <Eigen/Geometry>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "support/torture_strokes.hpp"

namespace polyscalpel {

/// The body under x -> linear * x + shift; a mirror image where det linear < 0.
struct Placement {
  Eigen::Matrix3d linear = Eigen::Matrix3d::Identity();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();

  bool isMirrored() const { return linear.determinant() < 0; }
  Eigen::Vector3d operator()(const Eigen::Vector3d& x) const { return linear * x + shift; }

  PolyhedralMesh operator()(const PolyhedralMesh& mesh) const {
    std::vector<PolyhedralMesh::CellLoops> cells;
    for (const CellId id : mesh.cells()) {
      PolyhedralMesh::CellLoops& loops = cells.emplace_back();
      for (const FaceId face : mesh.cell(id).faces) {
        std::vector<int>& loop = loops.emplace_back();
        for (const VertexId v : mesh.face(face).loop) loop.push_back(v.index());
        if ((mesh.face(face).cells[0] != id) != isMirrored()) std::reverse(loop.begin(), loop.end());
      }
    }
    const Eigen::Matrix3Xd points = (linear * mesh.restPositions()).colwise() + shift;
    return {points, cells};
  }

  CutOperation operator()(const CutOperation& operation) const {
    CutOperation placed = operation;
    if (auto* plane = std::get_if<PlaneCut>(&placed)) {
      plane->point_world = (*this)(plane->point_world);
      plane->normal_world = linear * plane->normal_world;
    } else if (auto* polygon = std::get_if<PolygonCut>(&placed)) {
      polygon->corners_world = ((linear * polygon->corners_world).colwise() + shift).eval();
    } else {
      auto& sweep = std::get<SweepCut>(placed);
      // A mirror image of a pose is none, so the blade is mirrored too: linear = rotation * mirror.
      const Eigen::Matrix3d mirror = isMirrored() ? Eigen::Matrix3d(Eigen::Vector3d(-1, 1, 1).asDiagonal())
                                                  : Eigen::Matrix3d::Identity();
      sweep.edge_tool = (mirror * sweep.edge_tool).eval();
      for (Eigen::Isometry3d& T : sweep.T_world_tool) {
        T.translation() = (*this)(T.translation());
        T.linear() = linear * T.linear() * mirror;
      }
    }
    return placed;
  }
};

inline Placement somePlacement(TortureRandom& random, bool is_mirrored) {
  Placement placement;
  placement.linear = someFrame(random);
  if (is_mirrored) placement.linear.col(0) *= -1;
  placement.shift = 3 * someDirection(random);
  return placement;
}

}  // namespace polyscalpel
