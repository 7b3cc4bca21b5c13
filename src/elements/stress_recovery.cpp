// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/stress_recovery.hpp"

#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/elements/corotation.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

using SymmetricTensor = Eigen::Matrix<double, 6, 1>;

SymmetricTensor toColumn(const Eigen::Matrix3d& A) {
  SymmetricTensor column;
  column << A(0, 0), A(1, 1), A(2, 2), A(1, 2), A(2, 0), A(0, 1);
  return column;
}

/// a : C^-1 : b for Hooke's law, from stresses.
class Compliance {
 public:
  explicit Compliance(const IsotropicMaterial& material)
      : shear_(1 / (2 * shearModulus(material))),
        trace_(material.poisson_ratio / material.youngs_modulus_pa) {}

  double operator()(const SymmetricTensor& a, const SymmetricTensor& b) const {
    const double product = a.head<3>().dot(b.head<3>()) + 2 * a.tail<3>().dot(b.tail<3>());
    return shear_ * product - trace_ * a.head<3>().sum() * b.head<3>().sum();
  }

 private:
  double shear_, trace_;
};

/// Integral over a cell of e : C^-1 : e, e the field that is linear on each sub-tet (vertex mean, surface
/// triangle) and takes these values at the vertices, their means at virtual vertices and the vertex mean. On
/// a tetrahedron that is the linear field. Exact: over a tetrahedron of volume v it is v / 20 times (sum over
/// the corners of e_i^2 + square of the sum).
double squaredNorm(const CellSurface& surface, const SymmetricTensors& values, const Compliance& compliance) {
  const int n = surface.num_vertices;
  SymmetricTensors at_points(6, surface.points.cols());
  at_points.leftCols(n) = values;
  for (std::size_t i = 0; i < surface.parents.size(); ++i) {
    SymmetricTensor mean = SymmetricTensor::Zero();
    for (const int parent : surface.parents[i]) mean += values.col(parent);
    at_points.col(n + static_cast<Eigen::Index>(i)) = mean / static_cast<double>(surface.parents[i].size());
  }
  const SymmetricTensor middle = values.rowwise().mean();
  const Eigen::Vector3d apex = starCentre(surface);
  double result = 0;
  for (const std::array<int, 3>& triangle : surface.triangles) {
    Eigen::Matrix3d edges;
    SymmetricTensor sum = middle;
    double squares = compliance(middle, middle);
    for (int corner = 0; corner < 3; ++corner) {
      edges.col(corner) = surface.points.col(triangle[corner]) - apex;
      const SymmetricTensor value = at_points.col(triangle[corner]);
      sum += value;
      squares += compliance(value, value);
    }
    const double volume = edges.col(0).dot(edges.col(1).cross(edges.col(2))) / 6;
    result += volume / 20 * (squares + compliance(sum, sum));
  }
  return result;
}

/// Means at the vertices of the stresses of the cells that `counts` holds for.
template <class Predicate>
SymmetricTensors smooth(const PolyhedralMesh& mesh, const Assembly& assembly,
                        const std::vector<CellId>& cells, const SymmetricTensors& cell_stresses,
                        const Predicate& counts) {
  SymmetricTensors sums = SymmetricTensors::Zero(6, mesh.numVertices());
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(mesh.numVertices());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (!counts(cells[c])) continue;
    const Eigen::VectorXd& share = assembly.elementMatrices(cells[c]).shape_integral;
    const std::vector<VertexId>& vertices = mesh.cell(cells[c]).vertices;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const double weight = share[static_cast<Eigen::Index>(i)];
      sums.col(vertices[i].index()) += weight * cell_stresses.col(static_cast<Eigen::Index>(c));
      weights[vertices[i].index()] += weight;
    }
  }
  for (Eigen::Index i = 0; i < sums.cols(); ++i) {
    if (weights[i] > 0) sums.col(i) /= weights[i];
  }
  return sums;
}

}  // namespace

