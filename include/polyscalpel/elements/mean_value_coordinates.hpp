// SPDX-License-Identifier: BSD-3-Clause
//
// T. Ju, S. Schaefer, J. Warren, "Mean value coordinates for closed triangular meshes", 2005, and M. S.
// Floater, G. Kos, M. Reimers, "Mean value coordinates in 3D", 2005.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {

/// Mean value coordinates of the n vertices of a cell, and their gradients. A virtual vertex hands its weight
/// in equal parts to its parents, so that the coordinates are linear on every surface triangle.
///
/// They sum to 1, reproduce linear fields, and are positive in convex cells; on a tetrahedron they are its
/// barycentric coordinates. With eps the unit roundoff, h the size of the cell and d the distance to the
/// nearest vertex, edge or triangle, values carry an absolute error of order eps. The second derivatives grow
/// like 1 / (h d) towards edges and vertices, so the rounding of the point itself makes gradients uncertain
/// by eps / d, and that is what is reached.
///
/// A workspace: keeps its storage from cell to cell. One thread at a time may use one object. Scalar is
/// double (several points at once) or long double (a reference for tests).
template <class Scalar>
class MeanValueCoordinates {
 public:
  using Matrix3X = Eigen::Matrix<Scalar, 3, Eigen::Dynamic>;
  using MatrixX = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  /// portable: takes the arithmetic that every machine has also where there is a wider one; the numbers are
  /// the same bit for bit.
  explicit MeanValueCoordinates(bool portable = false);
  ~MeanValueCoordinates();
  MeanValueCoordinates(MeanValueCoordinates&&) noexcept;
  MeanValueCoordinates& operator=(MeanValueCoordinates&&) noexcept;

  /// Takes a closed surface. It is not referred to afterwards.
  void setSurface(const CellSurface& surface);
  /// The same where star_centre, that of the surface, is known.
  void setSurface(const CellSurface& surface, const Eigen::Vector3d& star_centre);

  /// starCentre() of the surface [m]: the origin of the points given to evaluate().
  const Eigen::Vector3d& origin() const { return origin_; }

  /// Evaluates at k points (3 x k, one column per point [m], relative to origin()), each strictly inside the
  /// surface. What comes out for a point does not depend on the others. No allocation once the largest cell
  /// has been seen.
  void evaluate(const Eigen::Ref<const Matrix3X>& points);

  /// n x k: a column per point with the coordinates of all vertices. Valid until the next evaluate().
  Eigen::Map<const MatrixX> values() const { return {values_.data(), num_vertices_, num_points_}; }
  /// 3n x k [1/m]: a column per point with the gradients (x0 y0 z0 x1 ...). Valid until the next evaluate().
  Eigen::Map<const MatrixX> gradients() const { return {gradients_.data(), 3 * num_vertices_, num_points_}; }

 private:
  struct Kernel;

  std::unique_ptr<Kernel> kernel_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  Eigen::Index num_vertices_ = 0;
  Eigen::Index num_points_ = 0;
  std::vector<Scalar> values_;
  std::vector<Scalar> gradients_;
};

extern template class MeanValueCoordinates<double>;
extern template class MeanValueCoordinates<long double>;

}  // namespace polyscalpel
