// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/retessellation.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Geometry>

#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel::report {
namespace {

using Triangle = std::array<int, 3>;

/// Volume over the cube of the longest edge, 1 for the regular tetrahedron; negative where inside out.
double quality(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
               const Eigen::Vector3d& d) {
  double longest = 0;
  for (const Eigen::Vector3d& edge : {Eigen::Vector3d(b - a), Eigen::Vector3d(c - a), Eigen::Vector3d(d - a),
                                      Eigen::Vector3d(c - b), Eigen::Vector3d(d - b), Eigen::Vector3d(d - c)})
    longest = std::max(longest, edge.squaredNorm());
  return (b - a).cross(c - a).dot(d - a) * std::sqrt(2.0) / std::pow(longest, 1.5);
}

/// Cones from a vertex of a cell are taken from this quality on, also where a new vertex would be better.
constexpr double kGoodQuality = 0.05;
/// Tetrahedra below this quality are none.
constexpr double kWorstQuality = 1e-9;

class Divider {
 public:
  Divider(const PolyhedralMesh& mesh, Retessellation rule)
      : mesh_(mesh), rule_(rule), faces_(mesh.faceCapacity()), middles_(mesh.faceCapacity(), -1) {
    for (int i = 0; i < mesh.numVertices(); ++i) points_.push_back(mesh.restPosition(VertexId(i)));
    for (int f = 0; f < mesh.faceCapacity(); ++f) {
      if (!mesh.face(FaceId(f)).isAlive()) continue;
      if (rule == Retessellation::kMiddles)
        fanAroundMiddle(f);
      else
        divideByDiagonals(f);
    }
  }

  Tetrahedra divide() {
    // A bent face divided by diagonals may hide from the inside of a cell: it takes a middle then, which
    // concerns the neighbour too.
    bool has_changed = true;
    while (has_changed) {
      has_changed = false;
      for (const CellId id : mesh_.cells()) {
        if (findApex(id)) continue;
        for (const FaceId face : mesh_.cell(id).faces) fanAroundMiddle(face.index());
        has_changed = true;
      }
    }
    Tetrahedra result;
    for (const CellId id : mesh_.cells()) addCell(id, *findApex(id), result.cells);
    result.points.resize(3, static_cast<Eigen::Index>(points_.size()));
    for (std::size_t i = 0; i < points_.size(); ++i)
      result.points.col(static_cast<Eigen::Index>(i)) = points_[i];
    return result;
  }

 private:
  struct Apex {
    int vertex = -1;  // -1: a new one inside
    Eigen::Vector3d point;
  };

  std::vector<int> loopOf(int face) const {
    std::vector<int> loop;
    for (const VertexId vertex : mesh_.face(FaceId(face)).loop) loop.push_back(vertex.index());
    return loop;
  }

  void fanAroundMiddle(int face) {
    const std::vector<int> loop = loopOf(face);
    if (loop.size() == 3) faces_[face] = {{loop[0], loop[1], loop[2]}};
    if (loop.size() == 3 || middles_[face] >= 0) return;
    middles_[face] = static_cast<int>(points_.size());
    points_.push_back(virtualVertex(mesh_.face(FaceId(face)), mesh_.restPositions()));
    faces_[face].clear();
    for (std::size_t i = 0; i < loop.size(); ++i)
      faces_[face].push_back({middles_[face], loop[i], loop[(i + 1) % loop.size()]});
  }

  /// The diagonals whose worst triangle is best, by dynamic programming over chords of the loop.
  void divideByDiagonals(int face) {
    const std::vector<int> loop = loopOf(face);
    const int n = static_cast<int>(loop.size());
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (int i = 0; i < n; ++i) normal += points_[loop[i]].cross(points_[loop[(i + 1) % n]]);
    const auto triangleQuality = [&](int i, int j, int k) {
      const Eigen::Vector3d a = points_[loop[j]] - points_[loop[i]], b = points_[loop[k]] - points_[loop[i]];
      const double longest = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
      return a.cross(b).dot(normal.normalized()) / longest;
    };
    std::vector<std::vector<double>> best(n, std::vector<double>(n, kInfinity));
    std::vector<std::vector<int>> split(n, std::vector<int>(n, -1));
    for (int length = 2; length < n; ++length) {
      for (int i = 0; i + length < n; ++i) {
        const int k = i + length;
        best[i][k] = -kInfinity;
        for (int j = i + 1; j < k; ++j) {
          const double worst = std::min({best[i][j], best[j][k], triangleQuality(i, j, k)});
          if (worst > best[i][k]) best[i][k] = worst, split[i][k] = j;
        }
      }
    }
    collect(loop, split, 0, n - 1, faces_[face]);
  }

