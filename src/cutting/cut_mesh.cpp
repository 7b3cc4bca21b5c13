// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/cut_mesh.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <unordered_set>
#include <utility>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/cutting/blade_distance.hpp"
#include "polyscalpel/cutting/blade_sweep.hpp"
#include "polyscalpel/cutting/blade_way.hpp"
#include "polyscalpel/cutting/crossings.hpp"
#include "polyscalpel/cutting/cut_input.hpp"
#include "polyscalpel/cutting/front_closure.hpp"
#include "polyscalpel/cutting/split_cells.hpp"
#include "polyscalpel/mesh/mesh_editing.hpp"
#include "polyscalpel/mesh/mesh_index.hpp"

namespace polyscalpel {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Positions = Eigen::Ref<const Matrix3Xd>;

/// The last part of a motion, from which the direction is taken in which the blade arrives.
constexpr double kLatePart = 1.0 / 16;
/// A stroke goes on from a slit's front that is no further from the blade where it starts, in snap distances:
/// of two, one is the slit's sheet off its blade, and the other the front. From its walls it does within one,
/// as they may end a little behind the front.
constexpr double kTakeUpDistance = 2;
/// Snap tolerance along the blade where it stands, as part of the cut's: a nick little deeper than the snap
/// distance is to open.
constexpr double kNickSnap = 0.5;
/// Travel, in localSize, over which the direction of the blade is taken.
constexpr double kSteadyTravel = 0.1;

bool isAlwaysReady(CellId) {
  return true;
}

std::string plural(int count, const std::string& noun) {
  return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

void describe(CutResult& result) {
  switch (result.status) {
    case CutStatus::kMissed:
      result.message = "the blade does not meet the tissue";
      break;
    case CutStatus::kNothingSeparated:
      result.message = "the blade passes no cell whole";
      break;
    case CutStatus::kRefused:
      result.message = "the blade's way in one motion takes more than " + std::to_string(kMostSubSteps) +
                       " sub-steps of max_travel times the local cell size";
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

/// A mesh with its index under change: committed whole, or as it was.
class MeshTransaction {
 public:
  MeshTransaction(PolyhedralMesh& mesh, MeshIndex& index) : mesh_(mesh), editor(mesh), index(index) {}
  ~MeshTransaction() {
    // The mesh goes back to what it was; the tree has followed it on the way there only.
    if (!is_committed_ && editor.savepoint() > 0) index.tree.clear();
  }
  MeshTransaction(const MeshTransaction&) = delete;
  MeshTransaction& operator=(const MeshTransaction&) = delete;

  /// Commits what made a cut, and completes the result.
  CutResult end(CutResult result) {
    result.pieces_before = result.pieces_after = index.pieces.count();
    if (result.status == CutStatus::kCut) {
      result.change = editor.commit();
      is_committed_ = true;
      index.pieces.update(mesh_, result.change);
      result.pieces_after = index.pieces.count();
    }
    describe(result);
    return result;
  }

 private:
  PolyhedralMesh& mesh_;
  bool is_committed_ = false;

 public:
  MeshEditor editor;
  MeshIndex& index;
};

/// Rounds of remembering and splitting, one cut of a transaction.
class CutTransaction {
 public:
  CutTransaction(MeshTransaction& whole, Crossings& crossings, const CuttingConfig& config, int cut)
      : mesh_(whole.editor.mesh()),
        editor_(whole.editor),
        tree_(whole.index.tree),
        crossings_(crossings),
        config_(config) {
    POLYSCALPEL_ASSERT(cut >= 1);
    result_.cut = cut;
  }

  const CellTree& tree() const { return tree_; }
  std::size_t savepoint() const { return editor_.savepoint(); }
  MeshChange changeSince(std::size_t savepoint) const { return editor_.changeSince(savepoint); }

  void remember(const std::vector<Hit>& hits) {
    for (const Hit& hit : hits) crossings_.add(mesh_, hit, config_.snap_tolerance);
  }

  /// The motion is too long: nothing is cut.
  void refuse() { is_refused_ = true; }
  bool isRefused() const { return is_refused_; }

  /// Splits what is ready. Returns what this round changed.
  MeshChange split(const std::function<bool(CellId)>& is_ready) {
    has_met_ |= !crossings_.isEmpty();
    const std::size_t savepoint = editor_.savepoint();
    SplitCounts counts = splitCells(editor_, crossings_, is_ready, config_.snap_tolerance, result_.cut);
    result_.cells_split += counts.cells_split;
    result_.cut_area_m2 += counts.cap_area_m2;
    left_whole_.insert(counts.left_whole.begin(), counts.left_whole.end());
    MeshChange change = editor_.changeSince(savepoint);
    if (change.isEmpty()) return change;
    crossings_.update(mesh_, change);
    tree_.update(mesh_, change);
    return change;
  }

  /// Divides the cells in which the blade's surface ends; positions get the new vertices.
  void close(Matrix3Xd& positions, const std::vector<FrontSegment>& front, double surface_snap) {
    closeFront(editor_, tree_, crossings_, positions, front, config_.snap_tolerance, surface_snap);
  }

  /// Cells that could not be split, of all rounds.
  const std::set<CellId>& leftWhole() const { return left_whole_; }

  /// What it did, for the whole to be ended with. Cells that were only divided are no cut.
  CutResult finish(bool count_left_whole) {
    result_.status = is_refused_                                          ? CutStatus::kRefused
                     : result_.cells_split > 0 || result_.cut_area_m2 > 0 ? CutStatus::kCut
                     : has_met_                                           ? CutStatus::kNothingSeparated
                                                                          : CutStatus::kMissed;
    if (count_left_whole && !is_refused_) {
      // A cell may have been split after all in a later round.
      result_.cells_left_whole = static_cast<int>(std::count_if(
          left_whole_.begin(), left_whole_.end(), [&](CellId id) { return mesh_.cell(id).isAlive(); }));
    }
    return std::move(result_);
  }

 private:
  const PolyhedralMesh& mesh_;
  MeshEditor& editor_;
  CellTree& tree_;
  Crossings& crossings_;
  const CuttingConfig& config_;
  CutResult result_;
  std::set<CellId> left_whole_;
  bool has_met_ = false;
  bool is_refused_ = false;
};

}  // namespace

Eigen::Vector3d PolygonCut::areaVector() const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 1; i + 1 < corners_world.cols(); ++i) {
    const Eigen::Vector3d first = corners_world.col(i) - corners_world.col(0);
    sum += 0.5 * first.cross(corners_world.col(i + 1) - corners_world.col(0));
  }
  return sum;
}

struct BladeCut::Impl {
  Matrix3Xd edge_tool;
  CuttingConfig config;
  Crossings crossings;
  std::set<CellId> refused;            // could not be split; tried once more when the stroke ends
  std::optional<MeshIndex> own_index;  // where the caller keeps none: the pieces alone, without a tree
  std::optional<BladeFront> front;     // since the blade is in the tissue
  BladeWay way;                        // in the tissue
  std::optional<BladeTurn> turn;       // while the blade comes back in its own slit
  std::vector<VertexId> taken_up;      // of other slits, where the blade's way began
  double last_size = kInfinity;        // localSize around the blade, of when it had last crossed something
  double last_travel_in_sizes = 0;
  Matrix3Xd travel_since;  // of the blade relative to the tissue, not in front->travel_world yet

