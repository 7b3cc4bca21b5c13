// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/crossings.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/mesh/mesh_editing.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

/// An edge between two corners of the slit lies in it where neither is further from the blade's surface than
/// this times the snap distance, as a corner that has been absorbed may be; otherwise the edge is crossed, as
/// where a stroke crosses itself.
constexpr double kSlitThickness = 2;

/// A blade's way bends: how far it passes from a vertex is not told by where it crosses an edge further from
/// the vertex than this, in snap distances. The way off its tangent plane is this squared times half the snap
/// distance over the radius of the bend: one snap distance for a radius of 18, about that of a cell.
constexpr double kFurthestTold = 6;

/// Largest |cos| of the angle between a settled slit's edge and the blade's normal where that edge, shorter
/// than the slit is thick, may lie in the blade's surface.
constexpr double kLargestAlignmentInSlit = 0.5;

/// Vertices joined to `vertex` by an edge.
std::vector<VertexId> neighboursOf(const PolyhedralMesh& mesh, VertexId vertex) {
  std::vector<VertexId> neighbours;
  neighbours.reserve(2 * mesh.facesAround(vertex).size());
  for (const FaceId id : mesh.facesAround(vertex)) {
    const auto& loop = mesh.face(id).loop;
    const std::size_t i = findInLoop(mesh.face(id), vertex), n = loop.size();
    neighbours.push_back(loop[(i + 1) % n]);
    neighbours.push_back(loop[(i + n - 1) % n]);
  }
  std::sort(neighbours.begin(), neighbours.end());
  neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
  return neighbours;
}

/// Whether an edge lies in a wall of a cut, between two corners of it.
bool isInWall(const PolyhedralMesh& mesh, Edge edge) {
  const auto& faces = mesh.facesAround(edge.first);
  return std::any_of(faces.begin(), faces.end(), [&](FaceId id) {
    const Face& face = mesh.face(id);
    return face.cut > 0 && hasEdge(face, edge.first, edge.second);
  });
}

}  // namespace

