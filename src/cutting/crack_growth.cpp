// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/crack_growth.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/cutting/crack_front.hpp"
#include "polyscalpel/cutting/crossings.hpp"
#include "polyscalpel/cutting/split_cells.hpp"
#include "polyscalpel/mesh/mesh_editing.hpp"

namespace polyscalpel {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Positions = Eigen::Ref<const Eigen::Matrix3Xd>;

/// How much the plane of a crack follows the stress, in squares of the cell's size: the front's vertices pull
/// it with the square of their distance. Below a tenth of the size the stress prevails.
constexpr double kStressWeight = 0.01;

constexpr double kPi = 3.14159265358979323846;

/// |cos| between a crack's normal and the principal direction, at least.
constexpr double kSmallestCosine = 0.5;

struct Plane {
  Vector3d point, normal;
};

/// A cell as the plane of a crack divides it.
class CrackedCell {
 public:
  CrackedCell(const PolyhedralMesh& mesh, const Positions& positions, const CellLoad& load,
              double snap_tolerance)
      : mesh_(mesh),
        positions_(positions),
        load_(load),
        snap_tolerance_(snap_tolerance),
        front_(findFront(mesh, load.cell)) {
    findPlane();
    for (const VertexId v : mesh.cell(load.cell).vertices) {
      const int side = sideOf(v);
      is_passed_[0] |= side < 0;
      is_passed_[1] |= side > 0;
    }
  }

  const CellFront& front() const { return front_; }

  /// Whether the crack may run as the stress asks for, and parts anything here.
  bool isDivided() const {
    return plane_.normal.dot(principal_direction_) >= kSmallestCosine &&
           (isPassedWhole() || !facesInPlane().empty());
  }

  /// Whether the plane has corners of the cell on both sides.
  bool isPassedWhole() const { return is_passed_[0] && is_passed_[1]; }

  /// Energy that the area of the crack frees [J/m^2]; see CrackGrowth.
  double energyRelease_j_m2() const {
    const Vector3d& normal = plane_.normal;
    const double density = 0.5 * (load_.elastic_stress_pa * normal).dot(load_.elastic_strain * normal);
    if (front_.slit == 0) {
      const auto [lowest, highest] = extentAlong(normal);
      return (highest - lowest) * density;
    }
    const Vector3d a = positions_.col(front_.edge.first.index()),
                   b = positions_.col(front_.edge.second.index());
    const Vector3d ahead = normal.cross(b - a).normalized();
    const auto [lowest, highest] = extentAlong(ahead);
    const double front = ahead.dot(a);
    return kPi * std::max(highest - front, front - lowest) * density;
  }

  /// The edges that the plane crosses, those at a vertex in the plane included. Where a face lies in the
  /// plane, also those of the cell behind it, which is then added to the ready ones.
  std::vector<Hit> findHits(std::set<CellId>& ready) const {
    std::vector<Hit> hits;
    for (const Edge& edge : mesh_.edges(load_.cell)) {
      const int first = sideOf(edge.first), second = sideOf(edge.second);
      if (first == second) continue;
      const double to_first = first == 0 ? 0 : std::abs(heightOf(edge.first));
      const double to_second = second == 0 ? 0 : std::abs(heightOf(edge.second));
      hits.push_back({edge, to_first / (to_first + to_second), second != 0 ? second : -first});
    }
    const int behind = is_passed_[1] ? -1 : 1;
    for (const FaceId id : facesInPlane()) {
      const CellId other = mesh_.neighbour(id, load_.cell);
      ready.insert(other);
      const auto& loop = mesh_.face(id).loop;
      const auto isInFace = [&](VertexId v) { return std::find(loop.begin(), loop.end(), v) != loop.end(); };
      for (const Edge& edge : mesh_.edges(other)) {
        if (isInFace(edge.first) == isInFace(edge.second)) continue;
        const bool starts_here = isInFace(edge.first);
        hits.push_back({edge, starts_here ? 0.0 : 1.0, starts_here ? behind : -behind});
      }
    }
    return hits;
  }