  void forget() {
    crossings.clear();
    refused.clear();
    front.reset();
    way.clear();
    turn.reset();
    taken_up.clear();
    last_size = kInfinity;
    last_travel_in_sizes = 0;
  }

  /// The tissue's own motion around what the blade has crossed and not yet split or opened, as a rigid one.
  Isometry3d tissueMotion(const BladeMotion& motion) const {
    std::set<VertexId> around;
    for (const auto& [edge, crossed] : crossings.edges()) around.insert({edge.first, edge.second});
    around.insert(crossings.openVertices().begin(), crossings.openVertices().end());
    Isometry3d tissue = Isometry3d::Identity();
    if (around.empty()) return tissue;
    Matrix3Xd from(3, around.size()), to(3, around.size());
    Eigen::Index i = 0;
    for (const VertexId v : around) {
      from.col(i) = motion.positions_start.col(v.index());
      to.col(i++) = motion.positions_end.col(v.index());
    }
    // Where fewer than three vertices tell of it, the best fit may turn about what they leave open.
    if (around.size() > 3 && from != to) {
      tissue.matrix() = Eigen::umeyama(from, to, false);
    } else {
      tissue.translation() = (to - from).rowwise().mean();
    }
    return tissue;
  }

  /// Follows the way of the blade relative to the tissue around it, which has moved by `tissue`.
  void followFront(const BladeMotion& motion, const Isometry3d& tissue) {
    const Matrix3Xd blade_world = motion.T_world_tool_end * edge_tool;
    if (!front) {
      front = BladeFront{blade_world, Matrix3Xd::Zero(3, edge_tool.cols()), 0};
      travel_since = Matrix3Xd::Zero(3, edge_tool.cols());
    }
    // The direction in which the blade arrives, and the whole way.
    const Isometry3d T_late = interpolate(motion.T_world_tool_start, motion.T_world_tool_end, 1 - kLatePart);
    const Matrix3Xd start_world = motion.T_world_tool_start * edge_tool;
    const Matrix3Xd drift = tissue * start_world - start_world;
    travel_since = tissue.linear() * travel_since;
    front->travel_world = tissue.linear() * front->travel_world;
    travel_since += (blade_world - T_late * edge_tool) / kLatePart - drift;
    const Matrix3Xd way = blade_world - start_world - drift;
    last_travel_in_sizes = way.colwise().norm().maxCoeff() / last_size;
    front->blade_world = blade_world;
    front->stroke_length_m += way.colwise().norm().maxCoeff();
    if (front->travel_world.isZero(0) ||
        travel_since.colwise().norm().maxCoeff() > kSteadyTravel * last_size) {
      front->travel_world = travel_since;
      travel_since.setZero();
    }
  }

