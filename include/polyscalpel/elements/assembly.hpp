// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/core/block_matrix.hpp"
#include "polyscalpel/elements/cell_mechanics.hpp"
#include "polyscalpel/elements/corotated_body.hpp"
#include "polyscalpel/elements/element_formulation.hpp"
#include "polyscalpel/elements/strain_measure.hpp"
#include "polyscalpel/mesh/mesh_change.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// What cells of one kind are made of, and how they become elements.
struct CellKind {
  IsotropicMaterial material;
  ElementConfig element;
};

/// The kinds of a body's cells.
struct CellKinds {
  std::vector<CellKind> kinds = {{}};  ///< at least 1; equal in strain, exact_force and consistent_mass
  std::vector<int> of_cell;            ///< by cell id, indices into kinds; empty: kind 0 everywhere
};

/// All cells' matrices, and what they sum up to: mass, a positive semidefinite stiffness and forces, with one
/// rotation R a cell (M. Mueller, M. Gross, "Interactive Virtual Materials", Graphics Interface 2004). All
/// sums run over the cells by ascending id, so the same input gives the same bits. A value: a copy is
/// independent.
///
/// Positions and forces are 3 x numVertices(), one column per vertex [m], [N].
class Assembly {
 public:
  /// Matrices of every cell of the mesh. mass_floor: lowest mass of a vertex that a later cut makes or
  /// touches, as a part of the median vertex mass of this mesh; what such a vertex lacks is taken from the
  /// touched vertices that share a cell with it, so that no piece gains or loses mass. Where these have less
  /// than the floor on average, each gets no less than that average. A consistent mass has no floor. Throws
  /// std::invalid_argument for bad material or element config.
  Assembly(const PolyhedralMesh& mesh, const CellKinds& kinds, double mass_floor);
  /// One kind.
  Assembly(const PolyhedralMesh& mesh, const IsotropicMaterial& material, const ElementConfig& config,
           double mass_floor);

  /// Follows a change of the mesh: matrices are made for new and changed cells only, which take their
  /// parents' kinds and are linearised around their rest shape; the pattern is made anew.
  void update(const PolyhedralMesh& mesh, const MeshChange& change);

  int numVertices() const { return static_cast<int>(is_touched_.size()); }
  /// 3 x n [m].
  const Eigen::Matrix3Xd& restPositions() const { return rest_positions_; }
  /// Whether the stiffness is the same in every deformation.
  bool hasConstantStiffness() const { return !measure_->rotates(); }

  /// Pairs of vertices that share a cell. Stays as it is until the next update(). Made when first asked for
  /// after that, so no two threads may ask at once.
  const BlockPattern& pattern() const {
    if (!has_pattern_) makePattern();
    return pattern_;
  }

  /// Calls visit(other) for the vertices of higher index that share a cell with this one, ascending.
  template <class Visit>
  void forEachNeighbourAbove(int vertex, const Visit& visit) const {
    if (body_) {
      const RowPattern::Row& row = body_->pattern().rows[vertex];
      for (int k = row.first_above; k < row.first + row.count; ++k) visit(body_->pattern().column[k]);
    } else {
      const BlockPattern& blocks = pattern();
      for (int k = blocks.column_start[vertex] + 1; k < blocks.column_start[vertex + 1]; ++k)
        visit(blocks.row[k]);
    }
  }

  /// The fast way to forces and matrices; nullptr but for Strain::kCorotated. What it was linearised around
  /// is that of the assembly.
  CorotatedBody* corotatedBody() { return body_ ? &*body_ : nullptr; }

