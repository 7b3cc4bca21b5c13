// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/element_formulation.hpp"

#include <stdexcept>

#include <Eigen/Geometry>

#include "cell_integrals.hpp"
#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/elements/quadrature.hpp"

namespace polyscalpel {

// A third of each triangle's area vector to each of its corners.
void setVolumeAndMeanGradient(const CellSurface& surface, const Eigen::Matrix3Xd& points,
                              ElementMatrices& element) {
  Eigen::Matrix3Xd flux = Eigen::Matrix3Xd::Zero(3, points.cols());
  double sixfold_volume = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    const Eigen::Vector3d p = points.col(a);
    const Eigen::Vector3d third = (points.col(b) - p).cross(points.col(c) - p) / 6;
    sixfold_volume += 6 * p.dot(third);
    flux.col(a) += third;
    flux.col(b) += third;
    flux.col(c) += third;
  }
  for (std::size_t i = 0; i < surface.parents.size(); ++i) {
    const Eigen::Vector3d share = flux.col(surface.num_vertices + i) / surface.parents[i].size();
    for (const int parent : surface.parents[i]) flux.col(parent) += share;
  }
  element.volume = sixfold_volume / 6;
  requirePositive("volume of a cell", element.volume);
  element.mean_gradient = flux.leftCols(surface.num_vertices) / element.volume;
}

Eigen::MatrixXd stiffnessFromGradientProducts(const Eigen::MatrixXd& H, const LameModuli& moduli) {
  Eigen::MatrixXd K(H.rows(), H.cols());
  for (Eigen::Index b = 0; b < H.cols(); b += 3) {
    for (Eigen::Index a = b; a < H.rows(); a += 3) {
      Eigen::Matrix3d block = H.block<3, 3>(a, b);
      if (a == b) block.triangularView<Eigen::StrictlyUpper>() = block.transpose();
      Eigen::Matrix3d k = moduli.lambda_pa * block + moduli.mu_pa * block.transpose();
      k.diagonal().array() += moduli.mu_pa * block.trace();
      K.block<3, 3>(a, b) = k;
      if (a != b) K.block<3, 3>(b, a) = k.transpose();
    }
  }
  return K;
}

void validate(const ElementConfig& config) {
  tetrahedronRule(config.quadrature_points);
  requirePositive("stabilisation_scale", config.stabilisation_scale);
}

LameModuli stabilisationModuli(const IsotropicMaterial& material, const ElementConfig& config) {
  const bool shear_only = config.stabilisation_modulus == StabilisationModulus::kShear ||
                          (config.stabilisation_modulus == StabilisationModulus::kAutomatic &&
                           material.poisson_ratio > ElementConfig::kShearOnlyAbove);
  return {shear_only ? 0 : lameLambda(material), shearModulus(material)};
}

CellFormulation::CellFormulation(const ElementConfig& config) {
  validate(config);
  tetrahedron_ = makeTetrahedronElement(config);
  switch (config.formulation) {
    case Formulation::kMeanValue:
      polyhedron_ = makeMeanValueElement(config);
      return;
    case Formulation::kVirtual:
      polyhedron_ = makeVirtualElement(config);
      return;
  }
  throw std::invalid_argument("formulation = " + std::to_string(static_cast<int>(config.formulation)) +
                              ": must be mean_value or virtual");
}

ElementMatrices CellFormulation::makeMatrices(const CellSurface& surface,
                                              const IsotropicMaterial& material) const {
  return (surface.isTetrahedron() ? tetrahedron_ : polyhedron_)->makeMatrices(surface, material);
}

ElementMatrices makeElementMatrices(const CellSurface& surface, const IsotropicMaterial& material,
                                    const ElementConfig& config) {
  return CellFormulation(config).makeMatrices(surface, material);
}

Eigen::MatrixXd stiffness(const ElementMatrices& element, const IsotropicMaterial& material) {
  const auto gradient = element.mean_gradient.reshaped();
  const Eigen::MatrixXd H = element.volume * gradient * gradient.transpose();
  Eigen::MatrixXd K = stiffnessFromGradientProducts(H, {lameLambda(material), shearModulus(material)});
  if (!element.stabilisation.isEmpty()) K += element.stabilisation.matrix();
  return K;
}

}  // namespace polyscalpel
