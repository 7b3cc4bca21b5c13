// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/mesh/mesh_change.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"
#include "polyscalpel/simulation/simulation_state.hpp"

namespace polyscalpel {

/// What a cut did to the motion and the energy of the body. Changes are "after" minus "before"; those of the
/// motion are zero in the static modes.
struct CutBalance {
  Eigen::Vector3d momentum_change = Eigen::Vector3d::Zero();  ///< [kg m/s]; rounding, but see CutLedger
  /// About any point, as the momentum is unchanged [kg m^2/s].
  Eigen::Vector3d angular_momentum_change = Eigen::Vector3d::Zero();
  double kinetic_energy_change_j = 0;  ///< never above rounding
  /// Of the cells that the cut changed: before it, and of what it made of them. All other cells keep theirs.
  double elastic_energy_before_j = 0, elastic_energy_after_j = 0;
};

/// Carries velocities over a cut. A new vertex gets the velocity of the place where it is made. On a linear
/// tetrahedron the field of velocities is then the same as before, and so is its momentum. On a polyhedron it
/// is not: the shape functions of the parts do not sum up to those of the whole, nor do lumped masses keep
/// the kinetic energy. So, for each connected group of vertices around which cells or masses have changed,
/// which is a part of one piece as it was before the cut, over its free vertices S:
///
/// 1. Momentum. v_i += d, d = (P_before - P_after) / m_S: of all increments with this momentum, the one that
///    is smallest in the norm of the mass (minimise sum m_i |d_i|^2 at a given sum m_i d_i: all d_i equal). A
///    rotation is not added: the parts have a smaller lumped inertia than the whole, so keeping the angular
///    momentum of a spin would raise its energy. It is measured and told instead.
/// 2. Energy. Where the kinetic energy is then higher than before, v_i = V + s (v_i - V), V the mean velocity
///    of S by mass, with the largest s in [0, 1] for which it is not: the momentum does not depend on s. With
///    lumped masses there is always one where S is free: the least energy of a momentum P and a mass m_S is
///    |P|^2 / (2 m_S), which the state before had at least, m_S being unchanged.
///
/// Where fixed vertices have taken over a part of the mass, no velocities may do both; then the energy is
/// kept, the velocities of S are scaled, and the supports take the rest of the momentum, as they do in every
/// step. Linear lumped tetrahedra cut for the first time need no second part: their energy falls by itself,
/// |v|^2 being convex along the cut edges.
///
/// The elastic energy is not corrected. A linear tetrahedron's parts keep it to rounding. On polyhedra the
/// parts' energy lies between bounds that depend on the shapes only, as both are positive quadratic forms (of
/// the deformation without its rotation) with the same zeros: at the worst displacements 0.55 and 15.5 times
/// what it was, as measured for a cube and 100 random planes. What it was before and after is told.
class CutLedger {
 public:
  /// To be made when the mesh has been cut but state and assembly have not followed yet.
  /// is_moving: false in the static modes, where velocities carry no momentum.
  CutLedger(const SimulationState& state, const Assembly& assembly, const MeshChange& change, bool is_moving);

  /// To be called when both have followed: corrects the velocities and tells the balance.
  CutBalance settle(const PolyhedralMesh& mesh, const MeshChange& change, const Assembly& assembly,
                    SimulationState& state) const;

 private:
  std::vector<std::vector<int>> findGroups(const PolyhedralMesh& mesh, const MeshChange& change,
                                           const Assembly& assembly) const;
  void settleGroup(const std::vector<int>& vertices, const Assembly& assembly, SimulationState& state,
                   CutBalance& balance) const;

  double elastic_energy_ = 0;
  bool is_moving_ = false;    // and there is a velocity
  Eigen::VectorXd masses_;    // n, before [kg]
  Eigen::Matrix3Xd momenta_;  // 3 x n, before [kg m/s]; with a consistent mass only
};

}  // namespace polyscalpel
