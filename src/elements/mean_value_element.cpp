// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "cell_integrals.hpp"
#include "polyscalpel/elements/element_formulation.hpp"
#include "polyscalpel/elements/mean_value_coordinates.hpp"
#include "polyscalpel/elements/quadrature.hpp"

namespace polyscalpel {
namespace {

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

class MeanValueElement final : public ElementFormulation {
 public:
  explicit MeanValueElement(const ElementConfig& config)
      : config_(config), rule_(tetrahedronRule(config.quadrature_points)) {}

  ElementMatrices makeMatrices(const CellSurface& surface, const IsotropicMaterial& material) const override {
    const Eigen::Matrix3Xd points = surface.points.colwise() - vertexMean(surface);
    const CellQuadrature quadrature = makeCellQuadrature(surface, rule_);
    thread_local MeanValueCoordinates<double> coordinates;
    coordinates.setSurface(surface);
    coordinates.evaluate(quadrature.points);

    ElementMatrices element;
    setVolumeAndMeanGradient(surface, points, element);
    const Eigen::Index num_dofs = 3 * surface.num_vertices;
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(num_dofs, num_dofs);
    if (config_.gradient_correction) {
      addGradientFluctuation(coordinates.gradients(), quadrature.weights, points, element.mean_gradient,
                             config_.stabilisation_scale, H);
      element.stabilisation = stiffnessFromGradientProducts(H, stabilisationModuli(material, config_));
    } else {
      setUncorrected(coordinates.gradients(), quadrature.weights, material, element);
    }
    setMass(coordinates.values(), quadrature.weights, element);
    return element;
  }

 private:
  /// K = sum_q w_q G_q^T C G_q, as it comes: the remainder S may then be indefinite, and linear fields feel
  /// it.
  static void setUncorrected(const Eigen::Ref<const Eigen::MatrixXd>& gradients,
                             const Eigen::VectorXd& weights, const IsotropicMaterial& material,
                             ElementMatrices& element) {
    const Eigen::MatrixXd H = gradients * weights.asDiagonal() * gradients.transpose();
    const Eigen::MatrixXd K =
        stiffnessFromGradientProducts(H, {lameLambda(material), shearModulus(material)});
    element.stabilisation = K - stiffness(element, material);
  }

  /// Linear precision of the coordinates keeps the cell's mass and centroid, whatever the rule, unless
  /// something is clipped.
  void setMass(const Eigen::Ref<const Eigen::MatrixXd>& values, const Eigen::VectorXd& weights,
               ElementMatrices& element) const {
    element.shape_integral = (values * weights).cwiseMax(0);
    element.shape_integral *= element.volume / element.shape_integral.sum();
    if (!config_.consistent_mass) return;
    const Eigen::MatrixXd scaled = values * weights.cwiseSqrt().asDiagonal();
    element.mass_integral = scaled * scaled.transpose();
  }

  ElementConfig config_;
  const TetrahedronRule& rule_;
};

}  // namespace

std::unique_ptr<const ElementFormulation> makeMeanValueElement(const ElementConfig& config) {
  return std::make_unique<MeanValueElement>(config);
}

}  // namespace polyscalpel