void Crossings::add(const PolyhedralMesh& mesh, const Hit& hit, double snap_tolerance) {
  const auto [a, b] = hit.edge;
  const auto snap_a = snaps_.find(a), snap_b = snaps_.find(b);
  const double length = (mesh.restPosition(b) - mesh.restPosition(a)).norm();
  // Ways along the edge and distances from the blade's surface, in snap distances.
  const double along_a = hit.weight * length / (snap_tolerance * mesh.localSize(a)),
               along_b = (1 - hit.weight) * length / (snap_tolerance * mesh.localSize(b));
  const double to_a = hit.alignment * along_a, to_b = hit.alignment * along_b;
  const bool is_told = hit.normal.isZero(0) || std::max(along_a, along_b) < kFurthestTold ||
                       (std::max(to_a, to_b) < 1 && isInWall(mesh, hit.edge));
  const double furthest_told = is_told ? kInfinity : kFurthestTold;
  const bool is_near_a = to_a < 1 && along_a < furthest_told, is_near_b = to_b < 1 && along_b < furthest_told;
  const bool is_near = is_near_a || is_near_b;
  const bool through_a = is_near_a && (!is_near_b || hit.weight <= 0.5);
  const bool is_snapped = is_near && (through_a ? snap_a : snap_b) != snaps_.end();

  bool is_other_sheet = false;
  if (const auto former = edges_.find(hit.edge); former != edges_.end()) {
    CrossedEdge& crossed = former->second;
    if (crossed.last_time < time_) meetCells(cellsAroundEdge(mesh, a, b));
    crossed.last_time = time_;
    if (isSettled(mesh, hit.edge, crossed)) {
      if (isSamePlace(mesh, hit, crossed, snap_tolerance)) return;
    } else if (isGrazed(mesh, hit, crossed, snap_tolerance)) {
      edges_.erase(former);
      for (const auto& [snap, other] : {std::pair(snap_a, b), std::pair(snap_b, a)}) {
        if (snap != snaps_.end()) snap->second.forgetNeighbour(other);
      }
      return;
    } else if (is_near && isComingBack(hit.normal, crossed.normal) &&
               !isSamePlace(mesh, hit, crossed, snap_tolerance)) {
      is_other_sheet = true;
    } else {
      if (!is_near && !isSamePlace(mesh, hit, crossed, snap_tolerance)) crossed.addSecond(hit);
      return;
    }
    if (!is_other_sheet) edges_.erase(former);
  }

  if (snap_a != snaps_.end() && snap_b != snaps_.end()) {
    // A settled slit is crossed by a surface at an angle to it, however short the edges are that the two
    // sheets have in common. An edge with a settled and an open end goes from one sheet to the other.
    const bool is_settled = isReleased(a) || isReleased(b);
    const bool is_at_angle = is_settled && (hit.alignment > kLargestAlignmentInSlit ||
                                            isAtAngle(hit.normal, snap_a->second.normal) ||
                                            isAtAngle(hit.normal, snap_b->second.normal));
    if ((is_near || !is_settled) && std::max(to_a, to_b) < (is_at_angle ? 1 : kSlitThickness)) {
      // Drawn back through a slit that is not settled yet, the blade passes its corners once more.
      if (!is_settled && isComingBack(hit.normal, snap_a->second.normal) &&
          isComingBack(hit.normal, snap_b->second.normal))
        snap_a->second.last_time = snap_b->second.last_time = time_;
      return;
    }
  }
  if (is_near) {
    const VertexId vertex = through_a ? a : b, other = through_a ? b : a;
    const int other_side = through_a ? hit.sign : -hit.sign;
    const double weight = through_a ? hit.weight : 1 - hit.weight;
    if (is_near_a && is_near_b) {
      near_[other] = other_side;
    } else {
      const double to_other = through_a ? to_b : to_a, along_other = through_a ? along_b : along_a;
      const double off_tangent = hit.normal.isZero(0) ? 0 : std::pow(along_other / kFurthestTold, 2);
      recordDistance(other, snap_tolerance * (to_other - off_tangent));
    }
    if (is_snapped) {
      addAtSnapped(mesh, vertex, other, other_side, weight, hit.normal);
    } else {
      passCells(cellsAround(mesh, vertex));
      snapAt(mesh, vertex, -other_side, time_, hit.normal);
      snaps_[vertex].addHit(other, other_side, weight);
    }
    meetCells(cellsAroundEdge(mesh, a, b));
    return;
  }
  CrossedEdge& crossed = edges_[hit.edge];
  crossed.weight = hit.weight;
  crossed.sign = hit.sign;
  crossed.alignment = hit.alignment;
  crossed.normal = hit.normal;
  crossed.time = crossed.last_time = time_;
  meetCells(cellsAroundEdge(mesh, a, b));
  if (snap_a != snaps_.end() && !isReleased(a))
    snap_a->second.neighbours.push_back({b, hit.sign, hit.weight, hit.weight});
  if (snap_b != snaps_.end() && !isReleased(b))
    snap_b->second.neighbours.push_back({a, -hit.sign, 1 - hit.weight, 1 - hit.weight});
}

void Crossings::addAtSnapped(const PolyhedralMesh& mesh, VertexId vertex, VertexId other, int other_side,
                             double weight, const Eigen::Vector3d& normal) {
  SnappedVertex& snap = snaps_.at(vertex);
  if (snap.last_time < time_) passCells(cellsAround(mesh, vertex));
  snap.last_time = time_;
  if (!isReleased(vertex)) {
    // Another sheet, which goes through the corners that the parts of cells have got by the first one.
    if (isAtAngle(normal, snap.normal)) snap.time = time_;
    // What lies near the surface with both its ends says nothing new: by rounding, from one pass to the next.
    if (snap.side != 0 && !near_.count(other) && isSameSheet(normal, snap.normal)) {
      snap.addHit(other, other_side, weight);
    } else if (snap.side != 0 && !snap.find(other)) {
      snap.neighbours.push_back({other, other_side});
    }
    return;
  }
  snap.again.push_back({other, other_side, weight, weight});
  // An edge of the slit that leads away from the blade's surface: this sheet crosses the one that made it, as
  // it does where their normals tell so.
  if ((!isOnCut(other) || !isReleased(other)) && !isAtAngle(normal, snap.normal)) {
    // The sheets lie on each other: what one parts from the vertex, the other does, whichever way it is
    // drawn.
    if (snap.side != 0 && snap.sideOfNeighbour(other) == snap.side)
      snap.neighbours.push_back({other, -snap.side});
    return;
  }
  snap.neighbours = std::move(snap.again);
  snap.again.clear();
  snapAt(mesh, vertex, -other_side, time_, normal);
}