  MeshIndex& indexOf(const PolyhedralMesh& mesh, MeshIndex* given) {
    if (given) {
      own_index.reset();  // it would not see this change
      return *given;
    }
    if (!own_index) own_index.emplace(mesh);
    return *own_index;
  }

  /// Splits whatever the blade has passed, wherever it is.
  MeshChange splitAll(CutTransaction& transaction) {
    for (const CellId cell : refused) crossings.putBack(cell);
    return transaction.split(isAlwaysReady);
  }

  /// Splits whatever the blade has passed, up to where it stands. moved: positions, which get the vertices
  /// that closing the front makes. Returns what the splits after that changed.
  MeshChange splitToFront(CutTransaction& transaction, Matrix3Xd& moved) {
    if (front)
      transaction.close(moved, makeFront(turn ? turn->front : *front), kNickSnap * config.snap_tolerance);
    return splitAll(transaction);
  }

  /// Whether the blade, which comes back, leaves its own slit by this motion for another way. Otherwise way
  /// and turn go with the tissue to the motion's end.
  bool turnsAside(const BladeMotion& motion) {
    if (!front) return false;
    const Matrix3Xd start_world = motion.T_world_tool_start * edge_tool,
                    end_world = motion.T_world_tool_end * edge_tool;
    const Isometry3d tissue = tissueMotion(motion);
    // As seen from the tissue before the motion.
    const Matrix3Xd end_seen = tissue.inverse() * end_world;
    if (!turn && !crossings.isEmpty() && BladeTurn::startsAt(*front, end_seen - start_world)) {
      turn = BladeTurn{*front, motion.T_world_tool_start};
      way.goOn(start_world, 0);
    }
    if (turn && turn->isPassedBy(end_seen)) {
      front->travel_world = turn->front.travel_world;
      turn.reset();
    } else if (turn && way.distance(end_seen) > config.snap_tolerance * last_size) {
      return true;
    }
    way.follow(tissue);
    if (!turn) {
      way.goOn(end_world, kSteadyTravel * last_size);
      return false;
    }
    turn->follow(tissue);
    if ((end_world - turn->T_in_slit * edge_tool).colwise().norm().maxCoeff() > last_size)
      turn->T_in_slit = motion.T_world_tool_end;
    return false;
  }

