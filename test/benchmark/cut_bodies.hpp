// SPDX-License-Identifier: BSD-3-Clause
//
// Bodies that have been cut, for the comparison with re-tessellation.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "polyscalpel/materials/isotropic_material.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel::report {

struct CutBody {
  std::string name;
  PolyhedralMesh mesh;
  std::vector<bool> fixed;  ///< one flag a vertex: the foot, and every piece that the foot does not hold
  double foot_z_m = 0;      ///< the foot lies below
  Eigen::Vector3d gravity_m_s2 = Eigen::Vector3d::Zero();
  IsotropicMaterial material;
  int cells_before = 0;
  int cuts = 0;
  int pieces = 0;
  int loose_pieces = 0;      ///< pieces that are held whole because nothing else holds them
  int cells_left_whole = 0;  ///< cells that a cut passed and could not split soundly
  int violations = 0;        ///< of the mesh's invariants after all cuts
  double volume_error = 0;   ///< relative change of the volume by all cuts
  double cutting_s = 0;      ///< wall time of all cuts
  double mass_floor_kg = 0;  ///< the simulation's default: 2 % of the median vertex mass before any cut
};

/// The block [0, 3]^3 m of n^3 hexahedra on its fixed foot, under the planes x = 0.5, x = 1.5, y = 1.5 (M.
/// Wicke, M. Botsch, M. Gross 2007): n = 3 gives 60 cells from 27. Gravity acts across the columns that are
/// left.
CutBody makeCutBlock(int n);

/// Blades bent like hairpins.
struct Hairpins {
  int legs = 2;
  double reach = 0.85;  ///< of the outermost legs, in radii of the body
};

/// Those of the study of cell counts: such that 17 cuts leave 40,000 to 44,000 cells of some 8,300
/// tetrahedra.
constexpr Hairpins kHairpinsInBall = {2, 0.85}, kHairpinsInBunny = {3, 0.95};

/// A ball of radius 50 mm of 5 (2 half_count)^3 tetrahedra, its lowest part fixed, under curved cuts: a bowed
/// blade that turns and wanders as it comes down, from above the ball to 0.7 of its height.
CutBody makeCutBall(int half_count, int num_cuts);

/// A volume mesh from a file under the same kind of cuts, its lowest tenth fixed.
CutBody makeCutFile(const std::string& name, const std::string& path, int num_cuts);

/// The same ball under cuts that leave many more cells: each by one blade bent like a hairpin, its legs,
/// bowed and joined outside of the body, side by side; the blade turns and wanders as it passes the whole
/// body, along -z, across that, and along x in turns. The cuts of one direction lie at equal distances.
CutBody makeHairpinCutBall(int half_count, int num_cuts, const Hairpins& hairpins);

/// A volume mesh from a file under such cuts.
CutBody makeHairpinCutFile(const std::string& name, const std::string& path, int num_cuts,
                           const Hairpins& hairpins);

}  // namespace polyscalpel::report