bool Crossings::isOfEarlierPass(CellId cell, int last_time) const {
  if (earlier_.empty()) return false;
  const auto earlier = earlier_.find(cell);
  return earlier != earlier_.end() && !earlier->second.is_counted && last_time <= earlier->second.until;
}

const CrossedEdge* Crossings::find(CellId cell, Edge edge) const {
  const auto place = edges_.find(edge);
  if (place == edges_.end() || isOfEarlierPass(cell, place->second.last_time)) return nullptr;
  const auto part = parts_.find(cell);
  if (part == parts_.end()) return &place->second;
  // Crossed by the sheet that made the cap, which goes through the snapped corner instead?
  for (const VertexId end : {edge.first, edge.second}) {
    const auto settled = part->second.settled.find(end);
    if (settled == part->second.settled.end() || place->second.time > settled->second) continue;
    const auto snap = snaps_.find(end);
    if (snap == snaps_.end() || !isComingBack(place->second.normal, snap->second.normal)) return nullptr;
  }
  return &place->second;
}

bool Crossings::isSettled(const PolyhedralMesh& mesh, Edge edge, const CrossedEdge& crossed) const {
  const std::vector<CellId> around = cellsAroundEdge(mesh, edge.first, edge.second);
  return std::all_of(around.begin(), around.end(), [&](CellId cell) {
    const auto earlier = earlier_.find(cell);
    return !find(cell, edge) || (earlier != earlier_.end() && crossed.time <= earlier->second.until);
  });
}

bool Crossings::isSnapped(CellId cell, VertexId vertex) const {
  const auto snap = snaps_.find(vertex);
  if (snap == snaps_.end() || isOfEarlierPass(cell, snap->second.last_time)) return false;
  const auto part = parts_.find(cell);
  if (part == parts_.end()) return true;
  const auto settled = part->second.settled.find(vertex);
  return settled == part->second.settled.end() || snap->second.time > settled->second;
}

void Crossings::countEarlierPasses(CellId cell, bool is_counted) {
  const auto earlier = earlier_.find(cell);
  if (earlier != earlier_.end()) earlier->second.is_counted = is_counted;
}

bool Crossings::canJoin(VertexId vertex) const {
  return !isOnCut(vertex) || isReleased(vertex);
}

std::optional<int> Crossings::sideIfNear(VertexId vertex) const {
  const auto place = near_.find(vertex);
  return place == near_.end() ? std::nullopt : std::optional<int>(place->second);
}

void Crossings::recordDistance(VertexId vertex, double distance) {
  if (distance <= 0) return;
  const auto [place, is_new] = distances_.emplace(vertex, distance);
  if (!is_new) place->second = std::min(place->second, distance);
}

double Crossings::leastDistance(VertexId vertex) const {
  const auto place = distances_.find(vertex);
  return place == distances_.end() ? 0 : place->second;
}

int Crossings::sideOfNeighbour(VertexId snapped, VertexId neighbour) const {
  const auto place = snaps_.find(snapped);
  return place == snaps_.end() ? 0 : place->second.sideOfNeighbour(neighbour);
}

void Crossings::snap(const PolyhedralMesh& mesh, VertexId vertex, int side, CellId cell) {
  int time = 0;
  for (const auto& [a, b] : mesh.edges(cell)) {
    if (const CrossedEdge* crossed = find(cell, {a, b})) time = std::max(time, crossed->last_time);
    for (const VertexId end : {a, b}) {
      if (isSnapped(cell, end)) time = std::max(time, snaps_.at(end).last_time);
    }
  }
  snapAt(mesh, vertex, side, time);
  snaps_[vertex].has_joined = true;
}

void Crossings::takeUp(const PolyhedralMesh& mesh, VertexId vertex) {
  snaps_.erase(vertex);
  snapAt(mesh, vertex, 0, time_);
}

void Crossings::snapAt(const PolyhedralMesh& mesh, VertexId vertex, int side, int time,
                       const Eigen::Vector3d& normal) {
  SnappedVertex& snap = snaps_[vertex];
  snap.side = side;
  snap.normal = normal;
  snap.has_joined = false;
  snap.time = time_;
  snap.last_time = time;
  open_vertices_.insert(vertex);
  for (const CellId cell : cellsAround(mesh, vertex)) cells_.insert(cell);
  for (const VertexId other : neighboursOf(mesh, vertex)) {
    const auto crossed = edges_.find(makeEdge(vertex, other));
    if (crossed == edges_.end()) continue;
    // Where the blade comes back, both of its sheets may cross an edge, one of them through the vertex.
    if (isComingBack(normal, crossed->second.normal)) continue;
    snap.neighbours.push_back({other, crossed->second.sideAt(other < vertex)});
    edges_.erase(crossed);
  }
}

