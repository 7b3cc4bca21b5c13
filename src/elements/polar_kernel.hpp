// SPDX-License-Identifier: BSD-3-Clause
//
// N. J. Higham, "Computing the polar decomposition - with applications", 1986, for matrices side by side in
// the lanes of a Real. What a lane yields does not depend on its neighbours.
#pragma once

#include <limits>

#include "pack.hpp"

namespace polyscalpel {

/// The rotation of polarRotation() where Newton's iteration is no way to it. F, R: 9 numbers, column by
/// column.
void rotationBySvd(const double* F, double* R);
/// TurnOfRotation by eigenvalues. U: 9 numbers, symmetric; axial, turn: 3.
void turnByEigenvalues(const double* U, const double* axial, double* turn);

/// A 3 x 3 matrix, column by column.
template <class Real>
struct Square {
  Real entries[9];
  Real& operator[](int k) { return entries[k]; }
  const Real& operator[](int k) const { return entries[k]; }
};

template <class Real>
static inline Square<Real> product(const Square<Real>& A, const Square<Real>& B) {
  Square<Real> C;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i)
      C[3 * j + i] = A[i] * B[3 * j] + A[3 + i] * B[3 * j + 1] + A[6 + i] * B[3 * j + 2];
  }
  return C;
}
/// A^T B.
template <class Real>
static inline Square<Real> transposedProduct(const Square<Real>& A, const Square<Real>& B) {
  Square<Real> C;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i)
      C[3 * j + i] = A[3 * i] * B[3 * j] + A[3 * i + 1] * B[3 * j + 1] + A[3 * i + 2] * B[3 * j + 2];
  }
  return C;
}
/// A B^T.
template <class Real>
static inline Square<Real> productWithTransposed(const Square<Real>& A, const Square<Real>& B) {
  Square<Real> C;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) C[3 * j + i] = A[i] * B[j] + A[3 + i] * B[3 + j] + A[6 + i] * B[6 + j];
  }
  return C;
}

/// Transposed inverse times the determinant.
template <class Real>
static inline Square<Real> cofactors(const Square<Real>& A) {
  Square<Real> C;
  for (int j = 0; j < 3; ++j) {
    const int k = 3 * ((j + 1) % 3), l = 3 * ((j + 2) % 3);
    C[3 * j] = A[k + 1] * A[l + 2] - A[k + 2] * A[l + 1];
    C[3 * j + 1] = A[k + 2] * A[l] - A[k] * A[l + 2];
    C[3 * j + 2] = A[k] * A[l + 1] - A[k + 1] * A[l];
  }
  return C;
}
template <class Real>
static inline Real squaredNorm(const Square<Real>& A) {
  return (A[0] * A[0] + A[1] * A[1] + A[2] * A[2]) + (A[3] * A[3] + A[4] * A[4] + A[5] * A[5]) +
         (A[6] * A[6] + A[7] * A[7] + A[8] * A[8]);
}
template <class Real>
static inline Real absolute(const Real& a) {
  return select(a < 0, 0 - a, a);
}
template <class Real>
static inline Real largest(const Square<Real>& A) {
  Real result = absolute(A[0]);
  for (int k = 1; k < 9; ++k) {
    const Real entry = absolute(A[k]);
    result = select(result < entry, entry, result);
  }
  return result;
}