 private:
  /// Closest to the front's vertices, and across the principal direction where they leave it open: the
  /// eigenvector of the smallest eigenvalue, as of a least-squares plane.
  void findPlane() {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> principal(load_.stress_pa);
    principal_direction_ = principal.eigenvectors().col(2);
    const std::vector<VertexId>& vertices =
        front_.vertices.empty() ? mesh_.cell(load_.cell).vertices : front_.vertices;
    plane_.point.setZero();
    for (const VertexId v : vertices) plane_.point += positions_.col(v.index());
    plane_.point /= static_cast<double>(vertices.size());
    plane_.normal = principal_direction_;
    if (front_.vertices.empty()) return;
    const double size = mesh_.localSize(load_.cell);
    Matrix3d moments = -kStressWeight * size * size * principal_direction_ * principal_direction_.transpose();
    for (const VertexId v : vertices) {
      const Vector3d offset = positions_.col(v.index()) - plane_.point;
      moments += offset * offset.transpose();
    }
    plane_.normal = Eigen::SelfAdjointEigenSolver<Matrix3d>(moments).eigenvectors().col(0);
    if (plane_.normal.dot(principal_direction_) < 0) plane_.normal = -plane_.normal;
  }

  /// Lowest and highest coordinate of the cell's vertices.
  std::pair<double, double> extentAlong(const Vector3d& direction) const {
    double lowest = kInfinity, highest = -kInfinity;
    for (const VertexId v : mesh_.cell(load_.cell).vertices) {
      const double height = direction.dot(positions_.col(v.index()));
      lowest = std::min(lowest, height);
      highest = std::max(highest, height);
    }
    return {lowest, highest};
  }

  double heightOf(VertexId v) const { return plane_.normal.dot(positions_.col(v.index()) - plane_.point); }

  /// 0: on the front, or within the snap distance of the plane.
  int sideOf(VertexId v) const {
    if (std::binary_search(front_.vertices.begin(), front_.vertices.end(), v)) return 0;
    const double height = heightOf(v);
    if (std::abs(height) < snap_tolerance_ * mesh_.localSize(v)) return 0;
    return height > 0 ? 1 : -1;
  }

  /// Closed faces that lie in the plane, where the cell itself is on one side of it, and end at the front.
  std::vector<FaceId> facesInPlane() const {
    std::vector<FaceId> faces;
    if (isPassedWhole() || front_.slit == 0) return faces;
    for (const FaceId id : mesh_.cell(load_.cell).faces) {
      const Face& face = mesh_.face(id);
      if (face.isBoundary()) continue;
      if (std::any_of(face.loop.begin(), face.loop.end(), [&](VertexId v) { return sideOf(v) != 0; }))
        continue;
      bool is_at_front = false;
      for (std::size_t i = 0; i < face.loop.size(); ++i)
        is_at_front |= isOnCrackFront(mesh_, face.loop[i], face.loop[(i + 1) % face.loop.size()]);
      if (is_at_front) faces.push_back(id);
    }
    return faces;
  }

  const PolyhedralMesh& mesh_;
  Positions positions_;
  const CellLoad& load_;
  double snap_tolerance_;
  CellFront front_;
  Plane plane_;
  Vector3d principal_direction_;
  bool is_passed_[2] = {false, false};
};

const CellLoad* findLoad(const std::vector<CellLoad>& loads, CellId cell) {
  const auto place = std::lower_bound(loads.begin(), loads.end(), cell,
                                      [](const CellLoad& load, CellId id) { return load.cell < id; });
  return place != loads.end() && place->cell == cell ? &*place : nullptr;
}

std::string describe(const CutResult& result) {
  std::string text = "a crack " + std::string(result.cells_left_whole > 0 ? "is held up" : "runs");
  text += ": " + std::to_string(result.cells_split) + (result.cells_split == 1 ? " cell" : " cells") +
          " split, " + std::to_string(result.pieces_before) +
          (result.pieces_before == 1 ? " piece" : " pieces") + " before and " +
          std::to_string(result.pieces_after) + " after";
  if (result.cells_left_whole > 0) text += ", " + std::to_string(result.cells_left_whole) + " left whole";
  return text;
}

}  // namespace

void validate(const FractureConfig& config) {
  if (config.max_splits_per_step >= 1 && config.max_splits_per_step <= 1000000) return;
  throw std::invalid_argument("max_splits_per_step = " + std::to_string(config.max_splits_per_step) +
                              ": must be in [1, 1000000]");
}

