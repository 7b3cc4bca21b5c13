// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <type_traits>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/core/difference_matrix.hpp"
#include "polyscalpel/elements/element_formulation.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

struct CellBatch;

/// Forces and stiffness of all cells under small strain in turning frames, made for speed: what
/// cell_mechanics.hpp says of one cell, four cells of a kind side by side, and a matrix whose blocks are
/// summed edge by edge. A change of the mesh touches its own cells and rows only. Every sum runs by ascending
/// cell id, so the same mesh gives the same bits on any machine, with any number of threads. A value.
///
/// Stiffness of two vertices a, b of a cell: V (lambda h_a h_b^T + mu h_b h_a^T + mu (g_a . g_b) I), h = R g,
/// R turning with the cell; of these the third term never changes, and the first two are made from h alone.
class CorotatedBody {
 public:
  /// A cell as the mesh and its element have it.
  struct Cell {
    CellId id;
    const std::vector<VertexId>* vertices = nullptr;  ///< ascending
    const ElementMatrices* element = nullptr;
    LameModuli moduli;
    double density_kg_m3 = 0;
  };

  /// Takes out and puts in cells; removed ones must be there. num_vertices: of the mesh as it is now.
  void update(int num_vertices, const std::vector<CellId>& removed, const std::vector<Cell>& added);

  /// At most so many threads, >= 1, share a call's work.
  void setThreads(int num_threads) { num_threads_ = num_threads; }

  /// Vertices that do not move, fixed or asleep. Forces on them are zero, rows of the matrix and rotations of
  /// theirs are not made, and cells all of whose vertices are still cost nothing. One flag a vertex, or empty
  /// for none; holds until update().
  void setStill(const std::vector<char>& still);

  /// Which vertices share a cell.
  const RowPattern& pattern() const { return pattern_; }

  /// Takes each cell's rotation from these positions, 3 x n [m]. exact_force as in ElementConfig.
  void linearise(const Eigen::Ref<const Eigen::Matrix3Xd>& positions, bool exact_force);
  /// Linearises around `positions`, and sets `forces` to dE/dx at `ahead` by that linearisation: linearise()
  /// and internalForces() in one way through memory, with what assemble<float>() needs made on it too.
  void lineariseWithForces(const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                           const Eigen::Ref<const Eigen::Matrix3Xd>& ahead, bool exact_force,
                           Eigen::Matrix3Xd& forces);
  /// Every cell's rotation is the identity, as at rest.
  void lineariseAtRest();
  /// Rotation of a cell.
  Eigen::Matrix3d rotationOf(CellId cell) const;

  /// dE/dx by the last linearisation, 3 x n [N]; resized and set.
  void internalForces(const Eigen::Ref<const Eigen::Matrix3Xd>& positions, Eigen::Matrix3Xd& forces);

  /// matrix = mass_scale M + stiffness_scale K by the last linearisation. vertex_masses: n, row sums of M
  /// [kg].
  template <class Scalar>
  void assemble(const Eigen::VectorXd& vertex_masses, double mass_scale, double stiffness_scale,
                DifferenceMatrix<Scalar>& matrix);

  /// The same in the rest shape, whatever the last linearisation is, without those that are `still` then.
  void assembleAtRest(const Eigen::VectorXd& vertex_masses, double mass_scale, double stiffness_scale,
                      const std::vector<char>& still, DifferenceMatrix<double>& matrix);
  /// The same with the cells' rotations at these positions; rotations: of the vertices then, as
  /// vertexRotations() gives them.
  void assembleAt(const Eigen::Ref<const Eigen::Matrix3Xd>& positions, const Eigen::VectorXd& vertex_masses,
                  double mass_scale, double stiffness_scale, const std::vector<char>& still,
                  DifferenceMatrix<double>& matrix, std::vector<float>& rotations);

  /// Rotation of each vertex that moves, near those of its cells, 9 numbers each column by column.
  void vertexRotations(std::vector<float>& rotations);

  /// result = M values, 3 x n; vertex_masses: row sums of M.
  void multiplyMass(const Eigen::VectorXd& vertex_masses, bool is_consistent,
                    const Eigen::Ref<const Eigen::Matrix3Xd>& values, Eigen::Matrix3Xd& result) const;

 private:
  template <class Run>
  void runApart(const std::vector<char>& still, const Run& run);

