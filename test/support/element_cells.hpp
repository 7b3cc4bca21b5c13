// SPDX-License-Identifier: BSD-3-Clause
//
// Cells for the tests of elements: their surfaces, made by hand.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {

/// A polyhedron as points and outward loops; hanging[v] marks vertices that carry no virtual vertex.
struct PolyhedronSketch {
  Eigen::Matrix3Xd points;
  std::vector<std::vector<int>> loops;
  std::vector<bool> hanging;
};

struct NamedCell {
  std::string name;
  CellSurface surface;
  bool is_convex = true;
};

inline CellSurface makeSurface(const PolyhedronSketch& sketch) {
  CellSurface surface;
  surface.num_vertices = static_cast<int>(sketch.points.cols());
  surface.points = sketch.points;
  for (const std::vector<int>& loop : sketch.loops) {
    if (loop.size() == 3) {
      surface.triangles.push_back({loop[0], loop[1], loop[2]});
      continue;
    }
    const int centre = static_cast<int>(surface.points.cols());
    std::vector<int> corners;
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const int vertex : loop) {
      if (!sketch.hanging.empty() && sketch.hanging[vertex]) continue;
      corners.push_back(vertex);
      mean += sketch.points.col(vertex);
    }
    surface.points.conservativeResize(3, centre + 1);
    surface.points.col(centre) = mean / corners.size();
    surface.parents.emplace_back(corners.begin(), corners.end());
    for (std::size_t i = 0; i < loop.size(); ++i)
      surface.triangles.push_back({centre, loop[i], loop[(i + 1) % loop.size()]});
  }
  return surface;
}

inline PolyhedronSketch makeTetrahedronSketch() {
  PolyhedronSketch sketch;
  sketch.points.resize(3, 4);
  sketch.points << 0.1, 1.2, 0.3, 0.2,  //
      0.0, 0.1, 0.9, 0.3,               //
      0.0, 0.1, 0.2, 0.8;
  sketch.loops = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return sketch;
}

inline PolyhedronSketch makeCubeSketch() {
  PolyhedronSketch sketch;
  sketch.points.resize(3, 8);
  sketch.points << 0, 1, 1, 0, 0, 1, 1, 0,  //
      0, 0, 1, 1, 0, 0, 1, 1,               //
      0, 0, 0, 0, 1, 1, 1, 1;
  sketch.loops = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  return sketch;
}

/// What a plane leaves of a tetrahedron when it cuts off one corner.
inline PolyhedronSketch makePrismSketch() {
  const Eigen::Matrix3Xd tet = makeTetrahedronSketch().points;
  PolyhedronSketch sketch;
  sketch.points.resize(3, 6);
  const double cuts[] = {0.3, 0.5, 0.6};
  for (int i = 0; i < 3; ++i) {
    sketch.points.col(i) = tet.col(i);
    sketch.points.col(i + 3) = tet.col(i) + cuts[i] * (tet.col(3) - tet.col(i));
  }
  sketch.loops = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
  return sketch;
}

/// The part of a convex polyhedron on the side normal . x <= offset; the plane may not pass through a vertex.
inline PolyhedronSketch clip(const PolyhedronSketch& sketch, const Eigen::Vector3d& normal, double offset) {
  std::vector<Eigen::Vector3d> points;
  std::map<std::pair<int, int>, int> index;  // (v, v): kept vertex; (v, w): crossing of an edge
  const auto height = [&](int v) { return normal.dot(sketch.points.col(v)) - offset; };
  const auto indexOf = [&](int v, int w) {
    const auto key = std::minmax(v, w);
    const auto [found, is_new] = index.try_emplace({key.first, key.second}, static_cast<int>(points.size()));
    if (is_new) {
      const double a = height(key.first), b = height(key.second);
      const Eigen::Vector3d p = sketch.points.col(key.first), q = sketch.points.col(key.second);
      points.push_back(v == w ? p : Eigen::Vector3d(p + a / (a - b) * (q - p)));
    }
    return found->second;
  };
  PolyhedronSketch result;
  std::map<int, int> cap_next;
  for (const std::vector<int>& loop : sketch.loops) {
    std::vector<int> kept;
    int enters = -1, leaves = -1;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const int v = loop[i], w = loop[(i + 1) % loop.size()];
      if (height(v) < 0) kept.push_back(indexOf(v, v));
      if ((height(v) < 0) == (height(w) < 0)) continue;
      kept.push_back(indexOf(v, w));
      (height(v) < 0 ? leaves : enters) = kept.back();
    }
    if (kept.size() >= 3) result.loops.push_back(kept);
    if (leaves >= 0) cap_next[enters] = leaves;  // the face runs from leaves to enters, the cap against it
  }
  if (!cap_next.empty()) {
    std::vector<int> cap;
    for (int v = cap_next.begin()->first; cap.empty() || v != cap.front(); v = cap_next.at(v))
      cap.push_back(v);
    result.loops.push_back(cap);
  }
  result.points.resize(3, points.size());
  for (std::size_t i = 0; i < points.size(); ++i) result.points.col(i) = points[i];
  return result;
}

