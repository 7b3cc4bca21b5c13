// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include <boost/container/flat_map.hpp>

#include "polyscalpel/cutting/crossed_edge.hpp"
#include "polyscalpel/cutting/snapped_vertex.hpp"
#include "polyscalpel/mesh/mesh_change.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// What one stroke of one blade has crossed and not yet split, and what it has split. Where an edge of a
/// vertex is crossed by a surface that passes the vertex nearer than snap_tolerance * localSize, at right
/// angles to the surface, the crossing goes through the vertex: it is "snapped" in all cells around. So all
/// edges of a vertex agree, and no layer thinner than that is left between the two.
///
/// A stroke may cross its own slit. A cell that the blade has left is settled: what the blade crosses of it
/// from then on is another pass, which counts first for itself, and together with the earlier ones only where
/// it alone does not disconnect the cell. A vertex of the slit through which the blade goes once more is
/// snapped anew where an edge within the slit shows that the two sheets cross there; where they lie on each
/// other, the blade is drawn back through its own slit and makes nothing new.
class Crossings {
 public:
  /// Remembers a hit; the first one on an edge wins, until the blade has left all cells around it and comes
  /// back elsewhere on the edge. Where a bent way only grazes the edge, its second hit takes the first one
  /// back; where the blade comes back through it elsewhere, both count. Dropped: a hit within the snap
  /// distance of the slit that this stroke has just made, and one on an edge that lies in the slit, but not
  /// where the stroke crosses the slit.
  void add(const PolyhedralMesh& mesh, const Hit& hit, double snap_tolerance);

  /// The crossing of a cell's edge, nullptr where there is none that counts for this cell.
  const CrossedEdge* find(CellId cell, Edge edge) const;

  /// Whether the blade's surface goes through the vertex, for this cell. A cell that the stroke has split
  /// does not count the corners of its own cap, so that a blade which turns back can split it once more, but
  /// those that it has snapped anew since.
  bool isSnapped(CellId cell, VertexId vertex) const;

  /// Whether the vertex lies on the blade's surface: snapped to it, or made on it.
  bool isOnCut(VertexId vertex) const { return snaps_.count(vertex) > 0; }

  /// Whether the blade has crossed something of the cell once it had left it before.
  bool isPassedAgain(CellId cell) const { return earlier_.count(cell) > 0; }

  /// Has find() and isSnapped() count, for this cell, what the blade crossed before it had last left it.
  void countEarlierPasses(CellId cell, bool is_counted);

  /// Whether the vertex could join the cut: it is not on it, or on a sheet that is settled all around it.
  bool canJoin(VertexId vertex) const;

  /// Side of the blade's surface on which a vertex lies past which it goes within the snap distance, where an
  /// edge of it that is crossed there has been snapped to its other end.
  std::optional<int> sideIfNear(VertexId vertex) const;

  /// No less than this, in localSize, is a vertex away from the blade's surface, as edges of it tell that are
  /// snapped to their other ends; 0 where none does.
  double leastDistance(VertexId vertex) const;

  /// Side of the blade's surface on which a vertex lies that an edge joins to a snapped one; 0 where that is
  /// not known.
  int sideOfNeighbour(VertexId snapped, VertexId neighbour) const;

  /// Moves the crossings at a vertex into the vertex, as the blade passes it now. side: that on which it
  /// lies, +1 or -1, or 0 where that is not known.
  void snap(const PolyhedralMesh& mesh, VertexId vertex, int side) { snapAt(mesh, vertex, side, time_); }

  /// The same for a vertex that joins the cut in a cell: it is of the same pass as the latest of what that
  /// cell counts.
  void snap(const PolyhedralMesh& mesh, VertexId vertex, int side, CellId cell);

  /// Has the blade's surface begin at a vertex of a slit, whatever it was to this stroke before.
  void takeUp(const PolyhedralMesh& mesh, VertexId vertex);

  /// Snaps a vertex that another cut has made, where an edge of it is crossed within the snap distance.
  void snapNear(const PolyhedralMesh& mesh, VertexId vertex, double snap_tolerance);

  /// Records that a crossed edge has got a vertex where it was crossed.
  void recordSplitEdge(const PolyhedralMesh& mesh, Edge edge, VertexId middle);

  /// Records the two parts of a cell. first_side: side of the blade's surface on which the first part lies.
  /// is_second_whole: what has been crossed does not disconnect the second part any further. As long as it
  /// does, that part counts the corners of its caps, through which its own parts would hang together else.
  void recordSplitCell(CellId cell, CellId first, CellId second, const std::vector<VertexId>& cap_vertices,
                       int first_side, bool is_second_whole);

  /// The cell no longer counts the corners of its caps: nothing disconnects it any further.
  void settle(CellId cell);

  /// Records that an edge has got a vertex for another reason; is_on_cut: the edge lies in the blade's
  /// surface.
  void recordDividedEdge(const PolyhedralMesh& mesh, const NewVertex& origin, bool is_on_cut);

  /// Records on which side of the blade's surface a vertex lies from which a chord leads to snapped ones:
  /// they would take it to lie on their own side else.
  void recordSide(const PolyhedralMesh& mesh, VertexId vertex, int side);

  /// Records that an edge between two walls of the slit has got a vertex to open it by: the first of the new
  /// vertices, of which the others are copies.
  void recordOpenedEdge(const PolyhedralMesh& mesh, const std::vector<NewVertex>& new_vertices);

