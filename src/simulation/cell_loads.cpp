// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/cell_loads.hpp"

#include <algorithm>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/elements/corotation.hpp"
#include "polyscalpel/elements/stress_recovery.hpp"

namespace polyscalpel {
namespace {

using Eigen::Matrix3d;
using Eigen::Matrix3Xd;
using Positions = Eigen::Ref<const Matrix3Xd>;

/// Hooke's law, and the other way round.
Matrix3d stressOf(const Matrix3d& strain, const IsotropicMaterial& material) {
  return 2 * shearModulus(material) * strain + lameLambda(material) * strain.trace() * Matrix3d::Identity();
}
Matrix3d strainOf(const Matrix3d& stress, const IsotropicMaterial& material) {
  const double nu = material.poisson_ratio;
  return ((1 + nu) * stress - nu * stress.trace() * Matrix3d::Identity()) / material.youngs_modulus_pa;
}

/// Rate of strain of a cell [1/s], world frame: of F = R S that of S, to the first order in the strain. A
/// rigid motion has none.
Matrix3d strainRate(const PolyhedralMesh& mesh, const Assembly& assembly, CellId cell,
                    const Positions& positions, const Positions& velocities) {
  const std::vector<VertexId>& vertices = mesh.cell(cell).vertices;
  Matrix3Xd x(3, vertices.size()), v(3, vertices.size());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    x.col(i) = positions.col(vertices[i].index());
    v.col(i) = velocities.col(vertices[i].index());
  }
  const Matrix3Xd& gradient = assembly.elementMatrices(cell).mean_gradient;
  const Matrix3d R = assembly.strainMeasure().rotation(meanDeformationGradient(x, gradient));
  const Matrix3d rate = meanDeformationGradient(v, gradient) * R.transpose();
  return (rate + rate.transpose()) / 2;
}

Matrix3d toMatrix(const Eigen::Matrix<double, 6, 1>& s) {
  Matrix3d matrix;
  matrix << s[0], s[5], s[4], s[5], s[1], s[3], s[4], s[3], s[2];
  return matrix;
}

/// Mean over the vertices of a cell.
Matrix3d meanOf(const SymmetricTensors& at_vertices, const PolyhedralMesh& mesh, CellId cell) {
  Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
  for (const VertexId v : mesh.cell(cell).vertices) sum += at_vertices.col(v.index());
  return toMatrix(sum) / static_cast<double>(mesh.cell(cell).vertices.size());
}

}  // namespace

std::vector<CellLoad> findCellLoads(const PolyhedralMesh& mesh, const Assembly& assembly,
                                    const Positions& positions, const Positions& velocities,
                                    double stiffness_damping_s) {
  POLYSCALPEL_ASSERT(velocities.cols() == mesh.numVertices());
  std::vector<CellLoad> loads;
  const CellStresses elastic = findCellStresses(mesh, assembly, positions);
  for (int kind = 0; kind < assembly.numKinds(); ++kind) {
    const IsotropicMaterial& material = assembly.kind(kind).material;
    if (material.strength_pa == 0) continue;
    SymmetricTensors smoothed = smoothStresses(mesh, assembly, elastic, kind);
    if (stiffness_damping_s > 0) {
      CellStresses viscous = elastic;
      for (std::size_t i = 0; i < elastic.cells.size(); ++i) {
        if (assembly.kindOf(elastic.cells[i]) != kind) continue;
        const Matrix3d stress =
            stiffness_damping_s *
            stressOf(strainRate(mesh, assembly, elastic.cells[i], positions, velocities), material);
        viscous.cell_stresses.col(static_cast<Eigen::Index>(i)) << stress(0, 0), stress(1, 1), stress(2, 2),
            stress(1, 2), stress(2, 0), stress(0, 1);
      }
      smoothed += smoothStresses(mesh, assembly, viscous, kind);
    }
    for (std::size_t i = 0; i < elastic.cells.size(); ++i) {
      const CellId cell = elastic.cells[i];
      if (assembly.kindOf(cell) != kind) continue;
      CellLoad load;
      load.cell = cell;
      load.stress_pa = meanOf(smoothed, mesh, cell);
      // No eigenvalue is larger than the norm.
      if (load.stress_pa.norm() <= material.strength_pa) continue;
      load.elastic_stress_pa = toMatrix(elastic.cell_stresses.col(static_cast<Eigen::Index>(i)));
      load.elastic_strain = strainOf(load.elastic_stress_pa, material);
      load.strength_pa = material.strength_pa;
      load.fracture_toughness_j_m2 = material.fracture_toughness_j_m2;
      loads.push_back(load);
    }
  }
  std::sort(loads.begin(), loads.end(), [](const CellLoad& a, const CellLoad& b) { return a.cell < b.cell; });
  return loads;
}

}  // namespace polyscalpel