/// A cube cut by random planes around its centre.
inline PolyhedronSketch makeRandomSketch(unsigned seed, int num_planes) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> distance(0.3, 0.5);
  PolyhedronSketch sketch = makeCubeSketch();
  for (int i = 0; i < num_planes; ++i) {
    const Eigen::Vector3d direction =
        Eigen::Vector3d(normal(generator), normal(generator), normal(generator)).normalized();
    sketch = clip(sketch, direction, direction.dot(Eigen::Vector3d::Constant(0.5)) + distance(generator));
  }
  return sketch;
}

/// Hangs a vertex into every second edge, as the cut of a neighbour would.
inline PolyhedronSketch withHangingVertices(PolyhedronSketch sketch) {
  std::map<std::pair<int, int>, int> middle;
  sketch.hanging.assign(sketch.points.cols(), false);
  int count = 0;
  for (const std::vector<int>& loop : sketch.loops) {
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const auto edge = std::minmax(loop[i], loop[(i + 1) % loop.size()]);
      const auto [found, is_new] = middle.try_emplace({edge.first, edge.second}, -1);
      if (!is_new || count++ % 2 == 1) continue;
      found->second = static_cast<int>(sketch.points.cols());
      const double t = 0.3 + 0.05 * (count % 7);
      const Eigen::Vector3d p = (1 - t) * sketch.points.col(edge.first) + t * sketch.points.col(edge.second);
      sketch.points.conservativeResize(3, found->second + 1);
      sketch.points.col(found->second) = p;
      sketch.hanging.push_back(true);
    }
  }
  for (std::vector<int>& loop : sketch.loops) {
    std::vector<int> longer;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const auto edge = std::minmax(loop[i], loop[(i + 1) % loop.size()]);
      longer.push_back(loop[i]);
      const int hung = middle.at({edge.first, edge.second});
      if (hung >= 0) longer.push_back(hung);
    }
    loop = longer;
  }
  return sketch;
}

/// Every kind of cell, of size about 1.
inline std::vector<NamedCell> makeCells() {
  std::vector<NamedCell> cells;
  cells.push_back({"tetrahedron", makeSurface(makeTetrahedronSketch())});
  cells.push_back({"cube", makeSurface(makeCubeSketch())});
  cells.push_back({"prism", makeSurface(makePrismSketch())});
  cells.push_back({"hanging tetrahedron", makeSurface(withHangingVertices(makeTetrahedronSketch()))});
  cells.push_back({"hanging cube", makeSurface(withHangingVertices(makeCubeSketch()))});
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const PolyhedronSketch sketch = makeRandomSketch(seed, 2 + 2 * static_cast<int>(seed));
    cells.push_back({"random " + std::to_string(seed), makeSurface(sketch)});
    cells.push_back({"hanging random " + std::to_string(seed), makeSurface(withHangingVertices(sketch))});
  }
  PolyhedronSketch flat = makePrismSketch();
  flat.points.row(2) *= 0.02;
  cells.push_back({"flat prism", makeSurface(flat)});
  PolyhedronSketch bent = makeCubeSketch();
  bent.points.col(6) = Eigen::Vector3d(0.75, 0.8, 0.7);
  bent.points.col(1) = Eigen::Vector3d(1.1, -0.2, 0.1);
  cells.push_back({"bent cube", makeSurface(bent), false});
  return cells;
}

/// The same cell under x -> A x + b.
inline CellSurface transformed(CellSurface surface, const Eigen::Matrix3d& A, const Eigen::Vector3d& b) {
  surface.points = (A * surface.points).colwise() + b;
  return surface;
}

}  // namespace polyscalpel
