// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "polyscalpel/core/block_matrix.hpp"
#include "polyscalpel/elements/element_matrices.hpp"
#include "polyscalpel/mesh/mesh_change.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// All cells' matrices, and what they sum up to: mass, stiffness R K R^T and forces R K (R^T x - X), the
/// stiffness warping of M. Mueller, M. Gross, "Interactive Virtual Materials", Graphics Interface 2004, with
/// one rotation R a cell. All sums run over the cells by ascending id, so the same input gives the same bits.
/// A value: a copy is independent.
///
/// Positions and forces are 3 x numVertices(), one column per vertex [m], [N].
class Assembly {
 public:
  /// Matrices of every cell of the mesh. mass_floor: lowest mass of a vertex that a later cut makes or
  /// touches, as a part of the median vertex mass of this mesh. Throws std::invalid_argument for bad material
  /// or element config.
  Assembly(const PolyhedralMesh& mesh, const IsotropicMaterial& material, const ElementConfig& config,
           double mass_floor);

  /// Follows a change of the mesh: matrices are made for new and changed cells only; the pattern is made
  /// anew.
  void update(const PolyhedralMesh& mesh, const MeshChange& change);

  int numVertices() const { return pattern_.numVertices(); }
  bool isCorotated() const { return config_.corotated; }

  /// Pairs of vertices that share a cell. Stays as it is until the next update().
  const BlockPattern& pattern() const { return pattern_; }

  /// Takes each cell's rotation from its mean deformation gradient at these positions. Does nothing when not
  /// corotated: rotations are then identity for ever.
  void updateRotations(const Eigen::Ref<const Eigen::Matrix3Xd>& positions);

  /// Sets every rotation to identity: the small-strain operator of the rest shape.
  void resetRotations();

  /// matrix = mass_scale M + stiffness_scale R K R^T, at the rotations last taken. matrix: resized to the
  /// pattern.
  void assemble(double mass_scale, double stiffness_scale, Blocks& matrix);

  /// f = R K (R^T x - X) at the rotations last taken, whatever positions those were taken from; minus the
  /// elastic force on the vertices [N]. forces: resized and set.
  void internalForces(const Eigen::Ref<const Eigen::Matrix3Xd>& positions, Eigen::Matrix3Xd& forces);

  /// M v. values, result: 3 x n; result is resized and set.
  void multiplyMass(const Eigen::Ref<const Eigen::Matrix3Xd>& values, Eigen::Matrix3Xd& result) const;

  /// sum 1/2 (R^T x - X)^T K (R^T x - X) over the cells, with the rotations at x itself [J].
  double elasticEnergy(const Eigen::Ref<const Eigen::Matrix3Xd>& positions) const;

  /// Mass of each vertex, the row sums of M [kg], mass floor included.
  const Eigen::VectorXd& vertexMasses() const { return vertex_masses_; }
  /// Part of the mass that only the mass floor put there [kg].
  double addedMass_kg() const { return added_mass_; }

 private:
  // Cells that are alive, ascending, with their data side by side.
  struct PackedCell {
    int cell = 0;
    int num_vertices = 0;
    bool is_tetrahedron = false;
    int first_vertex = 0;  // in cell_vertices_, gradients_
    int first_block = 0;   // in cell_blocks_
    double volume = 0;
  };

  // Room for the largest cell, 3 x its number of vertices each, so that a step allocates nothing.
  struct Workspace {
    explicit Workspace(int num_vertices)
        : positions(3, num_vertices), back(3, num_vertices), forces(3, num_vertices) {}
    Eigen::Matrix3Xd
        positions;  // relative to the cell's first vertex: far from the origin forces would else lose digits
    Eigen::Matrix3Xd back;    // displacements R^T x - X
    Eigen::Matrix3Xd forces;  // K (R^T x - X), in the cell's own frame
  };

  void makeCell(const PolyhedralMesh& mesh, int cell);
  void pack(const PolyhedralMesh& mesh);
  void makePattern();
  void makeMasses();
  void assembleStiffness(double scale, Blocks& matrix);
  void gather(const PackedCell& cell, const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
              Workspace& work) const;
  Eigen::Matrix3d rotation(const PackedCell& cell, const Workspace& work) const;
  void cellForces(const PackedCell& cell, const Eigen::Matrix3d& R, Workspace& work) const;

  IsotropicMaterial material_;
  ElementConfig config_;
  double lambda_ = 0;
  double mu_ = 0;
  double mass_floor_kg_ = 0;

  std::vector<ElementMatrices>
      elements_;  // by cell id; a tetrahedron's stiffness is left empty, its gradients say it all
  std::vector<char> is_tetrahedron_;  // by cell id
  std::vector<char> is_touched_;      // by vertex id: made or touched by a cut
  Eigen::Matrix3Xd rest_positions_;

  std::vector<PackedCell> cells_;
  std::vector<int> cell_vertices_;
  Eigen::Matrix3Xd gradients_;  // Gm of all cells side by side
  std::vector<int>
      cell_blocks_;  // lower triangle, row by row: block of local vertices (0,0) (1,0) (1,1) (2,0) ...
  BlockPattern pattern_;
  Eigen::VectorXd vertex_masses_;
  std::vector<double> block_masses_;  // by block [kg]: entry m_ij of M
  double added_mass_ = 0;

  std::vector<Eigen::Matrix3d> rotations_;  // by packed cell
  Workspace work_{0};
  Blocks rest_stiffness_;  // K for identity rotations, made when first needed, when not corotated
};

}  // namespace polyscalpel
