// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/split_cells.hpp"

#include <algorithm>
#include <optional>
#include <set>

#include <boost/container/small_vector.hpp>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/cutting/border_sides.hpp"
#include "polyscalpel/cutting/cell_components.hpp"
#include "polyscalpel/cutting/cell_split.hpp"
#include "polyscalpel/cutting/cut_distance.hpp"
#include "polyscalpel/cutting/dividing_planes.hpp"
#include "polyscalpel/cutting/vertices_in_line.hpp"
#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

constexpr std::size_t kMostAbsorbed = 4;  ///< vertices of a thin component that may join the cut
/// How far they may be from it, in snap distances: what lies further off joins the cut only where no division
/// helps that has nearer ones join alone.
constexpr double kAbsorbDistances[] = {0.5, 1, 2};

/// How often a cell that cannot be split soundly is divided first.
constexpr int kMostDivisions = 3;
/// Snap tolerance of the dividing plane, as part of that of the cut: such cells are small already.
constexpr double kDivisionSnap = 0.1;

/// Area of a face [m^2] in the rest shape.
double area(const PolyhedralMesh& mesh, FaceId id) {
  double sum = 0;
  visitTriangles(mesh.face(id), mesh.restPositions(), [&](const Eigen::Matrix3d& corners) {
    sum +=
        0.5 * Eigen::Vector3d(corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).norm();
    return true;
  });
  return sum;
}

/// Splits cells and collects what has to be opened.
class Splitter {
 public:
  Splitter(MeshEditor& editor, Crossings& crossings, double snap_tolerance, int cut, Slit slit)
      : editor_(editor), crossings_(crossings), snap_tolerance_(snap_tolerance), cut_(cut), slit_(slit) {}

  /// Splits a cell and its parts until nothing in them is disconnected.
  void splitRepeatedly(CellId start) {
    std::vector<CellId> pending{start};
    while (!pending.empty()) {
      const CellId cell = pending.back();
      pending.pop_back();
      Outcome outcome = splitAsCrossed(cell, pending);
      if (outcome != Outcome::kSplit && crossings_.isPassedAgain(cell)) {
        crossings_.countEarlierPasses(cell, true);
        outcome = std::max(outcome, splitAsCrossed(cell, pending));
        if (outcome != Outcome::kSplit) crossings_.countEarlierPasses(cell, false);
      }
      if (outcome == Outcome::kLeftWhole) counts.left_whole.push_back(cell);
    }
  }

  /// Opens faces that lie in the slit between cells on its two sides, then separates the vertices.
  void openSlit(const std::function<bool(CellId)>& is_ready) {
    reopenAtFaceParts();
    const std::vector<VertexId> vertices(crossings_.openVertices().begin(), crossings_.openVertices().end());
    std::set<FaceId> faces;
    for (const VertexId vertex : vertices) {
      bool is_done = true;
      for (const FaceId id : mesh().facesAround(vertex)) {
        const Face& face = mesh().face(id);
        if (face.isBoundary()) continue;
        if (!is_ready(face.cells[0]) || !is_ready(face.cells[1])) {
          is_done = false;
        } else if (crossings_.isInSlit(mesh(), face)) {
          faces.insert(id);
        }
      }
      if (is_done) crossings_.release(vertex);
    }
    for (const FaceId id : faces) {
      const Face& face = mesh().face(id);
      const int sides =
          crossings_.sideOf(mesh(), face.cells[0], id) * crossings_.sideOf(mesh(), face.cells[1], id);
      if (sides < 0) caps_.insert(id);
    }
    std::set<VertexId> opened;
    std::vector<FaceId> walls;
    for (const FaceId id : caps_) {
      counts.cap_area_m2 += area(mesh(), id);
      opened.insert(mesh().face(id).loop.begin(), mesh().face(id).loop.end());
      const auto [front, back] = editor_.openFace(id, cut_);
      walls.push_back(front);
      walls.push_back(back);
    }
    for (const VertexId vertex : opened) editor_.separateVertex(vertex);
    openEdges(walls);
  }

