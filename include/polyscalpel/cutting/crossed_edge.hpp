// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include <Eigen/Core>

#include "polyscalpel/core/types.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// An edge of the mesh as (smaller id, larger id).
using Edge = std::pair<VertexId, VertexId>;

inline Edge makeEdge(VertexId a, VertexId b) {
  return a < b ? Edge{a, b} : Edge{b, a};
}

struct EdgeHash {
  std::size_t operator()(const Edge& edge) const noexcept {
    // Ids are dense: an odd factor spreads them over the buckets.
    const auto first = static_cast<std::uint64_t>(edge.first.index());
    return static_cast<std::size_t>(
        (first << 32 | static_cast<std::uint64_t>(edge.second.index())) * 0x9E3779B97F4A7C15u >> 16);
  }
};

/// The blade's surface through an edge.
struct Hit {
  Edge edge;
  double weight = 0;  ///< where, from edge.first (0) to edge.second (1); the same in rest and deformed shape
  int sign =
      0;  ///< +1: edge.first lies behind the blade's surface and edge.second before it; -1: the reverse
  double alignment = 1;  ///< |cos| of the angle between the edge and the normal of the blade's surface
  /// Of the surface, of length 1, where that is a blade's way, which bends; zero where it is a plane.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
};

/// A crossed edge.
struct CrossedEdge {
  double weight = 0;
  int sign = 0;                                      ///< as in Hit, at weight
  double alignment = 1;                              ///< as in Hit
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< as in Hit
  int time = 0;       ///< of the hit, counted in rounds of cutting as all times of Crossings
  int last_time = 0;  ///< when the blade was last here
  /// Where a bent surface comes back through the edge, > weight; infinite: nowhere.
  double second_weight = std::numeric_limits<double>::infinity();

  bool isTwice() const { return second_weight < 1; }
  /// Where a cut goes that parts the edge's first end from the rest, or its second end.
  double weightAt(bool is_first) const { return is_first || !isTwice() ? weight : second_weight; }
  /// Side of the blade's surface on which the edge's first end lies, or its second end.
  int sideAt(bool is_first) const { return is_first || isTwice() ? -sign : sign; }
  /// Takes a further hit, elsewhere on the edge, for the second one if the surface comes back there.
  void addSecond(const Hit& hit);
  /// The same seen from the edge's other end.
  CrossedEdge reversed() const;
  /// What lies on the part of the edge up to `end`; nothing where none does.
  std::optional<CrossedEdge> upTo(double end) const;
};

/// Whether a hit lies on the sheet that has crossed its edge already: within the snap distance.
bool isSamePlace(const PolyhedralMesh& mesh, const Hit& hit, const CrossedEdge& crossed,
                 double snap_tolerance);

/// Whether a blade's way only grazes an edge: it goes on to the same side, bent, and comes back through the
/// edge within the snap distance. Where the blade is drawn back instead, its normal turns round.
bool isGrazed(const PolyhedralMesh& mesh, const Hit& hit, const CrossedEdge& crossed, double snap_tolerance);

/// Whether a blade whose way has this normal comes back from where its way had the other one; not where one
/// is not known, that is, zero.
bool isComingBack(const Eigen::Vector3d& normal, const Eigen::Vector3d& former);

/// Whether two surfaces with these normals cross; not where one is not known, that is, zero.
bool isAtAngle(const Eigen::Vector3d& normal, const Eigen::Vector3d& other);

/// Whether a way with this normal goes on with the sheet that has the other one, the same way round; not
/// where one is not known, that is, zero.
bool isSameSheet(const Eigen::Vector3d& normal, const Eigen::Vector3d& other);

}  // namespace polyscalpel
