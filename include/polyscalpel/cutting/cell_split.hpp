// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include <boost/container/flat_set.hpp>
#include <boost/container/small_vector.hpp>

#include <Eigen/Core>

#include "polyscalpel/cutting/border_sides.hpp"
#include "polyscalpel/cutting/cap_facets.hpp"
#include "polyscalpel/cutting/crossings.hpp"
#include "polyscalpel/mesh/mesh_editing.hpp"

namespace polyscalpel {

/// Faces that gave way to two parts each, in the order of dividing.
using FaceParts = std::vector<std::pair<FaceId, std::pair<FaceId, FaceId>>>;

/// Divides one cell along the border of one component of its vertices, which hang together through edges
/// that nothing crosses: the component's part of the cell gets the faces it reaches, cut off by chords, and
/// the border over these faces is the loop of the cap.
class CellSplit {
 public:
  /// component: ascending.
  CellSplit(MeshEditor& editor, const Crossings& crossings, CellId cell,
            const std::vector<VertexId>& component);

  /// Divides the edges and faces that the border crosses. The mesh is to be rolled back by the caller where
  /// this or divide() fails: the border is not one loop, or a part would be thinner than
  /// isSound() allows.
  bool findBorder();

  /// Whether the border has left the neighbours of the cell sound, which it has given vertices and chords. To
  /// be asked where the cell is divided otherwise: divide() does so itself.
  bool leavesNeighboursSound() const;

  /// Divides the cell along the border found, and checks what has been touched. sides: of another border,
  /// which no edge of the cap may cross; nullptr: of none.
  bool divide(int cut, const BorderSides* sides = nullptr);

  CellId first, second;
  std::vector<FaceId> cap;
  /// Side of the blade's surface on which the first part lies.
  int firstSide() const { return side_votes_ >= 0 ? 1 : -1; }
  /// The border, counter-clockwise seen from outside the first part.
  const std::vector<VertexId>& capLoop() const { return cap_loop_; }
  /// Vertices of the cap and of the faces that lie in its place.
  const std::vector<VertexId>& capVertices() const { return cap_vertices_; }
  const std::vector<std::pair<Edge, VertexId>>& splitEdges() const { return split_edges_; }
  const FaceParts& splitFaceParts() const { return split_faces_; }
  /// Of the vertices made, those on edges that were shut between two walls of a slit: both sides share them
  /// until MeshEditor::separateVertex() has given each its own.
  const std::vector<VertexId>& sharedMiddles() const { return shared_middles_; }

 private:
  const PolyhedralMesh& mesh() const { return editor_.mesh(); }
  bool isInComponent(VertexId v) const { return component_.count(v) > 0; }
  bool isOnCut(VertexId v) const;
  bool splitCrossedEdges();
  bool splitFaces();
  bool hasFlap(const FaceLoop& loop, std::size_t start, std::size_t end) const;
  bool findCap();
  /// From where the two parts are to see the cap.
  enum class Apexes { kVertexMeans, kStarCentres };
  std::vector<std::vector<VertexId>> makeFacets(Apexes apexes, const std::vector<int>& sides_of_loop) const;
  Eigen::Vector3d vertexMeanOfPart(bool is_first) const;
  Eigen::Vector3d starCentreOfPart(bool is_first) const;
  bool joinsSides(const BorderSides& sides) const;

  MeshEditor& editor_;
  const Crossings& crossings_;
  CellId cell_;
  // Ordered, and without an allocation for each of their few members.
  boost::container::small_flat_set<VertexId, 16> component_;
  boost::container::small_flat_set<VertexId, 16> snapped_;  // vertices that the cell had
  boost::container::small_flat_set<VertexId, 16> middles_;
  boost::container::small_flat_set<CellId, 32> touched_;
  std::vector<std::pair<Edge, VertexId>> split_edges_;
  std::vector<VertexId> shared_middles_;
  FaceParts split_faces_;
  std::vector<FaceId> first_faces_;
  std::vector<VertexId> cap_loop_, cap_vertices_;
  int side_votes_ = 0;
};

/// Whether every sub-tet of the cell is above smallestSubTetAllowed().
bool isSound(const PolyhedralMesh& mesh, CellId cell);

}  // namespace polyscalpel
