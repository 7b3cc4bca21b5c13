// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/split_cells.hpp"

#include <algorithm>
#include <optional>
#include <set>

#include <boost/container/flat_map.hpp>
#include <boost/container/flat_set.hpp>
#include <boost/container/small_vector.hpp>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/cutting/cap_facets.hpp"
#include "polyscalpel/geometry/predicates.hpp"
#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

constexpr std::size_t kMostAbsorbed = 4;  ///< vertices of a thin component that may join the cut
constexpr double kAbsorbDistance = 2;     ///< how far they may be from it, in snap distances

/// A face's vertices in the cut are taken to be in line within this times localSize.
constexpr double kSmallestFlap = 1e-3;

/// Crossed edges and snapped corners may not leave a part of an edge shorter than this times its length:
/// rounding.
constexpr double kSmallestEdgePart = 1e-9;

/// How often a cell that cannot be split soundly is divided first.
constexpr int kMostDivisions = 3;
/// Snap tolerance of the dividing plane, as part of that of the cut: such cells are small already.
constexpr double kDivisionSnap = 0.1;

using FaceParts = std::vector<std::pair<FaceId, std::pair<FaceId, FaceId>>>;

/// The vertices of a cell that hang together through uncrossed edges; snapped vertices belong to none. Empty
/// where there is but one such component, which is most often so.
std::vector<std::vector<VertexId>> findComponents(const PolyhedralMesh& mesh, const Crossings& crossings,
                                                  CellId cell) {
  constexpr int kNone = -1;
  const auto& vertices = mesh.cell(cell).vertices;
  const auto localOf = [&](VertexId v) {
    return static_cast<int>(std::lower_bound(vertices.begin(), vertices.end(), v) - vertices.begin());
  };
  // Disjoint sets of local vertices, each named by its smallest member.
  boost::container::small_vector<int, 32> roots(vertices.size());
  const auto find = [&](int i) {
    while (roots[i] != i) i = roots[i] = roots[roots[i]];
    return i;
  };
  int num_components = 0;
  for (int i = 0; i < static_cast<int>(vertices.size()); ++i) {
    const bool is_on_cut = crossings.isSnapped(cell, vertices[i]);
    roots[i] = is_on_cut ? kNone : i;
    num_components += !is_on_cut;
  }
  mesh.forEachEdge(cell, [&](VertexId from, VertexId to) {
    int a = localOf(from), b = localOf(to);
    if (roots[a] == kNone || roots[b] == kNone || crossings.find(cell, {from, to})) return;
    a = find(a);
    b = find(b);
    if (a == b) return;
    roots[std::max(a, b)] = std::min(a, b);
    --num_components;
  });
  std::vector<std::vector<VertexId>> components;
  if (num_components < 2) return components;
  boost::container::small_vector<int, 32> component_of(vertices.size(), kNone);  // by root
  for (int i = 0; i < static_cast<int>(vertices.size()); ++i) {
    if (roots[i] == kNone) continue;
    int& component = component_of[find(i)];
    if (component == kNone) {
      component = static_cast<int>(components.size());
      components.emplace_back();
    }
    components[component].push_back(vertices[i]);
  }
  std::stable_sort(components.begin(), components.end(),
                   [](const auto& a, const auto& b) { return a.size() < b.size(); });
  return components;
}

/// Divides one cell along the border of one component.
class CellSplit {
 public:
  CellSplit(MeshEditor& editor, const Crossings& crossings, CellId cell,
            const std::vector<VertexId>& component)
      : editor_(editor), crossings_(crossings), cell_(cell), component_(component.begin(), component.end()) {}

  /// Divides the edges and faces that the border crosses. The mesh is to be rolled back by the caller where
  /// this or divide() fails.
  bool findBorder() {
    splitCrossedEdges();
    return splitFaces() && findCap();
  }