  /// Gives the sides of a slit vertices of their own where the cut crosses an edge that is shut between them.
  /// Not before all cells around such an edge are split: they all have it under the same name.
  void separateShutEdges() {
    for (const VertexId vertex : shared_middles_) editor_.separateVertex(vertex);
  }

  SplitCounts counts;

 private:
  const PolyhedralMesh& mesh() const { return editor_.mesh(); }

  enum class Outcome { kConnected, kLeftWhole, kSplit };

  /// Splits a cell in two by what counts as crossed of it.
  Outcome splitAsCrossed(CellId cell, std::vector<CellId>& parts) {
    auto components = findComponents(mesh(), crossings_, cell);
    while (absorbInLine(cell, components) || absorbNear(cell, components))
      components = findComponents(mesh(), crossings_, cell);
    if (lieOnOneSide(mesh(), crossings_, cell, components)) return Outcome::kConnected;
    if (splitOff(cell, components, parts)) return Outcome::kSplit;
    dropEmpty(cell, components);
    for (const double reach : kAbsorbDistances) {
      if (reach > furthest_absorbed_) break;
      while (components.size() > 1 &&
             (absorbBetween(cell) || absorbHanging(cell, components) || absorbFlat(cell, components, reach) ||
              absorbThin(cell, components, reach))) {
        components = findComponents(mesh(), crossings_, cell);
        if (splitOff(cell, components, parts)) return Outcome::kSplit;
        dropEmpty(cell, components);
      }
      if (components.size() < 2) {
        crossings_.settle(cell);
        return Outcome::kConnected;
      }
      if (divideAcross(cell, components, reach)) return Outcome::kSplit;
    }
    return Outcome::kLeftWhole;
  }

  bool splitOff(CellId cell, const std::vector<std::vector<VertexId>>& components,
                std::vector<CellId>& parts) {
    if (components.size() < 2) return false;
    for (const auto& component : components) {
      const std::size_t savepoint = editor_.savepoint();
      CellSplit split(editor_, crossings_, cell, component);
      if (!split.findBorder() || !divide(split)) {
        editor_.rollBackTo(savepoint);
        continue;
      }
      for (const auto& [edge, middle] : split.splitEdges()) crossings_.recordSplitEdge(mesh(), edge, middle);
      crossings_.recordSplitCell(cell, split.first, split.second, split.capVertices(), split.firstSide(),
                                 components.size() == 2);
      followFaces(split.splitFaceParts());
      follow(split.sharedMiddles());
      caps_.insert(split.cap.begin(), split.cap.end());
      parts.push_back(split.first);
      parts.push_back(split.second);
      ++counts.cells_split;
      return true;
    }
    return false;
  }

  /// Makes the cap of a split whose border is found.
  bool divide(CellSplit& split) {
    if (!border_) return split.divide(cut_);
    BorderSides sides = *border_;
    sides.follow(editor_.changeSince(border_since_).new_vertices);
    return split.divide(cut_, &sides);
  }

  /// A chord may leave a part of a face in the slit between corners that an earlier pass of the blade has
  /// snapped, and around which all was open.
  void reopenAtFaceParts() {
    for (const auto& [face, parts] : face_parts_) {
      for (const FaceId part : {parts.first, parts.second}) {
        const Face& at = mesh().face(part);
        if (!at.isAlive() || at.isBoundary()) continue;
        if (!std::all_of(at.loop.begin(), at.loop.end(), [&](VertexId v) { return crossings_.isOnCut(v); }))
          continue;
        for (const VertexId v : at.loop) crossings_.reopen(v);
      }
    }
  }

