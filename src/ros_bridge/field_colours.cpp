// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/field_colours.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "polyscalpel/ros_bridge/geometry_conversions.hpp"

namespace polyscalpel {
namespace {

constexpr int kNumColours = 6;
const std::array<Eigen::Vector3d, kNumColours> kColours = {
    Eigen::Vector3d(0.10, 0.12, 0.42), Eigen::Vector3d(0.42, 0.16, 0.58), Eigen::Vector3d(0.78, 0.24, 0.42),
    Eigen::Vector3d(0.93, 0.49, 0.22), Eigen::Vector3d(0.96, 0.76, 0.33), Eigen::Vector3d(1.00, 0.96, 0.74)};
/// Part of a colour's brightness that is lost in the dark: enough to see the shape, too little to be taken
/// for another value.
constexpr double kShadow = 0.3;

/// Error energy of each cell over its volume at rest, as the mean over the cells around each vertex.
Eigen::VectorXd vertexErrors(const PolyhedralMesh& mesh, const StressField& field) {
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(mesh.numVertices());
  Eigen::VectorXi counts = Eigen::VectorXi::Zero(mesh.numVertices());
  for (std::size_t i = 0; i < field.cells.size(); ++i) {
    const CellId cell = field.cells[i];
    const double error = field.cell_errors[static_cast<Eigen::Index>(i)];
    const double density = error * error / volume(makeCellSurface(mesh, cell, mesh.restPositions()));
    for (const VertexId vertex : mesh.cell(cell).vertices) {
      sums[vertex.index()] += density;
      ++counts[vertex.index()];
    }
  }
  return sums.array() / counts.cwiseMax(1).cast<double>().array();
}

double valueAt(const Face& face, int triangle, int corner, const Eigen::VectorXd& vertex_values) {
  double value = 0;
  for (const WeightedVertex& w : vertexWeights(face, triangle, Eigen::Vector3d::Unit(corner)))
    value += w.weight * vertex_values[w.vertex.index()];
  return value;
}

Eigen::VectorXd valuesOfAll(const PolyhedralMesh& mesh, const StressField& field, ColourBy colour_by) {
  switch (colour_by) {
    case ColourBy::kVonMises:
      return vonMises(field.vertex_stresses);
    case ColourBy::kMaxPrincipal:
      return principalValues(field.vertex_stresses).row(0).transpose();
    case ColourBy::kError:
      return vertexErrors(mesh, field);
    case ColourBy::kNone:
    case ColourBy::kPiece:
      break;
  }
  POLYSCALPEL_ASSERT(!"a colouring that shows no field");
  return {};
}

}  // namespace

Eigen::Vector3d mapColour(double value) {
  const double place = std::clamp(value, 0.0, 1.0) * (kNumColours - 1);
  const int below = std::min(static_cast<int>(place), kNumColours - 2);
  const double part = place - below;
  const auto i = static_cast<std::size_t>(below);
  return (1 - part) * kColours[i] + part * kColours[i + 1];
}

Eigen::VectorXd vertexValues(const PolyhedralMesh& mesh, const StressField& field, ColourBy colour_by) {
  Eigen::VectorXd values = valuesOfAll(mesh, field, colour_by);
  for (int i = 0; i < mesh.numVertices(); ++i) {
    if (mesh.isRetired(VertexId(i))) values[i] = std::numeric_limits<double>::quiet_NaN();
  }
  return values;
}

Eigen::Vector2d colourRange(const Eigen::VectorXd& values, const Eigen::Vector2d& asked_pa) {
  if (!asked_pa.isZero(0) || values.size() == 0) return asked_pa;
  return {values.minCoeff<Eigen::PropagateNumbers>(), values.maxCoeff<Eigen::PropagateNumbers>()};
}

std::string describeColours(ColourBy colour_by, const Eigen::Vector2d& range_pa) {
  const char* name = colour_by == ColourBy::kVonMises       ? "von Mises stress"
                     : colour_by == ColourBy::kMaxPrincipal ? "largest principal stress"
                                                            : "error energy density";
  char text[100];
  std::snprintf(text, sizeof(text), "%s %.4g to %.4g Pa", name, range_pa(0), range_pa(1));
  return text;
}

void colourByValues(visualization_msgs::Marker& marker, const PolyhedralMesh& mesh,
                    const SurfaceTriangles& triangles, const Eigen::VectorXd& vertex_values,
                    const Eigen::Vector2d& range_pa) {
  const double width = range_pa(1) - range_pa(0);
  const double alpha = marker.color.a;
  marker.colors.clear();
  for (std::size_t i = 0; i < triangles.origins.size(); ++i) {
    const auto& [face, triangle] = triangles.origins[i];
    for (int corner = 0; corner < 3; ++corner) {
      const double value = valueAt(mesh.face(face), triangle, corner, vertex_values);
      const double light = std::min(1.0, 1.3 * lightOn(triangles.normals[i].col(corner)));
      Eigen::Vector4d rgba;
      rgba << (1 - kShadow * (1 - light)) * mapColour(width > 0 ? (value - range_pa(0)) / width : 0), alpha;
      marker.colors.push_back(toColourMsg(rgba));
    }
  }
}

}  // namespace polyscalpel
