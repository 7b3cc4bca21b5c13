// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/cut_mesh.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/cutting/blade_sweep.hpp"
#include "polyscalpel/cutting/crossings.hpp"
#include "polyscalpel/cutting/cut_input.hpp"
#include "polyscalpel/cutting/split_cells.hpp"
#include "polyscalpel/mesh/mesh_editing.hpp"

namespace polyscalpel {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Positions = Eigen::Ref<const Matrix3Xd>;

bool isAlwaysReady(CellId) {
  return true;
}

std::string plural(int count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

/// Rounds of remembering and splitting in one transaction on the mesh.
class CutTransaction {
 public:
  CutTransaction(PolyhedralMesh& mesh, Crossings& crossings, const CuttingConfig& config, int cut)
      : mesh_(mesh), editor_(mesh), crossings_(crossings), config_(config) {
    POLYSCALPEL_ASSERT(cut >= 1);
    result_.cut = cut;
  }

  void remember(const std::vector<Hit>& hits) {
    for (const Hit& hit : hits) crossings_.add(mesh_, hit, config_.snap_tolerance);
  }

  /// Splits what is ready. Returns what this round changed.
  MeshChange split(const std::function<bool(CellId)>& is_ready) {
    has_met_ |= !crossings_.isEmpty();
    const std::size_t savepoint = editor_.savepoint();
    SplitCounts counts = splitCells(editor_, crossings_, is_ready, config_.snap_tolerance, result_.cut);
    result_.cells_split += counts.cells_split;
    result_.cut_area_m2 += counts.cap_area_m2;
    left_whole_.insert(counts.left_whole.begin(), counts.left_whole.end());
    MeshChange change = editor_.changeSince(savepoint);
    if (!change.isEmpty()) crossings_.update(mesh_, change);
    return change;
  }

  /// Cells that could not be split, of all rounds.
  const std::set<CellId>& leftWhole() const { return left_whole_; }

  /// Commits. The numbers of pieces are left to the caller.
  CutResult finish(bool count_left_whole) {
    result_.change = editor_.commit();
    result_.status = !result_.change.isEmpty() ? CutStatus::kCut
                     : has_met_                ? CutStatus::kNothingSeparated
                                               : CutStatus::kMissed;
    if (count_left_whole) {
      // A cell may have been split after all in a later round.
      result_.cells_left_whole = static_cast<int>(std::count_if(
          left_whole_.begin(), left_whole_.end(), [&](CellId id) { return mesh_.cell(id).isAlive(); }));
    }
    return std::move(result_);
  }

 private:
  PolyhedralMesh& mesh_;
  MeshEditor editor_;
  Crossings& crossings_;
  const CuttingConfig& config_;
  CutResult result_;
  std::set<CellId> left_whole_;
  bool has_met_ = false;
};

void describe(CutResult& result) {
  switch (result.status) {
    case CutStatus::kMissed:
      result.message = "the blade does not meet the tissue";
      break;
    case CutStatus::kNothingSeparated:
      result.message = "the blade passes no cell whole";
      break;
    case CutStatus::kCut:
      result.message = plural(result.cells_split, "cell") + " split, " +
                       plural(result.pieces_before, "piece") + " before and " +
                       std::to_string(result.pieces_after) + " after";
      break;
  }
  if (result.cells_left_whole > 0)
    result.message += ", " + plural(result.cells_left_whole, "cell") + " left whole";
}

}  // namespace

struct BladeCut::Impl {
  Matrix3Xd edge_tool;
  CuttingConfig config;
  Crossings crossings;
  std::set<CellId> refused;   // could not be split; tried once more when the stroke ends
  std::optional<int> pieces;  // of the mesh as it was last seen

  void forget() {
    crossings.clear();
    refused.clear();
  }

  void complete(const PolyhedralMesh& mesh, int pieces_before, CutResult& result) {
    result.pieces_before = pieces_before;
    if (result.status == CutStatus::kCut) pieces = findPieces(mesh).count;
    result.pieces_after = *pieces;
    describe(result);
  }

  int countPieces(const PolyhedralMesh& mesh) {
    if (!pieces) pieces = findPieces(mesh).count;
    return *pieces;
  }

  /// Splits whatever the blade has passed, wherever it is.
  MeshChange splitAll(CutTransaction& transaction) {
    for (const CellId cell : refused) crossings.putBack(cell);
    return transaction.split(isAlwaysReady);
  }

