// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "polyscalpel/collision/contact_detection.hpp"
#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/core/stage_timer.hpp"
#include "polyscalpel/cutting/blade_sweep.hpp"
#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/mesh/mesh_editing.hpp"
#include "polyscalpel/mesh/mesh_index.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "polyscalpel/simulation/cut_balance.hpp"
#include "polyscalpel/simulation/equilibrium.hpp"
#include "polyscalpel/simulation/mesh_quality.hpp"
#include "polyscalpel/simulation/piece_table.hpp"
#include "polyscalpel/simulation/regions.hpp"
#include "polyscalpel/simulation/simulation_state.hpp"
#include "polyscalpel/simulation/time_integration.hpp"
#include "scene_mesh.hpp"

namespace polyscalpel {

namespace {

using ToolPoses = std::vector<std::optional<Eigen::Isometry3d>>;

struct Sphere {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // in the tool's frame [m]
  double radius = 0;
};

Sphere boundingSphere(const Eigen::Matrix3Xd& points) {
  Sphere sphere;
  if (points.cols() == 0) return sphere;
  sphere.centre = (points.rowwise().minCoeff() + points.rowwise().maxCoeff()) / 2;
  sphere.radius = (points.colwise() - sphere.centre).colwise().norm().maxCoeff();
  return sphere;
}

struct Tool {
  std::optional<ToolShape> shape;  // where the scene has contact
  Sphere bounds;                   // of the shape; a point at the origin without
  std::optional<BladeCut> blade;
  std::optional<Eigen::Isometry3d> T_world_tool;  // at the end of the last step
  int cut = 0;  // number of the stroke under way, 0 before it has split anything
  // The blade's travel since it last moved for sure, and for how long that has been.
  double rest_travel_in_sizes = 0, rest_s = 0;
  bool is_front_closed = false;
};

// Longest way of any part of the tool: its origin, its blade, its shape's bounding sphere.
double longestWay(const Tool& tool, const ToolConfig& config, const Eigen::Isometry3d& T_start,
                  const Eigen::Isometry3d& T_end) {
  const auto way = [&](const Eigen::Vector3d& point) { return (T_end * point - T_start * point).norm(); };
  double longest = way(Eigen::Vector3d::Zero());
  if (config.blade_edge_tool) {
    for (Eigen::Index i = 0; i < config.blade_edge_tool->cols(); ++i) {
      longest = std::max(longest, way(config.blade_edge_tool->col(i)));
    }
  }
  const Eigen::Matrix3d turn = T_end.linear() - T_start.linear();  // its norm on vectors is 2 sin(angle / 2)
  return std::max(longest, way(tool.bounds.centre) + tool.bounds.radius * turn.norm() / std::sqrt(2.0));
}

void requirePose(std::size_t tool, const Eigen::Isometry3d& pose) {
  const std::string name = "T_world_tool[" + std::to_string(tool) + "]";
  requireFinite(name, pose.matrix());
  constexpr double kOrthonormal = 1e-6;
  const Eigen::Matrix3d R = pose.linear();
  if ((R.transpose() * R - Eigen::Matrix3d::Identity()).norm() > kOrthonormal || R.determinant() < 0) {
    throw std::invalid_argument(name + ": its linear part must be a rotation to within 1e-6");
  }
}

const char* nameOf(AnalysisMode mode) {
  switch (mode) {
    case AnalysisMode::kDynamic:
      return "dynamics";
    case AnalysisMode::kQuasiStatic:
      return "quasi-statics";
    case AnalysisMode::kStatic:
      return "statics";
  }
  POLYSCALPEL_ASSERT(false);
  return "";
}

double pointEnergy(const Eigen::Matrix3Xd& momenta, const SimulationState& state,
                   const Eigen::VectorXd& masses, const Eigen::Vector3d& gravity) {
  double energy = 0;
  for (Eigen::Index i = 0; i < momenta.cols(); ++i) {
    energy +=
        0.5 * momenta.col(i).dot(state.velocities.col(i)) - masses[i] * gravity.dot(state.positions.col(i));
  }
  return energy;
}

}  // namespace

struct Simulation::Impl {
  SimulationConfig config;
  std::vector<std::string> parts, remarks;
  std::vector<Tool> tools;

