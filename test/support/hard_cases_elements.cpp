// SPDX-License-Identifier: BSD-3-Clause
//
// Hard cases of one cell: a linear field must give the nodal forces of its tractions, and the stiffness must
// stay positive semidefinite, whatever the cell's shape.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <Eigen/Eigenvalues>

#include "polyscalpel/elements/element_formulation.hpp"
#include "support/element_cells.hpp"
#include "support/hard_cases_parts.hpp"

namespace polyscalpel {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

const IsotropicMaterial kMaterial{1.0, 0.3, 1.0};

/// How well a cell does.
struct CellErrors {
  double relative = 0;   ///< nodal forces of a linear field against those of its tractions
  double roundings = 0;  ///< the worst of force and semidefiniteness, in units of its rounding estimate
};

/// The forces come from the surface alone, so no code is shared with what is tested. Rounding estimates: a
/// force is a sum of products of K and u, and an entry of K a sum over the quadrature points, so eps |K| |u|
/// times their number; an eigenvalue is off by eps |K| times the same.
CellErrors measureCell(const CellSurface& surface) {
  ElementConfig config;
  const int n = surface.num_vertices;
  const Eigen::MatrixXd K = stiffness(makeElementMatrices(surface, kMaterial, config), kMaterial);
  Matrix3d gradient;
  gradient << 0.011, -0.004, 0.007, 0.003, -0.009, 0.002, -0.005, 0.006, 0.008;
  const Matrix3d strain = 0.5 * (gradient + gradient.transpose());
  const Matrix3d stress =
      lameLambda(kMaterial) * strain.trace() * Matrix3d::Identity() + 2 * shearModulus(kMaterial) * strain;
  Matrix3Xd expected = Matrix3Xd::Zero(3, surface.points.cols());
  for (const std::array<int, 3>& triangle : surface.triangles) {
    const Vector3d a = surface.points.col(triangle[0]);
    const Vector3d force =
        stress * (surface.points.col(triangle[1]) - a).cross(surface.points.col(triangle[2]) - a) / 6;
    for (const int point : triangle) expected.col(point) += force;
  }
  for (std::size_t k = 0; k < surface.parents.size(); ++k) {
    for (const int parent : surface.parents[k]) {
      expected.col(parent) += expected.col(n + static_cast<int>(k)) / surface.parents[k].size();
    }
  }
  expected.conservativeResize(3, n);
  const Matrix3Xd displacements =
      gradient * (surface.points.leftCols(n).colwise() - surface.points.leftCols(n).rowwise().mean());
  const Eigen::VectorXd forces = K * displacements.reshaped();
  const double error = (forces - expected.reshaped()).norm();
  const double terms = static_cast<double>(config.quadrature_points * surface.triangles.size());

  CellErrors errors;
  errors.relative = error / expected.norm();
  errors.roundings = error / (kEpsilon * terms * K.norm() * displacements.norm());
  const double lowest =
      Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K, Eigen::EigenvaluesOnly).eigenvalues()[0];
  errors.roundings = std::max(errors.roundings, -lowest / (kEpsilon * terms * K.norm()));
  // std::max passes a NaN over.
  if (!K.allFinite()) errors.roundings = errors.relative = std::numeric_limits<double>::quiet_NaN();
  return errors;
}

CellErrors worse(const CellErrors& a, const CellErrors& b) {
  const auto larger = [](double x, double y) { return x >= y ? x : y; };  // y where one of them is NaN ...
  CellErrors result{larger(a.relative, b.relative), larger(a.roundings, b.roundings)};
  if (std::isnan(a.roundings)) result = a;  // ... so a NaN stays
  return result;
}

constexpr const char* kQuantity = "error over its rounding estimate";

/// A unit cube cut at distances of a vertex, an edge or a face; both parts. The cut is at the far corner,
/// where coordinates have rounding of their own.
HardCase cutNear(const Vector3d& normal, Extent extent) {
  const auto both = [&](double distance) {
    const PolyhedronSketch cube = makeCubeSketch();
    const Vector3d unit = normal.normalized();
    const double offset = unit.sum() - distance;
    return worse(measureCell(makeSurface(clip(cube, unit, offset))),
                 measureCell(makeSurface(clip(cube, -unit, -offset))));
  };
  HardCase row;
  row.quantity = kQuantity;
  CellErrors all, last;
  for (int digits = 1; digits <= 10; ++digits) {
    last = both(std::pow(10, -digits));
    all = worse(all, last);
  }
  // The estimate counts every term; more than that is a loss of digits by the formula.
  judge(row, all.roundings, 1);
  row.what_happens =
      "Both parts give a linear field's forces to rounding at every distance; at 1e-10 that is " +
      figure(last.relative) + " of the force.";
  row.limit = "1e-10 of the edge is the smallest distance tried.";
  if (extent == Extent::kFull) {
    int digits = 10;
    try {
      while (digits < 16 && both(std::pow(10, -digits - 1)).relative < 1e-3) ++digits;
      row.limit = "The force is good to 1e-3 down to a distance of " + figure(std::pow(10, -digits)) +
                  " of the edge.";
    } catch (const std::invalid_argument&) {
      row.limit = "Nearer than " + figure(std::pow(10, -digits)) +
                  " of the edge the cell is refused as not star-shaped: the distance is rounding.";
    }
  }
  return row;
}