  /// Linearises every cell's force around these positions.
  void linearise(const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

  /// The same around the rest shape.
  void lineariseAtRest();

  /// matrix = mass_scale M + stiffness_scale K, K the positive semidefinite tangent of the linearisation;
  /// corotated: R K R^T. matrix: resized to the pattern.
  void assemble(double mass_scale, double stiffness_scale, Blocks& matrix);

  /// matrix = d^2 E / dx^2 at these positions, of the elastic energy itself: indefinite in general.
  void assembleExactTangent(const Eigen::Ref<const Eigen::Matrix3Xd>& positions, Blocks& matrix) const;

  /// Minus the elastic force on the vertices by the last linearisation: at the positions of that, and with
  /// exact_force, the gradient of elasticEnergy(); elsewhere linear in the positions. forces: resized and
  /// set.
  void internalForces(const Eigen::Ref<const Eigen::Matrix3Xd>& positions, Eigen::Matrix3Xd& forces);

  /// linearise(positions), then internalForces(ahead, forces), faster than one after the other; without what
  /// corotatedBody() takes for still, which linearise() alone forgets.
  void lineariseWithForces(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                           const Eigen::Ref<const Eigen::Matrix3Xd>& ahead, Eigen::Matrix3Xd& forces);

  /// Whether M has entries off its diagonal.
  bool hasConsistentMass() const { return kinds_.front().element.consistent_mass; }

  /// M v. values, result: 3 x n; result is resized and set.
  void multiplyMass(const Eigen::Ref<const Eigen::Matrix3Xd>& values, Eigen::Matrix3Xd& result) const;

  /// E(x) summed over the cells [J].
  double elasticEnergy(const Eigen::Ref<const Eigen::Matrix3Xd>& positions) const;

  /// E(x) of some cells that are alive [J].
  double elasticEnergy(const std::vector<CellId>& cells,
                       const Eigen::Ref<const Eigen::Matrix3Xd>& positions) const;

  /// Mass of each vertex, the row sums of M, mass floor included [kg]; 0 for a vertex without cells.
  const Eigen::VectorXd& vertexMasses() const { return vertex_masses_; }
  /// Mass that the mass floor has moved between the vertices of a piece [kg].
  double movedMass_kg() const { return moved_mass_; }

  const StrainMeasure& strainMeasure() const { return *measure_; }
  /// Kind of a cell that is alive.
  int kindOf(CellId cell) const { return kind_of_cell_[cell.index()]; }
  const CellKind& kind(int index) const { return kinds_[index]; }
  int numKinds() const { return static_cast<int>(kinds_.size()); }
  /// Matrices of a cell that is alive. Valid until the next update().
  const ElementMatrices& elementMatrices(CellId cell) const { return elements_[cell.index()]; }
  /// Calls visit(cell, kind, volume [m^3]) for every cell that is alive, ascending: one way through memory.
  template <class Visit>
  void visitVolumes(const Visit& visit) const {
    for (const PackedCell& cell : cells_) visit(CellId(cell.cell), cell.kind, cell.volume);
  }

 private:
  // Cells that are alive, ascending, with their data side by side, most in the same order.
  struct PackedCell {
    int cell = 0;
    int kind = 0;
    int num_vertices = 0;
    bool is_stabilised = false;
    int first_vertex = 0;  // in cell_vertices_, gradients_
    int first_block = 0;   // in cell_blocks_
    double volume = 0;
  };

  void makeCell(const PolyhedralMesh& mesh, int cell);
  void pack(const PolyhedralMesh& mesh);
  void repack(const PolyhedralMesh& mesh, const MeshChange& change);
  void makeRoom(int num_vertices, int num_blocks);
  void packCell(const PolyhedralMesh& mesh, CellId id, PackedCell& cell);
  void makeWorkspace();
  void makePattern() const;
  std::vector<CorotatedBody::Cell> bodyCells(const std::vector<CellId>& cells,
                                             const PolyhedralMesh& mesh) const;
  void makeMasses();
  void makeBlockMasses() const;
  void applyMassFloor();
  void assembleStiffness(double scale, Blocks& matrix) const;
  CellView view(const PackedCell& cell) const;
  Eigen::Ref<const Eigen::Matrix3Xd> gather(const PackedCell& cell,
                                            const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                                            Eigen::Matrix3Xd& room) const;

  const StrainMeasure* measure_ = nullptr;
  std::vector<CellKind> kinds_;
  std::vector<CellFormulation> formulations_;  // one a kind
  std::vector<LameModuli> moduli_;             // one a kind
  double mass_floor_kg_ = 0;

  std::vector<ElementMatrices> elements_;  // by cell id
  std::vector<int> kind_of_cell_;          // by cell id
  std::vector<char> is_touched_;           // by vertex id: made or touched by a cut

  std::vector<PackedCell> cells_;
  std::vector<int> cell_vertices_;
  Eigen::Matrix3Xd gradients_;  // Gm of all cells side by side
  mutable std::vector<int>
      cell_blocks_;  // lower triangle, row by row: block of local vertices (0,0) (1,0) (1,1) (2,0) ...
  int num_packed_vertices_ = 0;  // places in use or left behind, of cell_vertices_, gradients_
  int num_left_vertices_ = 0;    // of these, left behind by cells that were removed or changed
  int num_packed_blocks_ = 0;    // places in use or left behind, of cell_blocks_
  mutable BlockPattern pattern_;
  mutable bool has_pattern_ = false;
  Eigen::VectorXd vertex_masses_;
  mutable std::vector<double> block_masses_;  // by block [kg]: entry m_ij of M; comes and goes with pattern_
  double moved_mass_ = 0;

  Eigen::Matrix3Xd rest_positions_;
  std::optional<CorotatedBody> body_;
  DifferenceMatrix<double> differences_;           // room of assemble()
  std::vector<CellLinearisation> linearisations_;  // by cell id, where there is no body_
  int largest_cell_ = 0;                           // most vertices of a cell
  CellWorkspace work_{0};
  Eigen::Matrix3Xd gathered_, cell_forces_;
  Blocks rest_stiffness_;  // K, made when first needed, where it is constant
};

}  // namespace polyscalpel