  // Cells of equally many vertices and modes, side by side; places of cells are 4 a batch.
  struct Batch {
    int num_vertices = 0, num_modes = 0;
    int first_corner = 0;  // of 4 n: in vertices_, corner_forces_, corner gradients
    int first_number = 0;  // in numbers_
    int first_pair = 0;    // of 4 n (n - 1) / 2 blocks, where there are modes
    std::array<int, 4> cells = {-1, -1, -1, -1};
  };
  struct Corner {
    int corner = 0;
    int place = 0;  // of the cell
  };
  struct Span {
    int first = 0, count = 0;
  };
  // Sums of an entry above the diagonal; follow on each other in the order of the row's entries.
  struct Incidences {
    int num_pairs = 0;        // of corners
    int num_stabilisers = 0;  // of these, in cells with a stabilising part
  };
  struct Pair {
    int row_corner = 0, column_corner = 0;
  };
  // What the last linearisation makes of gradients and stabilising parts.
  template <class Scalar>
  struct Turned {
    std::vector<Scalar> gradients;  // 4 a corner
    std::vector<Scalar> blocks;     // 9 a pair of a cell with modes
    bool is_current = false;        // made from the last linearisation
  };
  // Where the numbers of a batch lie behind first_number.
  struct Layout;

  void removeCell(CellId cell);
  void addCell(const Cell& cell);
  void makeBatch(int num_vertices, int num_modes);
  void updateCorners(const std::vector<Cell>& added);
  void makeRow(int vertex);
  void linkRow(int vertex);
  void makeRows(const std::vector<int>& touched);
  void makeVertexRotation(int vertex);
  void selectRows();
  bool isStill(int vertex) const { return !still_.empty() && still_[vertex] != 0; }
  CellBatch view(const Batch& batch) const;
  template <class Visit>
  void forEachBatch(const Visit& visit) const;
  void gatherForces(Eigen::Matrix3Xd& forces) const;
  template <class Scalar>
  void resizeTurned(Turned<Scalar>& turned) const;
  template <class Scalar>
  void makeTurned(int index, const CellBatch& batch, void* room, Turned<Scalar>& turned) const;
  template <class Scalar>
  Turned<Scalar>& turnedOf() {
    if constexpr (std::is_same_v<Scalar, float>) {
      return turned_float_;
    } else {
      return turned_double_;
    }
  }

  int num_threads_ = 1;
  std::vector<char> still_;           // as given
  std::vector<char> batch_is_still_;  // all vertices of all its cells; empty: none is
  std::vector<int> moving_;           // vertices that are not still
  std::vector<int> rows_;             // theirs, and those above which entries of theirs stand
  std::vector<Batch> batches_;
  std::vector<std::vector<int>> free_places_;  // by number of vertices, twice: without and with modes
  std::vector<int> place_of_cell_;             // by cell id, -1 where there is none
  std::vector<int> vertices_;                  // of each corner
  std::vector<double> numbers_;
  std::vector<double> densities_;                // of each place
  std::vector<Eigen::MatrixXd> mass_integrals_;  // of each place; empty where masses are lumped
  int num_pairs_ = 0;
  int most_modes_ = 0;

  std::vector<Span> corners_of_vertex_;  // in corners_
  std::vector<Corner> corners_;          // of a vertex: by ascending cell id
  int num_left_corners_ = 0;

  RowPattern pattern_;
  int num_left_entries_ = 0;
  std::vector<Incidences> incidences_;  // of each entry
  std::vector<double> entry_masses_;    // of each entry [kg]
  std::vector<double> entry_shears_;    // sum of V mu g_a . g_b [N/m]
  std::vector<int> first_pair_;         // of each vertex's row, in pairs_
  std::vector<int> first_stabiliser_;   // of each vertex's row, in stabilisers_
  std::vector<Pair> pairs_;
  std::vector<int> stabilisers_;  // blocks of pairs

  std::vector<int> rotation_places_;  // 4 a vertex
  std::vector<double> rotation_weights_;

  std::vector<double> rotations_, spins_;  // 36 and 12 a batch
  std::vector<double> corner_forces_;      // 4 a corner
  Turned<float> turned_float_;
  Turned<double> turned_double_;

  // Room of makeRow, kept to allocate once.
  struct Meeting {
    int neighbour = 0, order = 0;
    Pair pair;
    int stabiliser = -1;
    double mass = 0, shear = 0;
  };
  std::vector<Meeting> meetings_;
};

}  // namespace polyscalpel
