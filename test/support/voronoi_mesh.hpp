// SPDX-License-Identifier: BSD-3-Clause
//
// Voronoi cells of a box: polyhedra of all kinds that no cut has made.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <stdexcept>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/mesh/polyhedral_mesh.hpp"
#include "support/element_cells.hpp"

namespace polyscalpel {

/// Gives one index to all points that lie within a tolerance of each other. The first of them stands for all.
class PointMerger {
 public:
  /// tolerance: > 0 [m], far below the distance of points that are to stay apart.
  explicit PointMerger(double tolerance) : tolerance_(tolerance) {}

  int add(const Eigen::Vector3d& point) {
    // Bins of four tolerances: a neighbour lies in the point's own bin or in one that is within tolerance.
    const auto bin = [&](const Eigen::Vector3d& p) {
      return std::array<long long, 3>{std::llround(p.x() / (4 * tolerance_)),
                                      std::llround(p.y() / (4 * tolerance_)),
                                      std::llround(p.z() / (4 * tolerance_))};
    };
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d offset(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      const auto found = bins_.find(bin(point + tolerance_ * offset));
      if (found == bins_.end()) continue;
      for (const int index : found->second) {
        if ((points_[index] - point).norm() < tolerance_) return index;
      }
    }
    points_.push_back(point);
    const int index = static_cast<int>(points_.size()) - 1;
    bins_[bin(point)].push_back(index);
    return index;
  }

  /// 3 x number of distinct points [m].
  Eigen::Matrix3Xd points() const {
    Eigen::Matrix3Xd points(3, points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) points.col(i) = points_[i];
    return points;
  }

 private:
  double tolerance_;
  std::vector<Eigen::Vector3d> points_;
  std::map<std::array<long long, 3>, std::vector<int>> bins_;
};

/// The Voronoi cells, clipped to a box, of seeds on a lattice that are moved at random.
class VoronoiCells {
 public:
  /// No edge is shorter than this, in units of the lattice: clear of rounding, so that neighbouring cells,
  /// each clipped for itself, agree on their vertices.
  static constexpr double kShortestEdge = 2e-3;
  /// Largest way of a seed along each axis, in units of the lattice.
  static constexpr double kJitter = 0.3;

  VoronoiCells(const Eigen::Vector3d& lowest, const Eigen::Vector3d& size, const Eigen::Vector3i& counts,
               unsigned seed)
      : lowest_(lowest), size_(size), counts_(counts), random_(seed) {
    spacing_ = size.cwiseQuotient(counts.cast<double>());
    const int num_cells = counts.prod();
    seeds_.resize(3, num_cells);
    cells_.resize(num_cells);
    std::vector<bool> is_stale(num_cells, true);
    for (int i = 0; i < num_cells; ++i) placeSeed(i);
    // A cell with a short edge gets another seed. One cell of every edge suffices, and it changes the edges
    // of its neighbours only.
    constexpr int kMostRounds = 200;
    for (int round = 0; round < kMostRounds; ++round) {
      std::vector<int> short_edged;
      for (int i = 0; i < num_cells; ++i) {
        if (is_stale[i]) cells_[i] = makeCell(i);
        is_stale[i] = false;
        if (shortestEdge(cells_[i]) < kShortestEdge * spacing_.minCoeff()) short_edged.push_back(i);
      }
      if (short_edged.empty()) return;
      std::vector<bool> is_near_moved(num_cells, false);
      for (const int moved : short_edged) {
        if (is_near_moved[moved]) continue;  // the neighbour that has moved may have cured it
        placeSeed(moved);
        for (const int near : neighbours(moved, 1)) is_near_moved[near] = true;
        for (const int near : neighbours(moved, kReach)) is_stale[near] = true;
        is_stale[moved] = true;
      }
    }
    throw std::runtime_error("no Voronoi cells without short edges found");
  }