  /// Divides the cell along the border found, and checks what has been touched.
  bool divide(int cut) {
    const auto facets = makeCapFacets(mesh(), cap_loop_, vertexMeanOfPart(true), vertexMeanOfPart(false));
    const auto split = editor_.splitCell(cell_, first_faces_, facets, cut);
    first = split.first;
    second = split.second;
    cap = split.cap;
    touched_.insert(first);
    touched_.insert(second);
    touched_.erase(cell_);
    return std::all_of(touched_.begin(), touched_.end(), [&](CellId id) { return isSound(id); });
  }

  CellId first, second;
  std::vector<FaceId> cap;
  /// Side of the blade's surface on which the first part lies.
  int firstSide() const { return side_votes_ >= 0 ? 1 : -1; }
  /// The border, counter-clockwise seen from outside the first part.
  const std::vector<VertexId>& capLoop() const { return cap_loop_; }
  /// Vertices of the cap and of the faces that lie in its place.
  const std::vector<VertexId>& capVertices() const { return cap_vertices_; }
  const std::vector<std::pair<Edge, VertexId>>& splitEdges() const { return split_edges_; }
  /// Faces that gave way to two parts each, in the order of dividing.
  const FaceParts& splitFaceParts() const { return split_faces_; }

 private:
  const PolyhedralMesh& mesh() const { return editor_.mesh(); }
  bool isInComponent(VertexId v) const { return component_.count(v) > 0; }
  bool isOnCut(VertexId v) const {
    return middles_.count(v) || (!isInComponent(v) && crossings_.isSnapped(cell_, v));
  }

  void splitCrossedEdges() {
    for (const Edge& edge : mesh().edges(cell_)) {
      const bool first_in = isInComponent(edge.first), second_in = isInComponent(edge.second);
      if (first_in == second_in || isOnCut(first_in ? edge.second : edge.first)) continue;
      const Crossings::CrossedEdge* crossed = crossings_.find(cell_, edge);
      POLYSCALPEL_ASSERT(crossed);
      side_votes_ += first_in ? -crossed->sign : crossed->sign;
      for (const CellId around : cellsAroundEdge(mesh(), edge.first, edge.second)) touched_.insert(around);
      const double weight = std::clamp(crossed->weight, kSmallestEdgePart, 1 - kSmallestEdgePart);
      const VertexId middle = editor_.splitEdge(edge.first, edge.second, weight);
      middles_.insert(middle);
      split_edges_.emplace_back(edge, middle);
    }
  }

  /// Cuts the component's vertices off every face that also reaches beyond the cut.
  bool splitFaces() {
    std::vector<FaceId> pending = mesh().cell(cell_).faces;
    while (!pending.empty()) {
      const FaceId id = pending.back();
      pending.pop_back();
      const auto& loop = mesh().face(id).loop;
      const std::size_t n = loop.size();
      bool reaches_beyond = false;
      std::size_t start = n;  // an entry on the cut that is followed by one of the component
      for (std::size_t i = 0; i < n; ++i) {
        reaches_beyond |= !isInComponent(loop[i]) && !isOnCut(loop[i]);
        if (isOnCut(loop[i]) && isInComponent(loop[(i + 1) % n])) start = i;
      }
      if (start == n) continue;
      std::size_t end = start + 1;
      while (isInComponent(loop[end % n])) ++end;
      if (!reaches_beyond && !hasFlap(loop, start, end)) continue;
      if (!isOnCut(loop[end % n]) || end % n == start) return false;
      if (!reaches_beyond) {
        for (std::size_t i = end + 1; i % n != start; ++i) cap_vertices_.push_back(loop[i % n]);
      }
      for (const CellId around : mesh().face(id).cells) {
        if (around.isValid()) touched_.insert(around);
      }
      const auto parts = editor_.splitFace(id, loop[start], loop[end % n]);
      split_faces_.emplace_back(id, parts);
      pending.push_back(parts.second);
    }
    return true;
  }

