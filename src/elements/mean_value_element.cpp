// SPDX-License-Identifier: BSD-3-Clause
//
// M. Wicke, M. Botsch, M. Gross, "A finite element method on convex polyhedra", 2007; C. Talischi, A.
// Pereira, I. F. M. Menezes, G. H. Paulino, "Gradient correction for polygonal and polyhedral finite
// elements", 2015.
#include "polyscalpel/elements/element_matrices.hpp"

#include <cmath>

#include <Eigen/Geometry>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/elements/mean_value_coordinates.hpp"
#include "polyscalpel/elements/quadrature.hpp"

namespace polyscalpel {
namespace {

/// V and Gm = 1/V * closed integral of N_i n dS. N_i is linear on each triangle: a third of its area vector
/// to each corner.
void setVolumeAndMeanGradient(const CellSurface& surface, const Eigen::Matrix3Xd& points,
                              ElementMatrices& element) {
  Eigen::Matrix3Xd flux = Eigen::Matrix3Xd::Zero(3, points.cols());
  double sixfold_volume = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    const Eigen::Vector3d p = points.col(a);
    const Eigen::Vector3d area_vector =
        (points.col(b) - p).cross(points.col(c) - p) / 6;  // a third of the area
    sixfold_volume += 6 * p.dot(area_vector);
    flux.col(a) += area_vector;
    flux.col(b) += area_vector;
    flux.col(c) += area_vector;
  }
  for (std::size_t i = 0; i < surface.parents.size(); ++i) {
    const Eigen::Vector3d share = flux.col(surface.num_vertices + i) / surface.parents[i].size();
    for (const int parent : surface.parents[i]) flux.col(parent) += share;
  }
  element.volume = sixfold_volume / 6;
  requirePositive("volume of a cell", element.volume);
  element.mean_gradient = flux.leftCols(surface.num_vertices) / element.volume;
}

/// Gradient products H (3n x 3n, H_ab = integral of g_a g_b^T; its lower triangle is read) to
/// K_ab = lambda H_ab + mu H_ab^T + mu tr(H_ab) I, which is B_a^T C B_b for isotropic C.
Eigen::MatrixXd stiffnessFromGradientProducts(const Eigen::MatrixXd& H, const IsotropicMaterial& material) {
  const double lambda = lameLambda(material);
  const double mu = shearModulus(material);
  Eigen::MatrixXd K(H.rows(), H.cols());
  for (Eigen::Index b = 0; b < H.cols(); b += 3) {
    for (Eigen::Index a = b; a < H.rows(); a += 3) {
      Eigen::Matrix3d block = H.block<3, 3>(a, b);
      if (a == b) block.triangularView<Eigen::StrictlyUpper>() = block.transpose();
      Eigen::Matrix3d k = lambda * block + mu * block.transpose();
      k.diagonal().array() += mu * block.trace();
      K.block<3, 3>(a, b) = k;
      if (a != b) K.block<3, 3>(b, a) = k.transpose();
    }
  }
  return K;
}

/// Adds scale * sum_q w_q (G_q - Gq) (G_q - Gq)^T to the lower triangle of H.
void addGradientFluctuation(const Eigen::Ref<const Eigen::MatrixXd>& gradients,
                            const Eigen::VectorXd& weights, const Eigen::Matrix3Xd& points,
                            const Eigen::Matrix3Xd& mean_gradient, double scale, Eigen::MatrixXd& H) {
  const Eigen::Index n = mean_gradient.cols();
  const Eigen::VectorXd mean = gradients * weights / weights.sum();
  Eigen::MatrixXd fluctuation = gradients.colwise() - mean;
  for (Eigen::Index q = 0; q < fluctuation.cols(); ++q) {
    Eigen::Map<Eigen::Matrix3Xd> of_point(fluctuation.col(q).data(), 3, n);
    // Linear fields have no fluctuation. Rounding leaves one, large in flat cells, where gradients lose
    // digits: take the gradient of the position field, which should be zero, out by means of Gm, whose own is
    // exactly the identity.
    Eigen::Matrix3d residual = Eigen::Matrix3d::Zero();
    for (Eigen::Index i = 0; i < n; ++i) residual += of_point.col(i) * points.col(i).transpose();
    for (Eigen::Index i = 0; i < n; ++i) of_point.col(i) -= residual * mean_gradient.col(i);
    of_point *= std::sqrt(scale * weights(q));
  }
  H.selfadjointView<Eigen::Lower>().rankUpdate(fluctuation);
}

void setTetrahedronMass(const ElementConfig& config, ElementMatrices& element) {
  element.shape_integral.setConstant(4, element.volume / 4);
  if (!config.consistent_mass) return;
  element.mass_integral.setConstant(4, 4, element.volume / 20);
  element.mass_integral.diagonal() *= 2;
}

/// Linear precision of the coordinates keeps the cell's mass and centroid, whatever the rule, unless
/// something is clipped.
void setMass(const Eigen::Ref<const Eigen::MatrixXd>& values, const Eigen::VectorXd& weights,
             const ElementConfig& config, ElementMatrices& element) {
  element.shape_integral = (values * weights).cwiseMax(0);
  element.shape_integral *= element.volume / element.shape_integral.sum();
  if (!config.consistent_mass) return;
  const Eigen::MatrixXd scaled = values * weights.cwiseSqrt().asDiagonal();
  element.mass_integral = scaled * scaled.transpose();
}

}  // namespace

void validate(const ElementConfig& config) {
  tetrahedronRule(config.quadrature_points);
  requirePositive("stabilisation_scale", config.stabilisation_scale);
}

ElementMatrices makeElementMatrices(const CellSurface& surface, const IsotropicMaterial& material,
                                    const ElementConfig& config) {
  const TetrahedronRule& rule = tetrahedronRule(config.quadrature_points);
  const Eigen::Matrix3Xd points = surface.points.colwise() - vertexMean(surface);
  ElementMatrices element;
  setVolumeAndMeanGradient(surface, points, element);
  const auto flat_gradient = element.mean_gradient.reshaped();
  Eigen::MatrixXd H = element.volume * flat_gradient * flat_gradient.transpose();
  if (surface.isTetrahedron()) {
    setTetrahedronMass(config, element);
  } else {
    const CellQuadrature quadrature = makeCellQuadrature(surface, rule);
    thread_local MeanValueCoordinates<double> coordinates;
    coordinates.setSurface(surface);
    coordinates.evaluate(quadrature.points);
    addGradientFluctuation(coordinates.gradients(), quadrature.weights, points, element.mean_gradient,
                           config.stabilisation_scale, H);
    setMass(coordinates.values(), quadrature.weights, config, element);
  }
  element.stiffness = stiffnessFromGradientProducts(H, material);
  return element;
}

}  // namespace polyscalpel
