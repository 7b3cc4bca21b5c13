// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>

#include "cell_integrals.hpp"
#include "polyscalpel/elements/element_formulation.hpp"
#include "polyscalpel/elements/mean_value_coordinates.hpp"
#include "polyscalpel/elements/quadrature.hpp"

namespace polyscalpel {
namespace {

/// The columns sqrt(w_q) (G_q - Gq), without what rounding has left of linear fields in them. Those have no
/// fluctuation, but flat cells, where gradients lose digits, give them a large one. What the position field
/// would feel, G X^T, is zero; it is taken out by means of Gm, whose own is exactly the identity: G - (G X^T)
/// Gm. points: 3 x n, of the cell's vertices.
Eigen::MatrixXd gradientFluctuation(const Eigen::Ref<const Eigen::MatrixXd>& gradients,
                                    const Eigen::VectorXd& weights,
                                    const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                    const Eigen::Matrix3Xd& mean_gradient) {
  const Eigen::VectorXd mean = gradients * weights / weights.sum();
  Eigen::MatrixXd fluctuation(gradients.rows(), gradients.cols());
  for (Eigen::Index q = 0; q < gradients.cols(); ++q) {
    fluctuation.col(q) = std::sqrt(weights[q]) * (gradients.col(q) - mean);
    Eigen::Map<Eigen::Matrix3Xd> of_vertices(fluctuation.col(q).data(), 3, points.cols());
    const Eigen::Matrix3d of_position = of_vertices.lazyProduct(points.transpose());
    of_vertices.noalias() -= of_position.lazyProduct(mean_gradient);
  }
  return fluctuation;
}

class MeanValueElement final : public ElementFormulation {
 public:
  explicit MeanValueElement(const ElementConfig& config)
      : config_(config), rule_(tetrahedronRule(config.quadrature_points)) {}

  ElementMatrices makeMatrices(const CellSurface& surface, const IsotropicMaterial& material) const override {
    const Eigen::Vector3d centre = starCentre(surface);
    const Eigen::Matrix3Xd points = surface.points.colwise() - centre;
    const CellQuadrature quadrature = makeCellQuadrature(surface, rule_, centre);
    thread_local MeanValueCoordinates<double> coordinates;
    coordinates.setSurface(surface, centre);
    coordinates.evaluate(quadrature.points);

    ElementMatrices element;
    setVolumeAndMeanGradient(surface, points, element);
    if (config_.gradient_correction) {
      const Eigen::MatrixXd fluctuation =
          gradientFluctuation(coordinates.gradients(), quadrature.weights,
                              points.leftCols(surface.num_vertices), element.mean_gradient);
      Eigen::MatrixXd H = Eigen::MatrixXd::Zero(fluctuation.rows(), fluctuation.rows());
      H.selfadjointView<Eigen::Lower>().rankUpdate(fluctuation, config_.stabilisation_scale);
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