  /// Where both ends of an edge within the slit lie on its front, the edge's two sides still share them, and
  /// would stay shut. One at which a cell would become too thin does, and is never divided (CellSplit).
  void openEdges(const std::vector<FaceId>& walls) {
    std::set<Edge> edges;
    for (const FaceId id : walls) {
      const auto& loop = mesh().face(id).loop;
      for (std::size_t i = 0; i < loop.size(); ++i)
        edges.insert(makeEdge(loop[i], loop[(i + 1) % loop.size()]));
    }
    for (const auto& [a, b] : edges) {
      const std::size_t savepoint = editor_.savepoint();
      if (!editor_.separateEdge(a, b)) continue;
      const MeshChange change = editor_.changeSince(savepoint);
      if (std::all_of(change.changed_cells.begin(), change.changed_cells.end(),
                      [&](CellId id) { return isSound(mesh(), id); })) {
        crossings_.recordOpenedEdge(mesh(), change.new_vertices);
      } else {
        editor_.rollBackTo(savepoint);
      }
    }
  }

  /// A second sheet of the same stroke may divide the cap that the first one has made.
  void followFaces(const FaceParts& parts) {
    for (const auto& [face, face_parts] : parts) {
      face_parts_.emplace_back(face, face_parts);
      if (caps_.erase(face)) caps_.insert({face_parts.first, face_parts.second});
    }
  }

  void follow(const std::vector<VertexId>& shared_middles) {
    shared_middles_.insert(shared_middles_.end(), shared_middles.begin(), shared_middles.end());
  }

  /// Where the cap of a cell would be bent so much that a part does not see all its surface from any one
  /// point: divides the cell by a closed plane across the cap, whose parts are then split by flatter caps.
  /// Tries one plane after the other until nothing is left whole. reach: how far off the cut what joins it
  /// may be in the parts, in snap distances. Returns whether it did.
  bool divideAcross(CellId cell, const std::vector<std::vector<VertexId>>& components, double reach) {
    const auto place = divisions_.find(cell);
    const int depth = place == divisions_.end() ? 0 : place->second;
    if (depth >= most_divisions_) return false;
    if (depth > 0) {
      // Part of such a trial: the first plane that divides it will do.
      for (const auto& component : components) {
        for (const DividingPlane& plane : kFurtherDividingPlanes) {
          if (divideBy(plane, cell, components, component, depth)) return true;
        }
      }
      return false;
    }
    const Progress before{crossings_, counts, caps_, face_parts_, shared_middles_, divisions_};
    const std::size_t savepoint = editor_.savepoint();
    for (const DividingPlane& plane : dividingPlanes()) {
      for (const auto& component : components) {
        furthest_absorbed_ = reach;
        const bool is_divided = divideBy(plane, cell, components, component, depth);
        furthest_absorbed_ = kInfinity;
        if (!is_divided) continue;
        if (counts.left_whole.size() == before.counts.left_whole.size()) return true;
        editor_.rollBackTo(savepoint);
        crossings_ = before.crossings;
        counts = before.counts;
        caps_ = before.caps;
        face_parts_ = before.face_parts;
        shared_middles_ = before.shared_middles;
        divisions_ = before.divisions;
      }
    }
    return false;
  }

