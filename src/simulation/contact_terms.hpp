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

/// The same as a hold of a matrix in difference form.
inline Hold holdOf(const LinearisedContact& contact, double scale) {
  Hold hold;
  for (const WeightedVertex& w : contact.contact.weights) hold.shares.push_back({w.vertex.index(), w.weight});
  hold.stiffness = scale * contact.B;
  return hold;
}

}  // namespace polyscalpel