void Crossings::snapNear(const PolyhedralMesh& mesh, VertexId vertex, double snap_tolerance) {
  if (snaps_.count(vertex)) return;
  for (const VertexId other : neighboursOf(mesh, vertex)) {
    const auto crossed = edges_.find(makeEdge(vertex, other));
    if (crossed == edges_.end()) continue;
    const bool is_first = vertex < other;
    const CrossedEdge from_vertex = is_first ? crossed->second : crossed->second.reversed();
    const double length = (mesh.restPosition(other) - mesh.restPosition(vertex)).norm();
    if (from_vertex.weight * from_vertex.alignment * length >= snap_tolerance * mesh.localSize(vertex))
      continue;
    snapAt(mesh, vertex, from_vertex.sideAt(true), from_vertex.last_time, from_vertex.normal);
    return;
  }
}

void Crossings::recordSplitEdge(const PolyhedralMesh& mesh, Edge edge, VertexId middle) {
  const auto place = edges_.find(edge);
  POLYSCALPEL_ASSERT(place != edges_.end());
  const CrossedEdge crossed = place->second;
  edges_.erase(place);
  const auto [a, b] = edge;
  int sign = crossed.sign;
  if (crossed.isTwice()) {
    // The other crossing goes on with the part of the edge in which it lies, and counts for the cells that
    // have just got the middle as the corner of a cap.
    const double at = (mesh.restPosition(middle) - mesh.restPosition(a)).norm() /
                      (mesh.restPosition(b) - mesh.restPosition(a)).norm();
    const bool by_first = std::abs(at - crossed.weight) <= std::abs(at - crossed.second_weight);
    CrossedEdge rest = by_first ? crossed.reversed() : crossed;
    rest.second_weight = std::numeric_limits<double>::infinity();
    rest.time = time_ + 1;
    if (!by_first) sign = -sign;
    const Edge part = makeEdge(by_first ? b : a, middle);
    edges_[part] = *rest.upTo(std::max(rest.weight, by_first ? 1 - at : at));
    putCellsAround(mesh, part);
  }
  snaps_[middle] = {0, crossed.time, crossed.last_time, false, {{a, -sign}, {b, sign}}, {}, crossed.normal};
  open_vertices_.insert(middle);
  for (const CellId cell : cellsAround(mesh, middle)) cells_.insert(cell);
}

void Crossings::recordSplitCell(CellId cell, CellId first, CellId second,
                                const std::vector<VertexId>& cap_vertices, int first_side,
                                bool is_second_whole) {
  Part part;
  if (const auto former = parts_.find(cell); former != parts_.end()) {
    part.settled = std::move(former->second.settled);
    parts_.erase(former);
  }
  // What is left of three may lie on the same side as the one before: corners of the cut part them, no sheet.
  const bool is_rest = std::any_of(part.settled.begin(), part.settled.end(),
                                   [](const auto& corner) { return corner.second == kNotYetSettled; });
  for (const VertexId v : cap_vertices) part.settled[v] = kNotYetSettled;
  parts_[second] = part;
  if (is_second_whole) parts_[second].settle(time_);
  parts_[second].side = is_rest ? 0 : -first_side;
  part.settle(time_);
  part.side = first_side;
  parts_[first] = std::move(part);
  inheritPasses(cell, first);
  inheritPasses(cell, second);
}

void Crossings::settle(CellId cell) {
  const auto part = parts_.find(cell);
  if (part == parts_.end() || !part->second.settle(time_)) return;
  // The side was that of all that was left when another part was cut off.
  part->second.side = 0;
}

bool Crossings::Part::settle(int time) {
  bool has_settled = false;
  for (auto& [vertex, since] : settled) {
    if (since != kNotYetSettled) continue;
    since = time;
    has_settled = true;
  }
  return has_settled;
}

void Crossings::inheritPasses(CellId cell, CellId part) {
  if (const auto pass = passes_.find(cell); pass != passes_.end()) passes_.emplace(part, int(pass->second));
  if (const auto earlier = earlier_.find(cell); earlier != earlier_.end())
    earlier_.emplace(part, Earlier(earlier->second));
}

