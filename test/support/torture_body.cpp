// SPDX-License-Identifier: BSD-3-Clause
#include "support/torture_body.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <utility>

#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/mesh_editing.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "support/plane_pieces.hpp"

namespace polyscalpel {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// Progressive cuts are checked after each step up to so many cells; larger meshes when the stroke ends.
constexpr int kMostCellsCheckedEachStep = 4000;

/// A vertex made between two others has the smaller of their sizes, and may lie as far off a cut as the one
/// of the larger size, through which the cut goes.
std::vector<VertexId> verticesAround(const PolyhedralMesh& mesh, VertexId vertex) {
  std::vector<VertexId> around;
  for (const CellId cell : cellsAround(mesh, vertex)) {
    const auto& vertices = mesh.cell(cell).vertices;
    around.insert(around.end(), vertices.begin(), vertices.end());
  }
  return around;
}

bool isOnWall(const PolyhedralMesh& mesh, VertexId vertex) {
  const auto& faces = mesh.facesAround(vertex);
  return std::any_of(faces.begin(), faces.end(), [&](FaceId id) { return mesh.face(id).cut > 0; });
}

double relativeLength(const PolyhedralMesh& mesh, VertexId a, VertexId b) {
  return (mesh.restPosition(b) - mesh.restPosition(a)).norm() /
         std::min(mesh.localSize(a), mesh.localSize(b));
}

}  // namespace

Vector3d SmoothDeformation::operator()(const Vector3d& rest_position) const {
  return rest_position + amplitude_m * (wave * rest_position + phase).array().sin().matrix();
}

int countPiecesByFloodFill(const PolyhedralMesh& mesh) {
  std::map<std::vector<VertexId>, std::vector<int>> cells_by_face;
  for (const CellId id : mesh.cells()) {
    for (const FaceId face : mesh.cell(id).faces) {
      const FaceLoop& loop = mesh.face(face).loop;
      std::vector<VertexId> corners(loop.begin(), loop.end());
      std::sort(corners.begin(), corners.end());
      cells_by_face[corners].push_back(id.index());
    }
  }
  std::map<int, std::vector<int>> joined;
  for (const CellId id : mesh.cells()) joined[id.index()];
  for (const auto& [corners, cells] : cells_by_face) {
    for (const int a : cells)
      for (const int b : cells)
        if (a != b) joined[a].push_back(b);
  }
  int count = 0;
  std::set<int> seen;
  for (const auto& [start, others] : joined) {
    if (!seen.insert(start).second) continue;
    ++count;
    std::vector<int> pending{start};
    while (!pending.empty()) {
      const int cell = pending.back();
      pending.pop_back();
      for (const int next : joined[cell])
        if (seen.insert(next).second) pending.push_back(next);
    }
  }
  return count;
}

TortureBody::TortureBody(std::string name, PolyhedralMesh mesh, bool is_convex)
    : name_(std::move(name)), mesh_(std::move(mesh)), is_convex_(is_convex) {
  std::vector<double> sizes;
  for (int i = 0; i < mesh_.numVertices(); ++i) {
    sizes.push_back(mesh_.localSize(VertexId(i)));
    box_.extend(mesh_.restPosition(VertexId(i)));
  }
  sizes_ = sizes;
  std::nth_element(sizes.begin(), sizes.begin() + sizes.size() / 2, sizes.end());
  size_ = sizes[sizes.size() / 2];
  volume_ = volume(mesh_, mesh_.restPositions());
  pieces_ = findPieces(mesh_).count;
}

Matrix3Xd TortureBody::positionsFor(const TortureCut& cut) const {
  Matrix3Xd positions = mesh_.restPositions();
  if (cut.deformation) {
    for (int i = 0; i < positions.cols(); ++i) positions.col(i) = (*cut.deformation)(positions.col(i));
  }
  return positions;
}

CutResult TortureBody::cutAtOnce(const TortureCut& cut, const CuttingConfig& config) {
  return cutMesh(mesh_, positionsFor(cut), cut.operation, config, num_cuts_);
}

