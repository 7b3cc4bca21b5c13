// SPDX-License-Identifier: BSD-3-Clause
//
// The mechanics of cell_mechanics.hpp for small strain in a turning frame, several cells side by side.
// Compiled once for every machine and once for wider registers (corotated_kernel_avx2.cpp), with the same
// roundings. All that is here depends on Real: nothing compiled for wide registers may end up elsewhere in
// the program.
#pragma once

#include <cstring>

#include "cell_batch.hpp"
#include "pack.hpp"
#include "polar_kernel.hpp"

namespace polyscalpel {

/// Real::kSize of a batch's cells, in the functions' order: linearise, then the others.
template <class Real>
class CorotatedKernel {
 public:
  static CorotatedKernels kernels() {
    return {&linearise,
            &forces,
            {&gradients<float>, &stabiliser<float>},
            {&gradients<double>, &stabiliser<double>},
            &meanRotations};
  }

 private:
  using Matrix = Square<Real>;
  static constexpr int kStride = kBatchSize;

  /// The batch from lane `first` on.
  CorotatedKernel(const CellBatch& whole, int first, void* room)
      : batch_(whole), room_(static_cast<Real*>(room)) {
    batch_.vertices += first;
    batch_.gradients += first;
    batch_.volume += first;
    batch_.lambda += first;
    batch_.mu += first;
    batch_.modes += first;
    batch_.stiffness += first;
    batch_.rest_modes += first;
  }
  template <class Run>
  static void forEachPart(const CellBatch& batch, void* room, const Run& run) {
    for (int first = 0; first < kBatchSize; first += Real::kSize)
      run(CorotatedKernel(batch, first, room), first);
  }

  static Real load(const double* numbers) {
    typename Real::Values values;
    std::memcpy(&values, numbers, sizeof values);
    return Real(values);
  }
  static void store(double* numbers, const Real& real) {
    for (int lane = 0; lane < Real::kSize; ++lane) numbers[lane] = real[lane];
  }
  /// A matrix column by column.
  static Matrix loadMatrix(const double* numbers) {
    Matrix matrix;
    for (int k = 0; k < 9; ++k) matrix[k] = load(numbers + kStride * k);
    return matrix;
  }
  struct Triple {
    Real x[3];
    Real& operator[](int c) { return x[c]; }
    const Real& operator[](int c) const { return x[c]; }
  };
  Triple vertexOf(const double* values, int i) const {
    const int* const vertex = batch_.vertices + kStride * i;
    Triple result;
    for (int c = 0; c < 3; ++c) {
      for (int lane = 0; lane < Real::kSize; ++lane) result[c].set(lane, values[3 * vertex[lane] + c]);
    }
    return result;
  }
  Triple gradientOf(int i) const {
    const double* const g = batch_.gradients + kStride * 3 * i;
    return {{load(g), load(g + kStride), load(g + 2 * kStride)}};
  }
  Real mode(int i, int k) const { return load(batch_.modes + kStride * (i * batch_.num_modes + k)); }
  /// Entry of S^, of which the lower triangle is kept row by row.
  Real stiffness(int row, int column) const {
    const int entry = row >= column ? row * (row + 1) / 2 + column : column * (column + 1) / 2 + row;
    return load(batch_.stiffness + kStride * entry);
  }
  static Triple times(const Matrix& A, const Triple& v) {
    Triple result;
    for (int c = 0; c < 3; ++c) result[c] = A[c] * v[0] + A[3 + c] * v[1] + A[6 + c] * v[2];
    return result;
  }

  /// F = sum of (x_i - x_0) (outer) g_i.
  Matrix deformationGradient(const double* positions) const {
    Matrix F;
    for (int k = 0; k < 9; ++k) F[k] = 0;
    const Triple origin = vertexOf(positions, 0);
    for (int i = 1; i < batch_.num_vertices; ++i) {
      const Triple x = vertexOf(positions, i), g = gradientOf(i);
      for (int row = 0; row < 3; ++row) {
        const Real d = x[row] - origin[row];
        for (int column = 0; column < 3; ++column) F[3 * column + row] = F[3 * column + row] + d * g[column];
      }
    }
    return F;
  }

  /// d = R^T x H - X H, mode by mode.
  void warp(const Matrix& R, const double* positions, Real* warped) const {
    const int m = batch_.num_modes;
    for (int k = 0; k < 3 * m; ++k) warped[k] = 0 - load(batch_.rest_modes + kStride * k);
    const Triple origin = vertexOf(positions, 0);
    for (int i = 0; i < batch_.num_vertices; ++i) {
      Triple x = vertexOf(positions, i), turned;
      for (int c = 0; c < 3; ++c) x[c] = x[c] - origin[c];
      for (int c = 0; c < 3; ++c) turned[c] = R[3 * c] * x[0] + R[3 * c + 1] * x[1] + R[3 * c + 2] * x[2];
      for (int k = 0; k < m; ++k) {
        const Real h = mode(i, k);
        for (int c = 0; c < 3; ++c) warped[3 * k + c] = warped[3 * k + c] + h * turned[c];
      }
    }
  }

