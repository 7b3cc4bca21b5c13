// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/cell_split.hpp"

#include <algorithm>

#include <boost/container/flat_map.hpp>

#include <Eigen/Geometry>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/cutting/cap_facets.hpp"
#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

/// A face's vertices in the cut are taken to be in line within this times localSize.
constexpr double kSmallestFlap = 1e-3;

/// Crossed edges and snapped corners may not leave a part of an edge shorter than this times its length:
/// rounding.
constexpr double kSmallestEdgePart = 1e-9;

}  // namespace

CellSplit::CellSplit(MeshEditor& editor, const Crossings& crossings, CellId cell,
                     const std::vector<VertexId>& component)
    : editor_(editor), crossings_(crossings), cell_(cell), component_(component.begin(), component.end()) {
  for (const VertexId v : mesh().cell(cell).vertices) {
    if (crossings.isSnapped(cell, v)) snapped_.insert(snapped_.end(), v);
  }
}

bool CellSplit::isOnCut(VertexId v) const {
  return middles_.count(v) || (snapped_.count(v) && !isInComponent(v));
}

bool CellSplit::findBorder() {
  return splitCrossedEdges() && splitFaces() && findCap();
}

bool CellSplit::leavesNeighboursSound() const {
  return std::all_of(touched_.begin(), touched_.end(),
                     [&](CellId id) { return id == cell_ || isSound(mesh(), id); });
}

bool CellSplit::divide(int cut, const BorderSides* sides) {
  if (!leavesNeighboursSound()) return false;
  std::vector<int> sides_of_loop;
  if (sides) {
    for (const VertexId v : cap_loop_) sides_of_loop.push_back(sides->at(v));
  }
  const std::size_t savepoint = editor_.savepoint();
  std::vector<std::vector<VertexId>> facets;
  for (const Apexes apexes : {Apexes::kVertexMeans, Apexes::kStarCentres}) {
    const auto former = std::move(facets);
    facets = makeFacets(apexes, sides_of_loop);
    if (facets == former) break;
    editor_.rollBackTo(savepoint);
    const auto split = editor_.splitCell(cell_, first_faces_, facets, cut);
    first = split.first;
    second = split.second;
    cap = split.cap;
    if (isSound(mesh(), first) && isSound(mesh(), second) && !(sides && joinsSides(*sides))) return true;
  }
  return false;
}

std::vector<std::vector<VertexId>> CellSplit::makeFacets(Apexes apexes,
                                                         const std::vector<int>& sides_of_loop) const {
  if (cap_loop_.size() == 3) return {cap_loop_};  // needs no apexes
  const auto apexOf = [&](bool is_first) {
    return apexes == Apexes::kVertexMeans ? vertexMeanOfPart(is_first) : starCentreOfPart(is_first);
  };
  return makeCapFacets(mesh(), cap_loop_, apexOf(true), apexOf(false), sides_of_loop);
}

bool CellSplit::splitCrossedEdges() {
  for (const Edge& edge : mesh().edges(cell_)) {
    const bool first_in = isInComponent(edge.first), second_in = isInComponent(edge.second);
    if (first_in == second_in || isOnCut(first_in ? edge.second : edge.first)) continue;
    const CrossedEdge* crossed = crossings_.find(cell_, edge);
    POLYSCALPEL_ASSERT(crossed);
    const bool is_shut = numFansAroundEdge(mesh(), edge.first, edge.second) > 1;
    side_votes_ += crossed->sideAt(first_in);
    const double weight = std::clamp(crossed->weightAt(first_in), kSmallestEdgePart, 1 - kSmallestEdgePart);
    const VertexId middle = editor_.splitEdge(edge.first, edge.second, weight);
    for (const CellId around : cellsAround(mesh(), middle)) touched_.insert(around);
    middles_.insert(middle);
    if (is_shut) shared_middles_.push_back(middle);
    split_edges_.emplace_back(edge, middle);
  }
  return true;
}

/// Cuts the component's vertices off every face that also reaches beyond the cut.
bool CellSplit::splitFaces() {
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
bool CellSplit::hasFlap(const FaceLoop& loop, std::size_t start, std::size_t end) const {
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
bool CellSplit::findCap() {
  first_faces_.reserve(mesh().cell(cell_).faces.size());
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
  cap_loop_.reserve(next.size() + 1);
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
Eigen::Vector3d CellSplit::vertexMeanOfPart(bool is_first) const {
  boost::container::small_vector<VertexId, 32> vertices;
  for (const FaceId id : mesh().cell(cell_).faces) {
    const bool is_in_first = std::find(first_faces_.begin(), first_faces_.end(), id) != first_faces_.end();
    if (is_in_first != is_first) continue;
    vertices.insert(vertices.end(), mesh().face(id).loop.begin(), mesh().face(id).loop.end());
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const VertexId v : vertices) sum += mesh().restPosition(v);
  return sum / static_cast<double>(vertices.size());
}

/// Star centre of one part as a fan over its border would close it.
Eigen::Vector3d CellSplit::starCentreOfPart(bool is_first) const {
  std::vector<Eigen::Matrix3d> triangles;
  for (const FaceId id : mesh().cell(cell_).faces) {
    const bool is_in_first = std::find(first_faces_.begin(), first_faces_.end(), id) != first_faces_.end();
    if (is_in_first != is_first) continue;
    const bool is_outward = mesh().face(id).cells[0] == cell_;
    visitTriangles(mesh().face(id), mesh().restPositions(), [&](const Eigen::Matrix3d& corners) {
      triangles.push_back(corners);
      if (!is_outward) triangles.back().col(1).swap(triangles.back().col(2));
      return true;
    });
  }
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const VertexId v : cap_loop_) middle += mesh().restPosition(v) / static_cast<double>(cap_loop_.size());
  for (std::size_t i = 0; i < cap_loop_.size(); ++i) {
    const Eigen::Vector3d from = mesh().restPosition(cap_loop_[i]);
    const Eigen::Vector3d to = mesh().restPosition(cap_loop_[(i + 1) % cap_loop_.size()]);
    triangles.emplace_back();
    triangles.back() << middle, (is_first ? from : to), (is_first ? to : from);
  }
  return starCentre(triangles, vertexMeanOfPart(is_first));
}

/// Whether an edge of the cap joins vertices of opposite sides.
bool CellSplit::joinsSides(const BorderSides& sides) const {
  return std::any_of(cap.begin(), cap.end(), [&](FaceId id) {
    const auto& loop = mesh().face(id).loop;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      if (sides.at(loop[i]) * sides.at(loop[(i + 1) % loop.size()]) < 0) return true;
    }
    return false;
  });
}

bool isSound(const PolyhedralMesh& mesh, CellId cell) {
  const CellSurface surface = makeCellSurface(mesh, cell, mesh.restPositions());
  return smallestSubTetVolume(surface) > smallestSubTetAllowed(surface, mesh.localSize(cell));
}

}  // namespace polyscalpel