CutResult TortureBody::cutProgressively(const TortureCut& cut, const CuttingConfig& config,
                                        TortureOutcome& outcome) {
  const auto& sweep = std::get<SweepCut>(cut.operation);
  BladeCut blade(sweep.edge_tool, config);
  Matrix3Xd positions = positionsFor(cut);
  CutResult sum;
  const auto add = [&](const CutResult& result) {
    if (sum.status != CutStatus::kCut && sum.status != CutStatus::kRefused) sum.status = result.status;
    sum.cells_split += result.cells_split;
    sum.cells_left_whole += result.cells_left_whole;
    sum.cut_area_m2 += result.cut_area_m2;
    sum.pieces_after = result.pieces_after;
    if (result.status != CutStatus::kCut) return;
    auto& made = sum.change.new_vertices;
    made.insert(made.end(), result.change.new_vertices.begin(), result.change.new_vertices.end());
    extendByNewVertices(result.change.new_vertices, positions);
    if (mesh_.numCells() > kMostCellsCheckedEachStep || !outcome.violations.empty()) return;
    outcome.violations = checkMesh(mesh_);
  };
  for (std::size_t i = 0; i + 1 < sweep.T_world_tool.size(); ++i) {
    const Matrix3Xd still = positions;
    add(blade.advance(mesh_, still, still, sweep.T_world_tool[i], sweep.T_world_tool[i + 1], num_cuts_));
  }
  const Matrix3Xd still = positions;
  add(blade.finish(mesh_, still, num_cuts_));
  return sum;
}

double TortureBody::sizeFor(const Known& separator, const std::vector<VertexId>& vertices) const {
  // The separator has not known a vertex that was made after it: what it left within the snap distance, by
  // the sizes of then, is to be left.
  double size = 0;
  for (const VertexId v : vertices)
    size = std::max(size, v.index() < separator.num_vertices ? mesh_.localSize(v) : sizes_[v.index()]);
  return size;
}

std::optional<std::vector<bool>> TortureBody::signatureOf(const Vector3d& rest_position,
                                                          const std::vector<VertexId>& vertices,
                                                          const CuttingConfig& config) const {
  std::vector<bool> signature;
  for (const Known& known : separators_) {
    const auto& [separator, deformation, num_vertices] = known;
    const double local_size = sizeFor(known, vertices);
    const double distance = separator.distance(deformation ? (*deformation)(rest_position) : rest_position);
    // A deformed edge stays straight while the map bends it: the sag of the map over one cell comes on top.
    double limit = (config.snap_tolerance * (1 + 1e-6) + separator.slack) * local_size;
    if (deformation) {
      const double curvature = deformation->amplitude_m * deformation->wave.rowwise().squaredNorm().sum();
      limit = (1.5 * config.snap_tolerance + separator.slack) * local_size +
              0.25 * curvature * local_size * local_size;
    }
    if (!(std::abs(distance) > limit)) return std::nullopt;
    signature.push_back(distance > 0);
  }
  return signature;
}

void TortureBody::compareWithSeparators(const CuttingConfig& config, TortureOutcome& outcome) {
  const Pieces pieces = findPieces(mesh_);
  std::map<int, std::set<std::vector<bool>>> signatures_of_piece;
  std::map<std::vector<bool>, std::set<int>> pieces_of_signature;
  const auto add = [&](const Vector3d& point, const std::vector<VertexId>& vertices, CellId cell) {
    const auto signature = signatureOf(point, vertices, config);
    if (!signature) return;
    const int piece = pieces.piece_of_cell[cell.index()];
    signatures_of_piece[piece].insert(*signature);
    pieces_of_signature[*signature].insert(piece);
  };
  for (int i = 0; i < mesh_.numVertices(); ++i) {
    const VertexId v(i);
    if (!mesh_.facesAround(v).empty())
      add(mesh_.restPosition(v), verticesAround(mesh_, v), mesh_.face(mesh_.facesAround(v).front()).cells[0]);
  }
  for (const CellId id : mesh_.cells()) {
    Vector3d mean = Vector3d::Zero();
    for (const VertexId v : mesh_.cell(id).vertices) mean += mesh_.restPosition(v);
    add(mean / mesh_.cell(id).vertices.size(), mesh_.cell(id).vertices, id);
  }
  for (const auto& [piece, signatures] : signatures_of_piece)
    outcome.pieces_missing += static_cast<int>(signatures.size()) - 1;
  if (is_convex_ && are_all_planes_) {
    for (const auto& [signature, apart] : pieces_of_signature)
      outcome.pieces_torn += static_cast<int>(apart.size()) - 1;
  }
}

void TortureBody::forgetFailedSeparator(const CuttingConfig& config) {
  const std::vector<Known> all = separators_;
  for (int i = static_cast<int>(all.size()) - 1; i >= 0; --i) {
    separators_ = all;
    separators_.erase(separators_.begin() + i);
    TortureOutcome without;
    compareWithSeparators(config, without);
    if (without.pieces_missing == 0) return;
  }
  separators_.clear();
}

