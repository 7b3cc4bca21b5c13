// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/corotated_body.hpp"

#include <algorithm>
#include <cstdint>

#include "corotated_layout.hpp"
#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/core/parallel.hpp"
#include "polyscalpel/core/quad.hpp"

namespace polyscalpel {

namespace {

constexpr int kBatchesAChunk = 64;
constexpr int kVerticesAChunk = 512;

/// Room for the kernels, one a thread, aligned for the widest registers.
void* roomFor(int num_modes) {
  thread_local std::vector<double> room;
  const std::size_t size = roomOf(num_modes) + 8;
  if (room.size() < size) room.resize(size);
  const auto address = reinterpret_cast<std::uintptr_t>(room.data());
  return reinterpret_cast<void*>((address + 63) / 64 * 64);
}

/// Columns side by side, as the kernels take them.
const double* numbersOf(const Eigen::Ref<const Eigen::Matrix3Xd>& positions) {
  POLYSCALPEL_ASSERT(positions.outerStride() == 3);
  return positions.data();
}

}  // namespace

CellBatch CorotatedBody::view(const Batch& batch) const {
  const Layout layout(batch.num_vertices, batch.num_modes);
  const double* const numbers = &numbers_[batch.first_number];
  return {batch.num_vertices,         batch.num_modes,         &vertices_[batch.first_corner],
          numbers + layout.gradients, numbers + layout.volume, numbers + layout.lambda,
          numbers + layout.mu,        numbers + layout.modes,  numbers + layout.stiffness,
          numbers + layout.rest_modes};
}

template <class Visit>
void CorotatedBody::forEachBatch(const Visit& visit) const {
  parallelChunks(static_cast<int>(batches_.size()), kBatchesAChunk, num_threads_, [&](int first, int last) {
    void* const room = roomFor(most_modes_);
    for (int b = first; b < last; ++b) {
      if (batch_is_still_.empty() || !batch_is_still_[b]) visit(b, view(batches_[b]), room);
    }
  });
}

void CorotatedBody::setStill(const std::vector<char>& still) {
  if (still == still_) return;
  still_ = still;
  batch_is_still_.clear();
  // What was made while others were still may lack those that move now.
  turned_float_.is_current = turned_double_.is_current = false;
  selectRows();
  if (still_.empty()) return;
  POLYSCALPEL_ASSERT(static_cast<int>(still_.size()) == pattern_.numVertices());
  for (const Batch& batch : batches_) {
    bool all = true;
    for (int k = 0; k < kBatchSize * batch.num_vertices; ++k) {
      const bool is_there = batch.cells[k % kBatchSize] >= 0;
      all = all && (!is_there || still_[vertices_[batch.first_corner + k]] != 0);
    }
    batch_is_still_.push_back(all ? 1 : 0);
  }
}

// A row makes the transposed blocks below the diagonal too, so one that is still serves those that move.
void CorotatedBody::selectRows() {
  moving_.clear();
  rows_.clear();
  for (int i = 0; i < pattern_.numVertices(); ++i) {
    bool is_needed = !isStill(i);
    if (is_needed) moving_.push_back(i);
    const RowPattern::Row& row = pattern_.rows[i];
    for (int entry = row.first_above; !is_needed && entry < row.first + row.count; ++entry)
      is_needed = !isStill(pattern_.column[entry]);
    if (is_needed) rows_.push_back(i);
  }
}

void CorotatedBody::linearise(const Eigen::Ref<const Eigen::Matrix3Xd>& positions, bool exact_force) {
  const double* const points = numbersOf(positions);
  const CorotatedKernels& kernels = corotatedKernels();
  turned_float_.is_current = turned_double_.is_current = false;
  forEachBatch([&](int b, const CellBatch& batch, void* room) {
    kernels.linearise(batch, points, exact_force, room, &rotations_[36 * b], &spins_[12 * b]);
  });
}

void CorotatedBody::lineariseWithForces(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                        const Eigen::Ref<const Eigen::Matrix3Xd>& ahead, bool exact_force,
                                        Eigen::Matrix3Xd& forces) {
  const double* const points = numbersOf(positions);
  const double* const points_ahead = numbersOf(ahead);
  const CorotatedKernels& kernels = corotatedKernels();
  turned_double_.is_current = false;
  resizeTurned(turned_float_);
  forEachBatch([&](int b, const CellBatch& batch, void* room) {
    kernels.linearise(batch, points, exact_force, room, &rotations_[36 * b], &spins_[12 * b]);
    kernels.forces(batch, points_ahead, &rotations_[36 * b], &spins_[12 * b], room,
                   &corner_forces_[4 * static_cast<std::size_t>(batches_[b].first_corner)]);
    makeTurned(b, batch, room, turned_float_);
  });
  turned_float_.is_current = true;
  gatherForces(forces);
}

void CorotatedBody::lineariseAtRest() {
  for (std::size_t k = 0; k < rotations_.size(); ++k) rotations_[k] = (k % 36) / 4 % 4 == 0 ? 1 : 0;
  std::fill(spins_.begin(), spins_.end(), 0.0);
  turned_float_.is_current = turned_double_.is_current = false;
}

Eigen::Matrix3d CorotatedBody::rotationOf(CellId cell) const {
  const int place = place_of_cell_[cell.index()];
  POLYSCALPEL_ASSERT(place >= 0);
  Eigen::Matrix3d R;
  for (int k = 0; k < 9; ++k)
    R.data()[k] = rotations_[36 * (place / kBatchSize) + kBatchSize * k + place % kBatchSize];
  return R;
}

void CorotatedBody::internalForces(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                   Eigen::Matrix3Xd& forces) {
  const double* const points = numbersOf(positions);
  const CorotatedKernels& kernels = corotatedKernels();
  forEachBatch([&](int b, const CellBatch& batch, void* room) {
    kernels.forces(batch, points, &rotations_[36 * b], &spins_[12 * b], room,
                   &corner_forces_[4 * static_cast<std::size_t>(batches_[b].first_corner)]);
  });
  gatherForces(forces);
}

void CorotatedBody::gatherForces(Eigen::Matrix3Xd& forces) const {
  if (still_.empty()) {
    forces.resize(3, pattern_.numVertices());
  } else {
    forces.setZero(3, pattern_.numVertices());
  }
  parallelChunks(static_cast<int>(moving_.size()), kVerticesAChunk, num_threads_, [&](int first, int last) {
    for (int m = first; m < last; ++m) {
      const int i = moving_[m];
      const Span& span = corners_of_vertex_[i];
      double sum[3] = {0, 0, 0};
      for (int k = span.first; k < span.first + span.count; ++k) {
        const double* const force = &corner_forces_[4 * static_cast<std::size_t>(corners_[k].corner)];
        for (int c = 0; c < 3; ++c) sum[c] += force[c];
      }
      for (int c = 0; c < 3; ++c) forces(c, i) = sum[c];
    }
  });
}

void CorotatedBody::vertexRotations(std::vector<float>& rotations) {
  rotations.resize(9 * static_cast<std::size_t>(pattern_.numVertices()));
  const CorotatedKernels& kernels = corotatedKernels();
  parallelChunks(static_cast<int>(moving_.size()), kVerticesAChunk, num_threads_, [&](int first, int last) {
    kernels.mean_rotations(rotations_.data(), rotation_places_.data(), rotation_weights_.data(),
                           &moving_[first], last - first, rotations.data());
  });
}

template <class Scalar>
void CorotatedBody::resizeTurned(Turned<Scalar>& turned) const {
  turned.gradients.resize(4 * vertices_.size());
  turned.blocks.resize(9 * static_cast<std::size_t>(num_pairs_) + 1);
}

// h of a batch's corners and the stabilising blocks of its pairs.
template <class Scalar>
void CorotatedBody::makeTurned(int index, const CellBatch& batch, void* room, Turned<Scalar>& turned) const {
  const TurnedKernels<Scalar>& kernels = turnedKernels<Scalar>(corotatedKernels());
  kernels.gradients(batch, &rotations_[36 * index],
                    &turned.gradients[4 * static_cast<std::size_t>(batches_[index].first_corner)]);
  if (batch.num_modes > 0)
    kernels.stabiliser(batch, &rotations_[36 * index], room,
                       turned.blocks.data() + 9 * static_cast<std::size_t>(batches_[index].first_pair));
}

// Each entry above the diagonal is written once, and its transpose at its mirror.
template <class Scalar>
void CorotatedBody::assemble(const Eigen::VectorXd& vertex_masses, double mass_scale, double stiffness_scale,
                             DifferenceMatrix<Scalar>& matrix) {
  Turned<Scalar>& turned = turnedOf<Scalar>();
  if (!turned.is_current) {
    resizeTurned(turned);
    forEachBatch([&](int b, const CellBatch& batch, void* room) { makeTurned(b, batch, room, turned); });
    turned.is_current = true;
  }
  matrix.resize(pattern_);
  const Scalar scale = static_cast<Scalar>(stiffness_scale);
  parallelChunks(static_cast<int>(rows_.size()), kVerticesAChunk, num_threads_, [&](int first, int last) {
    for (int r = first; r < last; ++r) {
      const int i = rows_[r];
      const bool is_still = isStill(i);
      matrix.masses[i] = mass_scale * vertex_masses[i];
      const RowPattern::Row& row = pattern_.rows[i];
      const Pair* pair = pairs_.data() + first_pair_[i];
      const int* stabiliser = stabilisers_.data() + first_stabiliser_[i];
      for (int entry = row.first_above; entry < row.first + row.count; ++entry) {
        if (is_still && isStill(pattern_.column[entry])) {
          pair += incidences_[entry].num_pairs;
          stabiliser += incidences_[entry].num_stabilisers;
          continue;
        }
        Quad<Scalar> c0 = {}, c1 = {}, c2 = {};
        for (const Pair* const end = pair + incidences_[entry].num_pairs; pair != end; ++pair) {
          const Quad<Scalar> a = loadQuad(&turned.gradients[4 * static_cast<std::size_t>(pair->row_corner)]);
          const Quad<Scalar> b =
              loadQuad(&turned.gradients[4 * static_cast<std::size_t>(pair->column_corner)]);
          const Quad<Scalar> stretched = b * spread<3>(a);  // times lambda / mu
          c0 += a * spread<0>(stretched) + b * spread<0>(a);
          c1 += a * spread<1>(stretched) + b * spread<1>(a);
          c2 += a * spread<2>(stretched) + b * spread<2>(a);
        }
        for (const int* const end = stabiliser + incidences_[entry].num_stabilisers; stabiliser != end;
             ++stabiliser) {
          const Scalar* const block = &turned.blocks[9 * static_cast<std::size_t>(*stabiliser)];
          c0 += loadQuad(block);
          c1 += loadQuad(block + 3);
          c2 += loadQuad(block + 6);
        }
        const Scalar diagonal =
            static_cast<Scalar>(mass_scale * entry_masses_[entry] + stiffness_scale * entry_shears_[entry]);
        c0 = c0 * scale + Quad<Scalar>{diagonal, 0, 0, 0};
        c1 = c1 * scale + Quad<Scalar>{0, diagonal, 0, 0};
        c2 = c2 * scale + Quad<Scalar>{0, 0, diagonal, 0};
        Scalar* const block = &matrix.blocks[9 * static_cast<std::size_t>(entry)];
        storeThree(block, c0);
        storeThree(block + 3, c1);
        storeThree(block + 6, c2);
        Scalar* const transposed = &matrix.blocks[9 * static_cast<std::size_t>(pattern_.mirror[entry])];
        const Quad<Scalar> low = pick<0, 4, 1, 5>(c0, c1), high = pick<2, 6, 3, 7>(c0, c1);
        storeThree(transposed, pick<0, 1, 4, 7>(low, c2));
        storeThree(transposed + 3, pick<2, 3, 5, 7>(low, c2));
        storeThree(transposed + 6, pick<0, 1, 6, 7>(high, c2));
      }
    }
  });
}

template void CorotatedBody::assemble<float>(const Eigen::VectorXd&, double, double,
                                             DifferenceMatrix<float>&);
template void CorotatedBody::assemble<double>(const Eigen::VectorXd&, double, double,
                                              DifferenceMatrix<double>&);

// With others still, and another linearisation, which is gone afterwards.
template <class Run>
void CorotatedBody::runApart(const std::vector<char>& still, const Run& run) {
  const std::vector<double> rotations = rotations_, spins = spins_;
  const std::vector<char> still_now = still_;
  setStill(still);
  run();
  rotations_ = rotations;
  spins_ = spins;
  turned_float_.is_current = turned_double_.is_current = false;
  setStill(still_now);
}

void CorotatedBody::assembleAtRest(const Eigen::VectorXd& vertex_masses, double mass_scale,
                                   double stiffness_scale, const std::vector<char>& still,
                                   DifferenceMatrix<double>& matrix) {
  runApart(still, [&] {
    lineariseAtRest();
    assemble(vertex_masses, mass_scale, stiffness_scale, matrix);
  });
}

void CorotatedBody::assembleAt(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                               const Eigen::VectorXd& vertex_masses, double mass_scale,
                               double stiffness_scale, const std::vector<char>& still,
                               DifferenceMatrix<double>& matrix, std::vector<float>& rotations) {
  runApart(still, [&] {
    linearise(positions, false);
    assemble(vertex_masses, mass_scale, stiffness_scale, matrix);
    vertexRotations(rotations);
  });
}

// As the matrix: row sums, and differences to the neighbours.
void CorotatedBody::multiplyMass(const Eigen::VectorXd& vertex_masses, bool is_consistent,
                                 const Eigen::Ref<const Eigen::Matrix3Xd>& values,
                                 Eigen::Matrix3Xd& result) const {
  result.resize(3, values.cols());
  parallelChunks(pattern_.numVertices(), kVerticesAChunk, num_threads_, [&](int first, int last) {
    for (int i = first; i < last; ++i) {
      Eigen::Vector3d sum = vertex_masses[i] * values.col(i);
      if (is_consistent) {
        const RowPattern::Row& row = pattern_.rows[i];
        for (int entry = row.first; entry < row.first + row.count; ++entry)
          sum += entry_masses_[entry] * (values.col(pattern_.column[entry]) - values.col(i));
      }
      result.col(i) = sum;
    }
  });
}

}  // namespace polyscalpel