  /// Records that cells have been divided for another reason: their parts are what they were.
  void recordDividedCells(const MeshChange& change);

  /// Side of the blade's surface on which a cell lies, seen from a face of it whose corners are all snapped:
  /// +1, -1, or 0 where nothing tells. A cell with every vertex snapped lies where most ends of its edges
  /// were before they were snapped.
  int sideOf(const PolyhedralMesh& mesh, CellId cell, FaceId face) const;

  /// Whether all corners of the face are snapped, by the same pass of the blade for each of its cells. What
  /// lies in line between two of them is no corner.
  bool isInSlit(const PolyhedralMesh& mesh, const Face& face) const;

  /// Follows a commit: copies of vertices are crossed and snapped as the originals are; crossings of edges
  /// that are gone are dropped. Ends one unit of time.
  void update(const PolyhedralMesh& mesh, const MeshChange& change);

  /// Takes out the cells around whose edges or corners something was crossed since they were last taken,
  /// ascending. Those that are not ready stay.
  std::vector<CellId> takeCells(const PolyhedralMesh& mesh, const std::function<bool(CellId)>& is_ready);

  /// Has a cell taken out once more.
  void putBack(CellId cell) { cells_.insert(cell); }

  /// Snapped vertices whose faces may still have to be opened, ascending.
  const std::set<VertexId>& openVertices() const { return open_vertices_; }
  /// The faces around the vertex need not be looked at again.
  void release(VertexId vertex) { open_vertices_.erase(vertex); }
  /// The faces around a snapped vertex are to be looked at once more.
  void reopen(VertexId vertex) { open_vertices_.insert(vertex); }

  const std::unordered_map<Edge, CrossedEdge, EdgeHash>& edges() const { return edges_; }
  bool isEmpty() const { return edges_.empty() && snaps_.empty(); }
  void clear();

 private:
  /// Has a vertex on the way from a snapped one to a neighbour lie on the neighbour's side.
  void inheritNeighbour(VertexId snapped, VertexId neighbour, VertexId heir);
  void putCellsAround(const PolyhedralMesh& mesh, Edge edge);
  /// As putCellsAround(), for a hit: a cell that the blade had left begins another pass.
  void passCells(const std::vector<CellId>& cells);
  /// The same for those that have the edge which is hit: the blade is in them.
  void meetCells(const std::vector<CellId>& cells);
  /// Whether the blade has left a cell that is ready. One of which it has only snapped a corner, by an edge
  /// beyond, it may still have to come to, as long as it is at another cell around that corner.
  bool hasLeft(const PolyhedralMesh& mesh, CellId cell, const std::function<bool(CellId)>& is_ready) const;
  /// Has the part of a cell be passed as the cell was.
  void inheritPasses(CellId cell, CellId part);
  /// Snaps a vertex made between two snapped ones.
  void snapBetween(const NewVertex& origin);
  /// Has it be a corner of their caps, as its parents are, for the cells around `place`, which is the vertex
  /// itself or a copy of it that these cells are to get.
  void settleBetween(const PolyhedralMesh& mesh, const NewVertex& origin, VertexId place);
  /// normal: see SnappedVertex.
  void snapAt(const PolyhedralMesh& mesh, VertexId vertex, int side, int time,
              const Eigen::Vector3d& normal = Eigen::Vector3d::Zero());
  /// A hit nearer than the snap distance to a vertex that is snapped already. weight: from the vertex on.
  void addAtSnapped(const PolyhedralMesh& mesh, VertexId vertex, VertexId other, int other_side,
                    double weight, const Eigen::Vector3d& normal);
  bool isOfEarlierPass(CellId cell, int last_time) const;
  /// Whether the blade has left all cells around a vertex of the slit and what was to open there is open.
  bool isReleased(VertexId vertex) const { return open_vertices_.count(vertex) == 0; }
  void recordDistance(VertexId vertex, double distance);

  /// Whether a crossing counts for no cell around its edge.
  bool isSettled(const PolyhedralMesh& mesh, Edge edge, const CrossedEdge& crossed) const;

  /// In place of the time at which a corner became one, where the part still counts it.
  static constexpr int kNotYetSettled = -1;
  struct Part {
    int side = 0;                                       ///< 0: to be told by its vertices
    boost::container::flat_map<VertexId, int> settled;  ///< corners of its caps, and when they became that
    /// Has the corners settle that have not yet. Returns whether there were any.
    bool settle(int time);
  };
  struct Earlier {
    int until = 0;  ///< when the blade had last left the cell
    bool is_counted = false;
  };

  std::unordered_map<Edge, CrossedEdge, EdgeHash> edges_;
  std::unordered_map<VertexId, SnappedVertex> snaps_;
  std::unordered_map<VertexId, int> near_;          // see sideIfNear()
  std::unordered_map<VertexId, double> distances_;  // see leastDistance()
  std::unordered_map<CellId, Part> parts_;
  /// In place of the time at which the blade had left a cell, where it has not.
  static constexpr int kUnderWay = -1;
  std::unordered_map<CellId, int> passes_;  ///< through cells, and when these were taken once it had left
  std::unordered_map<CellId, Earlier> earlier_;  ///< passes, of cells to which the blade has come back
  std::set<VertexId> open_vertices_;
  std::set<CellId> cells_;  ///< to be looked at
  int time_ = 0;
};

}  // namespace polyscalpel
