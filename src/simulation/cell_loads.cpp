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

/// Cauchy stresses of the mean strains of cells of one material.
struct Stresses {
  std::vector<CellId> cells;               // ascending
  SymmetricTensors elastic, with_damping;  // 6 x cells [Pa]
};

Eigen::Matrix<double, 6, 1> toColumn(const Matrix3d& A) {
  Eigen::Matrix<double, 6, 1> column;
  column << A(0, 0), A(1, 1), A(2, 2), A(1, 2), A(2, 0), A(0, 1);
  return column;
}

/// The damping's part is that of the rate of S, of F = R S, to the first order in the strain: a rigid motion
/// has none.
Stresses findStresses(const PolyhedralMesh& mesh, const Assembly& assembly, int kind,
                      const Positions& positions, const Positions& velocities, double stiffness_damping_s) {
  Stresses stresses;
  for (int i = 0; i < mesh.cellCapacity(); ++i) {
    if (mesh.cell(CellId(i)).isAlive() && assembly.kindOf(CellId(i)) == kind)
      stresses.cells.push_back(CellId(i));
  }
  const Eigen::Index n = static_cast<Eigen::Index>(stresses.cells.size());
  stresses.elastic.resize(6, n);
  stresses.with_damping.resize(6, n);
  const IsotropicMaterial& material = assembly.kind(kind).material;
  const StrainMeasure& measure = assembly.strainMeasure();
  Matrix3Xd x, v;
  for (Eigen::Index c = 0; c < n; ++c) {
    const std::vector<VertexId>& vertices = mesh.cell(stresses.cells[c]).vertices;
    x.resize(3, static_cast<Eigen::Index>(vertices.size()));
    v.resize(3, x.cols());
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      x.col(i) = positions.col(vertices[i].index());
      v.col(i) = velocities.col(vertices[i].index());
    }
    const Matrix3Xd& gradient = assembly.elementMatrices(stresses.cells[c]).mean_gradient;
    const Matrix3d F = meanDeformationGradient(x, gradient);
    const Matrix3d R = measure.rotation(F);
    const Matrix3d elastic = measure.cauchyStress(F, R, {lameLambda(material), shearModulus(material)});
    stresses.elastic.col(c) = toColumn(elastic);
    stresses.with_damping.col(c) = stresses.elastic.col(c);
    if (stiffness_damping_s == 0) continue;
    const Matrix3d rate = meanDeformationGradient(v, gradient) * R.transpose();
    stresses.with_damping.col(c) +=
        stiffness_damping_s * toColumn(stressOf((rate + rate.transpose()) / 2, material));
  }
  return stresses;
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
  for (int kind = 0; kind < assembly.numKinds(); ++kind) {
    const IsotropicMaterial& material = assembly.kind(kind).material;
    if (material.strength_pa == 0) continue;
    const Stresses stresses = findStresses(mesh, assembly, kind, positions, velocities, stiffness_damping_s);
    const SymmetricTensors smoothed = smoothStresses(mesh, assembly, stresses.cells, stresses.with_damping);
    for (std::size_t i = 0; i < stresses.cells.size(); ++i) {
      CellLoad load;
      load.cell = stresses.cells[i];
      load.stress_pa = meanOf(smoothed, mesh, load.cell);
      // No eigenvalue is larger than the norm.
      if (load.stress_pa.norm() <= material.strength_pa) continue;
      load.elastic_stress_pa = toMatrix(stresses.elastic.col(static_cast<Eigen::Index>(i)));
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