  /// f = S^ d.
  void stabilise(const Real* warped, Real* stabilising) const {
    const int size = 3 * batch_.num_modes;
    const double* entry = batch_.stiffness;
    for (int row = 0; row < size; ++row) {
      Real sum = 0;
      for (int column = 0; column < row; ++column, entry += kStride) {
        const Real s = load(entry);
        sum = sum + s * warped[column];
        stabilising[column] = stabilising[column] + s * warped[row];
      }
      stabilising[row] = sum + load(entry) * warped[row];
      entry += kStride;
    }
  }

  static void linearise(const CellBatch& batch, const double* positions, bool exact_force, void* room,
                        double* rotation, double* spin) {
    forEachPart(batch, room, [&](const CorotatedKernel& part, int first) {
      part.linearisePart(positions, exact_force, rotation + first, spin + first);
    });
  }
  void linearisePart(const double* positions, bool exact_force, double* rotation, double* spin) const {
    const Matrix F = deformationGradient(positions);
    const Matrix R = polarRotation(F);
    for (int k = 0; k < 9; ++k) store(rotation + kStride * k, R[k]);
    const int m = batch_.num_modes;
    if (m == 0) return;
    Real c[3] = {0, 0, 0};
    if (exact_force) {
      Real* const warped = room_;
      Real* const f = room_ + 3 * m;
      warp(R, positions, warped);
      stabilise(warped, f);
      Real torque[3] = {0, 0, 0};
      for (int k = 0; k < 3 * m; k += 3) {
        Real y[3];
        for (int i = 0; i < 3; ++i) y[i] = warped[k + i] + load(batch_.rest_modes + kStride * (k + i));
        for (int i = 0; i < 3; ++i) {
          const int j = (i + 1) % 3, l = (i + 2) % 3;
          torque[i] = torque[i] + (y[j] * f[k + l] - y[l] * f[k + j]);
        }
      }
      turnOfRotation(transposedProduct(R, F), torque, c);
    }
    for (int i = 0; i < 3; ++i) store(spin + kStride * i, 0 - c[i]);
  }

  static void forces(const CellBatch& batch, const double* positions, const double* rotation,
                     const double* spin, void* room, double* corner_forces) {
    forEachPart(batch, room, [&](const CorotatedKernel& part, int first) {
      part.partForces(positions, rotation + first, spin + first, corner_forces + 4 * first);
    });
  }
  void partForces(const double* positions, const double* rotation, const double* spin, double* forces) const {
    const int n = batch_.num_vertices, m = batch_.num_modes;
    const Matrix R = loadMatrix(rotation);
    const Matrix D = transposedProduct(R, deformationGradient(positions));
    const Real volume = load(batch_.volume);
    const Real mu = load(batch_.mu) * volume;
    const Real pressure = load(batch_.lambda) * volume * (D[0] + D[4] + D[8] - 3);
    Matrix local;  // the stress in the cell's frame, and what turning the stabilising part's frame takes
    for (int column = 0; column < 3; ++column) {
      for (int row = 0; row < 3; ++row)
        local[3 * column + row] = mu * (D[3 * column + row] + D[3 * row + column]);
      local[4 * column] = mu * (2 * (D[4 * column] - 1)) + pressure;
    }
    Real* const turned = room_ + 6 * m;
    if (m > 0) {
      const Real c[3] = {load(spin), load(spin + kStride), load(spin + 2 * kStride)};
      for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        local[3 * j + l] = local[3 * j + l] + c[i];
        local[3 * l + j] = local[3 * l + j] - c[i];
      }
      Real* const warped = room_;
      Real* const f = room_ + 3 * m;
      warp(R, positions, warped);
      stabilise(warped, f);
      for (int k = 0; k < m; ++k) {
        const Triple product = times(R, {{f[3 * k], f[3 * k + 1], f[3 * k + 2]}});
        for (int c3 = 0; c3 < 3; ++c3) turned[3 * k + c3] = product[c3];
      }
    }
    const Matrix stress = product(R, local);
    for (int i = 0; i < n; ++i) {
      Triple f = times(stress, gradientOf(i));
      for (int k = 0; k < m; ++k) {
        const Real h = mode(i, k);
        for (int c = 0; c < 3; ++c) f[c] = f[c] + h * turned[3 * k + c];
      }
      double* const corner = forces + 4 * kStride * i;
      for (int lane = 0; lane < Real::kSize; ++lane) {
        for (int c = 0; c < 3; ++c) corner[4 * lane + c] = f[c][lane];
      }
    }
  }