  static void collect(const std::vector<int>& loop, const std::vector<std::vector<int>>& split, int i, int k,
                      std::vector<Triangle>& triangles) {
    if (k - i < 2) return;
    const int j = split[i][k];
    triangles.push_back({loop[i], loop[j], loop[k]});
    collect(loop, split, i, j, triangles);
    collect(loop, split, j, k, triangles);
  }

  /// Triangles of a cell, outward.
  std::vector<Triangle> surfaceOf(CellId id) const {
    std::vector<Triangle> triangles;
    for (const FaceId face : mesh_.cell(id).faces) {
      for (Triangle triangle : faces_[face.index()]) {
        if (mesh_.face(face).cells[0] != id) std::swap(triangle[1], triangle[2]);
        triangles.push_back(triangle);
      }
    }
    return triangles;
  }

  double worstQuality(const std::vector<Triangle>& surface, const Apex& apex) const {
    double worst = kInfinity;
    for (const Triangle& t : surface) {
      if (std::find(t.begin(), t.end(), apex.vertex) != t.end()) continue;
      // Outward seen from the apex is inside out for quality().
      worst = std::min(worst, quality(apex.point, points_[t[0]], points_[t[1]], points_[t[2]]));
    }
    return worst;
  }

  /// Where the tetrahedra of a cell meet; nothing where all choices are bad and middles may help.
  std::optional<Apex> findApex(CellId id) const {
    const std::vector<Triangle> surface = surfaceOf(id);
    const std::vector<VertexId>& vertices = mesh_.cell(id).vertices;
    const bool is_tetrahedron = vertices.size() == 4 && surface.size() == 4;
    Apex best{-1, starCentre(makeCellSurface(mesh_, id, mesh_.restPositions()))};
    if (rule_ == Retessellation::kMiddles && !is_tetrahedron) return best;
    double best_quality = worstQuality(surface, best);
    for (const VertexId vertex : vertices) {
      const Apex apex{vertex.index(), points_[vertex.index()]};
      const double worst = worstQuality(surface, apex);
      if (worst > best_quality || (best.vertex < 0 && worst > kGoodQuality))
        best = apex, best_quality = worst;
    }
    if (best_quality < kWorstQuality && mayGetMiddles(id)) return std::nullopt;
    return best;
  }

  bool mayGetMiddles(CellId id) const {
    const std::vector<FaceId>& faces = mesh_.cell(id).faces;
    return std::any_of(faces.begin(), faces.end(), [&](FaceId face) {
      return mesh_.face(face).loop.size() > 3 && middles_[face.index()] < 0;
    });
  }

  void addCell(CellId id, const Apex& apex, std::vector<std::array<int, 4>>& cells) {
    int vertex = apex.vertex;
    if (vertex < 0) {
      vertex = static_cast<int>(points_.size());
      points_.push_back(apex.point);
    }
    for (const Triangle& t : surfaceOf(id))
      if (std::find(t.begin(), t.end(), vertex) == t.end()) cells.push_back({vertex, t[0], t[1], t[2]});
  }

  const PolyhedralMesh& mesh_;
  const Retessellation rule_;
  std::vector<Eigen::Vector3d> points_;
  std::vector<std::vector<Triangle>> faces_;  // by face id, as the loop turns
  std::vector<int> middles_;                  // by face id, -1: none
};

}  // namespace

Tetrahedra retessellate(const PolyhedralMesh& mesh, Retessellation rule) {
  return Divider(mesh, rule).divide();
}

PolyhedralMesh toMesh(const Tetrahedra& tetrahedra) {
  std::vector<PolyhedralMesh::CellLoops> cells;
  cells.reserve(tetrahedra.cells.size());
  for (const auto& [a, b, c, d] : tetrahedra.cells)
    cells.push_back({{a, c, b}, {a, b, d}, {b, c, d}, {c, a, d}});
  return PolyhedralMesh(tetrahedra.points, cells);
}

}  // namespace polyscalpel::report
