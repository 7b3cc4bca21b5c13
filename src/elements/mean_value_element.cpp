// SPDX-License-Identifier: BSD-3-Clause
#include "cell_integrals.hpp"
#include "polyscalpel/elements/element_formulation.hpp"
#include "polyscalpel/elements/mean_value_coordinates.hpp"
#include "polyscalpel/elements/quadrature.hpp"

namespace polyscalpel {
namespace {

/// The columns sqrt(w_q) (G_q - Gq) H. Linear fields have no fluctuation, but in flat cells, where gradients
/// lose digits, rounding would give them a large one: the modes H leave them out. gradients: a column a
/// point, of the cell's vertices.
Eigen::MatrixXd gradientFluctuation(const Eigen::Ref<const Eigen::MatrixXd>& gradients,
                                    const Eigen::VectorXd& weights, const Eigen::MatrixXd& modes) {
  Eigen::MatrixXd fluctuation(3 * modes.cols(), gradients.cols());
  for (Eigen::Index q = 0; q < gradients.cols(); ++q) {
    const Eigen::Map<const Eigen::Matrix3Xd> of_vertices(gradients.col(q).data(), 3, modes.rows());
    Eigen::Map<Eigen::Matrix3Xd>(fluctuation.col(q).data(), 3, modes.cols()) = of_vertices.lazyProduct(modes);
  }
  const Eigen::VectorXd mean = fluctuation * weights / weights.sum();
  fluctuation.colwise() -= mean;
  fluctuation *= weights.cwiseSqrt().asDiagonal();
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
      const auto corners = points.leftCols(surface.num_vertices);
      Stabilisation& stabilisation = element.stabilisation;
      stabilisation.modes = nonLinearModes(corners);
      stabilisation.rest_modes = corners * stabilisation.modes;
      const Eigen::MatrixXd fluctuation =
          gradientFluctuation(coordinates.gradients(), quadrature.weights, stabilisation.modes);
      Eigen::MatrixXd products = Eigen::MatrixXd::Zero(fluctuation.rows(), fluctuation.rows());
      products.selfadjointView<Eigen::Lower>().rankUpdate(fluctuation, config_.stabilisation_scale);
      stabilisation.stiffness =
          stiffnessFromGradientProducts(products, stabilisationModuli(material, config_));
    } else {
      setUncorrected(coordinates.gradients(), quadrature.weights, points.leftCols(surface.num_vertices),
                     material, element);
    }
    setMass(coordinates.values(), quadrature.weights, element);
    return element;
  }

 private:
  /// K = sum_q w_q G_q^T C G_q, as it comes: the remainder S may then be indefinite, and linear fields feel
  /// it, so that each vertex is a mode.
  static void setUncorrected(const Eigen::Ref<const Eigen::MatrixXd>& gradients,
                             const Eigen::VectorXd& weights,
                             const Eigen::Ref<const Eigen::Matrix3Xd>& corners,
                             const IsotropicMaterial& material, ElementMatrices& element) {
    const Eigen::MatrixXd H = gradients * weights.asDiagonal() * gradients.transpose();
    const Eigen::MatrixXd K =
        stiffnessFromGradientProducts(H, {lameLambda(material), shearModulus(material)});
    element.stabilisation = {Eigen::MatrixXd::Identity(corners.cols(), corners.cols()),
                             K - stiffness(element, material), corners};
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
