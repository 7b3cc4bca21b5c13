// SPDX-License-Identifier: BSD-3-Clause
//
// What the three parts of the table of hard cases share.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"
#include "support/hard_cases.hpp"

namespace polyscalpel {

/// Relative rounding of a double.
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

/// The rows of each part.
std::vector<HardCaseEntry> elementCases();
std::vector<HardCaseEntry> bodyCases();
std::vector<HardCaseEntry> motionCases();

/// A figure as the table shows it: two digits.
std::string figure(double value);

/// Sets held from value and bound (a NaN does not hold) and from what else the row says.
void judge(HardCase& row, double value, double bound, bool as_said = true);

/// Box with grid lines at the given coordinates [m], ascending.
PolyhedralMesh makeGridBox(const std::vector<double>& xs, const std::vector<double>& ys,
                           const std::vector<double>& zs);

/// `count` equal steps from `lowest` to `highest`, both included.
std::vector<double> evenly(double lowest, double highest, int count);

/// One flag a vertex: on the lowest x of the rest shape.
std::vector<bool> lowestX(const PolyhedralMesh& mesh);

/// Deformation gradient of a cell: the mean of its linear part over the cell.
Eigen::Matrix3d meanDeformation(const PolyhedralMesh& mesh, const Assembly& assembly, CellId cell,
                                const Eigen::Matrix3Xd& positions);

/// det F of every cell that is alive, by ascending id; below zero where it is inverted.
Eigen::VectorXd cellDeterminants(const PolyhedralMesh& mesh, const Assembly& assembly,
                                 const Eigen::Matrix3Xd& positions);

/// Consistent nodal forces of a stress on the whole boundary of the rest shape, 3 x n [N].
Eigen::Matrix3Xd boundaryLoads(const PolyhedralMesh& mesh, const Eigen::Matrix3d& stress);

/// Patch test of B. M. Irons: the whole boundary of the uncut body is held in a linear field, what a cut has
/// opened is loaded by the field's tractions. Returns |u - exact| / |exact| over all vertices, infinite where
/// the body has no solution. is_held: one flag a vertex.
double patchTestError(const PolyhedralMesh& mesh, const std::vector<bool>& is_held,
                      const IsotropicMaterial& material);

}  // namespace polyscalpel