StressField recoverStress(const PolyhedralMesh& mesh, const Assembly& assembly,
                          const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  POLYSCALPEL_ASSERT(positions.cols() == mesh.numVertices() && assembly.numVertices() == mesh.numVertices());
  StressField field;
  field.cells = mesh.cells();
  const Eigen::Index num_cells = static_cast<Eigen::Index>(field.cells.size());
  field.cell_stresses.resize(6, num_cells);
  field.cell_strains.resize(6, num_cells);
  const StrainMeasure& measure = assembly.strainMeasure();
  for (Eigen::Index c = 0; c < num_cells; ++c) {
    const ElementMatrices& element = assembly.elementMatrices(field.cells[c]);
    const std::vector<VertexId>& vertices = mesh.cell(field.cells[c]).vertices;
    Eigen::Matrix3Xd local(3, static_cast<Eigen::Index>(vertices.size()));
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      local.col(static_cast<Eigen::Index>(i)) =
          positions.col(vertices[i].index()) - positions.col(vertices[0].index());
    }
    const IsotropicMaterial& material = assembly.kind(assembly.kindOf(field.cells[c])).material;
    const Eigen::Matrix3d F = meanDeformationGradient(local, element.mean_gradient);
    const Eigen::Matrix3d R = measure.rotation(F);
    field.cell_stresses.col(c) =
        toColumn(measure.cauchyStress(F, R, {lameLambda(material), shearModulus(material)}));
    field.cell_strains.col(c) = toColumn(measure.strain(F, R));
  }
  field.vertex_stresses = smoothStresses(mesh, assembly, field.cells, field.cell_stresses);

  field.cell_errors.resize(num_cells);
  double squared_error = 0;
  for (int kind = 0; kind < assembly.numKinds(); ++kind) {
    // Across a change of material the stress itself jumps: smoothing over it would count as error.
    const auto is_of_kind = [&](CellId cell) { return assembly.kindOf(cell) == kind; };
    SymmetricTensors of_kind;
    if (assembly.numKinds() > 1)
      of_kind = smooth(mesh, assembly, field.cells, field.cell_stresses, is_of_kind);
    const SymmetricTensors& smoothed = assembly.numKinds() > 1 ? of_kind : field.vertex_stresses;
    const Compliance compliance(assembly.kind(kind).material);
    for (Eigen::Index c = 0; c < num_cells; ++c) {
      if (!is_of_kind(field.cells[c])) continue;
      const std::vector<VertexId>& vertices = mesh.cell(field.cells[c]).vertices;
      SymmetricTensors difference(6, static_cast<Eigen::Index>(vertices.size()));
      for (std::size_t i = 0; i < vertices.size(); ++i) {
        difference.col(static_cast<Eigen::Index>(i)) =
            smoothed.col(vertices[i].index()) - field.cell_stresses.col(c);
      }
      const double squared =
          squaredNorm(makeCellSurface(mesh, field.cells[c], mesh.restPositions()), difference, compliance);
      field.cell_errors[c] = std::sqrt(std::max(squared, 0.0));
      squared_error += std::max(squared, 0.0);
    }
  }
  const double total = squared_error + 2 * assembly.elasticEnergy(positions);
  field.relative_error = total > 0 ? std::sqrt(squared_error / total) : 0;
  return field;
}

SymmetricTensors smoothStresses(const PolyhedralMesh& mesh, const Assembly& assembly,
                                const std::vector<CellId>& cells, const SymmetricTensors& cell_stresses) {
  return smooth(mesh, assembly, cells, cell_stresses, [](CellId) { return true; });
}

Eigen::VectorXd vonMises(const SymmetricTensors& stresses) {
  const auto s = stresses.array();
  return (0.5 * ((s.row(0) - s.row(1)).square() + (s.row(1) - s.row(2)).square() +
                 (s.row(2) - s.row(0)).square()) +
          3 * (s.row(3).square() + s.row(4).square() + s.row(5).square()))
      .sqrt()
      .matrix()
      .transpose();
}

Eigen::Matrix3Xd principalValues(const SymmetricTensors& stresses) {
  Eigen::Matrix3Xd values(3, stresses.cols());
  for (Eigen::Index i = 0; i < stresses.cols(); ++i) {
    const auto s = stresses.col(i);
    Eigen::Matrix3d stress;
    stress << s[0], s[5], s[4], s[5], s[1], s[3], s[4], s[3], s[2];
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(stress, Eigen::EigenvaluesOnly);
    values.col(i) = eigen.eigenvalues().reverse();
  }
  return values;
}

}  // namespace polyscalpel
