// SPDX-License-Identifier: BSD-3-Clause
#include "support/hard_cases.hpp"

#include <cmath>
#include <exception>
#include <sstream>

#include <Eigen/Geometry>

#include "polyscalpel/mesh/surface.hpp"
#include "polyscalpel/simulation/static_solution.hpp"
#include "support/hard_cases_parts.hpp"

namespace polyscalpel {

std::vector<HardCaseEntry> hardCaseEntries() {
  std::vector<HardCaseEntry> entries;
  for (const std::vector<HardCaseEntry>& part : {elementCases(), bodyCases(), motionCases()}) {
    for (const HardCaseEntry& entry : part) {
      entries.push_back({entry.name, [entry](Extent extent) {
                           HardCase row;
                           try {
                             row = entry.run(extent);
                           } catch (const std::exception& error) {
                             row.what_happens = std::string("threw: ") + error.what();
                             row.value = std::numeric_limits<double>::quiet_NaN();
                           }
                           row.name = entry.name;
                           return row;
                         }});
    }
  }
  return entries;
}

std::vector<HardCase> runHardCases(Extent extent, const std::function<void(const HardCase&)>& progress) {
  std::vector<HardCase> rows;
  for (const HardCaseEntry& entry : hardCaseEntries()) {
    rows.push_back(entry.run(extent));
    if (progress) progress(rows.back());
  }
  return rows;
}

std::string figure(double value) {
  std::ostringstream text;
  text.precision(2);
  text << value;
  return text.str();
}

void judge(HardCase& row, double value, double bound, bool as_said) {
  row.value = value;
  row.bound = bound;
  row.as_said = as_said;
  row.held = as_said && value <= bound;
}

std::vector<double> evenly(double lowest, double highest, int count) {
  std::vector<double> values;
  for (int i = 0; i <= count; ++i) values.push_back(lowest + (highest - lowest) * i / count);
  return values;
}

PolyhedralMesh makeGridBox(const std::vector<double>& xs, const std::vector<double>& ys,
                           const std::vector<double>& zs) {
  const int nx = static_cast<int>(xs.size()), ny = static_cast<int>(ys.size()),
            nz = static_cast<int>(zs.size());
  const auto at = [&](int i, int j, int k) { return i + nx * (j + ny * k); };
  Eigen::Matrix3Xd points(3, nx * ny * nz);
  std::vector<PolyhedralMesh::CellLoops> cells;
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        points.col(at(i, j, k)) = Eigen::Vector3d(xs[i], ys[j], zs[k]);
        if (i + 1 == nx || j + 1 == ny || k + 1 == nz) continue;
        const int v[] = {at(i, j, k),     at(i + 1, j, k),     at(i + 1, j + 1, k),     at(i, j + 1, k),
                         at(i, j, k + 1), at(i + 1, j, k + 1), at(i + 1, j + 1, k + 1), at(i, j + 1, k + 1)};
        cells.push_back({{v[0], v[3], v[2], v[1]},
                         {v[4], v[5], v[6], v[7]},
                         {v[0], v[1], v[5], v[4]},
                         {v[1], v[2], v[6], v[5]},
                         {v[2], v[3], v[7], v[6]},
                         {v[3], v[0], v[4], v[7]}});
      }
    }
  }
  return PolyhedralMesh(points, cells);
}

std::vector<bool> lowestX(const PolyhedralMesh& mesh) {
  const double lowest = mesh.restPositions().row(0).minCoeff();
  std::vector<bool> flags(mesh.numVertices());
  for (int i = 0; i < mesh.numVertices(); ++i) flags[i] = mesh.restPosition(VertexId(i)).x() <= lowest;
  return flags;
}

Eigen::Matrix3d meanDeformation(const PolyhedralMesh& mesh, const Assembly& assembly, CellId cell,
                                const Eigen::Matrix3Xd& positions) {
  const std::vector<VertexId>& vertices = mesh.cell(cell).vertices;
  const Eigen::Matrix3Xd& gradient = assembly.elementMatrices(cell).mean_gradient;
  Eigen::Matrix3d F = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    F += (positions.col(vertices[i].index()) - positions.col(vertices[0].index())) *
         gradient.col(static_cast<int>(i)).transpose();
  }
  return F;
}

Eigen::VectorXd cellDeterminants(const PolyhedralMesh& mesh, const Assembly& assembly,
                                 const Eigen::Matrix3Xd& positions) {
  Eigen::VectorXd determinants(mesh.numCells());
  int i = 0;
  for (const CellId id : mesh.cells())
    determinants[i++] = meanDeformation(mesh, assembly, id, positions).determinant();
  return determinants;
}

Eigen::Matrix3Xd boundaryLoads(const PolyhedralMesh& mesh, const Eigen::Matrix3d& stress) {
  Eigen::Matrix3Xd loads = Eigen::Matrix3Xd::Zero(3, mesh.numVertices());
  for (int f = 0; f < mesh.faceCapacity(); ++f) {
    const Face& face = mesh.face(FaceId(f));
    if (!face.isAlive() || !face.isBoundary()) continue;
    for (int i = 0; i < numTriangles(face); ++i) {
      const Eigen::Matrix3d corners = triangleCorners(face, i, mesh.restPositions());
      const Eigen::Vector3d area_vector = 0.5 * Eigen::Vector3d(corners.col(1) - corners.col(0))
                                                    .cross(Eigen::Vector3d(corners.col(2) - corners.col(0)));
      for (const WeightedVertex& w : vertexWeights(face, i, Eigen::Vector3d::Constant(1.0 / 3))) {
        loads.col(w.vertex.index()) += w.weight * (stress * area_vector);
      }
    }
  }
  return loads;
}

double patchTestError(const PolyhedralMesh& mesh, const std::vector<bool>& is_held,
                      const IsotropicMaterial& material) {
  ElementConfig config;
  config.strain = Strain::kLinear;
  Assembly assembly(mesh, material, config, 0);
  Eigen::Matrix3d gradient;
  gradient << 0.011, -0.004, 0.007, 0.003, -0.009, 0.002, -0.005, 0.006, 0.008;
  const Eigen::Matrix3Xd exact = gradient * mesh.restPositions();
  const Eigen::Matrix3d strain = 0.5 * (gradient + gradient.transpose());
  const Eigen::Matrix3d stress = lameLambda(material) * strain.trace() * Eigen::Matrix3d::Identity() +
                                 2 * shearModulus(material) * strain;
  Eigen::Matrix3Xd lift = Eigen::Matrix3Xd::Zero(3, mesh.numVertices());
  for (int i = 0; i < mesh.numVertices(); ++i) {
    if (is_held[i]) lift.col(i) = exact.col(i);
  }
  Eigen::Matrix3Xd lift_forces;
  assembly.internalForces(mesh.restPositions() + lift, lift_forces);
  const StaticSolution solution =
      solveStatic(mesh, assembly, is_held, boundaryLoads(mesh, stress) - lift_forces);
  if (solution.status != SolveStatus::kSolved) return kInfinity;
  return (solution.displacements + lift - exact).norm() / exact.norm();
}

}  // namespace polyscalpel