  /// Divides a cell across the border of one of its components and splits the parts. Returns whether it did.
  bool divideBy(const DividingPlane& dividing, CellId cell,
                const std::vector<std::vector<VertexId>>& components, const std::vector<VertexId>& component,
                int depth) {
    const std::size_t savepoint = editor_.savepoint();
    CellSplit split(editor_, crossings_, cell, component);
    if (!split.findBorder() || !split.leavesNeighboursSound() || hasDoubledEdge(cell)) {
      editor_.rollBackTo(savepoint);
      return false;
    }
    const std::size_t divided = editor_.savepoint();
    Crossings plane;
    const double tolerance = kDivisionSnap * snap_tolerance_;
    for (const Hit& hit : hitsAcross(mesh(), cell, split.capLoop(), dividing))
      plane.add(mesh(), hit, tolerance);
    Splitter across(editor_, plane, tolerance, 0, Slit::kClosed);
    across.most_divisions_ = 0;
    // An edge within the dividing face that goes from one side of the border to the other is crossed by
    // nothing, and would join them for good.
    BorderSides sides(split.capLoop(), component, [&](VertexId v) { return crossings_.isSnapped(cell, v); });
    across.border_ = &sides;
    across.border_since_ = divided;
    across.splitRepeatedly(cell);
    const MeshChange change = editor_.changeSince(divided);
    if (change.new_cells.empty()) {
      editor_.rollBackTo(savepoint);
      return false;
    }
    for (const auto& [edge, middle] : split.splitEdges()) crossings_.recordSplitEdge(mesh(), edge, middle);
    sides.follow(change.new_vertices);
    for (const NewVertex& vertex : change.new_vertices)
      crossings_.recordDividedEdge(mesh(), vertex, sides.at(vertex.vertex) == 0);
    for (const NewVertex& vertex : change.new_vertices) crossings_.snapNear(mesh(), vertex.vertex, tolerance);
    for (const NewVertex& vertex : change.new_vertices) {
      if (sides.at(vertex.vertex) != 0)
        crossings_.recordSide(mesh(), vertex.vertex, sides.at(vertex.vertex) * split.firstSide());
    }
    crossings_.recordDividedCells(change);
    followFaces(split.splitFaceParts());
    followFaces(across.face_parts_);
    follow(split.sharedMiddles());
    follow(across.shared_middles_);
    for (const NewCell& part : change.new_cells) {
      divisions_[part.cell] = depth + 1;
      if (joins(part.cell, sides, components)) counts.left_whole.push_back(part.cell);
    }
    for (const NewCell& part : change.new_cells) splitRepeatedly(part.cell);
    return true;
  }

  /// Whether vertices of a cell on both sides of a border hang together, or of different ones of the
  /// components that the whole had: what the dividing face has of two that corners of the cut hold apart,
  /// nothing does.
  bool joins(CellId cell, const BorderSides& sides,
             const std::vector<std::vector<VertexId>>& components_of_whole) const {
    const auto& vertices = mesh().cell(cell).vertices;
    auto components = findComponents(mesh(), crossings_, cell);
    if (components.empty()) components.push_back({vertices.begin(), vertices.end()});
    return std::any_of(components.begin(), components.end(), [&](const auto& component) {
      const auto hasSide = [&](int side) {
        return std::any_of(component.begin(), component.end(),
                           [&](VertexId v) { return sides.at(v) == side; });
      };
      const auto meets = [&](const auto& of_whole) {
        return std::any_of(of_whole.begin(), of_whole.end(), [&](VertexId v) {
          return std::binary_search(component.begin(), component.end(), v);
        });
      };
      return (hasSide(-1) && hasSide(1)) ||
             std::count_if(components_of_whole.begin(), components_of_whole.end(), meets) > 1;
    });
  }

  /// Whether chords have cut flat faces off the two at an edge in which vertices hang: the chords then join
  /// the same two vertices.
  bool hasDoubledEdge(CellId cell) const {
    const auto edges = mesh().edges(cell);  // ascending
    return std::adjacent_find(edges.begin(), edges.end()) != edges.end();
  }

  /// Whether a component could join the cut: none of it lies on the cut already, for other cells.
  bool canJoin(const std::vector<VertexId>& component) const {
    return std::all_of(component.begin(), component.end(), [&](VertexId v) { return crossings_.canJoin(v); });
  }

  /// Forgets the components that no cut can part from the cell: a cap would fold up in the edge in which they
  /// hang, and enclose nothing.
  void dropEmpty(CellId cell, std::vector<std::vector<VertexId>>& components) const {
    if (components.size() < 2) return;
    components.erase(
        std::remove_if(components.begin(), components.end(),
                       [&](const auto& component) { return hangInOneEdge(mesh(), cell, component); }),
        components.end());
  }

