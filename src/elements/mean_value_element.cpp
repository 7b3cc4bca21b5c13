// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "cell_integrals.hpp"
#include "polyscalpel/elements/element_formulation.hpp"
#include "polyscalpel/elements/mean_value_coordinates.hpp"
#include "polyscalpel/elements/quadrature.hpp"

namespace polyscalpel {
namespace {

/// sum_q w_q (G_q - Gq) (G_q - Gq)^T, lower triangle.
Eigen::MatrixXd gradientFluctuation(const Eigen::Ref<const Eigen::MatrixXd>& gradients,
                                    const Eigen::VectorXd& weights) {
  const Eigen::VectorXd mean = gradients * weights / weights.sum();
  const Eigen::VectorXd roots = weights.cwiseSqrt();
  Eigen::MatrixXd fluctuation(gradients.rows(), gradients.cols());
  for (Eigen::Index q = 0; q < gradients.cols(); ++q) {
    fluctuation.col(q) = roots[q] * (gradients.col(q) - mean);
  }
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(gradients.rows(), gradients.rows());
  H.selfadjointView<Eigen::Lower>().rankUpdate(fluctuation);
  return H;
}

/// Linear fields have no fluctuation. Rounding leaves one, large in flat cells, where gradients lose digits:
/// take the gradient of the position field, which should be zero, out by means of Gm, whose own is exactly
/// the identity. G - (G X^T) Gm = G Q, Q = I - X^T Gm, so H turns into Q^T H Q, by vertices.
void removeLinearFields(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                        const Eigen::Matrix3Xd& mean_gradient, Eigen::MatrixXd& H) {
  const Eigen::Index n = mean_gradient.cols();
  Eigen::MatrixXd Q = -points.transpose() * mean_gradient;
  Q.diagonal().array() += 1;
  H.triangularView<Eigen::StrictlyUpper>() = H.transpose();
  // A Q, for each of a vertex's three columns.
  const auto timesQ = [&](const Eigen::MatrixXd& A) {
    using Columns = Eigen::OuterStride<>;
    Eigen::MatrixXd product(3 * n, 3 * n);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Map<const Eigen::MatrixXd, 0, Columns> of_A(A.data() + 3 * n * k, 3 * n, n,
                                                               Columns(9 * n));
      Eigen::Map<Eigen::MatrixXd, 0, Columns> of_product(product.data() + 3 * n * k, 3 * n, n,
                                                         Columns(9 * n));
      of_product.noalias() = of_A.lazyProduct(Q);
    }
    return product;
  };
  H = timesQ(timesQ(H).transpose());
}

class MeanValueElement final : public ElementFormulation {
 public:
  explicit MeanValueElement(const ElementConfig& config)
      : config_(config), rule_(tetrahedronRule(config.quadrature_points)) {}

  ElementMatrices makeMatrices(const CellSurface& surface, const IsotropicMaterial& material) const override {
    const Eigen::Matrix3Xd points = surface.points.colwise() - starCentre(surface);
    const CellQuadrature quadrature = makeCellQuadrature(surface, rule_);
    thread_local MeanValueCoordinates<double> coordinates;
    coordinates.setSurface(surface);
    coordinates.evaluate(quadrature.points);

    ElementMatrices element;
    setVolumeAndMeanGradient(surface, points, element);
    if (config_.gradient_correction) {
      Eigen::MatrixXd H = gradientFluctuation(coordinates.gradients(), quadrature.weights);
      removeLinearFields(points.leftCols(surface.num_vertices), element.mean_gradient, H);
      H *= config_.stabilisation_scale;
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