  /// The slit ends where the blade has turned, and a new stroke begins where it was last in that slit: two
  /// sheets of one stroke that meet within a cell would have it hang together between them. positions: where
  /// the motion starts that leaves the slit; they get columns for the new vertices.
  void beginAnew(CutTransaction& transaction, const PolyhedralMesh& mesh, const BladeMotion& motion,
                 Matrix3Xd& positions, bool& has_left) {
    extendByNewVertices(splitToFront(transaction, positions).new_vertices, positions);
    const Isometry3d T_in_slit = turn->T_in_slit;
    forget();
    if (T_in_slit.isApprox(motion.T_world_tool_start, 0)) return;
    const Matrix3Xd still = positions;
    const MeshChange change =
        moveOn(transaction, mesh, {edge_tool, T_in_slit, motion.T_world_tool_start, still, still}, has_left);
    extendByNewVertices(change.new_vertices, positions);
  }

  /// One motion within a transaction. Returns what it changed; sets has_left where it ended the stroke.
  MeshChange move(CutTransaction& transaction, const PolyhedralMesh& mesh, const BladeMotion& motion,
                  bool& has_left) {
    if (!turnsAside(motion)) return moveOn(transaction, mesh, motion, has_left);
    const std::size_t savepoint = transaction.savepoint();
    Matrix3Xd start = motion.positions_start, end = motion.positions_end;
    beginAnew(transaction, mesh, motion, start, has_left);
    if (transaction.isRefused()) return {};
    extendByNewVertices(transaction.changeSince(savepoint).new_vertices, end);
    moveOn(transaction, mesh, {edge_tool, motion.T_world_tool_start, motion.T_world_tool_end, start, end},
           has_left);
    return transaction.changeSince(savepoint);
  }