void TortureBody::measureEdges(int first_new_vertex, const std::vector<NewVertex>& new_vertices,
                               TortureOutcome& outcome) const {
  outcome.shortest_edge = kInfinity;
  outcome.shortest_part = 1;
  for (const CellId id : mesh_.cells()) {
    for (const auto& [a, b] : mesh_.edges(id)) {
      const double length = relativeLength(mesh_, a, b);
      outcome.shortest_edge = std::min(outcome.shortest_edge, length);
    }
  }
  for (const NewVertex& made : new_vertices) {
    if (made.parents[0] == made.parents[1] || made.vertex.index() < first_new_vertex) continue;
    // The middle of a shut edge between two walls, which opens it, however short it is.
    if (made.weight == 0.5 && isOnWall(mesh_, made.parents[0]) && isOnWall(mesh_, made.parents[1])) continue;
    for (const VertexId parent : made.parents)
      outcome.shortest_part = std::min(outcome.shortest_part, relativeLength(mesh_, made.vertex, parent));
  }
}

TortureOutcome TortureBody::apply(const TortureCut& cut, const CuttingConfig& config) {
  TortureOutcome outcome;
  ++num_cuts_;
  const int first_new_vertex = mesh_.numVertices();
  const bool is_plane = std::holds_alternative<PlaneCut>(cut.operation) && !cut.deformation;
  std::vector<PlanePiece> parts;
  if (num_cuts_ == 1 && is_plane) parts = clipByPlane(mesh_, std::get<PlaneCut>(cut.operation));
  CutResult result;
  try {
    result = cut.is_progressive ? cutProgressively(cut, config, outcome) : cutAtOnce(cut, config);
  } catch (const std::invalid_argument&) {
    outcome.was_refused = true;
    return outcome;
  } catch (const std::exception& error) {
    outcome.violations.push_back(std::string("thrown: ") + error.what());
    return outcome;
  }
  outcome.was_refused = result.status == CutStatus::kRefused;
  outcome.status = result.status;
  outcome.splits = result.cells_split;
  outcome.left_whole = result.cells_left_whole;

  if (outcome.violations.empty()) outcome.violations = checkMesh(mesh_);
  if (!outcome.violations.empty()) return outcome;
  const int found = countPiecesByFloodFill(mesh_);
  if (findPieces(mesh_).count != found) outcome.violations.push_back("findPieces() is not the flood fill");
  if (result.pieces_after != found) outcome.violations.push_back("pieces_after is not the flood fill");
  if (mesh_.numVertices() - first_new_vertex != static_cast<int>(result.change.new_vertices.size()))
    outcome.violations.push_back("new_vertices are not the vertices that were added");
  for (const NewVertex& made : result.change.new_vertices)
    sizes_.push_back(std::max(sizes_[made.parents[0].index()], sizes_[made.parents[1].index()]));
  outcome.volume_error = volume(mesh_, mesh_.restPositions()) / volume_ - 1;
  measureEdges(first_new_vertex, result.change.new_vertices, outcome);

  if (!parts.empty()) {
    double largest = 0;
    for (int i = 0; i < first_new_vertex; ++i) largest = std::max(largest, mesh_.localSize(VertexId(i)));
    const PlaneComparison comparison = compareWithClipping(mesh_, parts, config.snap_tolerance * largest);
    if (comparison.missing > 0) outcome.violations.push_back("fewer pieces than exact clipping gives");
    if (comparison.spurious > 0) outcome.violations.push_back("more pieces than exact clipping gives");
    if (is_convex_) outcome.piece_volume_error = comparison.volume_error;
  }
  if (cut.is_repeat && was_last_complete_) outcome.pieces_torn += std::abs(found - pieces_);
  pieces_ = found;
  if (cut.separator && !outcome.was_refused)
    separators_.push_back({*cut.separator, cut.deformation, first_new_vertex});
  are_all_planes_ = are_all_planes_ && is_plane;
  compareWithSeparators(config, outcome);
  if (outcome.pieces_missing > 0) forgetFailedSeparator(config);
  was_last_complete_ = outcome.left_whole == 0 && outcome.pieces_missing == 0;
  // What is found once would be found after every later cut.
  if (outcome.pieces_missing > 0 || outcome.pieces_torn > 0) are_all_planes_ = false;
  return outcome;
}

}  // namespace polyscalpel
