// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "polyscalpel/core/types.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// A vertex that the blade's surface goes through.
struct SnappedVertex {
  /// A vertex at the other end of a crossed edge.
  struct Neighbour {
    VertexId vertex;
    int side = 0;  ///< of the blade's surface
    /// Where the edge is crossed, from the snapped vertex (0) to this one (1). As it stands, no hit is nearer
    /// or further.
    double nearest = 0, furthest = 1;
  };

  int side = 0;             ///< of the vertex; 0 for one made on the blade's surface
  int time = 0;             ///< when the blade's surface came to go through it
  int last_time = 0;        ///< when the blade was last here
  bool has_joined = false;  ///< no hit has brought it here
  std::vector<Neighbour> neighbours;
  std::vector<Neighbour> again;                      ///< the same as the blade comes back, released before
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< of the blade's way here; zero where not known

  /// nullptr where no hit has told of it.
  const Neighbour* find(VertexId neighbour) const;
  /// Side on which a neighbour lies: that of the vertex where no hit has told of it.
  int sideOfNeighbour(VertexId neighbour) const;
  void forgetNeighbour(VertexId neighbour);
  /// One more hit of the sheet that goes through the vertex, on an edge of it, at a weight from the vertex
  /// on, beyond which the surface's side is `other_side`. A bent sheet may come through an edge more than
  /// once: the hit nearest to the vertex tells on which side it lies, the furthest one on which the neighbour
  /// does.
  void addHit(VertexId neighbour, int other_side, double weight);
};

}  // namespace polyscalpel