  /// Whether a face that has no vertex beyond the cut still reaches beyond the chord from its entry `end` to
  /// its entry `start`: all further vertices are snapped, and not in line. The part beyond the chord then
  /// lies in the cut, and belongs to the other part of the cell; kept in this part, it would lie on the cap.
  bool hasFlap(const std::vector<VertexId>& loop, std::size_t start, std::size_t end) const {
    const std::size_t n = loop.size();
    if (!isOnCut(loop[end % n]) || end % n == start) return false;
    const Eigen::Vector3d from = mesh().restPosition(loop[end % n]), to = mesh().restPosition(loop[start]);
    const Eigen::Vector3d along = (to - from).normalized();
    for (std::size_t i = end + 1; i % n != start; ++i) {
      const double off = along.cross(mesh().restPosition(loop[i % n]) - from).norm();
      if (off > kSmallestFlap * mesh().localSize(loop[i % n])) return true;
    }
    return false;
  }

  /// Chains the half-edges between the component's faces and the rest into the one loop that the cap must be.
  bool findCap() {
    boost::container::small_flat_map<Edge, int, 32> count;  // of the component's faces at an edge
    for (const FaceId id : mesh().cell(cell_).faces) {
      const auto& loop = mesh().face(id).loop;
      if (std::none_of(loop.begin(), loop.end(), [&](VertexId v) { return isInComponent(v); })) continue;
      first_faces_.push_back(id);
      for (std::size_t i = 0; i < loop.size(); ++i) ++count[makeEdge(loop[i], loop[(i + 1) % loop.size()])];
    }
    if (first_faces_.empty() || first_faces_.size() == mesh().cell(cell_).faces.size()) return false;

    boost::container::small_flat_map<VertexId, VertexId, 16>
        next;  // against the faces' own direction: counter-clockwise for the cap
    for (const FaceId id : first_faces_) {
      const Face& face = mesh().face(id);
      const bool is_outward = face.cells[0] == cell_;
      for (std::size_t i = 0; i < face.loop.size(); ++i) {
        VertexId from = face.loop[i], to = face.loop[(i + 1) % face.loop.size()];
        if (count[makeEdge(from, to)] != 1) continue;
        if (!is_outward) std::swap(from, to);
        if (!isOnCut(from) || !isOnCut(to) || !next.emplace(to, from).second) return false;
      }
    }
    if (next.size() < 3) return false;
    VertexId at = next.begin()->first;
    do {
      cap_loop_.push_back(at);
      const auto step = next.find(at);
      if (step == next.end()) return false;
      at = step->second;
    } while (at != cap_loop_.front() && cap_loop_.size() <= next.size());
    if (cap_loop_.size() != next.size()) return false;
    cap_vertices_.insert(cap_vertices_.end(), cap_loop_.begin(), cap_loop_.end());

    if (side_votes_ == 0) {
      // No edge was crossed between its ends: the cap goes through snapped vertices alone.
      for (const auto& [a, b] : mesh().edges(cell_)) {
        if (next.count(a) && isInComponent(b)) side_votes_ += crossings_.sideOfNeighbour(a, b);
        if (next.count(b) && isInComponent(a)) side_votes_ += crossings_.sideOfNeighbour(b, a);
      }
    }
    return true;
  }

  /// Mean of the vertices that one part will have.
  Eigen::Vector3d vertexMeanOfPart(bool is_first) const {
    std::set<VertexId> vertices;
    for (const FaceId id : mesh().cell(cell_).faces) {
      const bool is_in_first = std::find(first_faces_.begin(), first_faces_.end(), id) != first_faces_.end();
      if (is_in_first != is_first) continue;
      vertices.insert(mesh().face(id).loop.begin(), mesh().face(id).loop.end());
    }
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const VertexId v : vertices) sum += mesh().restPosition(v);
    return sum / static_cast<double>(vertices.size());
  }

  bool isSound(CellId id) const {
    const double size = mesh().localSize(id);
    const CellSurface surface = makeCellSurface(mesh(), id, mesh().restPositions());
    return smallestSubTetVolume(surface) > kSmallestRelativeSubTet * size * size * size;
  }

  MeshEditor& editor_;
  const Crossings& crossings_;
  CellId cell_;
  // Ordered, and without an allocation for each of their few members.
  boost::container::small_flat_set<VertexId, 16> component_;
  boost::container::small_flat_set<VertexId, 16> middles_;
  boost::container::small_flat_set<CellId, 32> touched_;
  std::vector<std::pair<Edge, VertexId>> split_edges_;
  FaceParts split_faces_;
  std::vector<FaceId> first_faces_;
  std::vector<VertexId> cap_loop_, cap_vertices_;
  int side_votes_ = 0;
};