void Crossings::recordDividedEdge(const PolyhedralMesh& mesh, const NewVertex& origin, bool is_on_cut) {
  const auto [a, b] = makeEdge(origin.parents[0], origin.parents[1]);
  const auto crossed = edges_.find({a, b});
  if (is_on_cut && crossed == edges_.end()) {
    snapBetween(origin);
    settleBetween(mesh, origin, origin.vertex);
    open_vertices_.insert(origin.vertex);
    for (const CellId cell : cellsAround(mesh, origin.vertex)) cells_.insert(cell);
    return;
  }
  if (crossed == edges_.end()) {
    // Seen from an end through which the blade has gone, the new vertex lies where the other end does.
    inheritNeighbour(a, b, origin.vertex);
    inheritNeighbour(b, a, origin.vertex);
    return;
  }
  // Another cut has divided the edge; the crossing stays in the part where it was. The new vertex is the
  // larger one, so the part at the second end runs against the edge.
  const double at = a == origin.parents[0] ? origin.weight : 1 - origin.weight;
  const CrossedEdge whole = crossed->second;
  inheritNeighbour(whole.weight <= at ? a : b, whole.weight <= at ? b : a, origin.vertex);
  const auto before = whole.upTo(at), after = whole.reversed().upTo(1 - at);
  for (const auto& [end, part] : {std::pair(a, before), std::pair(b, after)}) {
    if (!part) continue;
    edges_.emplace(makeEdge(end, origin.vertex), *part);
    putCellsAround(mesh, makeEdge(end, origin.vertex));
  }
}

void Crossings::snapBetween(const NewVertex& origin) {
  SnappedVertex snap;
  for (const VertexId parent : origin.parents) {
    const auto place = snaps_.find(parent);
    if (place == snaps_.end()) continue;
    snap.time = std::max(snap.time, place->second.time);
    snap.last_time = std::max(snap.last_time, place->second.last_time);
  }
  snaps_[origin.vertex] = std::move(snap);
}

void Crossings::settleBetween(const PolyhedralMesh& mesh, const NewVertex& origin, VertexId place) {
  for (const CellId cell : cellsAround(mesh, place)) {
    const auto part = parts_.find(cell);
    if (part == parts_.end()) continue;
    auto& settled = part->second.settled;
    const auto first = settled.find(origin.parents[0]), second = settled.find(origin.parents[1]);
    if (first != settled.end() && second != settled.end())
      settled[origin.vertex] = std::max(first->second, second->second);
  }
}

void Crossings::recordSide(const PolyhedralMesh& mesh, VertexId vertex, int side) {
  for (const VertexId other : neighboursOf(mesh, vertex)) {
    const auto snap = snaps_.find(other);
    if (snap == snaps_.end()) continue;
    if (!snap->second.find(vertex)) snap->second.neighbours.push_back({vertex, side});
  }
}

void Crossings::inheritNeighbour(VertexId snapped, VertexId neighbour, VertexId heir) {
  const auto snap = snaps_.find(snapped);
  if (snap == snaps_.end()) return;
  if (const auto* known = snap->second.find(neighbour))
    snap->second.neighbours.push_back({heir, known->side});
}

void Crossings::recordOpenedEdge(const PolyhedralMesh& mesh, const std::vector<NewVertex>& new_vertices) {
  const NewVertex& middle = new_vertices.front();
  snapBetween(middle);
  for (const NewVertex& side : new_vertices) settleBetween(mesh, middle, side.vertex);
}

void Crossings::recordDividedCells(const MeshChange& change) {
  for (const NewCell& cell : change.new_cells) {
    const auto part = parts_.find(cell.parent);
    if (part != parts_.end()) parts_.emplace(cell.cell, Part(part->second));
    inheritPasses(cell.parent, cell.cell);
    if (cells_.count(cell.parent)) cells_.insert(cell.cell);
  }
}