  // As made; reset() copies them back.
  PolyhedralMesh pristine_mesh;
  SimulationState pristine_state;
  std::optional<Assembly> pristine_assembly;
  std::optional<QualityMonitor> pristine_quality;  // scenes with cutting
  double rest_volume = 0;

  PolyhedralMesh mesh;
  SimulationState state;
  std::optional<Assembly> assembly;
  std::optional<ImplicitEuler> integrator;  // dynamic scenes
  std::optional<TissueSurface> surface;     // scenes with contact
  MeshIndex index;
  std::vector<PieceProperties> piece_table;
  std::optional<QualityMonitor> quality;
  Debris debris;  // all of it, without the changes
  std::int64_t step_count = 0;
  int num_cuts = 0;
  int cells_left_whole = 0;
  bool static_solution_stands = false;
  double static_residual = 0;
  std::optional<StressField> stress;

  explicit Impl(const SimulationConfig& given) : config(given) {
    validate(config);
    MeshFile file = makeSceneMesh(config.mesh);
    remarks = std::move(file.remarks);
    pristine_mesh = std::move(file.mesh);
    rest_volume = volume(pristine_mesh, pristine_mesh.restPositions());
    pristine_state = makeRestState(pristine_mesh, config.fixed);
    pristine_assembly.emplace(pristine_mesh, makeCellKinds(pristine_mesh, config, file.region_names),
                              config.integration.mass_floor);
    if (config.cutting) pristine_quality.emplace(pristine_mesh, *pristine_assembly);
    parts = {"mesh", "elements", nameOf(config.integration.mode)};
    bool has_shape = false;
    for (const ToolConfig& tool_config : config.tools) {
      Tool tool;
      if (config.contact && tool_config.shape) {
        tool.shape.emplace(*tool_config.shape);
        tool.bounds = boundingSphere(tool.shape->triangles());
        has_shape = true;
      }
      tools.push_back(std::move(tool));
    }
    if (has_shape) parts.push_back("contact");
    if (config.cutting) parts.push_back("cutting");
    if (!tools.empty()) parts.push_back("tools");
    if (config.stress) parts.push_back("stress");
    reset();
  }

  bool isDynamic() const { return config.integration.mode == AnalysisMode::kDynamic; }
  bool hasContact() const { return std::find(parts.begin(), parts.end(), "contact") != parts.end(); }

  void reset() {
    mesh = pristine_mesh;
    state = pristine_state;
    assembly = pristine_assembly;
    index = MeshIndex(mesh);
    quality = pristine_quality;
    debris = Debris();
    countPieces();
    step_count = 0;
    num_cuts = 0;
    cells_left_whole = 0;
    static_solution_stands = false;
    stress.reset();
    if (isDynamic()) integrator.emplace(config.integration);
    if (hasContact()) surface.emplace(mesh, state.positions);
    for (std::size_t i = 0; i < tools.size(); ++i) {
      tools[i].T_world_tool.reset();
      tools[i].cut = 0;
      tools[i].rest_travel_in_sizes = tools[i].rest_s = 0;
      tools[i].is_front_closed = false;
      if (config.tools[i].blade_edge_tool)
        tools[i].blade.emplace(*config.tools[i].blade_edge_tool, *config.cutting);
    }
  }

