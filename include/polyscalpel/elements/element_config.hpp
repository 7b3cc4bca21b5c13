// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace polyscalpel {

/// What stands for the shape functions of a polyhedron. A tetrahedron takes its closed form under any.
enum class Formulation {
  kMeanValue,  ///< mean value coordinates, integrated by quadrature on sub-tets
  kVirtual,    ///< first-order virtual element: no shape functions, no quadrature; the cheap mode
};

/// The moduli that the stabilising term sees.
enum class StabilisationModulus {
  kAutomatic,  ///< kShear for nu > ElementConfig::kShearOnlyAbove, else kFull
  kFull,       ///< the material's own C
  kShear,      ///< C with lambda = 0: bending does not lock where the material is nearly incompressible
};

/// How strains are measured.
enum class Strain {
  kLinear,     ///< Cauchy's small strain: the stiffness is constant, rotations inflate
  kCorotated,  ///< small strain in a frame that turns with the cell
  kGreen,      ///< Green's strain: St. Venant-Kirchhoff. No restoring force in inverted cells
};

/// How a cell becomes a finite element.
struct ElementConfig {
  /// With all of C the tip of a bent beam of hexahedra is off by more at every nu > 0, and locks above 0.4:
  /// with four cells across 4.9, 7.9, 32, 71 % at nu = 0.3, 0.4, 0.49, 0.499, against 2.6, 2.9, 3.7, 3.8 % by
  /// shear alone. At nu = 0 both are the same.
  static constexpr double kShearOnlyAbove = 0;

  Formulation formulation = Formulation::kMeanValue;
  int quadrature_points = 4;  ///< of mean values, in each sub-tet (vertex mean, surface triangle): 1, 4 or 11
  StabilisationModulus stabilisation_modulus = StabilisationModulus::kAutomatic;
  double stabilisation_scale = 1;  ///< alpha, > 0
  bool consistent_mass = false;    ///< consistent instead of lumped mass
  Strain strain = Strain::kCorotated;
  /// Forces include the derivative of the rotation, so that they are minus the gradient of the energy and
  /// carry no net torque. Without it a polyhedron's forces are those of plain stiffness warping, a little
  /// cheaper.
  bool exact_force = true;
  /// False leaves out the gradient correction: the plain quadrature of Wicke, Botsch, Gross 2007. It fails
  /// the patch test; for comparisons only.
  bool gradient_correction = true;
};

/// Throws std::invalid_argument with name, value and range.
void validate(const ElementConfig& config);

}  // namespace polyscalpel
