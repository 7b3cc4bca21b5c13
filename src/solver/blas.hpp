// SPDX-License-Identifier: BSD-3-Clause
//
// BLAS on parts of column-major matrices by the precision of their numbers.
#pragma once

#include <cblas.h>

namespace polyscalpel {

/// B = B L^-T, L lower triangular.
inline void solveTransposedRight(int rows, int columns, const float* L, int leading_L, float* B,
                                 int leading_B) {
  cblas_strsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, rows, columns, 1, L, leading_L,
              B, leading_B);
}
inline void solveTransposedRight(int rows, int columns, const double* L, int leading_L, double* B,
                                 int leading_B) {
  cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasTrans, CblasNonUnit, rows, columns, 1, L, leading_L,
              B, leading_B);
}
/// B = B L^-1.
inline void solveRight(int rows, int columns, const float* L, int leading_L, float* B, int leading_B) {
  cblas_strsm(CblasColMajor, CblasRight, CblasLower, CblasNoTrans, CblasNonUnit, rows, columns, 1, L,
              leading_L, B, leading_B);
}
inline void solveRight(int rows, int columns, const double* L, int leading_L, double* B, int leading_B) {
  cblas_dtrsm(CblasColMajor, CblasRight, CblasLower, CblasNoTrans, CblasNonUnit, rows, columns, 1, L,
              leading_L, B, leading_B);
}
/// B = L^-1 B.
inline void solveLeft(int rows, int columns, const float* L, int leading_L, float* B, int leading_B) {
  cblas_strsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, rows, columns, 1, L,
              leading_L, B, leading_B);
}
inline void solveLeft(int rows, int columns, const double* L, int leading_L, double* B, int leading_B) {
  cblas_dtrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasNonUnit, rows, columns, 1, L,
              leading_L, B, leading_B);
}
/// C -= A A^T on and below the diagonal. C: size x size, A: size x columns.
inline void subtractSquare(int size, int columns, const float* A, int leading_A, float* C, int leading_C) {
  cblas_ssyrk(CblasColMajor, CblasLower, CblasNoTrans, size, columns, -1, A, leading_A, 1, C, leading_C);
}
inline void subtractSquare(int size, int columns, const double* A, int leading_A, double* C, int leading_C) {
  cblas_dsyrk(CblasColMajor, CblasLower, CblasNoTrans, size, columns, -1, A, leading_A, 1, C, leading_C);
}

}  // namespace polyscalpel
