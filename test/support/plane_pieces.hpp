// SPDX-License-Identifier: BSD-3-Clause
//
// What a plane makes of an uncut body, by exact clipping of its cells: the measure for the cutting kernel,
// which snaps crossings to vertices.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// A part of the body on one side of the plane, in one piece.
struct PlanePiece {
  double volume_m3 = 0;
  double thickness_m = 0;  ///< largest distance of its points from the plane
  double cut_area_m2 = 0;  ///< where it lies in the plane
  VertexId farthest;       ///< vertex of the body that is thickness_m away
};

/// All parts of an uncut mesh with flat faces, in its rest shape. Parts are joined where they share a face
/// off the plane.
std::vector<PlanePiece> clipByPlane(const PolyhedralMesh& mesh, const PlaneCut& plane);

/// How the pieces of a cut mesh differ from those of exact clipping.
struct PlaneComparison {
  int missing = 0;   ///< parts thicker than the snap distance that share their piece with another such part
  int spurious = 0;  ///< pieces beyond the number of all parts
  double volume_error = 0;  ///< largest difference of a thick part's volume, by (snap distance * cut area)
};

/// parts: of the mesh before the cut. snap_distance_m: largest of the mesh.
PlaneComparison compareWithClipping(const PolyhedralMesh& cut_mesh, const std::vector<PlanePiece>& parts,
                                    double snap_distance_m);

}  // namespace polyscalpel