  PolyhedralMesh mesh() const {
    PointMerger merger(1e-2 * kShortestEdge * spacing_.minCoeff());
    std::vector<PolyhedralMesh::CellLoops> cells;
    for (const PolyhedronSketch& sketch : cells_) {
      std::vector<int> index(sketch.points.cols());
      for (std::size_t i = 0; i < index.size(); ++i) index[i] = merger.add(sketch.points.col(i));
      PolyhedralMesh::CellLoops& loops = cells.emplace_back(sketch.loops);
      for (std::vector<int>& loop : loops) {
        for (int& vertex : loop) vertex = index[vertex];
      }
    }
    return PolyhedralMesh(merger.points(), cells);
  }

 private:
  static constexpr int kReach = 3;  // lattice steps within which seeds can share a face

  Eigen::Vector3i latticePoint(int i) const {
    return {i % counts_.x(), i / counts_.x() % counts_.y(), i / counts_.x() / counts_.y()};
  }

  void placeSeed(int i) {
    std::uniform_real_distribution<double> way(-kJitter, kJitter);
    Eigen::Vector3d p = latticePoint(i).cast<double>();
    for (double& coordinate : p) coordinate += 0.5 + way(random_);
    seeds_.col(i) = lowest_ + p.cwiseProduct(spacing_);
  }

  std::vector<int> neighbours(int i, int reach) const {
    std::vector<int> result;
    const Eigen::Vector3i centre = latticePoint(i);
    for (int z = -reach; z <= reach; ++z) {
      for (int y = -reach; y <= reach; ++y) {
        for (int x = -reach; x <= reach; ++x) {
          const Eigen::Vector3i p = centre + Eigen::Vector3i(x, y, z);
          if (p == centre || (p.array() < 0).any() || (p.array() >= counts_.array()).any()) continue;
          result.push_back(p.x() + counts_.x() * (p.y() + counts_.y() * p.z()));
        }
      }
    }
    return result;
  }

  // The box clipped by the bisectors to the other seeds, nearest first, until the rest is too far to matter.
  PolyhedronSketch makeCell(int i) const {
    PolyhedronSketch cell = makeCubeSketch();
    cell.points = (size_.asDiagonal() * cell.points).colwise() + lowest_;
    const Eigen::Vector3d centre = seeds_.col(i);
    std::vector<int> others = neighbours(i, kReach);
    std::sort(others.begin(), others.end(), [&](int a, int b) {
      return (seeds_.col(a) - centre).squaredNorm() < (seeds_.col(b) - centre).squaredNorm();
    });
    for (const int other : others) {
      const Eigen::Vector3d way = seeds_.col(other) - centre;
      const double radius = (cell.points.colwise() - centre).colwise().norm().maxCoeff();
      if (way.norm() > 2 * radius) break;
      const Eigen::Vector3d normal = way.normalized();
      const double offset = normal.dot(centre) + way.norm() / 2;
      if ((normal.transpose() * cell.points).maxCoeff() > offset) cell = clip(cell, normal, offset);
    }
    return cell;
  }

  static double shortestEdge(const PolyhedronSketch& cell) {
    double shortest = kInfinity;
    for (const std::vector<int>& loop : cell.loops) {
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const Eigen::Vector3d edge = cell.points.col(loop[(i + 1) % loop.size()]) - cell.points.col(loop[i]);
        shortest = std::min(shortest, edge.norm());
      }
    }
    return shortest;
  }

  Eigen::Vector3d lowest_, size_, spacing_;
  Eigen::Vector3i counts_;
  std::mt19937 random_;
  Eigen::Matrix3Xd seeds_;
  std::vector<PolyhedronSketch> cells_;
};

/// Box from lowest to lowest + size [m], divided into counts.prod() Voronoi cells. Same input, same mesh.
inline PolyhedralMesh makeVoronoiBox(const Eigen::Vector3d& lowest, const Eigen::Vector3d& size,
                                     const Eigen::Vector3i& counts, unsigned seed = 1) {
  return VoronoiCells(lowest, size, counts, seed).mesh();
}

}  // namespace polyscalpel
