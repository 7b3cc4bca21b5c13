// SPDX-License-Identifier: BSD-3-Clause
//
// What a simulation is made of. One concept a source: simulation.cpp builds and tells, simulation_steps.cpp
// moves tissue and tools, simulation_cuts.cpp cuts and follows what was cut or has torn.
#pragma once

#include "polyscalpel/simulation/simulation.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "polyscalpel/collision/contact_detection.hpp"
#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/mesh/mesh_index.hpp"
#include "polyscalpel/simulation/piece_sleep.hpp"
#include "polyscalpel/simulation/simulation_state.hpp"
#include "polyscalpel/simulation/time_integration.hpp"

namespace polyscalpel {

using ToolPoses = std::vector<std::optional<Eigen::Isometry3d>>;

/// Holds a tool's shape.
struct BoundingSphere {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // in the tool's frame [m]
  double radius = 0;
};

/// A tool of the scene and its motion.
struct Tool {
  std::optional<ToolShape> shape;  // where the scene has contact
  BoundingSphere bounds;           // of the shape; a point at the origin without
  std::optional<BladeCut> blade;
  std::optional<Eigen::Isometry3d> T_world_tool;  // at the end of the last step
  int cut = 0;  // number of the stroke under way, 0 before it has split anything
  // The blade's travel since it last moved for sure, and for how long that has been.
  double rest_travel_in_sizes = 0, rest_s = 0;
  bool is_front_closed = false;
};

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
  std::optional<PieceSleep> sleep;          // dynamic scenes where pieces may
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
  std::optional<CrackGrowth> cracks;  // scenes with fracture
  FractureCounts fracture;

  explicit Impl(const SimulationConfig& given);

  bool isDynamic() const { return config.integration.mode == AnalysisMode::kDynamic; }
  bool maySleep() const {
    return isDynamic() && config.integration.sleep_speed_m_s > 0 &&
           config.solver.kind != SolverKind::kDirect && config.element.strain == Strain::kCorotated;
  }
  bool hasContact() const { return std::find(parts.begin(), parts.end(), "contact") != parts.end(); }

  void reset();

  std::vector<LinearisedContact> findContacts(const ToolPoses& T_end, StepReport& report);
  void applyContactForces(const std::vector<LinearisedContact>& contacts,
                          const std::vector<Eigen::Vector3d>& forces, const ToolPoses& T_end,
                          StepReport& report);
  void moveBlades(const ToolPoses& T_end, Eigen::Matrix3Xd& positions_start, StepReport& report);
  void countPieces() { piece_table = measurePieces(index.pieces.pieces(), *assembly); }
  void growCracks(StepReport& report);
  void commit(int tool, CutResult result, Eigen::Matrix3Xd* positions_start, StepReport& report);
  void followChange(int tool, const MeshChange& change);
  CutReport followCut(CutCause cause, int tool, CutResult result);
  Debris removeDebris();
  bool comesToRest(Tool& tool) const;
  Eigen::Vector3d cuttingResistance(int tool, const CutResult& result, int faces_before,
                                    const Eigen::Matrix3Xd& positions_start, const Eigen::Isometry3d& T_start,
                                    const Eigen::Isometry3d& T_end) const;
  double fractureToughness(const CutResult& result, int faces_before) const;
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

}  // namespace polyscalpel
