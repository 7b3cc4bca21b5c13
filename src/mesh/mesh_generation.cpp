// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/mesh/mesh_generation.hpp"

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "polyscalpel/core/checks.hpp"
#include "standard_cells.hpp"

namespace polyscalpel {
namespace {

/// Above this number of cubes the face ids of five tets a cube would leave the range of int.
constexpr double kMaxCubes = 1e8;

/// The points of a box, x fastest, then y, then z.
class Grid {
 public:
  Grid(const Eigen::Vector3d& lowest, const Eigen::Vector3d& size, const Eigen::Vector3i& counts)
      : lowest_(lowest), size_(size), counts_(counts) {
    requireFinite("lowest", lowest);
    for (int axis = 0; axis < 3; ++axis) {
      const std::string index = "(" + std::to_string(axis) + ")";
      requirePositive("size" + index, size(axis));
      requireInRange("counts" + index, counts(axis), 1, kMaxCubes);
    }
    requireInRange("product of counts", counts.cast<double>().prod(), 1, kMaxCubes);
  }

  const Eigen::Vector3i& counts() const { return counts_; }

  int index(const Eigen::Vector3i& ijk) const {
    return ijk(0) + (counts_(0) + 1) * (ijk(1) + (counts_(1) + 1) * ijk(2));
  }

  /// 3 x n, one column per grid point [m].
  Eigen::Matrix3Xd points() const {
    Eigen::Matrix3Xd points(3, (counts_ + Eigen::Vector3i::Ones()).prod());
    for (int k = 0; k <= counts_(2); ++k) {
      for (int j = 0; j <= counts_(1); ++j) {
        for (int i = 0; i <= counts_(0); ++i) {
          const Eigen::Array3d ratios =
              Eigen::Array3i(i, j, k).cast<double>() / counts_.array().cast<double>();
          points.col(index({i, j, k})) = lowest_ + (size_.array() * ratios).matrix();
        }
      }
    }
    return points;
  }

  /// Calls visit with the lowest corner of each cube, x fastest.
  template <class Visit>
  void forEachCube(Visit visit) const {
    for (int k = 0; k < counts_(2); ++k) {
      for (int j = 0; j < counts_(1); ++j) {
        for (int i = 0; i < counts_(0); ++i) visit(Eigen::Vector3i(i, j, k));
      }
    }
  }

 private:
  Eigen::Vector3d lowest_;
  Eigen::Vector3d size_;
  Eigen::Vector3i counts_;
};

std::vector<PolyhedralMesh::CellLoops> makeHexes(const Grid& grid) {
  // Corners of a cube in the order of makeHexLoops.
  static const std::array<Eigen::Vector3i, 8> kCorners = {{{0, 0, 0},
                                                           {1, 0, 0},
                                                           {1, 1, 0},
                                                           {0, 1, 0},  //
                                                           {0, 0, 1},
                                                           {1, 0, 1},
                                                           {1, 1, 1},
                                                           {0, 1, 1}}};
  std::vector<PolyhedralMesh::CellLoops> cells;
  cells.reserve(grid.counts().prod());
  grid.forEachCube([&](const Eigen::Vector3i& cube) {
    std::array<int, 8> corners;
    for (int c = 0; c < 8; ++c) corners[c] = grid.index(cube + kCorners[c]);
    cells.push_back(makeHexLoops(corners));
  });
  return cells;
}

std::vector<PolyhedralMesh::CellLoops> makeTets(const Grid& grid) {
  std::vector<PolyhedralMesh::CellLoops> cells;
  cells.reserve(5 * static_cast<std::size_t>(grid.counts().prod()));
  const auto addTet = [&](const std::array<Eigen::Vector3i, 4>& corners) {
    Eigen::Matrix3i edges;
    for (int c = 0; c < 3; ++c) edges.col(c) = corners[c + 1] - corners[0];
    const int orientation = edges.col(0).dot(edges.col(1).cross(edges.col(2)));
    POLYSCALPEL_ASSERT(orientation != 0);
    std::array<int, 4> vertices;
    for (int c = 0; c < 4; ++c) vertices[c] = grid.index(corners[c]);
    if (orientation < 0) std::swap(vertices[2], vertices[3]);
    cells.push_back(makeTetLoops(vertices));
  };
  grid.forEachCube([&](const Eigen::Vector3i& cube) {
    std::array<Eigen::Vector3i, 4> central;
    int num_even = 0;
    for (int bits = 0; bits < 8; ++bits) {
      const Eigen::Vector3i corner = cube + Eigen::Vector3i(bits & 1, (bits >> 1) & 1, (bits >> 2) & 1);
      if (corner.sum() % 2 == 0) {
        central[num_even++] = corner;
        continue;
      }
      std::array<Eigen::Vector3i, 4> tet = {corner, corner, corner, corner};
      for (int axis = 0; axis < 3; ++axis) tet[axis + 1](axis) += corner(axis) == cube(axis) ? 1 : -1;
      addTet(tet);
    }
    POLYSCALPEL_ASSERT(num_even == 4);
    addTet(central);
  });
  return cells;
}

/// Map of the cube [-1, 1]^3 onto the unit ball along the rays from the centre: the concentric cube of half
/// edge s goes to a blend of itself (share 1 - s) and the sphere of radius s (share s). Cells in the middle
/// stay cubes, and at the corners of the cube, where three of its faces become one smooth surface, the cells
/// keep a positive volume. (Mapping each coordinate by the other two's squares is smoother, but singular
/// there: it turns cells over from 8^3 cubes on.)
Eigen::Vector3d mapCubeToBall(const Eigen::Vector3d& p) {
  const double half_edge = p.cwiseAbs().maxCoeff();
  if (half_edge == 0) return p;
  return p * ((1 - half_edge) + half_edge * half_edge / p.norm());
}

}  // namespace

PolyhedralMesh makeHexBox(const Eigen::Vector3d& lowest, const Eigen::Vector3d& size,
                          const Eigen::Vector3i& counts) {
  const Grid grid(lowest, size, counts);
  return PolyhedralMesh(grid.points(), makeHexes(grid));
}

PolyhedralMesh makeTetBox(const Eigen::Vector3d& lowest, const Eigen::Vector3d& size,
                          const Eigen::Vector3i& counts) {
  const Grid grid(lowest, size, counts);
  return PolyhedralMesh(grid.points(), makeTets(grid));
}

PolyhedralMesh makeTetBall(const Eigen::Vector3d& centre, double radius_m, int half_count) {
  requireFinite("centre", centre);
  requirePositive("radius_m", radius_m);
  requireInRange("half_count", half_count, 1, std::floor(std::cbrt(kMaxCubes) / 2));
  const Grid grid(-Eigen::Vector3d::Ones(), 2 * Eigen::Vector3d::Ones(),
                  Eigen::Vector3i::Constant(2 * half_count));
  Eigen::Matrix3Xd points = grid.points();
  for (int i = 0; i < points.cols(); ++i) points.col(i) = centre + radius_m * mapCubeToBall(points.col(i));
  return PolyhedralMesh(points, makeTets(grid));
}

}  // namespace polyscalpel