/// A cube with each face in m x m coplanar ones.
PolyhedronSketch makeTiledCube(int m) {
  std::map<std::array<int, 3>, int> index;
  std::vector<Vector3d> points;
  const auto indexOf = [&](const Eigen::Vector3i& p) {
    const auto [found, is_new] = index.try_emplace({p[0], p[1], p[2]}, static_cast<int>(points.size()));
    if (is_new) points.push_back(p.cast<double>() / m);
    return found->second;
  };
  PolyhedronSketch sketch;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, m}) {
      for (int i = 0; i < m; ++i) {
        for (int j = 0; j < m; ++j) {
          std::vector<int> loop;
          for (const auto& [a, b] : {std::pair{0, 0}, std::pair{1, 0}, std::pair{1, 1}, std::pair{0, 1}}) {
            Eigen::Vector3i p;
            p[axis] = side;
            p[(axis + 1) % 3] = i + a;
            p[(axis + 2) % 3] = j + b;
            loop.push_back(indexOf(p));
          }
          if (side == 0) std::reverse(loop.begin(), loop.end());
          sketch.loops.push_back(loop);
        }
      }
    }
  }
  sketch.points.resize(3, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) sketch.points.col(i) = points[i];
  return sketch;
}

HardCase manyVerticesInFaces(Extent extent) {
  HardCase row;
  row.quantity = kQuantity;
  CellErrors all;
  int num_vertices = 0;
  const int most = extent == Extent::kFull ? 5 : 3;
  for (int m = 2; m <= most; ++m) {
    const PolyhedronSketch tiled = makeTiledCube(m), hung = withHangingVertices(tiled);
    all = worse(all, worse(measureCell(makeSurface(tiled)), measureCell(makeSurface(hung))));
    num_vertices = static_cast<int>(hung.points.cols());
  }
  judge(row, all.roundings, 1);
  row.what_happens = "A cube with " + std::to_string(num_vertices) +
                     " vertices, most of them inside its faces and edges, gives a linear field's forces to " +
                     figure(all.relative) + ".";
  row.limit = "None found; the time to make a cell's matrices grows with vertices times triangles.";
  return row;
}

HardCase sixtyFaces(Extent) {
  PolyhedronSketch ball = makeCubeSketch();
  // Planes around a sphere, evenly by a spiral: near enough to each other to leave nothing of the cube.
  constexpr int kPlanes = 60;
  for (int i = 0; i < kPlanes; ++i) {
    const double z = 1 - (2 * i + 1.0) / kPlanes, angle = i * EIGEN_PI * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    const Vector3d direction(r * std::cos(angle), r * std::sin(angle), z);
    ball = clip(ball, direction, direction.sum() / 2 + 0.4);
  }
  HardCase row;
  row.quantity = kQuantity;
  const CellErrors errors = measureCell(makeSurface(ball));
  judge(row, errors.roundings, 1, ball.loops.size() == kPlanes);
  row.what_happens = "A polyhedron with " + std::to_string(ball.loops.size()) + " faces and " +
                     std::to_string(ball.points.cols()) + " vertices gives a linear field's forces to " +
                     figure(errors.relative) + ".";
  row.limit = "None found; the time to make a cell's matrices grows with vertices times triangles.";
  return row;
}

/// Every vertex of a cube moved by a part of the edge, so that all faces are bent.
PolyhedronSketch makeBentCube(double part) {
  PolyhedronSketch cube = makeCubeSketch();
  for (int i = 0; i < 8; ++i) {
    const Vector3d X = cube.points.col(i);
    // Neighbours in a face go to and fro.
    const double sense = static_cast<int>(X.sum()) % 2 == 0 ? 1 : -1;
    cube.points.col(i) += sense * part * (Vector3d::Constant(0.5) - X).cwiseSign();
  }
  return cube;
}

HardCase bentFaces(Extent extent) {
  HardCase row;
  row.quantity = kQuantity;
  CellErrors all;
  for (const double part : {0.01, 0.02, 0.05, 0.1, 0.15, 0.2}) {
    all = worse(all, measureCell(makeSurface(makeBentCube(part))));
  }
  judge(row, all.roundings, 1);
  row.what_happens =
      "Cubes whose vertices lie 1 to 20 % of the edge off their faces, to both sides in turn, "
      "give a linear field's forces to " +
      figure(all.relative) + ".";
  row.limit = "20 % is the most tried.";
  if (extent == Extent::kFull) {
    double part = 0.2;
    try {
      for (; part < 1; part += 0.01) measureCell(makeSurface(makeBentCube(part + 0.01)));
      row.limit = "None found up to 100 %.";
    } catch (const std::invalid_argument&) {
      row.limit = "From " + figure(part + 0.01) +
                  " of the edge on the cell is not star-shaped from its vertex mean and is refused.";
    }
  }
  return row;
}

}  // namespace

std::vector<HardCaseEntry> elementCases() {
  return {{"cell cut near a vertex",
           [](Extent extent) {
             return cutNear({1, 1.1, 0.9}, extent);
           }},
          {"cell cut near an edge",
           [](Extent extent) {
             return cutNear({1, 0.8, 0}, extent);
           }},
          {"cell cut near a face",
           [](Extent extent) {
             return cutNear({1, 0, 0}, extent);
           }},
          {"vertices inside faces and edges", manyVerticesInFaces},
          {"faces bent by 1 to 20 %", bentFaces},
          {"cell with 60 faces", sixtyFaces}};
}

}  // namespace polyscalpel