/// R of F = R S, det R = +1; safe for inverted, flat and zero F.
template <class Real>
static inline Square<Real> polarRotation(const Square<Real>& deformation_gradient) {
  // Newton's iteration is used where det F exceeds this part of |F|^3: there F is far from singular (a
  // rotation has 0.19), so that few steps reach full precision.
  constexpr double kOrdinaryDeterminant = 0.01;
  constexpr int kMaxNewtonSteps = 12;
  // Quadratic convergence: what is left after a smaller change is of the order of its square.
  constexpr double kConverged = 1e-8;
  // The part of |R^-1|^2 / |R|^2, or of its inverse, from which on steps are scaled.
  constexpr double kNoScaling = 0.8;
  // A factor > 0 does not change R; taking it out keeps determinants from over- and underflow. Division,
  // since the inverse of a subnormal number is infinite.
  const Real scale = largest(deformation_gradient);
  const auto is_something = 0 < scale;
  const Real divisor = select(is_something, scale, 1);
  Square<Real> F;
  for (int k = 0; k < 9; ++k) F[k] = deformation_gradient[k] / divisor;

  Square<Real> C = cofactors(F);
  Real determinant = F[0] * C[0] + F[1] * C[1] + F[2] * C[2];
  const Real first_square = squaredNorm(F);
  Real square = first_square;
  const auto is_ordinary = kOrdinaryDeterminant * square * sqrt(square) < determinant;
  Square<Real> R;
  for (int k = 0; k < 9; ++k) R[k] = select(is_ordinary, F[k], k % 4 == 0 ? 1 : 0);
  auto is_moving = is_ordinary;
  for (int step = 0; step < kMaxNewtonSteps && is_moving.any(); ++step) {
    // R <- (g R + R^-T / g) / 2; g^2 = |R^-1| / |R| makes the first steps short cuts and tends to 1. Near
    // that it is left out: its roots take longer than all the rest.
    const Real of_inverse = squaredNorm(C), of_itself = determinant * determinant * square;
    const auto is_scaled =
        is_moving && !(kNoScaling * of_itself < of_inverse && kNoScaling * of_inverse < of_itself);
    Real g = 1;
    if (is_scaled.any()) g = select(is_scaled, sqrt(sqrt(of_inverse / of_itself)), g);
    const Real of_R = 0.5 * g, of_C = 0.5 / (g * determinant);
    Square<Real> change;
    for (int k = 0; k < 9; ++k) {
      const Real next = of_R * R[k] + of_C * C[k];
      change[k] = next - R[k];
      R[k] = select(is_moving, next, R[k]);
    }
    is_moving = is_moving && kConverged <= largest(change);
    if (!is_moving.any()) break;
    C = cofactors(R);
    determinant = R[0] * C[0] + R[1] * C[1] + R[2] * C[2];
    square = squaredNorm(R);
  }
  for (int lane = 0; lane < Real::kSize; ++lane) {
    if (is_ordinary[lane] && !is_moving[lane]) continue;
    if (first_square[lane] == 0) continue;  // of zero: identity
    double from[9], to[9];
    for (int k = 0; k < 9; ++k) from[k] = F[k][lane];
    rotationBySvd(from, to);
    for (int k = 0; k < 9; ++k) R[k].set(lane, to[k]);
  }
  return R;
}

/// turn = (tr(U) I - U)^-1 axial, U the symmetric part of R^T F.
template <class Real>
static inline void turnOfRotation(const Square<Real>& stretch, const Real* axial, Real* turn) {
  constexpr double kOrdinary = 1e-2;  // far from a kink the plain inverse does
  Square<Real> A;
  const Real trace = stretch[0] + stretch[4] + stretch[8];
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) A[3 * j + i] = -0.5 * (stretch[3 * j + i] + stretch[3 * i + j]);
    A[4 * j] = A[4 * j] + trace;
  }
  const Square<Real> C = cofactors(A);
  const Real determinant = A[0] * C[0] + A[1] * C[1] + A[2] * C[2];
  const Real mean = (A[0] + A[4] + A[8]) / 3;
  const auto is_ordinary = 0 < mean && kOrdinary * mean * mean * mean < determinant;
  const Real inverse = 1 / select(is_ordinary, determinant, 1);
  for (int i = 0; i < 3; ++i)
    turn[i] = (C[i] * axial[0] + C[3 + i] * axial[1] + C[6 + i] * axial[2]) * inverse;
  for (int lane = 0; lane < Real::kSize; ++lane) {
    if (is_ordinary[lane]) continue;
    double from[9], of[3], to[3];
    for (int j = 0; j < 3; ++j) {
      for (int i = 0; i < 3; ++i)
        from[3 * j + i] = 0.5 * (stretch[3 * j + i][lane] + stretch[3 * i + j][lane]);
    }
    for (int i = 0; i < 3; ++i) of[i] = axial[i][lane];
    turnByEigenvalues(from, of, to);
    for (int i = 0; i < 3; ++i) turn[i].set(lane, to[i]);
  }
}

}  // namespace polyscalpel
