// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/mesh/mesh_change.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// How thin the cells are that cuts have left, in rest shape: the effect of the sliver policy
/// (CuttingConfig). h is the size of the uncut mesh around a vertex (PolyhedralMesh::localSize).
struct MeshQuality {
  double shortest_edge_m = 0;
  double shortest_edge_relative = 0;         ///< length over the smaller h of its ends, the smallest of all
  double smallest_cell_volume_relative = 0;  ///< volume over h^3, h the smallest of the cell's vertices
  /// Largest tr(K_ii) / (3 m_i) of any vertex, K the stiffness at rest and M the mass [1/s^2]: by Rayleigh's
  /// quotient never more than the largest squared angular frequency of the lumped body, and as K <= n diag(K)
  /// for a cell of n vertices not less than 1 / (3 n) of it, n the most vertices of a cell.
  double largest_stiffness_over_mass_1_s2 = 0;
};

/// The largest of numbered values that come, change and go: O(log n) for each.
class LargestValue {
 public:
  void set(int number, double value);
  void remove(int number);
  /// 0 where there is none.
  double get() const { return heap_.empty() ? 0 : heap_.front().first; }

 private:
  void dropOutdated();

  std::vector<double> values_;                // by number; NaN: none
  std::vector<std::pair<double, int>> heap_;  // outdated entries stay until they come up
};

/// Keeps a mesh's quality while it is cut: exact at any time, and brought up to date from the changed cells
/// and the vertices whose mass has changed alone. A value: a copy is independent.
class QualityMonitor {
 public:
  QualityMonitor(const PolyhedralMesh& mesh, const Assembly& assembly);

  /// Follows a change of the mesh, once the assembly has.
  void update(const PolyhedralMesh& mesh, const Assembly& assembly, const MeshChange& change);

  MeshQuality quality() const;

 private:
  void setCell(const PolyhedralMesh& mesh, const Assembly& assembly, CellId cell);
  void setVertex(const PolyhedralMesh& mesh, const Assembly& assembly, VertexId vertex);

  LargestValue minus_edge_, minus_relative_edge_, minus_volume_;  // by cell
  LargestValue stiffness_over_mass_;                              // by vertex
  Eigen::VectorXd masses_;                                        // n, as last seen [kg]
};

}  // namespace polyscalpel
