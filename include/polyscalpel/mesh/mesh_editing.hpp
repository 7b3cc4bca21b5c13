// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "polyscalpel/mesh/block_list.hpp"
#include "polyscalpel/mesh/mesh_change.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"

namespace polyscalpel {

/// One transaction on a mesh: elementary edits, each of which keeps it conforming, written to a journal. What
/// is not committed is undone when the editor goes, so a cut is made whole or not at all.
class MeshEditor {
 public:
  /// The mesh must outlive the editor; one editor a mesh at a time.
  explicit MeshEditor(PolyhedralMesh& mesh);
  ~MeshEditor();
  MeshEditor(const MeshEditor&) = delete;
  MeshEditor& operator=(const MeshEditor&) = delete;

  const PolyhedralMesh& mesh() const { return mesh_; }

  /// A place in the journal to which edits can be undone.
  std::size_t savepoint() const { return journal_.size(); }
  void rollBackTo(std::size_t savepoint);

  /// Puts a vertex at (1 - weight) a + weight b on the edge a-b of every face that has it, weight in (0, 1).
  VertexId splitEdge(VertexId a, VertexId b, double weight);

  /// Divides a face by the chord from a to b, two vertices of its loop that are not adjacent there. Both
  /// cells get both parts. Returns the part with the loop a ... b first.
  std::pair<FaceId, FaceId> splitFace(FaceId face, VertexId a, VertexId b);

  /// Divides a cell by new faces, the cap, shared by both parts. first_faces: the faces of the first part;
  /// cap_facets: loops of the cap's faces, counter-clockwise seen from outside the first part, which together
  /// close both parts. Returns first part, second part, the cap's faces.
  struct SplitCell {
    CellId first, second;
    std::vector<FaceId> cap;
  };
  SplitCell splitCell(CellId cell, const std::vector<FaceId>& first_faces,
                      const std::vector<std::vector<VertexId>>& cap_facets, int cut);

  /// Replaces a face between two cells by two boundary faces in the same place, marked with the cut's number.
  /// Returns that of the face's first cell first.
  std::pair<FaceId, FaceId> openFace(FaceId face, int cut);

  /// Where the cells around a vertex are no longer joined through closed faces, gives each part but the one
  /// with the smallest cell id a copy of the vertex.
  void separateVertex(VertexId vertex);

  /// Where the cells around an edge are no longer joined through closed faces at it, but both its ends still
  /// belong to all of them, gives the edge a middle vertex, and each part but one a copy of that. Returns
  /// whether it did.
  bool separateEdge(VertexId a, VertexId b);

  /// Takes whole pieces out of the mesh: every cell that shares a face with one of these is among them. Their
  /// faces go with them, and the vertices that nothing uses then retire.
  void removeCells(const std::vector<CellId>& cells);

  /// What the edits after a savepoint did, as seen from there.
  MeshChange changeSince(std::size_t savepoint) const;

  /// Ends the transaction and keeps its edits. The editor may not be used afterwards.
  MeshChange commit();

 private:
  /// One entry of the journal. What an edit has replaced is kept as plain numbers in one array, and no more
  /// of it than the edit has replaced: a cut touches each list of a cell or a vertex many times.
  struct Undo {
    enum class Kind {
      kOldFace,
      kOldFaceCells,
      kOldCell,
      kOldVertexFaces,
      kFaceOfVertexAdded,
      kFaceOfVertexErased,
      kFaceOfCellAdded,
      kFaceOfCellErased,
      kVertexOfCellAdded,
      kNewFace,
      kNewCell,
      kNewVertex,
      kRetiredVertex
    };
    Kind kind;
    int id = 0;
    std::size_t saved = 0;  ///< where its numbers start in saved_
  };

  void note(Undo::Kind kind, int id) { journal_.push_back({kind, id, saved_.size()}); }
  template <class Values>
  void save(const Values& values);
  template <class Values>
  const int* restore(const int* saved, Values& values);
  Face& touchFace(FaceId id);
  Cell& touchCell(CellId id);
  std::vector<FaceId>& touchVertexFaces(VertexId id);
  void addFaceTo(VertexId vertex, FaceId face);
  void eraseFaceFrom(VertexId vertex, FaceId face);
  void addFaceTo(CellId cell, FaceId face);
  void eraseFaceFrom(CellId cell, FaceId face);
  void addVertexTo(CellId cell, VertexId vertex);
  void replaceCell(FaceId face, CellId former, CellId cell);
  FaceId addFace(Face face);
  CellId addCell(CellId former, std::vector<FaceId> faces);
  VertexId addVertex(const NewVertex& origin);
  void removeFace(FaceId id);
  void refreshVertices(CellId id);

  PolyhedralMesh& mesh_;
  BlockList<Undo> journal_;
  std::vector<int> saved_;
  std::vector<NewVertex> new_vertices_;
  std::vector<CellId> parents_;  ///< of the cells from first_new_cell_ on, the cell that was split
  int first_new_cell_ = 0;
  mutable std::vector<char> cell_marks_, face_marks_;  ///< of changeSince(), 0 between its calls
  /// What changeSince(0) has last returned, for commit(), which most often comes next.
  mutable std::optional<MeshChange> whole_change_;
  mutable std::size_t edits_in_whole_change_ = 0;
};

/// Index of a vertex in a face's loop, -1 where it is not in it.
inline int findInLoop(const Face& face, VertexId vertex) {
  const auto place = std::find(face.loop.begin(), face.loop.end(), vertex);
  return place == face.loop.end() ? -1 : static_cast<int>(place - face.loop.begin());
}

/// Whether the face has the edge a-b.
inline bool hasEdge(const Face& face, VertexId a, VertexId b) {
  const std::size_t n = face.loop.size();
  const std::size_t i = std::find(face.loop.begin(), face.loop.end(), a) - face.loop.begin();
  if (i == n) return false;
  return face.loop[i + 1 < n ? i + 1 : 0] == b || face.loop[i > 0 ? i - 1 : n - 1] == b;
}

/// Cells that have the edge a-b, ascending; empty where there is no such edge.
std::vector<CellId> cellsAroundEdge(const PolyhedralMesh& mesh, VertexId a, VertexId b);

/// How many groups the cells that have the edge a-b fall into, each joined through closed faces at the edge:
/// 1 in a sound mesh, 0 where there is no such edge.
int numFansAroundEdge(const PolyhedralMesh& mesh, VertexId a, VertexId b);

/// Cells that have the vertex, ascending.
std::vector<CellId> cellsAround(const PolyhedralMesh& mesh, VertexId vertex);

}  // namespace polyscalpel
