// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <type_traits>

namespace polyscalpel {

constexpr int kBatchSize = 4;   ///< cells side by side
constexpr int kCellsAMean = 4;  ///< cells whose rotations make a vertex's

/// Cells of equally many vertices and modes, with the numbers of each at every fourth place. A lane without a
/// cell has zeros everywhere.
struct CellBatch {
  int num_vertices = 0;
  int num_modes = 0;                   ///< m = n - 4, or 0 where cells have no stabilising part
  const int* vertices = nullptr;       ///< n
  const double* gradients = nullptr;   ///< Gm, 3 n [1/m]
  const double* volume = nullptr;      ///< [m^3]
  const double* lambda = nullptr;      ///< [Pa]
  const double* mu = nullptr;          ///< [Pa]
  const double* modes = nullptr;       ///< H, n x m, row by row
  const double* stiffness = nullptr;   ///< S^, the lower triangle row by row [N/m]
  const double* rest_modes = nullptr;  ///< X H, 3 m [m]
};

/// Place of the pair a < b of n vertices among all pairs.
constexpr int pairOf(int n, int a, int b) {
  return a * (2 * n - a - 1) / 2 + (b - a - 1);
}

/// What a matrix is made from.
template <class Scalar>
struct TurnedKernels {
  /// At each vertex of each cell, vertex by vertex, then cell by cell: (V mu)^(1/2) R g, and lambda / mu.
  void (*gradients)(const CellBatch& batch, const double* rotation, Scalar* corners);
  /// Blocks (H (x) R) S^ (H (x) R)^T of the pairs a < b, 9 numbers each column by column; pair by pair, then
  /// cell by cell.
  void (*stabiliser)(const CellBatch& batch, const double* rotation, void* room, Scalar* blocks);
};

/// What a batch is asked for, by any width of registers, bit for bit the same. positions: 3 numbers a vertex.
/// room: of roomOf() doubles, aligned to 64 bytes.
struct CorotatedKernels {
  /// rotation: 9 numbers a cell, column by column; spin: 3 (CellLinearisation::spin).
  void (*linearise)(const CellBatch& batch, const double* positions, bool exact_force, void* room,
                    double* rotation, double* spin);
  /// dE/dx at each vertex of each cell: 4 numbers, the last of which is left as it is; vertex by vertex, then
  /// cell by cell.
  void (*forces)(const CellBatch& batch, const double* positions, const double* rotation, const double* spin,
                 void* room, double* corner_forces);
  TurnedKernels<float> single;
  TurnedKernels<double> twofold;
  /// For each of `count` vertices the rotation nearest to the weighted sum of those of kCellsAMean cells, 9
  /// numbers each, column by column. cells: places, kBatchSize a batch; these, weights and result of all
  /// vertices.
  void (*mean_rotations)(const double* rotations, const int* cells, const double* weights,
                         const int* vertices, int count, float* result);
};

template <class Scalar>
const TurnedKernels<Scalar>& turnedKernels(const CorotatedKernels& kernels) {
  if constexpr (std::is_same_v<Scalar, float>) {
    return kernels.single;
  } else {
    return kernels.twofold;
  }
}

/// Doubles that the kernels need beside.
constexpr int roomOf(int num_modes) {
  return kBatchSize * 9 * (num_modes * (num_modes + 1) / 2 + num_modes + 1);
}

/// The fastest that this processor has.
const CorotatedKernels& corotatedKernels();
/// Those with 4 doubles in a register, or nullptr where compiler or processor cannot.
const CorotatedKernels* avx2CorotatedKernels();

}  // namespace polyscalpel