CrackPlan CrackGrowth::plan(const PolyhedralMesh& mesh, const Positions& positions,
                            const std::vector<CellLoad>& loads) const {
  POLYSCALPEL_ASSERT(positions.cols() == mesh.numVertices());
  std::vector<std::pair<double, const CellLoad*>> strained;  // minus stress over strength
  for (const CellLoad& load : loads) {
    const double stress =
        Eigen::SelfAdjointEigenSolver<Matrix3d>(load.stress_pa, Eigen::EigenvaluesOnly).eigenvalues()[2];
    if (stress > load.strength_pa && refused_.count(load.cell) == 0)
      strained.emplace_back(-stress / load.strength_pa, &load);
  }
  std::sort(strained.begin(), strained.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : a.second->cell < b.second->cell;
  });
  CrackPlan plan;
  std::map<int, std::vector<CellId>> cells;  // by slit
  int count = 0;
  const CellLoad* start = nullptr;  // of a new crack
  for (const auto& [minus_ratio, load] : strained) {
    const CrackedCell cell(mesh, positions, *load, snap_tolerance_);
    if (!cell.isDivided() || cell.energyRelease_j_m2() < load->fracture_toughness_j_m2) continue;
    if (cell.front().slit == 0) {
      if (!start && !isNearFront(mesh, load->cell)) start = load;
      continue;
    }
    if (count == config_.max_splits_per_step) {
      plan.is_limited = true;
      break;
    }
    cells[cell.front().slit].push_back(load->cell);
    ++count;
  }
  if (count == 0 && start) cells[0].push_back(start->cell);
  for (auto& [slit, of_slit] : cells) plan.advances.push_back({slit, std::move(of_slit)});
  return plan;
}

CutResult CrackGrowth::grow(PolyhedralMesh& mesh, const Positions& positions, const CrackAdvance& advance,
                            const std::vector<CellLoad>& loads, int next_cut, MeshIndex& index) {
  const auto known = crack_of_slit_.find(advance.slit);
  CutResult result;
  result.cut = known == crack_of_slit_.end() ? next_cut : known->second;
  result.status = CutStatus::kNothingSeparated;
  result.pieces_before = result.pieces_after = index.pieces.count();

  MeshEditor editor(mesh);
  Eigen::Matrix3Xd moved = positions;
  for (const CellId id : advance.cells) {
    const CellLoad* load = findLoad(loads, id);
    POLYSCALPEL_ASSERT(load);
    if (!mesh.cell(id).isAlive()) continue;
    const CrackedCell cell(mesh, moved, *load, snap_tolerance_);
    // The split of a neighbour may have opened what was to be opened here.
    if (!cell.isDivided() || (advance.slit != 0 && cell.front().slit == 0)) continue;
    std::set<CellId> ready = {id};
    Crossings crossings;
    for (const Hit& hit : cell.findHits(ready)) crossings.add(mesh, hit, snap_tolerance_);
    const int first_new = mesh.cellCapacity();
    const std::size_t savepoint = editor.savepoint();
    const SplitCounts counts = splitCells(
        editor, crossings, [&](CellId c) { return c.index() >= first_new || ready.count(c) > 0; },
        snap_tolerance_, result.cut);
    if (counts.cap_area_m2 == 0 || !counts.left_whole.empty()) {
      editor.rollBackTo(savepoint);
      refused_.insert(id);
      ++result.cells_left_whole;
      continue;
    }
    extendByNewVertices(editor.changeSince(savepoint).new_vertices, moved);
    result.cells_split += counts.cells_split;
    result.cut_area_m2 += counts.cap_area_m2;
    result.status = CutStatus::kCut;
  }
  if (result.status == CutStatus::kCut) {
    result.change = editor.commit();
    index.update(mesh, result.change);
    result.pieces_after = index.pieces.count();
    if (advance.slit != 0) crack_of_slit_[advance.slit] = result.cut;
    crack_of_slit_[result.cut] = result.cut;
  }
  result.message = describe(result);
  return result;
}

void CrackGrowth::update(const MeshChange& change) {
  for (const CellId id : change.removed_cells) refused_.erase(id);
  for (const CellId id : change.changed_cells) refused_.erase(id);
}

}  // namespace polyscalpel