  std::vector<LinearisedContact> findContacts(const ToolPoses& T_end, StepReport& report);
  void applyContactForces(const std::vector<LinearisedContact>& contacts,
                          const std::vector<Eigen::Vector3d>& forces, const ToolPoses& T_end,
                          StepReport& report);
  void moveBlades(const ToolPoses& T_end, Eigen::Matrix3Xd& positions_start, StepReport& report);
  void countPieces() { piece_table = measurePieces(mesh, index.pieces.pieces(), *assembly); }
  void commit(int tool, CutResult result, Eigen::Matrix3Xd* positions_start, StepReport& report);
  void followChange(int tool, const MeshChange& change);
  CutEvent followCut(int tool, CutResult result);
  Debris removeDebris();
  bool comesToRest(Tool& tool) const;
  Eigen::Vector3d cuttingResistance(int tool, const CutResult& result,
                                    const Eigen::Matrix3Xd& positions_start, const Eigen::Isometry3d& T_start,
                                    const Eigen::Isometry3d& T_end) const;
  Eigen::Vector3d bladeMiddle(int tool) const { return config.tools[tool].blade_edge_tool->rowwise().mean(); }
  bool hasBlade() const {
    return std::any_of(tools.begin(), tools.end(), [](const Tool& tool) { return tool.blade.has_value(); });
  }
  void finishMotion(const std::vector<LinearisedContact>& contacts,
                    const std::vector<Eigen::Vector3d>& forces, const ToolPoses& T_end,
                    Eigen::Matrix3Xd& positions_start, StepReport& report);
  bool stepDynamic(const ToolPoses& T_end, StepReport& report);
  bool stepStatic(const ToolPoses& T_end, StepReport& report);
  void recoverStressWhenDue(StepReport& report);
};

// Contacts at the current positions with the tools where they will be at the end of the step, linearised. The
// tool's material point under a contact moves with the rigid motion from the tool's start to its end.
std::vector<LinearisedContact> Simulation::Impl::findContacts(const ToolPoses& T_end, StepReport& report) {
  std::vector<LinearisedContact> linearised;
  if (!surface) return linearised;
  const double h = config.integration.time_step_s;
  bool is_refitted = false;
  for (std::size_t i = 0; i < tools.size(); ++i) {
    if (!tools[i].shape || !T_end[i] || report.tools[i].reseated) continue;
    std::vector<Contact> contacts;
    {
      const StageTimer timer(report.times.detection_s);
      if (!is_refitted) surface->refit(mesh, state.positions);
      is_refitted = true;
      contacts =
          surface->findContacts(mesh, state.positions, *tools[i].shape, *T_end[i], config.contact->margin_m);
    }
    const StageTimer timer(report.times.contact_s);
    for (const Contact& contact : contacts) {
      Eigen::Vector3d velocity_tissue = Eigen::Vector3d::Zero();
      for (const WeightedVertex& w : contact.weights) {
        velocity_tissue += w.weight * state.velocities.col(w.vertex.index());
      }
      const Eigen::Vector3d point_start =
          *tools[i].T_world_tool * (T_end[i]->inverse() * contact.point_world);
      const Eigen::Vector3d velocity_tool = (contact.point_world - point_start) / h;
      const LinearisedContact candidate =
          lineariseContact(contact, static_cast<int>(i), velocity_tissue, velocity_tool, h, *config.contact);
      if (candidate.force_0.isZero(0) && candidate.B.isZero(0)) continue;  // the gap stays open
      linearised.push_back(candidate);
    }
  }
  return linearised;
}

void Simulation::Impl::applyContactForces(const std::vector<LinearisedContact>& contacts,
                                          const std::vector<Eigen::Vector3d>& forces, const ToolPoses& T_end,
                                          StepReport& report) {
  if (contacts.empty()) return;
  const StageTimer timer(report.times.contact_s);
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    if (forces[c].isZero(0)) continue;
    const Contact& contact = contacts[c].contact;
    const int tool = contacts[c].tool;
    report.contacts.push_back({tool, contact.face, contact.point_world, forces[c], contact.gap_m});
    addReaction(report.tools[tool].wrench_tool, forces[c], contact.point_world, *T_end[tool]);
  }
}

