// SPDX-License-Identifier: BSD-3-Clause
//
// Cracks that run through cells where tension passes the strength: the split is that of a blade's cut, its
// surface is told by the stress. Any slit may grow, a blade's as well (crack_front.hpp).
#pragma once

#include <map>
#include <set>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_change.hpp"
#include "polyscalpel/mesh/mesh_index.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// Cracks driven by stress. A crack advances by one cell a step at each place of its front, at most: beyond
/// that the stress has to be found anew.
struct FractureConfig {
  int max_splits_per_step = 20;  ///< in [1, 1000000]: the most strained cells come first
};

/// Throws std::invalid_argument with name, value and range.
void validate(const FractureConfig& config);

/// What drives a crack through a cell, in deformed space.
struct CellLoad {
  CellId cell;
  Eigen::Matrix3d stress_pa;           ///< smoothed Cauchy stress, that of damping included
  Eigen::Matrix3d elastic_stress_pa;   ///< the cell's own, neither smoothed nor damped
  Eigen::Matrix3d elastic_strain;      ///< of the elastic stress
  double strength_pa = 0;              ///< > 0
  double fracture_toughness_j_m2 = 0;  ///< >= 0
};

/// Cells that one crack is to split in a step.
struct CrackAdvance {
  int slit = 0;  ///< number of the slit from whose front the crack goes on; 0: a new crack
  std::vector<CellId> cells;
};

/// What a step's stress asks for.
struct CrackPlan {
  std::vector<CrackAdvance> advances;  ///< by ascending number of the slit, a new crack first
  bool is_limited = false;             ///< more cells would have split but for max_splits_per_step
};

/// The cracks of a body. A value: a copy is independent.
///
/// A cell may split when the largest principal value of its stress passes the strength, and the energy that
/// a new area of crack frees, G, is at least the fracture toughness. At a front the stress ahead is
/// K / sqrt(2 pi r), its mean over a cell that reaches to r = l is K sqrt(2 / (pi l)), and G = K^2 / E (G. R.
/// Irwin, "Analysis of stresses and strains near the end of a crack traversing a plate", 1957):
///
///   G = pi / 2 l (sigma n) . (eps n),
///
/// sigma and eps those of the cell, n the normal of the crack's plane, l how far the cell reaches ahead of
/// the front. So G does not depend on the size of the cells, while the strength alone would be passed there
/// at any load by cells small enough. Where there is no front yet, G is the energy that the traction on the
/// plane holds in the cell, l its extent along n (Z. P. Bazant, B. H. Oh, "Crack band theory for fracture of
/// concrete", 1983, linear elastic): G = 1 / 2 l (sigma n) . (eps n). The toughness decides whether a crack
/// runs, not how fast: no energy is taken from the body but that of its faces set free.
///
/// A cell at a front splits along the plane that holds the front's vertices in it and otherwise lies as
/// nearly as possible across the principal direction; it does not split where the two directions are more
/// than 60 degrees apart. A new crack starts only while no front goes on, since a crack that grows unloads
/// what is around it: in the most strained cell of the body that has no front near it, along the plane
/// through the mean of its vertices across the principal direction. A vertex nearer to a plane than the snap
/// distance is taken to lie in it, and where a whole face then does, that face is opened.
class CrackGrowth {
 public:
  /// Both valid.
  CrackGrowth(const FractureConfig& config, double snap_tolerance)
      : config_(config), snap_tolerance_(snap_tolerance) {}

  /// Which cells are to split. loads: one a cell at most; cells without one do not break. positions: 3 x n
  /// [m]. Ties go to the smaller id.
  CrackPlan plan(const PolyhedralMesh& mesh, const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                 const std::vector<CellLoad>& loads) const;

  /// Splits the cells of one advance that are still there, each by itself. next_cut: number for a crack that
  /// has none yet. A cell that cannot be split soundly is left whole and counted, and not tried again before
  /// its shape changes. The status is kCut or kNothingSeparated; index: as in cutMesh(), tree fitted or
  /// empty.
  CutResult grow(PolyhedralMesh& mesh, const Eigen::Ref<const Eigen::Matrix3Xd>& positions,
                 const CrackAdvance& advance, const std::vector<CellLoad>& loads, int next_cut,
                 MeshIndex& index);

  /// To be called when anything has changed the mesh, grow() included.
  void update(const MeshChange& change);

 private:
  FractureConfig config_;
  double snap_tolerance_;
  std::map<int, int> crack_of_slit_;  // number of the crack that goes on from a slit; a crack's own included
  std::set<CellId> refused_;          // could not be split as they are
};

}  // namespace polyscalpel
