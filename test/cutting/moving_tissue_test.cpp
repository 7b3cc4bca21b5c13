// SPDX-License-Identifier: BSD-3-Clause
//
// Blade and tissue both move: every edge counts as crossed once, whoever moves.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "polyscalpel/cutting/blade_sweep.hpp"
#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "support/torture_strokes.hpp"
#include "support/unit_cube.hpp"

namespace polyscalpel {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

Matrix3Xd longBlade() {
  return bladeFromTo({0, 0, -3}, {0, 0, 3});
}

using Motion = std::function<Matrix3Xd(const Matrix3Xd& rest, double s)>;  // positions at s in [0, 1]

/// Sums of the signed hits of each edge over a motion in some steps; edges of sum 0 are left out.
std::map<Edge, int> sumOfHits(const PolyhedralMesh& mesh, const Matrix3Xd& edge_tool,
                              const std::function<Isometry3d(double)>& blade, const Motion& tissue,
                              int steps) {
  std::map<Edge, int> sums;
  const Matrix3Xd rest = mesh.restPositions();
  for (int i = 0; i < steps; ++i) {
    const double s0 = static_cast<double>(i) / steps, s1 = static_cast<double>(i + 1) / steps;
    const Isometry3d T_start = blade(s0), T_end = blade(s1);
    const Matrix3Xd start = tissue(rest, s0), end = tissue(rest, s1);
    const auto hits = findHits(mesh, {}, {edge_tool, T_start, T_end, start, end}, 0.25);
    for (const Hit& hit : hits.value()) sums[hit.edge] += hit.sign;
  }
  for (auto sum = sums.begin(); sum != sums.end();) sum = sum->second == 0 ? sums.erase(sum) : std::next(sum);
  return sums;
}

TEST(MovingTissue, EveryEdgeIsCrossedExactlyOnceWhoeverMoves) {
  // The blade goes through along a plane as the tissue sees it, part of the way being the tissue's; both are
  // carried along besides. Which edges a plane crosses is known exactly.
  const PolyhedralMesh mesh = unitTets(4);
  const Matrix3Xd rest = mesh.restPositions();
  constexpr double kMaxTravel = 0.25;
  double size = kInfinity;
  for (int i = 0; i < mesh.numVertices(); ++i) size = std::min(size, mesh.localSize(VertexId(i)));
  TortureRandom random(3);
  for (int trial = 0; trial < 8; ++trial) {
    const Matrix3d axes = someFrame(random);
    const Vector3d centre = Vector3d::Constant(0.5) + 0.15 * someDirection(random);
    const bool is_carried_in_plane = trial % 2 == 0;
    const Vector3d carried =
        is_carried_in_plane ? Vector3d(0.5 * axes.col(0) - 0.4 * axes.col(2)) : 0.7 * someDirection(random);
    // The halves of a sub-step go one after the other, so the blade leaves the plane and comes back to it.
    const double reach = is_carried_in_plane ? 0 : kMaxTravel * size;
    std::map<Edge, int> expected;
    for (const Hit& hit : findHits(mesh, {}, rest, PlaneCut{centre, axes.col(1)}))
      expected[hit.edge] = hit.sign;
    const auto isClear = [&](const Edge& edge) {
      for (const VertexId v : {edge.first, edge.second})
        if (std::abs(axes.col(1).dot(rest.col(v.index()) - centre)) < reach) return false;
      return true;
    };
    for (const double part : {0.0, 0.35, 1.0}) {
      for (const int steps : {3, 25}) {
        const std::string where = "trial " + std::to_string(trial) + ", the tissue's part " +
                                  std::to_string(part) + ", " + std::to_string(steps) + " steps";
        const Vector3d way = 2.6 * axes.col(0);
        const auto blade = [&](double s) {
          return at(centre + (s - 0.5) * (1 - part) * way - 0.5 * part * way + s * carried, axes);
        };
        const Motion tissue = [&](const Matrix3Xd& from, double s) {
          return Matrix3Xd(from.colwise() + Vector3d(s * carried - s * part * way));
        };
        const std::map<Edge, int> sums = sumOfHits(mesh, longBlade(), blade, tissue, steps);
        int sense = 0, compared = 0;
        for (const auto& [edge, sign] : expected) {
          if (!isClear(edge)) continue;
          const auto found = sums.find(edge);
          ASSERT_NE(found, sums.end()) << where;
          if (sense == 0) sense = found->second * sign;
          EXPECT_EQ(found->second, sense * sign) << where;
          ++compared;
        }
        EXPECT_EQ(std::abs(sense), 1) << where;
        EXPECT_GT(compared, 20) << where;
        for (const auto& [edge, sum] : sums) {
          EXPECT_TRUE(expected.count(edge) == 1 || !isClear(edge)) << where;
        }
      }
    }
  }
}

/// A body that waves and shears while it is cut.
Matrix3Xd waving(const Matrix3Xd& rest, double s) {
  Matrix3Xd positions = rest;
  for (int i = 0; i < rest.cols(); ++i) {
    const Vector3d x = rest.col(i);
    positions.col(i) += Vector3d(0.15 * s * x.z(), 0.08 * std::sin(2 * M_PI * s) * std::sin(3 * x.x()),
                                 0.05 * s * std::sin(4 * x.y()));
  }
  return positions;
}

struct Outcome {
  int pieces = 1, cells = 0, cuts = 0;
  double smaller_volume = 0;
};

/// A stroke of a blade through a body; positions of new vertices follow the body's motion linearly, as in a
/// simulation they follow their parents.
Outcome draw(const std::function<Isometry3d(double)>& T_world_tool, const Motion& tissue, int steps) {
  PolyhedralMesh mesh = unitTets(4);
  BladeCut blade(longBlade(), CuttingConfig());
  const Matrix3Xd rest = mesh.restPositions();
  std::vector<NewVertex> made;
  const auto positionsAt = [&](double s) {
    Matrix3Xd positions = tissue(rest, s);
    extendByNewVertices(made, positions);
    return positions;
  };
  Outcome outcome;
  for (int i = 0; i <= steps; ++i) {
    const double s0 = static_cast<double>(i) / steps, s1 = std::min(1.0, static_cast<double>(i + 1) / steps);
    const Matrix3Xd start = positionsAt(s0), end = positionsAt(s1);
    const CutResult result =
        i < steps ? blade.advance(mesh, start, end, T_world_tool(s0), T_world_tool(s1), outcome.cuts + 1)
                  : blade.finish(mesh, end, outcome.cuts + 1);
    if (result.status != CutStatus::kCut) continue;
    ++outcome.cuts;
    made.insert(made.end(), result.change.new_vertices.begin(), result.change.new_vertices.end());
    EXPECT_TRUE(checkMesh(mesh).empty()) << "step " << i << ": " << checkMesh(mesh).front();
  }
  const Pieces pieces = findPieces(mesh);
  std::vector<double> volumes(pieces.count, 0);
  for (const CellId id : mesh.cells())
    volumes[pieces.piece_of_cell[id.index()]] += volume(makeCellSurface(mesh, id, mesh.restPositions()));
  outcome.pieces = pieces.count;
  outcome.cells = mesh.numCells();
  outcome.smaller_volume = *std::min_element(volumes.begin(), volumes.end());
  return outcome;
}

TEST(MovingTissue, TissueThatDeformsWhileBothMoveIsCutAsByTheFineReference) {
  const auto blade = [](double s) {
    return at({-0.5 + 1.4 * s, 0.47 + 0.05 * std::sin(5 * s), 0.5},
              AngleAxisd(0.3 * std::sin(4 * s), Vector3d::UnitX()).toRotationMatrix());
  };
  const Motion tissue = [](const Matrix3Xd& rest, double s) {
    return Matrix3Xd(waving(rest, s).colwise() - Vector3d(0.9 * s, 0, 0));
  };
  const Outcome fine = draw(blade, tissue, 2000);
  ASSERT_EQ(fine.pieces, 2);
  for (const int steps : {25, 100, 400}) {
    const Outcome outcome = draw(blade, tissue, steps);
    EXPECT_EQ(outcome.pieces, 2) << steps;
    EXPECT_NEAR(outcome.cells, fine.cells, 0.02 * fine.cells) << steps;
    EXPECT_NEAR(outcome.smaller_volume, fine.smaller_volume, 0.02 * fine.smaller_volume) << steps;
  }
}

TEST(MovingTissue, AHalfCutBodyThatCarriesTheBladeAlongEndsAsIfTheStrokeHadEndedThere) {
  // Half in, as the body stands; then both turn and travel as one, or do not.
  const Isometry3d in = at({0.52, 0.47, 0.5});
  const auto carry = [](double s) {
    Isometry3d T = at({0.8 * s, -0.3 * s, 0.1 * s});
    T.rotate(AngleAxisd(2 * s, Vector3d(1, 2, 3).normalized()));
    return T;
  };
  int cells[2];
  for (const bool is_carried : {false, true}) {
    PolyhedralMesh mesh = unitTets(4);
    BladeCut blade(longBlade(), CuttingConfig());
    Matrix3Xd positions = mesh.restPositions();
    int cuts = 0;
    for (int i = 0; i < 20; ++i) {
      const Matrix3Xd still = positions;
      const CutResult result = blade.advance(mesh, still, still, at({-0.4 + 0.046 * i, 0.47, 0.5}),
                                             at({-0.4 + 0.046 * (i + 1), 0.47, 0.5}), ++cuts);
      extendByNewVertices(result.change.new_vertices, positions);
    }
    ASSERT_GT(mesh.numCells(), unitTets(4).numCells());
    ASSERT_TRUE(blade.isCutting());
    for (int i = 0; i < 50 && is_carried; ++i) {
      const Isometry3d start = carry(i / 50.0), end = carry((i + 1) / 50.0);
      const Matrix3Xd positions_start = start * positions, positions_end = end * positions;
      const CutResult result =
          blade.advance(mesh, positions_start, positions_end, start * in, end * in, ++cuts);
      extendByNewVertices(result.change.new_vertices, positions);
    }
    const Matrix3Xd at_end = is_carried ? Matrix3Xd(carry(1) * positions) : positions;
    blade.finish(mesh, at_end, ++cuts);
    EXPECT_TRUE(checkMesh(mesh).empty());
    cells[is_carried] = mesh.numCells();
  }
  EXPECT_EQ(cells[0], cells[1]);
}

}  // namespace
}  // namespace polyscalpel