  template <class Scalar>
  static void gradients(const CellBatch& batch, const double* rotation, Scalar* corners) {
    forEachPart(batch, nullptr, [&](const CorotatedKernel& part, int first) {
      part.partGradients(rotation + first, corners + 4 * first);
    });
  }
  template <class Scalar>
  void partGradients(const double* rotation, Scalar* corners) const {
    const Real mu = load(batch_.mu), root = sqrt(load(batch_.volume) * mu);
    const Real ratio = load(batch_.lambda) / select(0 < mu, mu, 1);
    Matrix R = loadMatrix(rotation);
    for (int k = 0; k < 9; ++k) R[k] = R[k] * root;
    for (int i = 0; i < batch_.num_vertices; ++i) {
      const Triple h = times(R, gradientOf(i));
      Scalar* const corner = corners + 4 * kStride * i;
      for (int lane = 0; lane < Real::kSize; ++lane) {
        for (int c = 0; c < 3; ++c) corner[4 * lane + c] = static_cast<Scalar>(h[c][lane]);
        corner[4 * lane + 3] = static_cast<Scalar>(ratio[lane]);
      }
    }
  }

  template <class Scalar>
  static void stabiliser(const CellBatch& batch, const double* rotation, void* room, Scalar* blocks) {
    forEachPart(batch, room, [&](const CorotatedKernel& part, int first) {
      part.partStabiliser(rotation + first, blocks + 9 * first);
    });
  }
  template <class Scalar>
  void partStabiliser(const double* rotation, Scalar* blocks) const {
    const int n = batch_.num_vertices, m = batch_.num_modes;
    const Matrix R = loadMatrix(rotation);
    Matrix* const turned = reinterpret_cast<Matrix*>(room_);  // R S^_kl R^T, l <= k
    Matrix* const half = turned + m * (m + 1) / 2;            // sum over k of H_ak R S^_kl R^T
    for (int k = 0; k < m; ++k) {
      for (int l = 0; l <= k; ++l) {
        Matrix S;
        for (int column = 0; column < 3; ++column) {
          for (int row = 0; row < 3; ++row) S[3 * column + row] = stiffness(3 * k + row, 3 * l + column);
        }
        turned[k * (k + 1) / 2 + l] = productWithTransposed(product(R, S), R);
      }
    }
    for (int a = 0; a + 1 < n; ++a) {
      for (int l = 0; l < m; ++l) {
        Matrix sum;
        for (int e = 0; e < 9; ++e) sum[e] = 0;
        for (int k = 0; k < m; ++k) {
          const Real h = mode(a, k);
          const Matrix& T = turned[k >= l ? k * (k + 1) / 2 + l : l * (l + 1) / 2 + k];
          for (int column = 0; column < 3; ++column) {
            for (int row = 0; row < 3; ++row) {
              const int entry = 3 * column + row;
              sum[entry] = sum[entry] + h * T[k >= l ? entry : 3 * row + column];
            }
          }
        }
        half[l] = sum;
      }
      for (int b = a + 1; b < n; ++b) {
        Matrix block;
        for (int e = 0; e < 9; ++e) block[e] = 0;
        for (int l = 0; l < m; ++l) {
          const Real h = mode(b, l);
          for (int e = 0; e < 9; ++e) block[e] = block[e] + h * half[l][e];
        }
        Scalar* const to = blocks + 9 * kStride * pairOf(n, a, b);
        for (int lane = 0; lane < Real::kSize; ++lane) {
          for (int e = 0; e < 9; ++e) to[9 * lane + e] = static_cast<Scalar>(block[e][lane]);
        }
      }
    }
  }

  static void meanRotations(const double* rotations, const int* cells, const double* weights,
                            const int* vertices, int count, float* result) {
    for (int first = 0; first < count; first += Real::kSize) {
      Matrix sum;
      for (int k = 0; k < 9; ++k) sum[k] = 0;
      for (int lane = 0; lane < Real::kSize; ++lane) {
        const int vertex = vertices[first + lane < count ? first + lane : count - 1];
        for (int i = kCellsAMean * vertex; i < kCellsAMean * (vertex + 1); ++i) {
          const double* const R = rotations + 9 * kStride * (cells[i] / kStride) + cells[i] % kStride;
          for (int k = 0; k < 9; ++k) sum[k].set(lane, sum[k][lane] + weights[i] * R[kStride * k]);
        }
      }
      const Matrix R = polarRotation(sum);
      for (int lane = 0; lane < Real::kSize && first + lane < count; ++lane) {
        for (int k = 0; k < 9; ++k) result[9 * vertices[first + lane] + k] = static_cast<float>(R[k][lane]);
      }
    }
  }

  CellBatch batch_;
  Real* room_;
};

}  // namespace polyscalpel
