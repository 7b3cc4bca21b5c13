// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include "polyscalpel/core/stage_timer.hpp"
#include "polyscalpel/cutting/blade_sweep.hpp"
#include "polyscalpel/mesh/mesh_editing.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "polyscalpel/simulation/cell_loads.hpp"
#include "simulation_impl.hpp"

namespace polyscalpel {

// Everything downstream of the mesh refreshes from the change. tool: whose blade made it and knows it, -1 for
// none.
void Simulation::Impl::followChange(int tool, const MeshChange& change) {
  applyMeshChange(state, change);
  assembly->update(mesh, change);
  if (quality) quality->update(mesh, *assembly, change);
  if (integrator) integrator->follow(mesh, change);
  if (sleep) sleep->follow(mesh, index.pieces.pieces(), &change, state);
  if (surface) surface->update(mesh, change, state.positions);
  for (std::size_t i = 0; i < tools.size(); ++i) {
    if (static_cast<int>(i) != tool && tools[i].blade) tools[i].blade->update(mesh, change);
  }
  if (cracks) cracks->update(change);
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

CutReport Simulation::Impl::followCut(CutCause cause, int tool, CutResult result) {
  CutReport report;
  report.cause = cause;
  report.tool = tool;
  const CutLedger ledger(state, *assembly, result.change, isDynamic());
  followChange(tool, result.change);
  report.balance = ledger.settle(mesh, result.change, *assembly, state);
  num_cuts = std::max(num_cuts, result.cut + result.num_cuts - 1);
  if (cause != CutCause::kFracture) cells_left_whole += result.cells_left_whole;
  report.debris = removeDebris();
  report.pieces = piece_table;
  report.result = std::move(result);
  return report;
}

void Simulation::Impl::commit(int tool, CutResult result, Eigen::Matrix3Xd* positions_start,
                              StepReport& report) {
  if (result.status != CutStatus::kCut) return;
  const StageTimer timer(report.times.update_s);
  if (positions_start) extendByNewVertices(result.change.new_vertices, *positions_start);
  report.cuts.push_back(followCut(CutCause::kTool, tool, std::move(result)));
}

// Mean over the new faces of a cut, by area [J/m^2]. faces_before: capacity of the mesh before it; a stroke's
// older faces carry its number too.
double Simulation::Impl::fractureToughness(const CutResult& result, int faces_before) const {
  double area = 0, energy = 0;
  for (const FaceId id : result.change.changed_faces) {
    const Face& face = mesh.face(id);
    if (id.index() < faces_before || !face.isAlive() || face.cut != result.cut) continue;
    const double face_area = planeOf(face, mesh.restPositions()).second.norm();
    area += face_area;
    energy += face_area * assembly->kind(assembly->kindOf(face.cells[0])).material.fracture_toughness_j_m2;
  }
  return area > 0 ? energy / area : 0;
}

// The work of fracture, toughness times new area, over the blade's travel relative to the tissue it has just
// opened, and against that travel. World frame [N]; zero without travel.
Eigen::Vector3d Simulation::Impl::cuttingResistance(int tool, const CutResult& result, int faces_before,
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
  return -fractureToughness(result, faces_before) * result.cut_area_m2 / length * (travel / length);
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
    const int faces_before = mesh.faceCapacity();
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
      const Eigen::Vector3d on_blade = cuttingResistance(tool, report.cuts.back().result, faces_before,
                                                         positions_start, *tools[i].T_world_tool, *T_end[i]);
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

// Where the stress of the step that has just ended passes the strength. A static body's stress stands with
// its solution.
void Simulation::Impl::growCracks(StepReport& report) {
  if (!cracks || !report.converged) return;
  std::vector<CellLoad> loads;
  CrackPlan plan;
  {
    const StageTimer timer(report.times.fracture_s);
    loads = findCellLoads(mesh, *assembly, state.positions, state.velocities,
                          isDynamic() ? config.integration.stiffness_damping_s : 0);
    plan = cracks->plan(mesh, state.positions, loads);
  }
  report.fracture_limited = plan.is_limited;
  for (const CrackAdvance& advance : plan.advances) {
    CutResult result;
    {
      const StageTimer timer(report.times.fracture_s);
      result = cracks->grow(mesh, state.positions, advance, loads, num_cuts + 1, index);
    }
    fracture.cells_split += result.cells_split;
    fracture.cells_left_whole += result.cells_left_whole;
    fracture.area_m2 += result.cut_area_m2;
    if (result.status != CutStatus::kCut) continue;
    const StageTimer timer(report.times.update_s);
    report.cuts.push_back(followCut(CutCause::kFracture, -1, std::move(result)));
  }
}

CutResult Simulation::cut(const CutOperation& operation) {
  return cutAll({operation}).result;
}

CutReport Simulation::cutAll(const std::vector<CutOperation>& operations) {
  Impl& s = *impl_;
  if (!s.config.cutting) throw std::invalid_argument("cut: the scene is built without cutting");
  s.index.tree.fit(s.mesh, s.state.positions);
  CutResult result =
      cutMesh(s.mesh, s.state.positions, operations, *s.config.cutting, s.num_cuts + 1, &s.index);
  if (result.status == CutStatus::kCut) return s.followCut(CutCause::kRequest, -1, std::move(result));
  CutReport report;
  report.result = std::move(result);
  report.pieces = s.piece_table;
  return report;
}

}  // namespace polyscalpel