/// Area of a face [m^2] in the rest shape.
double area(const PolyhedralMesh& mesh, FaceId id) {
  const Face& face = mesh.face(id);
  double sum = 0;
  for (int i = 0; i < numTriangles(face); ++i) {
    const Eigen::Matrix3d corners = triangleCorners(face, i, mesh.restPositions());
    sum +=
        0.5 * Eigen::Vector3d(corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).norm();
  }
  return sum;
}

/// Splits cells and collects what has to be opened.
class Splitter {
 public:
  Splitter(MeshEditor& editor, Crossings& crossings, double snap_tolerance, int cut)
      : editor_(editor), crossings_(crossings), snap_tolerance_(snap_tolerance), cut_(cut) {}

  /// Splits a cell and its parts until nothing in them is disconnected.
  void splitRepeatedly(CellId start) {
    std::vector<CellId> pending{start};
    while (!pending.empty()) {
      const CellId cell = pending.back();
      pending.pop_back();
      auto components = findComponents(mesh(), crossings_, cell);
      bool is_split = splitOff(cell, components, pending);
      while (
          !is_split && components.size() > 1 &&
          (absorbHanging(cell, components) || absorbFlat(cell, components) || absorbThin(cell, components))) {
        components = findComponents(mesh(), crossings_, cell);
        is_split = splitOff(cell, components, pending);
      }
      if (is_split || components.size() < 2 || divideAcross(cell, components, pending)) continue;
      counts.left_whole.push_back(cell);
    }
  }

