// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "cell_integrals.hpp"
#include "polyscalpel/elements/element_formulation.hpp"

namespace polyscalpel {
namespace {

/// With this, a cube's S has the trace that mean value coordinates with four points give it.
constexpr double kScaleOfCube = 0.0854;

/// The field that is linear on every sub-tet (vertex mean, surface triangle), its value at the vertex mean
/// being the mean of all vertices': integrals of its shape functions are exact on linear fields, and never
/// negative in a star-shaped cell.
class SubTetMass {
 public:
  explicit SubTetMass(const CellSurface& surface) : surface_(surface), weights_(surface.num_vertices, 4) {}

  /// points: relative to the vertex mean.
  void addTo(const Eigen::Matrix3Xd& points, bool consistent, ElementMatrices& element) {
    const int n = surface_.num_vertices;
    element.shape_integral.setZero(n);
    if (consistent) element.mass_integral.setZero(n, n);
    weights_.col(3).setConstant(1.0 / n);
    for (const std::array<int, 3>& triangle : surface_.triangles) {
      const double volume =
          points.col(triangle[0]).dot(points.col(triangle[1]).cross(points.col(triangle[2]))) / 6;
      for (int corner = 0; corner < 3; ++corner) setWeights(triangle[corner], corner);
      const Eigen::VectorXd sum = weights_.rowwise().sum();
      element.shape_integral += volume / 4 * sum;
      if (!consistent) continue;
      element.mass_integral += volume / 20 * (sum * sum.transpose() + weights_ * weights_.transpose());
    }
  }

 private:
  void setWeights(int point, int column) {
    weights_.col(column).setZero();
    if (point < surface_.num_vertices) {
      weights_(point, column) = 1;
      return;
    }
    const auto& parents = surface_.parents[point - surface_.num_vertices];
    for (const int parent : parents) weights_(parent, column) = 1.0 / static_cast<double>(parents.size());
  }

  const CellSurface& surface_;
  Eigen::MatrixXd weights_;  // n x 4: of the cell's vertices at the corners of a sub-tet
};

class VirtualElement final : public ElementFormulation {
 public:
  explicit VirtualElement(const ElementConfig& config) : config_(config) {}

  ElementMatrices makeMatrices(const CellSurface& surface, const IsotropicMaterial& material) const override {
    const Eigen::Matrix3Xd points = surface.points.colwise() - starCentre(surface);
    const Eigen::Index n = surface.num_vertices;
    if (!(smallestSubTetVolume(surface) > 0)) refuse(surface);
    ElementMatrices element;
    setVolumeAndMeanGradient(surface, points, element);
    SubTetMass(surface).addTo(points, config_.consistent_mass, element);

    // (P u)_i = mean of u + (sum_j u_j Gm_j) . (X_i - mean of X); the modes have no mean.
    const Eigen::Matrix3Xd corners = points.leftCols(n).colwise() - points.leftCols(n).rowwise().mean();
    Stabilisation& stabilisation = element.stabilisation;
    stabilisation.modes = nonLinearModes(corners);
    stabilisation.rest_modes = corners * stabilisation.modes;
    const Eigen::Matrix3Xd gradient_of_modes = element.mean_gradient * stabilisation.modes;
    const Eigen::MatrixXd remainder = stabilisation.modes - corners.transpose() * gradient_of_modes;
    // The volume over the squared size, not the mean part's own diagonal: in a flat cell that is the
    // stiffness across, and the bending modes would be as stiff.
    const LameModuli moduli = stabilisationModuli(material, config_);
    const double s = config_.stabilisation_scale * kScaleOfCube * (moduli.lambda_pa + 4 * moduli.mu_pa) *
                     element.volume * n / corners.squaredNorm();
    const Eigen::MatrixXd scalar = s * remainder.transpose() * remainder;
    const Eigen::Index m = stabilisation.numModes();
    stabilisation.stiffness.setZero(3 * m, 3 * m);
    for (Eigen::Index k = 0; k < m; ++k) {
      for (Eigen::Index l = 0; l < m; ++l) {
        stabilisation.stiffness.block<3, 3>(3 * k, 3 * l)
            .diagonal()
            .setConstant(0.5 * (scalar(k, l) + scalar(l, k)));
      }
    }
    return element;
  }

 private:
  [[noreturn]] static void refuse(const CellSurface& surface);

  ElementConfig config_;
};

void VirtualElement::refuse(const CellSurface& surface) {
  throw std::invalid_argument("smallest volume of the tetrahedra (vertex mean, surface triangle) = " +
                              std::to_string(smallestSubTetVolume(surface)) +
                              ": must be in (0, inf), the cell is not star-shaped");
}

}  // namespace

std::unique_ptr<const ElementFormulation> makeVirtualElement(const ElementConfig& config) {
  return std::make_unique<VirtualElement>(config);
}

}  // namespace polyscalpel