// Everything downstream of the mesh refreshes from the change. tool: whose blade made it and knows it, -1 for
// none.
void Simulation::Impl::followChange(int tool, const MeshChange& change) {
  applyMeshChange(state, change);
  assembly->update(mesh, change);
  if (quality) quality->update(mesh, *assembly, change);
  if (integrator) integrator->restart();
  if (surface) surface->update(mesh, change, state.positions);
  for (std::size_t i = 0; i < tools.size(); ++i) {
    if (static_cast<int>(i) != tool && tools[i].blade) tools[i].blade->update(mesh, change);
  }
  countPieces();
  static_solution_stands = false;
  stress.reset();
}

Debris Simulation::Impl::removeDebris() {
  Debris removed;
  const Pieces& pieces = index.pieces.pieces();
  const std::vector<CellId> cells = findDebris(mesh, pieces, piece_table, config.cutting->debris_volume_m3);
  if (cells.empty()) return removed;
  std::set<int> numbers;
  for (const CellId cell : cells) numbers.insert(pieces.piece_of_cell[cell.index()]);
  for (const int piece : numbers) {
    ++removed.num_pieces;
    removed.volume_m3 += piece_table[piece].volume_m3;
    removed.mass_kg += piece_table[piece].mass_kg;
  }
  MeshEditor editor(mesh);
  editor.removeCells(cells);
  removed.change = editor.commit();
  index.update(mesh, removed.change);
  followChange(-1, removed.change);
  debris.num_pieces += removed.num_pieces;
  debris.volume_m3 += removed.volume_m3;
  debris.mass_kg += removed.mass_kg;
  return removed;
}

CutEvent Simulation::Impl::followCut(int tool, CutResult result) {
  CutEvent event;
  event.tool = tool;
  const CutLedger ledger(state, *assembly, result.change, isDynamic());
  followChange(tool, result.change);
  event.balance = ledger.settle(mesh, result.change, *assembly, state);
  num_cuts = std::max(num_cuts, result.cut + result.num_cuts - 1);
  cells_left_whole += result.cells_left_whole;
  event.debris = removeDebris();
  event.pieces = piece_table;
  event.result = std::move(result);
  return event;
}

void Simulation::Impl::commit(int tool, CutResult result, Eigen::Matrix3Xd* positions_start,
                              StepReport& report) {
  if (result.status != CutStatus::kCut) return;
  const StageTimer timer(report.times.update_s);
  if (positions_start) extendByNewVertices(result.change.new_vertices, *positions_start);
  report.cuts.push_back(followCut(tool, std::move(result)));
}

// The work of fracture, toughness times new area, over the blade's travel relative to the tissue it has just
// opened, and against that travel. World frame [N]; zero without travel.
Eigen::Vector3d Simulation::Impl::cuttingResistance(int tool, const CutResult& result,
                                                    const Eigen::Matrix3Xd& positions_start,
                                                    const Eigen::Isometry3d& T_start,
                                                    const Eigen::Isometry3d& T_end) const {
  if (result.change.new_vertices.empty()) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d middle = bladeMiddle(tool);
  Eigen::Vector3d travel = T_end * middle - T_start * middle;
  Eigen::Vector3d tissue = Eigen::Vector3d::Zero();
  for (const NewVertex& vertex : result.change.new_vertices) {
    tissue += state.positions.col(vertex.vertex.index()) - positions_start.col(vertex.vertex.index());
  }
  travel -= tissue / static_cast<double>(result.change.new_vertices.size());
  // Below this the direction of the travel is rounding.
  constexpr double kNoTravel = 1e-9;  // [m]
  const double length = travel.norm();
  if (length < kNoTravel) return Eigen::Vector3d::Zero();
  return -config.cutting->fracture_toughness_j_m2 * result.cut_area_m2 / length * (travel / length);
}