  /// Opens faces that lie in the slit between cells on its two sides, then separates the vertices.
  void openSlit(const std::function<bool(CellId)>& is_ready) {
    const std::vector<VertexId> vertices(crossings_.openVertices().begin(), crossings_.openVertices().end());
    std::set<FaceId> faces;
    for (const VertexId vertex : vertices) {
      bool is_done = true;
      for (const FaceId id : mesh().facesAround(vertex)) {
        const Face& face = mesh().face(id);
        if (face.isBoundary()) continue;
        if (!is_ready(face.cells[0]) || !is_ready(face.cells[1])) {
          is_done = false;
        } else if (crossings_.isInSlit(face)) {
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
    for (const FaceId id : caps_) {
      counts.cap_area_m2 += area(mesh(), id);
      opened.insert(mesh().face(id).loop.begin(), mesh().face(id).loop.end());
      editor_.openFace(id, cut_);
    }
    for (const VertexId vertex : opened) editor_.separateVertex(vertex);
  }

  SplitCounts counts;

 private:
  const PolyhedralMesh& mesh() const { return editor_.mesh(); }

  bool splitOff(CellId cell, const std::vector<std::vector<VertexId>>& components,
                std::vector<CellId>& parts) {
    if (components.size() < 2) return false;
    for (const auto& component : components) {
      const std::size_t savepoint = editor_.savepoint();
      CellSplit split(editor_, crossings_, cell, component);
      if (!split.findBorder() || !split.divide(cut_)) {
        editor_.rollBackTo(savepoint);
        continue;
      }
      for (const auto& [edge, middle] : split.splitEdges()) crossings_.recordSplitEdge(mesh(), edge, middle);
      crossings_.recordSplitCell(cell, split.first, split.second, split.capVertices(), split.firstSide());
      followFaces(split.splitFaceParts());
      caps_.insert(split.cap.begin(), split.cap.end());
      parts.push_back(split.first);
      parts.push_back(split.second);
      ++counts.cells_split;
      return true;
    }
    return false;
  }

  /// A second sheet of the same stroke may divide the cap that the first one has made.
  void followFaces(const FaceParts& parts) {
    for (const auto& [face, face_parts] : parts) {
      face_parts_.emplace_back(face, face_parts);
      if (caps_.erase(face)) caps_.insert({face_parts.first, face_parts.second});
    }
  }

  /// Where the cap of a cell would be bent so much that a part does not see all its surface from any one
  /// point: divides the cell by a closed plane across the longest way of the cap, whose parts are then split
  /// by flatter caps. Returns whether it did.
  bool divideAcross(CellId cell, const std::vector<std::vector<VertexId>>& components,
                    std::vector<CellId>& parts) {
    const auto place = divisions_.find(cell);
    const int depth = place == divisions_.end() ? 0 : place->second;
    if (depth >= most_divisions_) return false;
    for (std::size_t attempt = 0; attempt < 2 * components.size(); ++attempt) {
      const std::size_t savepoint = editor_.savepoint();
      CellSplit split(editor_, crossings_, cell, components[attempt / 2]);
      if (!split.findBorder()) {
        editor_.rollBackTo(savepoint);
        continue;
      }
      const std::size_t divided = editor_.savepoint();
      Crossings plane;
      const double tolerance = kDivisionSnap * snap_tolerance_;
      for (const Hit& hit : hitsAcross(cell, split.capLoop(), attempt % 2 == 0 ? 2 : 1)) {
        plane.add(mesh(), hit, tolerance);
      }
      Splitter across(editor_, plane, tolerance, 0);
      across.most_divisions_ = 0;
      across.splitRepeatedly(cell);
      const MeshChange change = editor_.changeSince(divided);
      if (change.new_cells.empty()) {
        editor_.rollBackTo(savepoint);
        continue;
      }
      for (const auto& [edge, middle] : split.splitEdges()) crossings_.recordSplitEdge(mesh(), edge, middle);
      std::set<Edge> border;
      const auto& loop = split.capLoop();
      for (std::size_t i = 0; i < loop.size(); ++i)
        border.insert(makeEdge(loop[i], loop[(i + 1) % loop.size()]));
      for (const NewVertex& vertex : change.new_vertices) {
        const bool is_on_border = border.count(makeEdge(vertex.parents[0], vertex.parents[1])) > 0;
        crossings_.recordDividedEdge(mesh(), vertex, is_on_border);
        if (!is_on_border) continue;
        for (const VertexId end : vertex.parents) border.insert(makeEdge(end, vertex.vertex));
      }
      for (const NewVertex& vertex : change.new_vertices)
        crossings_.snapNear(mesh(), vertex.vertex, tolerance);
      crossings_.recordDividedCells(change);
      followFaces(split.splitFaceParts());
      followFaces(across.face_parts_);
      for (const NewCell& part : change.new_cells) {
        divisions_[part.cell] = depth + 1;
        parts.push_back(part.cell);
      }
      return true;
    }
    return false;
  }

  /// Hits of a cell's edges, in rest shape, on the plane through the middle of a border and across one of its
  /// principal axes (2: the longest).
  std::vector<Hit> hitsAcross(CellId cell, const std::vector<VertexId>& loop, int axis) const {
    Eigen::Matrix3Xd points(3, loop.size());
    for (std::size_t i = 0; i < loop.size(); ++i) points.col(i) = mesh().restPosition(loop[i]);
    const Eigen::Vector3d middle = points.rowwise().mean();
    points.colwise() -= middle;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(points * points.transpose());
    const Eigen::Vector3d normal = axes.eigenvectors().col(axis);
    std::vector<Hit> hits;
    for (const Edge& edge : mesh().edges(cell)) {
      const Eigen::Vector3d a = mesh().restPosition(edge.first), b = mesh().restPosition(edge.second);
      const int side_a = sideOfPlane(a, middle, normal), side_b = sideOfPlane(b, middle, normal);
      if (side_a == side_b) continue;
      const double to_a = std::abs(normal.dot(a - middle)), to_b = std::abs(normal.dot(b - middle));
      hits.push_back({edge, to_a + to_b > 0 ? to_a / (to_a + to_b) : 0.5, side_b});
    }
    return hits;
  }

  /// Lets the first component join the cut that consists of vertices hanging in an edge between two corners
  /// of the cut: they lie on it, though no edge of theirs crosses it. Returns whether there was one.
  bool absorbHanging(CellId cell, const std::vector<std::vector<VertexId>>& components) {
    for (const auto& component : components) {
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
        sides.emplace_back(v, side != 0 ? side : 1);
      }
      if (sides.size() != component.size()) continue;
      for (const auto& [v, side] : sides) crossings_.snap(mesh(), v, side);
      return true;
    }
    return false;
  }

  /// Lets the first component join the cut that lies flat on it: all its vertices within the absorbing
  /// distance of the mean plane of its border. Returns whether there was one.
  bool absorbFlat(CellId cell, const std::vector<std::vector<VertexId>>& components) {
    for (const auto& component : components) {
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
               kAbsorbDistance * snap_tolerance_ * mesh().localSize(v);
      });
      if (!is_flat) continue;
      for (const VertexId v : component) crossings_.snap(mesh(), v, side);
      return true;
    }
    return false;
  }

