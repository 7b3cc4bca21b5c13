// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "polyscalpel/collision/contact_forces.hpp"
#include "polyscalpel/core/block_matrix.hpp"
#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/core/difference_matrix.hpp"

namespace polyscalpel {

/// A quantity at the vertices (3 x n) at the contact's point: J values.
inline Eigen::Vector3d atContact(const Contact& contact, const Eigen::Matrix3Xd& values) {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  for (const WeightedVertex& w : contact.weights) value += w.weight * values.col(w.vertex.index());
  return value;
}

/// rhs += J^T force.
inline void addAtContact(const Contact& contact, const Eigen::Vector3d& force, Eigen::Matrix3Xd& rhs) {
  for (const WeightedVertex& w : contact.weights) rhs.col(w.vertex.index()) += w.weight * force;
}

/// matrix += scale J^T B J, on and below the diagonal.
inline void addContactMatrix(const LinearisedContact& contact, double scale, const BlockPattern& pattern,
                             Blocks& matrix) {
  const std::vector<WeightedVertex>& weights = contact.contact.weights;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const int vertex = weights[i].vertex.index();
    for (std::size_t j = 0; j < weights.size(); ++j) {
      if (weights[j].vertex.index() > vertex) continue;
      const int block = pattern.find(vertex, weights[j].vertex.index());
      POLYSCALPEL_ASSERT(block >= 0);
      matrix[block] += scale * weights[i].weight * weights[j].weight * contact.B;
    }
  }
}

/// The same for a matrix in difference form: what contacts add to a vertex's row in all is a tie.
template <class Scalar>
void addContactMatrix(const LinearisedContact& contact, double scale, const RowPattern& pattern,
                      DifferenceMatrix<Scalar>& matrix) {
  const std::vector<WeightedVertex>& weights = contact.contact.weights;
  for (const WeightedVertex& i : weights) {
    const int vertex = i.vertex.index();
    double sum = 0;
    for (const WeightedVertex& j : weights) {
      sum += j.weight;
      if (j.vertex == i.vertex) continue;
      const int entry = pattern.find(vertex, j.vertex.index());
      POLYSCALPEL_ASSERT(entry >= 0);
      Eigen::Map<Eigen::Matrix<Scalar, 3, 3>>(&matrix.blocks[9 * static_cast<std::size_t>(entry)]) +=
          (scale * i.weight * j.weight * contact.B).template cast<Scalar>();
    }
    matrix.ties.push_back({vertex, scale * i.weight * sum * contact.B});
  }
}

}  // namespace polyscalpel
