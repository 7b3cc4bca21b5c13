// SPDX-License-Identifier: BSD-3-Clause
//
// A body that is cut again and again, and what must hold after every cut.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "polyscalpel/core/types.hpp"
#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// A smooth map of space that a body is cut through, so that flat cuts are bent ones in its rest shape:
/// X + amplitude * sin(wave * X + phase), each component by itself. Invertible where amplitude times every
/// row's length of `wave` is below 1.
struct SmoothDeformation {
  double amplitude_m = 0;
  Eigen::Matrix3d wave = Eigen::Matrix3d::Zero();   ///< one row a component [rad/m]
  Eigen::Vector3d phase = Eigen::Vector3d::Zero();  ///< [rad]

  Eigen::Vector3d operator()(const Eigen::Vector3d& rest_position) const;
};

/// A surface that divides all of space, as the cut that it belongs to divides the body.
struct Separator {
  /// Signed distance [m] of a point in the space of the cut; its absolute value is never too large.
  std::function<double(const Eigen::Vector3d&)> distance;
  /// How far the cut may lie off it beyond the snap distance, as a multiple of the local size: curvature.
  double slack = 0;
};

/// One cut, complete in itself: applied again to the same mesh it does the same.
struct TortureCut {
  std::string kind;
  CutOperation operation;
  /// A sweep is drawn pose by pose through BladeCut::advance() and ended by finish(), not cut at once.
  bool is_progressive = false;
  std::optional<SmoothDeformation> deformation;
  std::optional<Separator> separator;
  /// Goes where the last cut went: nothing may come apart.
  bool is_repeat = false;
  /// A sweep's poses along the same path in so many steps; empty where there is no such path.
  std::function<std::vector<Eigen::Isometry3d>(int)> path;
};

/// What one cut did and what is wrong with the mesh after it.
struct TortureOutcome {
  CutStatus status = CutStatus::kMissed;
  bool was_refused = false;  ///< no cut by its input, or a motion that is too long
  int splits = 0;
  int left_whole = 0;
  std::vector<std::string> violations;  ///< of checkMesh(), and of the counts of pieces
  int pieces_missing = 0;               ///< parts thicker than the snap distance that still hang together
  int pieces_torn = 0;                  ///< parts that no cut separates, of a convex body, and that are apart
  double volume_error = 0;              ///< of the body since it was whole, relative
  double piece_volume_error = 0;  ///< see PlaneComparison; only of the first plane through a convex body
  /// Of the mesh, rest length by the local size; kInfinity where the cut was refused as no cut.
  double shortest_edge = kInfinity;
  /// The same of the edges that the cut has crossed and divided; 1 where it has none.
  double shortest_part = 1;
};

class TortureBody {
 public:
  /// is_convex: whether planes may only divide it into as many parts as they divide its convex hull.
  TortureBody(std::string name, PolyhedralMesh mesh, bool is_convex);

  const std::string& name() const { return name_; }
  const PolyhedralMesh& mesh() const { return mesh_; }
  /// Median of the local sizes of the uncut mesh [m].
  double size() const { return size_; }
  const Eigen::AlignedBox3d& box() const { return box_; }
  int numCuts() const { return num_cuts_; }
  bool isConvex() const { return is_convex_; }

  /// Where the body lies for a cut, 3 x n.
  Eigen::Matrix3Xd positionsFor(const TortureCut& cut) const;

  TortureOutcome apply(const TortureCut& cut, const CuttingConfig& config);

 private:
  struct Known {
    Separator separator;
    std::optional<SmoothDeformation> deformation;
    int num_vertices = 0;  // of the mesh that it cut
  };

  CutResult cutAtOnce(const TortureCut& cut, const CuttingConfig& config);
  CutResult cutProgressively(const TortureCut& cut, const CuttingConfig& config, TortureOutcome& outcome);
  /// Signed side of each separator, none where the point is too near to one of them to tell.
  /// vertices: those that it is taken from.
  std::optional<std::vector<bool>> signatureOf(const Eigen::Vector3d& rest_position,
                                               const std::vector<VertexId>& vertices,
                                               const CuttingConfig& config) const;
  /// Local size [m] by which a separator judges a place at these vertices.
  double sizeFor(const Known& separator, const std::vector<VertexId>& vertices) const;
  void compareWithSeparators(const CuttingConfig& config, TortureOutcome& outcome);
  /// Takes out the separator without which nothing is missing: what is found once would be found after every
  /// later cut.
  void forgetFailedSeparator(const CuttingConfig& config);
  void measureEdges(int first_new_vertex, const std::vector<NewVertex>& new_vertices,
                    TortureOutcome& outcome) const;

  std::string name_;
  PolyhedralMesh mesh_;
  bool is_convex_ = false;
  bool are_all_planes_ = true;  // every cut so far
  double size_ = 0, volume_ = 0;
  Eigen::AlignedBox3d box_;
  int num_cuts_ = 0, pieces_ = 0;
  bool was_last_complete_ = true;  // the last cut left nothing whole and nothing hanging together
  std::vector<Known> separators_;
  std::vector<double> sizes_;  // of the vertices: the largest of those between which each was made
};

/// Number of pieces of a mesh by our own flood fill, which joins cells whose faces have the same vertices and
/// uses no list of neighbours.
int countPiecesByFloodFill(const PolyhedralMesh& mesh);

}  // namespace polyscalpel