void Crossings::update(const PolyhedralMesh& mesh, const MeshChange& change) {
  recordDividedCells(change);
  for (const CellId id : change.removed_cells) {
    parts_.erase(id);
    passes_.erase(id);
    earlier_.erase(id);
  }

  for (const NewVertex& origin : change.new_vertices) recordDividedEdge(mesh, origin, false);

  std::unordered_map<VertexId, VertexId> originals;  // of copies, as they stood before this change
  for (const NewVertex& origin : change.new_vertices) {
    if (origin.parents[0] != origin.parents[1]) continue;
    const auto further = originals.find(origin.parents[0]);
    originals[origin.vertex] = further == originals.end() ? origin.parents[0] : further->second;
  }
  const auto originalOf = [&](VertexId v) {
    const auto place = originals.find(v);
    return place == originals.end() ? v : place->second;
  };

  for (const NewVertex& origin : change.new_vertices) {
    const auto snap = snaps_.find(originalOf(origin.vertex));
    if (snap == snaps_.end() || originalOf(origin.vertex) == origin.vertex) continue;
    const SnappedVertex value = snap->second;
    snaps_[origin.vertex] = value;
    if (open_vertices_.count(originalOf(origin.vertex))) open_vertices_.insert(origin.vertex);
  }
  for (const NewVertex& origin : change.new_vertices) {
    const VertexId copy = origin.vertex, former = originalOf(copy);
    if (former == copy) continue;
    for (const VertexId other : neighboursOf(mesh, copy)) {
      if (const auto snap = snaps_.find(other); snap != snaps_.end()) {
        if (const auto* known = snap->second.find(former))
          snap->second.neighbours.push_back({copy, known->side});
      }
      const VertexId former_other = originalOf(other);
      if (const auto crossed = edges_.find(makeEdge(former, former_other)); crossed != edges_.end()) {
        CrossedEdge moved = crossed->second;
        if ((former < former_other) != (copy < other)) moved = moved.reversed();
        edges_.emplace(makeEdge(copy, other), moved);
        putCellsAround(mesh, makeEdge(copy, other));
      }
    }
    for (const CellId cell : cellsAround(mesh, copy)) {
      const auto part = parts_.find(cell);
      if (part == parts_.end()) continue;
      const auto settled = part->second.settled.find(former);
      if (settled != part->second.settled.end()) part->second.settled.emplace(copy, int(settled->second));
    }
  }
  for (auto crossed = edges_.begin(); crossed != edges_.end();) {
    const auto [a, b] = crossed->first;
    crossed = cellsAroundEdge(mesh, a, b).empty() ? edges_.erase(crossed) : std::next(crossed);
  }
  ++time_;
}

std::vector<CellId> Crossings::takeCells(const PolyhedralMesh& mesh,
                                         const std::function<bool(CellId)>& is_ready) {
  std::vector<CellId> taken;
  for (auto cell = cells_.begin(); cell != cells_.end();) {
    if (!mesh.cell(*cell).isAlive()) {
      cell = cells_.erase(cell);
    } else if (is_ready(*cell) && hasLeft(mesh, *cell, is_ready)) {
      taken.push_back(*cell);
      passes_[*cell] = time_;
      cell = cells_.erase(cell);
    } else {
      ++cell;
    }
  }
  if (!taken.empty()) ++time_;
  return taken;
}

bool Crossings::hasLeft(const PolyhedralMesh& mesh, CellId cell,
                        const std::function<bool(CellId)>& is_ready) const {
  if (passes_.count(cell)) return true;
  const auto& vertices = mesh.cell(cell).vertices;
  return std::all_of(vertices.begin(), vertices.end(), [&](VertexId v) {
    if (!isOnCut(v) || isReleased(v)) return true;
    const auto& faces = mesh.facesAround(v);
    return std::all_of(faces.begin(), faces.end(), [&](FaceId id) {
      const auto& cells = mesh.face(id).cells;
      return is_ready(cells[0]) && (!cells[1].isValid() || is_ready(cells[1]));
    });
  });
}

void Crossings::passCells(const std::vector<CellId>& cells) {
  for (const CellId cell : cells) {
    cells_.insert(cell);
    const auto pass = passes_.find(cell);
    if (pass == passes_.end() || pass->second == kUnderWay) continue;
    earlier_[cell] = {pass->second, false};
    passes_.erase(pass);
  }
}

void Crossings::meetCells(const std::vector<CellId>& cells) {
  passCells(cells);
  for (const CellId cell : cells) passes_.emplace(cell, int(kUnderWay));
}

void Crossings::putCellsAround(const PolyhedralMesh& mesh, Edge edge) {
  for (const CellId cell : cellsAroundEdge(mesh, edge.first, edge.second)) cells_.insert(cell);
}

void Crossings::clear() {
  edges_.clear();
  snaps_.clear();
  near_.clear();
  distances_.clear();
  parts_.clear();
  passes_.clear();
  earlier_.clear();
  open_vertices_.clear();
  cells_.clear();
}

}  // namespace polyscalpel