// positions_start: of the tissue before the step; gets new vertices too.
void Simulation::Impl::moveBlades(const ToolPoses& T_end, Eigen::Matrix3Xd& positions_start,
                                  StepReport& report) {
  for (std::size_t i = 0; i < tools.size(); ++i) {
    if (!tools[i].blade) continue;
    const int tool = static_cast<int>(i);
    BladeCut& blade = *tools[i].blade;
    const int cut = tools[i].cut > 0 ? tools[i].cut : num_cuts + 1;
    const bool sweeps = T_end[i] && !report.tools[i].reseated;
    CutResult result;
    {
      const StageTimer timer(report.times.cutting_s);
      if (sweeps) {
        index.tree.fit(mesh, positions_start, state.positions,
                       reachOf(*config.tools[i].blade_edge_tool, *tools[i].T_world_tool, *T_end[i]));
        result = blade.advance(mesh, positions_start, state.positions, *tools[i].T_world_tool, *T_end[i], cut,
                               &index);
      } else if (tools[i].T_world_tool) {
        result = blade.finish(mesh, state.positions, cut, &index);  // it has gone, or was taken elsewhere
      }
      report.tools[i].pending_crossings = blade.numPending();
    }
    if (result.status == CutStatus::kRefused) report.tools[i].refusal = result.message;
    if (result.status == CutStatus::kCut) tools[i].cut = cut;
    if (!blade.isCutting()) tools[i].cut = 0;
    const std::size_t num_events = report.cuts.size();
    commit(tool, std::move(result), &positions_start, report);
    if (sweeps && report.cuts.size() > num_events) {
      const Eigen::Vector3d on_blade = cuttingResistance(tool, report.cuts.back().result, positions_start,
                                                         *tools[i].T_world_tool, *T_end[i]);
      addReaction(report.tools[i].wrench_tool, -on_blade, *T_end[i] * bladeMiddle(tool), *T_end[i]);
    }
    if (sweeps && comesToRest(tools[i])) {
      CutResult closed;
      {
        const StageTimer timer(report.times.cutting_s);
        index.tree.fit(mesh, state.positions);
        closed = blade.closeFront(mesh, state.positions, cut, &index);
        report.tools[i].pending_crossings = blade.numPending();
      }
      if (closed.status == CutStatus::kCut) tools[i].cut = cut;
      commit(tool, std::move(closed), &positions_start, report);
    }
  }
}

// Whether the blade has just come to rest, so that the slit is to reach up to it.
bool Simulation::Impl::comesToRest(Tool& tool) const {
  constexpr double kRestTravel = 0.02;  // in local sizes: less than this is a hand's tremor
  tool.rest_travel_in_sizes += tool.blade->travelInSizes();
  tool.rest_s += config.integration.time_step_s;
  if (tool.rest_travel_in_sizes > kRestTravel || !tool.blade->isCutting()) {
    tool.rest_travel_in_sizes = tool.rest_s = 0;
    tool.is_front_closed = false;
  }
  if (tool.is_front_closed || tool.rest_s < config.cutting->close_front_after_s) return false;
  tool.is_front_closed = tool.blade->isCutting();
  return tool.is_front_closed;
}

// After the tissue has moved: forces on the tools, blades, and the tools' own poses.
void Simulation::Impl::finishMotion(const std::vector<LinearisedContact>& contacts,
                                    const std::vector<Eigen::Vector3d>& forces, const ToolPoses& T_end,
                                    Eigen::Matrix3Xd& positions_start, StepReport& report) {
  applyContactForces(contacts, forces, T_end, report);
  if (hasBlade()) moveBlades(T_end, positions_start, report);
  for (std::size_t i = 0; i < tools.size(); ++i) tools[i].T_world_tool = T_end[i];
}

bool Simulation::Impl::stepDynamic(const ToolPoses& T_end, StepReport& report) {
  const std::vector<LinearisedContact> contacts = findContacts(T_end, report);
  Eigen::Matrix3Xd positions_start;
  if (hasBlade()) positions_start = state.positions;
  const IntegrationResult result = integrator->step(state, *assembly, contacts);
  report.relative_residual = result.relative_residual;
  report.solves = result.solves;
  report.times.assembly_s = result.assembly_s;
  report.times.solve_s = result.solve_s;
  report.times.contact_s += result.contact_s;
  if (result.status != SolveStatus::kSolved) {
    report.message = toString(result.status);
    return false;
  }
  finishMotion(contacts, result.contact_forces, T_end, positions_start, report);
  return true;
}

