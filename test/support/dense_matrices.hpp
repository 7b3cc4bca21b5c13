// SPDX-License-Identifier: BSD-3-Clause
//
// Sparse matrices written out, 3 n x 3 n.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "polyscalpel/core/block_matrix.hpp"
#include "polyscalpel/core/difference_matrix.hpp"
#include "polyscalpel/elements/corotation.hpp"
#include "polyscalpel/elements/element_formulation.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

inline Eigen::MatrixXd toDense(const BlockPattern& pattern, const Blocks& blocks) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * pattern.numVertices(), 3 * pattern.numVertices());
  for (int column = 0; column < pattern.numVertices(); ++column) {
    for (int k = pattern.column_start[column]; k < pattern.column_start[column + 1]; ++k) {
      dense.block<3, 3>(3 * pattern.row[k], 3 * column) = blocks[k];
      dense.block<3, 3>(3 * column, 3 * pattern.row[k]) = blocks[k].transpose();
    }
  }
  return dense;
}

/// A_ij of an entry.
template <class Scalar>
Eigen::Matrix3d blockOf(const DifferenceMatrix<Scalar>& matrix, int entry) {
  return Eigen::Map<const Eigen::Matrix<Scalar, 3, 3>>(&matrix.blocks[9 * static_cast<std::size_t>(entry)])
      .template cast<double>();
}

template <class Scalar>
Eigen::MatrixXd toDense(const RowPattern& pattern, const DifferenceMatrix<Scalar>& matrix) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * pattern.numVertices(), 3 * pattern.numVertices());
  for (int i = 0; i < pattern.numVertices(); ++i) {
    const RowPattern::Row& row = pattern.rows[i];
    Eigen::Matrix3d diagonal = static_cast<double>(matrix.masses[i]) * Eigen::Matrix3d::Identity();
    for (int entry = row.first; entry < row.first + row.count; ++entry) {
      dense.block<3, 3>(3 * i, 3 * pattern.column[entry]) = blockOf(matrix, entry);
      diagonal -= blockOf(matrix, entry);
    }
    dense.block<3, 3>(3 * i, 3 * i) = diagonal;
  }
  for (const auto& tie : matrix.ties)
    dense.block<3, 3>(3 * tie.vertex, 3 * tie.vertex) += tie.stiffness.template cast<double>();
  return dense;
}

/// Places of the vertices' numbers, 3 each.
inline std::vector<int> dofsOf(const std::vector<int>& vertices) {
  std::vector<int> dofs;
  for (const int vertex : vertices) {
    for (int c = 0; c < 3; ++c) dofs.push_back(3 * vertex + c);
  }
  return dofs;
}

inline std::vector<int> indicesOf(const std::vector<VertexId>& vertices) {
  std::vector<int> indices;
  for (const VertexId vertex : vertices) indices.push_back(vertex.index());
  return indices;
}

/// Plain stiffness warping: f = sum R K (R^T x - X) and its matrix sum R K R^T, cell by cell, straight from
/// the element's matrices.
inline void assembleDense(const PolyhedralMesh& mesh, const IsotropicMaterial& material,
                          const ElementConfig& config, const Eigen::Matrix3Xd& positions,
                          Eigen::MatrixXd& matrix, Eigen::VectorXd& forces) {
  matrix.setZero(3 * mesh.numVertices(), 3 * mesh.numVertices());
  forces.setZero(3 * mesh.numVertices());
  for (const CellId id : mesh.cells()) {
    const ElementMatrices element =
        makeElementMatrices(makeCellSurface(mesh, id, mesh.restPositions()), material, config);
    const std::vector<int> vertices = indicesOf(mesh.cell(id).vertices), dofs = dofsOf(vertices);
    const Eigen::Matrix3Xd x = positions(Eigen::all, vertices);
    const Eigen::Matrix3Xd X = mesh.restPositions()(Eigen::all, vertices);
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    if (config.strain == Strain::kCorotated)
      R = polarRotation(meanDeformationGradient(x, element.mean_gradient));
    Eigen::MatrixXd rotation = Eigen::MatrixXd::Zero(dofs.size(), dofs.size());
    for (std::size_t i = 0; i < vertices.size(); ++i) rotation.block<3, 3>(3 * i, 3 * i) = R;
    const Eigen::Matrix3Xd u = R.transpose() * x - X;
    const Eigen::MatrixXd K = stiffness(element, material);
    matrix(dofs, dofs) += rotation * K * rotation.transpose();
    forces(dofs) += rotation * (K * Eigen::VectorXd(u.reshaped()));
  }
}

/// M, consistent or lumped as the config says.
inline Eigen::MatrixXd massDense(const PolyhedralMesh& mesh, const IsotropicMaterial& material,
                                 const ElementConfig& config) {
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(3 * mesh.numVertices(), 3 * mesh.numVertices());
  for (const CellId id : mesh.cells()) {
    const ElementMatrices element =
        makeElementMatrices(makeCellSurface(mesh, id, mesh.restPositions()), material, config);
    const std::vector<int> vertices = indicesOf(mesh.cell(id).vertices);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      for (std::size_t j = 0; j < vertices.size(); ++j) {
        const double integral = config.consistent_mass ? element.mass_integral(i, j)
                                : i == j               ? element.shape_integral[i]
                                                       : 0;
        for (int c = 0; c < 3; ++c)
          matrix(3 * vertices[i] + c, 3 * vertices[j] + c) += material.density_kg_m3 * integral;
      }
    }
  }
  return matrix;
}

}  // namespace polyscalpel