  /// As move(), of a blade that goes on or comes back in its own slit.
  MeshChange moveOn(CutTransaction& transaction, const PolyhedralMesh& mesh, const BladeMotion& motion,
                    bool& has_left) {
    const std::optional<std::vector<Hit>> hits =
        findHits(mesh, transaction.tree(), motion, config.max_travel);
    has_left = !hits;
    if (!hits) {
      transaction.refuse();
      return {};
    }
    if (!front) {
      const Matrix3Xd start_world = motion.T_world_tool_start * edge_tool;
      way.goOn(start_world, 0);
      way.goOn(motion.T_world_tool_end * edge_tool, 0);
      taken_up = slitAtBlade(mesh, transaction.tree(), motion.positions_start, start_world,
                             config.snap_tolerance, kTakeUpDistance * config.snap_tolerance);
    }
    if (!hits->empty()) {
      // Before the hits, which would say of a vertex at the blade on which side of it it lies: by rounding.
      for (const VertexId v : taken_up) crossings.takeUp(mesh, v);
      taken_up.clear();
      last_size = kInfinity;
      for (const Hit& hit : *hits)
        last_size = std::min({last_size, mesh.localSize(hit.edge.first), mesh.localSize(hit.edge.second)});
    }
    transaction.remember(*hits);
    const Matrix3Xd blade_world = motion.T_world_tool_end * edge_tool;
    const std::unordered_set<CellId> held =
        cellsAtBlade(mesh, transaction.tree(), motion.positions_end, blade_world, config.hold_back);
    followFront(motion, tissueMotion(motion));
    has_left = held.empty();
    if (has_left) return splitAll(transaction);
    // Parts of a cell that was ready are, too: they are not among the held ones.
    MeshChange change = transaction.split([&](CellId id) { return held.count(id) == 0; });
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
                            const Isometry3d& T_world_tool_end, int cut, MeshIndex* index) {
  // Exact arithmetic has no value for what is not finite, and ends the program.
  requireFinite("tool pose at the start", T_world_tool_start.matrix());
  requireFinite("tool pose at the end", T_world_tool_end.matrix());
  requireFinite("positions at the start", positions_start);
  requireFinite("positions at the end", positions_end);
  MeshTransaction whole(mesh, impl_->indexOf(mesh, index));
  CutTransaction transaction(whole, impl_->crossings, impl_->config, cut);
  bool has_left = false;
  impl_->move(transaction, mesh,
              {impl_->edge_tool, T_world_tool_start, T_world_tool_end, positions_start, positions_end},
              has_left);
  CutResult result = transaction.finish(has_left);
  // What is remembered goes on from here, so divisions stay even where they were of no use. A motion that is
  // refused has made none: not that of the front where the blade has turned before, either.
  if (!transaction.isRefused() && whole.editor.savepoint() > 0) result.status = CutStatus::kCut;
  result = whole.end(std::move(result));
  if (has_left) impl_->forget();
  return result;
}

CutResult BladeCut::closeFront(PolyhedralMesh& mesh, const Positions& positions, int cut, MeshIndex* index) {
  const Crossings crossings_before = impl_->crossings;
  MeshTransaction whole(mesh, impl_->indexOf(mesh, index));
  CutTransaction transaction(whole, impl_->crossings, impl_->config, cut);
  Matrix3Xd moved = positions;
  impl_->splitToFront(transaction, moved);
  CutResult result = whole.end(transaction.finish(true));
  if (result.status != CutStatus::kCut) impl_->crossings = crossings_before;
  return result;
}

CutResult BladeCut::finish(PolyhedralMesh& mesh, const Positions& positions, int cut, MeshIndex* index) {
  CutResult result = closeFront(mesh, positions, cut, index);
  impl_->forget();
  return result;
}

void BladeCut::forget() {
  impl_->forget();
}

void BladeCut::update(const PolyhedralMesh& mesh, const MeshChange& change) {
  impl_->crossings.update(mesh, change);
  impl_->own_index.reset();
}

int BladeCut::numPending() const {
  return static_cast<int>(impl_->crossings.edges().size());
}

Matrix3Xd BladeCut::pendingPoints(const Positions& positions) const {
  std::vector<std::pair<Edge, double>> weights;
  for (const auto& [edge, crossed] : impl_->crossings.edges()) weights.emplace_back(edge, crossed.weight);
  std::sort(weights.begin(), weights.end());
  Matrix3Xd points(3, weights.size());
  Eigen::Index i = 0;
  for (const auto& [edge, weight] : weights) {
    points.col(i++) =
        (1 - weight) * positions.col(edge.first.index()) + weight * positions.col(edge.second.index());
  }
  return points;
}

double BladeCut::travelInSizes() const {
  return impl_->last_travel_in_sizes;
}
bool BladeCut::isCutting() const {
  return !impl_->crossings.isEmpty();
}

namespace {

/// One operation of a transaction. moved: positions of all vertices, which gets those of new ones.
CutResult cutOnce(MeshTransaction& whole, Matrix3Xd& moved, const CutOperation& operation,
                  const CuttingConfig& config, int cut) {
  const PolyhedralMesh& mesh = whole.editor.mesh();
  BladeCut::Impl stroke;
  stroke.config = config;
  CutTransaction transaction(whole, stroke.crossings, config, cut);
  const auto follow = [&](const MeshChange& change) { extendByNewVertices(change.new_vertices, moved); };
  if (const auto* sweep = std::get_if<SweepCut>(&operation)) {
    stroke.edge_tool = sweep->edge_tool;
    bool has_left = true;
    for (std::size_t i = 0; i + 1 < sweep->T_world_tool.size(); ++i) {
      // At rest, and one column for each vertex that the mesh has as the motion starts.
      const MeshChange change = stroke.move(
          transaction, mesh,
          {stroke.edge_tool, sweep->T_world_tool[i], sweep->T_world_tool[i + 1], moved, moved}, has_left);
      follow(change);
      if (transaction.isRefused()) break;
      if (has_left) stroke.forget();
    }
    if (!has_left) follow(stroke.splitToFront(transaction, moved));
  } else if (const auto* polygon = std::get_if<PolygonCut>(&operation)) {
    // The parts of divided cells are then searched as all others: of their new edges, those in the border
    // alone are remembered as it is closed, and others may lie beyond a corner that points inwards. Both are
    // snapped alike, so that the slits of two polygons meet where their borders do.
    const std::vector<FrontSegment> border = makeFront(*polygon);
    transaction.close(moved, border, config.snap_tolerance);
    transaction.remember(findHits(mesh, transaction.tree(), moved, *polygon));
    const std::unordered_set<CellId> beyond =
        cellsBeyond(mesh, transaction.tree(), stroke.crossings, moved, border, config.snap_tolerance);
    follow(transaction.split([&](CellId id) { return beyond.count(id) == 0; }));
  } else {
    transaction.remember(findHits(mesh, transaction.tree(), moved, std::get<PlaneCut>(operation)));
    follow(transaction.split(isAlwaysReady));
  }
  return transaction.finish(true);
}

}  // namespace

CutResult cutMesh(PolyhedralMesh& mesh, const Positions& positions,
                  const std::vector<CutOperation>& operations, const CuttingConfig& config, int cut,
                  MeshIndex* given_index) {
  validate(config);
  validate(operations);
  std::optional<MeshIndex> own_index;
  if (!given_index) own_index.emplace(mesh);
  MeshIndex& index = given_index ? *given_index : *own_index;
  // Many searches, of a sweep's steps and of a polygon's sides: a tree pays.
  const bool searches = std::any_of(operations.begin(), operations.end(), [](const CutOperation& operation) {
    return !std::holds_alternative<PlaneCut>(operation);
  });
  if (searches && index.tree.isEmpty()) index.tree.fit(mesh, positions);

  MeshTransaction whole(mesh, index);
  Matrix3Xd moved = positions;
  CutResult result;
  for (std::size_t i = 0; i < operations.size(); ++i) {
    CutResult one = cutOnce(whole, moved, operations[i], config, cut + static_cast<int>(i));
    if (one.status != CutStatus::kCut) {
      one.cut = cut;
      one = whole.end(std::move(one));
      if (operations.size() > 1) {
        one.message = "cut " + std::to_string(i + 1) + " of " + std::to_string(operations.size()) + ": " +
                      one.message + "; none of them is made";
      }
      return one;  // the editor undoes what the ones before it did
    }
    result.cells_split += one.cells_split;
    result.cells_left_whole += one.cells_left_whole;
    result.cut_area_m2 += one.cut_area_m2;
  }
  result.status = CutStatus::kCut;
  result.cut = cut;
  result.num_cuts = static_cast<int>(operations.size());
  return whole.end(std::move(result));
}

CutResult cutMesh(PolyhedralMesh& mesh, const Positions& positions, const CutOperation& operation,
                  const CuttingConfig& config, int cut, MeshIndex* index) {
  return cutMesh(mesh, positions, std::vector<CutOperation>{operation}, config, cut, index);
}

}  // namespace polyscalpel