  /// One motion within a transaction. Returns what it changed; sets has_left where it ended the stroke.
  MeshChange move(CutTransaction& transaction, const PolyhedralMesh& mesh, const BladeMotion& motion,
                  bool& has_left) {
    transaction.remember(findHits(mesh, motion, config.max_travel));
    has_left = false;
    if (crossings.isEmpty()) return {};
    const Matrix3Xd blade_world = motion.T_world_tool_end * edge_tool;
    if (!isBladeInTissue(mesh, motion.positions_end, blade_world, config.hold_back)) {
      has_left = true;
      return splitAll(transaction);
    }
    const int first_new = mesh.cellCapacity();
    std::unordered_map<CellId, bool> known;
    const auto isReady = [&](CellId id) {
      if (id.index() >= first_new) return true;  // a part of a cell that was
      const auto [place, is_new] = known.emplace(id, true);
      if (is_new) place->second = !isBladeAt(mesh, id, motion.positions_end, blade_world, config.hold_back);
      return place->second;
    };
    MeshChange change = transaction.split(isReady);
    refused.insert(transaction.leftWhole().begin(), transaction.leftWhole().end());
    return change;
  }
};

BladeCut::BladeCut(const Positions& edge_tool, const CuttingConfig& config)
    : impl_(std::make_unique<Impl>()) {
  validateBladeEdge(edge_tool);
  validate(config);
  impl_->edge_tool = edge_tool;
  impl_->config = config;
}

BladeCut::~BladeCut() = default;
BladeCut::BladeCut(BladeCut&&) noexcept = default;
BladeCut& BladeCut::operator=(BladeCut&&) noexcept = default;

CutResult BladeCut::advance(PolyhedralMesh& mesh, const Positions& positions_start,
                            const Positions& positions_end, const Isometry3d& T_world_tool_start,
                            const Isometry3d& T_world_tool_end, int cut) {
  // Exact arithmetic has no value for what is not finite, and ends the program.
  requireFinite("tool pose at the start", T_world_tool_start.matrix());
  requireFinite("tool pose at the end", T_world_tool_end.matrix());
  requireFinite("positions at the start", positions_start);
  requireFinite("positions at the end", positions_end);
  const int pieces_before = impl_->countPieces(mesh);
  CutTransaction transaction(mesh, impl_->crossings, impl_->config, cut);
  bool has_left = false;
  impl_->move(transaction, mesh,
              {impl_->edge_tool, T_world_tool_start, T_world_tool_end, positions_start, positions_end},
              has_left);
  CutResult result = transaction.finish(has_left);
  if (has_left) impl_->forget();
  impl_->complete(mesh, pieces_before, result);
  return result;
}

CutResult BladeCut::finish(PolyhedralMesh& mesh, const Positions&, int cut) {
  const int pieces_before = impl_->countPieces(mesh);
  CutTransaction transaction(mesh, impl_->crossings, impl_->config, cut);
  impl_->splitAll(transaction);
  CutResult result = transaction.finish(true);
  impl_->forget();
  impl_->complete(mesh, pieces_before, result);
  return result;
}

void BladeCut::forget() {
  impl_->forget();
}

void BladeCut::update(const PolyhedralMesh& mesh, const MeshChange& change) {
  impl_->crossings.update(mesh, change);
  impl_->pieces.reset();
}

int BladeCut::numPending() const {
  return static_cast<int>(impl_->crossings.edges().size());
}
bool BladeCut::isCutting() const {
  return !impl_->crossings.isEmpty();
}

CutResult cutMesh(PolyhedralMesh& mesh, const Positions& positions, const CutOperation& operation,
                  const CuttingConfig& config, int cut) {
  validate(config);
  std::visit([](const auto& value) { validate(value); }, operation);
  const int pieces_before = findPieces(mesh).count;

  CutResult result;
  if (const auto* sweep = std::get_if<SweepCut>(&operation)) {
    BladeCut::Impl stroke;
    stroke.edge_tool = sweep->edge_tool;
    stroke.config = config;
    CutTransaction transaction(mesh, stroke.crossings, config, cut);
    Matrix3Xd moved = positions;
    bool has_left = true;
    for (std::size_t i = 0; i + 1 < sweep->T_world_tool.size(); ++i) {
      const Positions still = moved;
      const MeshChange change = stroke.move(
          transaction, mesh,
          {stroke.edge_tool, sweep->T_world_tool[i], sweep->T_world_tool[i + 1], still, still}, has_left);
      extendByNewVertices(change.new_vertices, moved);
      if (has_left) stroke.forget();
    }
    if (!has_left) stroke.splitAll(transaction);
    result = transaction.finish(true);
  } else {
    Crossings crossings;
    CutTransaction transaction(mesh, crossings, config, cut);
    if (const auto* plane = std::get_if<PlaneCut>(&operation)) {
      transaction.remember(findHits(mesh, positions, *plane));
    } else {
      transaction.remember(findHits(mesh, positions, std::get<PolygonCut>(operation)));
    }
    transaction.split(isAlwaysReady);
    result = transaction.finish(true);
  }
  result.pieces_before = pieces_before;
  result.pieces_after = result.status == CutStatus::kCut ? findPieces(mesh).count : pieces_before;
  describe(result);
  return result;
}

}  // namespace polyscalpel