  /// Lets a vertex join the cut that hangs in an edge between two corners of the cut, in line with them,
  /// before it is split off as a sliver: the edge lies in the slit. Returns whether there was one.
  bool absorbInLine(CellId cell, const std::vector<std::vector<VertexId>>& components) {
    for (const auto& component : components) {
      if (component.size() > 1) break;  // ascending sizes
      const VertexId v = component.front();
      if (!canJoin(component)) continue;
      boost::container::small_vector<VertexId, 8> around;
      mesh().forEachEdge(cell, [&](VertexId a, VertexId b) {
        if (a == v || b == v) around.push_back(a == v ? b : a);
      });
      if (around.size() != 2 || !crossings_.isSnapped(cell, around[0]) ||
          !crossings_.isSnapped(cell, around[1]) || !areInLine(mesh(), around[0], {v}, around[1]))
        continue;
      crossings_.snap(mesh(), v, sideBetween(around[0], {v}, around[1]), cell);
      return true;
    }
    return false;
  }

  /// Lets the first component join the cut that lies within the snap distance of the blade's surface with all
  /// its vertices. Returns whether there was one. A plane that only divides cells keeps to its place: where
  /// it goes is as far as the slit's front comes.
  bool absorbNear(CellId cell, const std::vector<std::vector<VertexId>>& components) {
    if (components.size() < 2 || slit_ == Slit::kClosed) return false;
    for (const auto& component : components) {
      if (!canJoin(component) || isKnownFar(mesh(), crossings_, cell, component, snap_tolerance_)) continue;
      std::vector<std::pair<VertexId, int>> sides;
      for (const VertexId v : component) {
        const std::optional<int> side = crossings_.sideIfNear(v);
        if (side) sides.emplace_back(v, *side);
      }
      if (sides.size() != component.size()) continue;
      for (const auto& [v, side] : sides) crossings_.snap(mesh(), v, side, cell);
      return true;
    }
    return false;
  }

  /// Lets vertices join the cut that lie on a face's side between two corners of the cut, in line with them:
  /// the side lies in the slit, as it would if they were not there, and a chord would cut nothing off the
  /// face. Returns whether there were any.
  bool absorbBetween(CellId cell) {
    for (const FaceId id : mesh().cell(cell).faces) {
      const auto parts =
          partsOffCut(mesh().face(id).loop, [&](VertexId v) { return crossings_.isSnapped(cell, v); });
      for (const auto& [from, between, to] : parts) {
        if (!canJoin(between) || !areInLine(mesh(), from, between, to)) continue;
        const int side = sideBetween(from, between, to);
        for (const VertexId v : between) crossings_.snap(mesh(), v, side, cell);
        return true;
      }
    }
    return false;
  }

  /// Side of the blade's surface on which vertices lie between two corners of the cut, as these have it; 0
  /// where they do not agree: then nothing tells, and neither end may speak for the vertices' own neighbours.
  int sideBetween(VertexId from, const std::vector<VertexId>& between, VertexId to) const {
    const int first = crossings_.sideOfNeighbour(from, between.front()),
              second = crossings_.sideOfNeighbour(to, between.back());
    if (first == 0 || first == second) return second;
    return second == 0 ? first : 0;
  }

  /// Lets the first component join the cut that consists of vertices hanging in an edge between two corners
  /// of the cut: they lie on it, though no edge of theirs crosses it. Returns whether there was one.
  bool absorbHanging(CellId cell, const std::vector<std::vector<VertexId>>& components) {
    for (const auto& component : components) {
      if (!canJoin(component)) continue;
      std::vector<std::pair<VertexId, int>> sides;
      for (const VertexId v : component) {
        int degree = 0, side = 0;
        bool is_held = true;
        for (const auto& [a, b] : mesh().edges(cell)) {
          if (a != v && b != v) continue;
          ++degree;
          const VertexId other = a == v ? b : a;
          if (std::binary_search(component.begin(), component.end(), other)) continue;
          is_held &= crossings_.isSnapped(cell, other);
          if (side == 0) side = crossings_.sideOfNeighbour(other, v);
        }
        if (!is_held || degree != 2) break;
        sides.emplace_back(v, side);
      }
      if (sides.size() != component.size()) continue;
      for (const auto& [v, side] : sides) crossings_.snap(mesh(), v, side, cell);
      return true;
    }
    return false;
  }