// Nothing moves in a static scene but by a cut, so the solution stands until the next one.
bool Simulation::Impl::stepStatic(const ToolPoses& T_end, StepReport& report) {
  if (config.integration.mode == AnalysisMode::kStatic && static_solution_stands) {
    report.relative_residual = static_residual;
    return true;
  }
  const std::vector<LinearisedContact> contacts = findContacts(T_end, report);
  Eigen::Matrix3Xd positions_start = state.positions;
  const Eigen::Matrix3Xd weights = config.integration.gravity_m_s2 * assembly->vertexMasses().transpose();
  const EquilibriumResult result =
      findEquilibrium(mesh, *assembly, state.fixed, weights, contacts, config.integration, state.positions);
  report.relative_residual = result.relative_residual;
  report.solves = result.iterations;
  report.iterations = result.iterations;
  report.times.assembly_s = result.assembly_s;
  report.times.solve_s = result.solve_s;
  report.times.contact_s += result.contact_s;
  if (!result.converged) {
    report.message = result.message;
    return false;
  }
  static_solution_stands = true;
  static_residual = result.relative_residual;
  if (config.integration.mode == AnalysisMode::kStatic) return true;
  state.velocities = (state.positions - positions_start) / config.integration.time_step_s;
  finishMotion(contacts, result.contact_forces, T_end, positions_start, report);
  return true;
}

void Simulation::Impl::recoverStressWhenDue(StepReport& report) {
  if (!config.stress || step_count % config.stress->interval_steps != 0) return;
  const StageTimer timer(report.times.stress_s);
  stress = recoverStress(mesh, *assembly, state.positions);
}

Simulation::Simulation(const SimulationConfig& config) : impl_(std::make_unique<Impl>(config)) {}
Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

StepReport Simulation::step(const std::vector<std::optional<Eigen::Isometry3d>>& T_world_tool) {
  Impl& s = *impl_;
  if (T_world_tool.size() != s.tools.size()) {
    throw std::invalid_argument("T_world_tool has " + std::to_string(T_world_tool.size()) +
                                " poses: must have one for each of the " + std::to_string(s.tools.size()) +
                                " tools");
  }
  for (std::size_t i = 0; i < T_world_tool.size(); ++i) {
    if (T_world_tool[i]) requirePose(i, *T_world_tool[i]);
  }
  StepReport report;
  {
    const StageTimer timer(report.times.total_s);
    report.tools.resize(s.tools.size());
    for (std::size_t i = 0; i < s.tools.size(); ++i) {
      if (!T_world_tool[i]) continue;
      const std::optional<Eigen::Isometry3d>& T_start = s.tools[i].T_world_tool;
      report.tools[i].enabled = true;
      report.tools[i].reseated = !T_start || longestWay(s.tools[i], s.config.tools[i], *T_start,
                                                        *T_world_tool[i]) > s.config.tools[i].max_jump_m;
    }
    report.converged =
        s.isDynamic() ? s.stepDynamic(T_world_tool, report) : s.stepStatic(T_world_tool, report);
    if (report.converged) {
      ++s.step_count;
      s.recoverStressWhenDue(report);
    }
  }
  return report;
}

CutResult Simulation::cut(const CutOperation& operation) {
  return cutAll({operation}).result;
}

CutEvent Simulation::cutAll(const std::vector<CutOperation>& operations) {
  Impl& s = *impl_;
  if (!s.config.cutting) throw std::invalid_argument("cut: the scene is built without cutting");
  s.index.tree.fit(s.mesh, s.state.positions);
  CutResult result =
      cutMesh(s.mesh, s.state.positions, operations, *s.config.cutting, s.num_cuts + 1, &s.index);
  if (result.status == CutStatus::kCut) return s.followCut(-1, std::move(result));
  CutEvent event;
  event.result = std::move(result);
  event.pieces = s.piece_table;
  return event;
}