  /// Lets the first thin component join the cut. Returns whether there was one.
  bool absorbThin(CellId cell, const std::vector<std::vector<VertexId>>& components) {
    for (const auto& component : components) {
      if (component.size() > kMostAbsorbed) continue;
      std::vector<std::pair<VertexId, int>> sides;
      for (const VertexId v : component) {
        const std::optional<int> side = sideIfThin(cell, v);
        if (side) sides.emplace_back(v, *side);
      }
      if (sides.size() != component.size()) continue;
      for (const auto& [v, side] : sides) crossings_.snap(mesh(), v, side);
      return true;
    }
    return false;
  }

  /// Side of the cut on which a vertex lies that is no further from it than may be absorbed.
  std::optional<int> sideIfThin(CellId cell, VertexId v) const {
    const double reach = kAbsorbDistance * snap_tolerance_ * mesh().localSize(v);
    std::optional<int> side;
    for (const auto& [a, b] : mesh().edges(cell)) {
      if (a != v && b != v) continue;
      const VertexId other = a == v ? b : a;
      const double length = (mesh().restPosition(b) - mesh().restPosition(a)).norm();
      if (const auto* crossed = crossings_.find(cell, {a, b})) {
        if (length * (a == v ? crossed->weight : 1 - crossed->weight) < reach)
          side = a == v ? -crossed->sign : crossed->sign;
      } else if (!side && crossings_.isSnapped(cell, other) && length < reach) {
        side = crossings_.sideOfNeighbour(other, v);
      }
    }
    return side;
  }

  MeshEditor& editor_;
  Crossings& crossings_;
  double snap_tolerance_;
  int cut_;
  std::set<FaceId> caps_;  // closed as yet
  FaceParts face_parts_;   // of all faces divided so far
  std::unordered_map<CellId, int> divisions_;
  int most_divisions_ = kMostDivisions;
};

}  // namespace

SplitCounts splitCells(MeshEditor& editor, Crossings& crossings, const std::function<bool(CellId)>& is_ready,
                       double snap_tolerance, int cut, Slit slit) {
  Splitter splitter(editor, crossings, snap_tolerance, cut);
  // A split puts vertices on its neighbours' edges, and a corner that joins the cut concerns all cells around
  // it.
  for (auto cells = crossings.takeCells(editor.mesh(), is_ready); !cells.empty();
       cells = crossings.takeCells(editor.mesh(), is_ready)) {
    for (const CellId cell : cells) {
      if (editor.mesh().cell(cell).isAlive()) splitter.splitRepeatedly(cell);
    }
  }
  if (slit == Slit::kOpen) splitter.openSlit(is_ready);
  return splitter.counts;
}

}  // namespace polyscalpel