  /// Lets the first component join the cut that lies flat on it: all its vertices within the absorbing
  /// distance of the mean plane of its border. Returns whether there was one.
  bool absorbFlat(CellId cell, const std::vector<std::vector<VertexId>>& components, double reach) {
    for (const auto& component : components) {
      if (!canJoin(component) || isKnownFar(mesh(), crossings_, cell, component, reach * snap_tolerance_))
        continue;
      const std::size_t savepoint = editor_.savepoint();
      CellSplit split(editor_, crossings_, cell, component);
      const bool has_border = split.findBorder();
      const int side = split.firstSide();
      Eigen::Matrix3Xd border(3, split.capLoop().size());
      for (Eigen::Index i = 0; i < border.cols(); ++i)
        border.col(i) = mesh().restPosition(split.capLoop()[i]);
      editor_.rollBackTo(savepoint);
      if (!has_border) continue;
      const Eigen::Vector3d middle = border.rowwise().mean();
      border.colwise() -= middle;
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(border * border.transpose());
      const Eigen::Vector3d normal = axes.eigenvectors().col(0);
      const bool is_flat = std::all_of(component.begin(), component.end(), [&](VertexId v) {
        return std::abs(normal.dot(mesh().restPosition(v) - middle)) <
               reach * snap_tolerance_ * mesh().localSize(v);
      });
      if (!is_flat) continue;
      for (const VertexId v : component) crossings_.snap(mesh(), v, side, cell);
      return true;
    }
    return false;
  }

  /// Lets the first thin component join the cut. Returns whether there was one.
  bool absorbThin(CellId cell, const std::vector<std::vector<VertexId>>& components, double reach) {
    for (const auto& component : components) {
      if (component.size() > kMostAbsorbed) continue;
      if (!canJoin(component) || isKnownFar(mesh(), crossings_, cell, component, reach * snap_tolerance_))
        continue;
      std::vector<std::pair<VertexId, int>> sides;
      for (const VertexId v : component) {
        const std::optional<int> side = sideIfNear(mesh(), crossings_, cell, v, reach * snap_tolerance_);
        if (side) sides.emplace_back(v, *side);
      }
      if (sides.size() != component.size()) continue;
      for (const auto& [v, side] : sides) crossings_.snap(mesh(), v, side, cell);
      return true;
    }
    return false;
  }

  /// What is to be taken back with a trial that has led nowhere.
  struct Progress {
    Crossings crossings;
    SplitCounts counts;
    std::set<FaceId> caps;
    FaceParts face_parts;
    std::vector<VertexId> shared_middles;
    std::unordered_map<CellId, int> divisions;
  };

  MeshEditor& editor_;
  Crossings& crossings_;
  double snap_tolerance_;
  int cut_;
  Slit slit_;
  std::set<FaceId> caps_;                 // closed as yet
  FaceParts face_parts_;                  // of all faces divided so far
  std::vector<VertexId> shared_middles_;  // see CellSplit
  std::unordered_map<CellId, int> divisions_;
  int most_divisions_ = kMostDivisions;
  double furthest_absorbed_ = kInfinity;  // of kAbsorbDistances, within a trial
  const BorderSides* border_ = nullptr;   // where set: no edge of a cap may join its two sides
  std::size_t border_since_ = 0;          // savepoint up to which it tells
};

}  // namespace

SplitCounts splitCells(MeshEditor& editor, Crossings& crossings, const std::function<bool(CellId)>& is_ready,
                       double snap_tolerance, int cut, Slit slit) {
  Splitter splitter(editor, crossings, snap_tolerance, cut, slit);
  // A split puts vertices on its neighbours' edges, and a corner that joins the cut concerns all cells around
  // it.
  for (auto cells = crossings.takeCells(editor.mesh(), is_ready); !cells.empty();
       cells = crossings.takeCells(editor.mesh(), is_ready)) {
    for (const CellId cell : cells) {
      if (editor.mesh().cell(cell).isAlive()) splitter.splitRepeatedly(cell);
    }
  }
  splitter.separateShutEdges();
  if (slit == Slit::kOpen) splitter.openSlit(is_ready);
  return splitter.counts;
}

}  // namespace polyscalpel