void Simulation::reset() {
  impl_->reset();
}

const SimulationConfig& Simulation::config() const {
  return impl_->config;
}
const PolyhedralMesh& Simulation::mesh() const {
  return impl_->mesh;
}
const Eigen::Matrix3Xd& Simulation::positions() const {
  return impl_->state.positions;
}
const Eigen::Matrix3Xd& Simulation::velocities() const {
  return impl_->state.velocities;
}
const Pieces& Simulation::pieces() const {
  return impl_->index.pieces.pieces();
}
const std::vector<PieceProperties>& Simulation::pieceTable() const {
  return impl_->piece_table;
}
const std::vector<bool>& Simulation::fixedVertices() const {
  return impl_->state.fixed;
}

const ToolShape* Simulation::toolShape(int tool) const {
  const Impl& s = *impl_;
  POLYSCALPEL_ASSERT(tool >= 0 && tool < static_cast<int>(s.tools.size()));
  return s.tools[tool].shape ? &*s.tools[tool].shape : nullptr;
}

int Simulation::numPending(int tool) const {
  const Impl& s = *impl_;
  POLYSCALPEL_ASSERT(tool >= 0 && tool < static_cast<int>(s.tools.size()));
  return s.tools[tool].blade ? s.tools[tool].blade->numPending() : 0;
}

Eigen::Matrix3Xd Simulation::pendingPoints(int tool) const {
  const Impl& s = *impl_;
  POLYSCALPEL_ASSERT(tool >= 0 && tool < static_cast<int>(s.tools.size()));
  if (!s.tools[tool].blade) return Eigen::Matrix3Xd(3, 0);
  return s.tools[tool].blade->pendingPoints(s.state.positions);
}

std::int64_t Simulation::stepCount() const {
  return impl_->step_count;
}
double Simulation::time_s() const {
  return static_cast<double>(impl_->step_count) * impl_->config.integration.time_step_s;
}
double Simulation::restVolume_m3() const {
  return impl_->rest_volume;
}
int Simulation::numCuts() const {
  return impl_->num_cuts;
}
int Simulation::cellsLeftWhole() const {
  return impl_->cells_left_whole;
}
const Debris& Simulation::debris() const {
  return impl_->debris;
}
std::optional<MeshQuality> Simulation::quality() const {
  if (!impl_->quality) return std::nullopt;
  return impl_->quality->quality();
}
std::optional<double> Simulation::conditionEstimate() const {
  const Impl& s = *impl_;
  if (!s.quality || !s.isDynamic()) return std::nullopt;
  const IntegrationConfig& c = s.config.integration;
  return 1 + c.time_step_s * (c.time_step_s + c.stiffness_damping_s) /
                 (1 + c.time_step_s * c.mass_damping_per_s) *
                 s.quality->quality().largest_stiffness_over_mass_1_s2;
}
double Simulation::movedMass_kg() const {
  return impl_->assembly->movedMass_kg();
}

double Simulation::totalEnergy_j() const {
  const Impl& s = *impl_;
  Eigen::Matrix3Xd momenta;
  s.assembly->multiplyMass(s.state.velocities, momenta);
  return s.assembly->elasticEnergy(s.state.positions) +
         pointEnergy(momenta, s.state, s.assembly->vertexMasses(), s.config.integration.gravity_m_s2);
}

const StressField* Simulation::stressField() const {
  return impl_->stress ? &*impl_->stress : nullptr;
}

const std::vector<std::string>& Simulation::parts() const {
  return impl_->parts;
}
const std::vector<std::string>& Simulation::remarks() const {
  return impl_->remarks;
}

}  // namespace polyscalpel
