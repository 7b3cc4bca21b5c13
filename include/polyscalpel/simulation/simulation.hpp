// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "polyscalpel/collision/contact_forces.hpp"
#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/elements/stress_recovery.hpp"
#include "polyscalpel/mesh/polyhedral_mesh.hpp"
#include "polyscalpel/simulation/cut_balance.hpp"
#include "polyscalpel/simulation/mesh_quality.hpp"
#include "polyscalpel/simulation/piece_table.hpp"
#include "polyscalpel/simulation/simulation_config.hpp"
#include "polyscalpel/solver/solver_report.hpp"

namespace polyscalpel {

/// Wall time spent in each stage of a step [s]; exactly 0 for a part that the scene does not build.
struct StageTimes {
  double detection_s = 0;  ///< contact detection, refitting of the collision surface
  double contact_s = 0;    ///< contact forces and their matrix entries
  double assembly_s = 0;   ///< rotations, stiffness, forces
  double solve_s = 0;      ///< factorisation and solution
  double cutting_s = 0;    ///< crossings and splits
  double update_s = 0;     ///< matrices, pattern and surface after a cut
  double stress_s = 0;     ///< stress and error estimate
  double fracture_s =
      0;               ///< stress that drives cracks, and their growth; update_s holds what follows from it
  double total_s = 0;  ///< the whole step
};

/// A contact as it acted in a step.
struct AppliedContact {
  int tool = 0;
  FaceId face;
  Eigen::Vector3d point_world;            ///< [m]
  Eigen::Vector3d force_on_tissue_world;  ///< [N]
  double gap_m = 0;                       ///< at the start of the step
};

/// A tool as it acted in a step.
///
/// Cutting resistance is the work of fracture, toughness times the area cut in the step, over the travel of
/// the blade's middle relative to the tissue just opened, against that travel, at the blade's middle; nothing
/// without travel. The area comes cell by cell, so it acts in bursts whose work is right in the sum. The tool
/// alone feels it: fracture takes the work, and no force is put on the tissue. So action equals reaction for
/// the contacts, not for this part.
struct ToolReport {
  Wrench wrench_tool;    ///< of the tissue on the tool (contact, friction, cutting resistance), in the tool's
                         ///< frame at its origin
  bool enabled = false;  ///< had a pose
  bool reseated = false;  ///< jumped further than max_jump_m, or had no pose before
  int pending_crossings = 0;
  std::string refusal;  ///< why its motion was not cut (CutStatus::kRefused); empty otherwise
};

enum class CutCause {
  kTool,      ///< a blade's motion
  kRequest,   ///< cut() or cutAll()
  kFracture,  ///< stress
};

/// A change of topology, for the cut_events topic.
struct CutReport {
  CutCause cause = CutCause::kRequest;
  int tool = -1;     ///< whose blade it was; -1 where the cause is another
  CutResult result;  ///< of the cut alone; pieces_after counts the debris too
  CutBalance balance;
  Debris debris;
  std::vector<PieceProperties> pieces;  ///< after the cut and without the debris
};

/// What stress has torn.
struct FractureCounts {
  int cells_split = 0;
  int cells_left_whole = 0;  ///< that should have split and could not be split soundly
  double area_m2 = 0;        ///< of cracks in rest shape, each counted once
};

struct StepReport {
  bool converged = true;  ///< false: the solver failed, the state is as before the step
  std::string message;    ///< why, when not converged
  /// |A dv - b| / |b| of the last solve; in the static modes EquilibriumResult::relative_residual.
  double relative_residual = 0;
  int solves = 0;
  int iterations = 0;       ///< Newton steps of the static modes
  SolverReport solver;      ///< dynamic scenes
  int half_steps = 0;       ///< > 0: the step was made of so many shorter ones, since it failed as a whole
  int sleeping_pieces = 0;  ///< after the step
  StageTimes times;
  std::vector<ToolReport> tools;  ///< one a tool of the config
  std::vector<AppliedContact> contacts;
  std::vector<CutReport> cuts;
  bool fracture_limited = false;  ///< more would have torn but for FractureConfig::max_splits_per_step
};

/// A soft body, tools and their motion. Single-threaded: one thread may call it at a time.
class Simulation {
 public:
  /// Reads or makes the mesh, builds what the scene asks for. Throws std::invalid_argument, also for a mesh
  /// that fails checkMesh.
  explicit Simulation(const SimulationConfig& config);
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;

  /// One step of time_step_s. T_world_tool: for each tool its pose at the end of the step, or nothing where
  /// the tool is not there. Throws std::invalid_argument for a wrong number of poses or one that is not
  /// finite.
  StepReport step(const std::vector<std::optional<Eigen::Isometry3d>>& T_world_tool);

  /// Cuts the body as it lies, at once. Throws std::invalid_argument for input that is no cut, or a scene
  /// without cutting.
  CutResult cut(const CutOperation& operation);

  /// Several cuts as one transaction (see cutMesh), and all that came of it. The body is as it was unless the
  /// result's status is kCut. Throws as cut() does.
  CutReport cutAll(const std::vector<CutOperation>& operations);

  /// Back to the rest mesh, uncut, at time 0, bit for bit.
  void reset();

  const SimulationConfig& config() const;
  const PolyhedralMesh& mesh() const;
  /// 3 x n, one column per vertex [m], world frame. Valid until the next step, cut or reset.
  const Eigen::Matrix3Xd& positions() const;
  /// 3 x n [m/s].
  const Eigen::Matrix3Xd& velocities() const;
  /// Numbered as PieceTracker says: a piece that is not divided keeps its number.
  const Pieces& pieces() const;
  /// One entry a piece, by its number in pieces(). Valid until the next step, cut or reset.
  const std::vector<PieceProperties>& pieceTable() const;
  const std::vector<bool>& fixedVertices() const;
  /// Shape of a tool, or nullptr when it has none or the scene has no contact.
  const ToolShape* toolShape(int tool) const;

  /// Edges that a tool's blade has crossed and that are not split yet (BladeCut says until when); 0 for a
  /// tool without a blade.
  int numPending(int tool) const;
  /// Where they are crossed: 3 x numPending(tool), world frame [m].
  Eigen::Matrix3Xd pendingPoints(int tool) const;

  std::int64_t stepCount() const;
  double time_s() const;         ///< stepCount() * time_step_s
  double restVolume_m3() const;  ///< of the mesh before any cut
  /// Strokes of blades that have split something, cuts by cut() and cracks, since the start or the last
  /// reset.
  int numCuts() const;
  int cellsLeftWhole() const;  ///< summed over these cuts, without cracks
  /// By stress alone, since the start or the last reset.
  const FractureCounts& fracture() const;
  /// What was taken away as debris since the start or the last reset, without the changes.
  const Debris& debris() const;
  /// How thin the cells have become; nothing in a scene without cutting.
  std::optional<MeshQuality> quality() const;
  /// Estimate of the condition number of a step's matrix in the norm of the mass, from the stiffest vertex:
  /// 1 + h (h + b) / (1 + h a) * MeshQuality::largest_stiffness_over_mass_1_s2, h the time step, a and b
  /// Rayleigh's. Nothing in a scene without cutting, or in a static one, whose matrix holds no mass.
  std::optional<double> conditionEstimate() const;
  double movedMass_kg() const;   ///< between vertices of a piece, by the mass floor
  double totalEnergy_j() const;  ///< kinetic + elastic + gravity
  /// Stress as last computed, on the mesh as it was then; nullptr before that, after a cut until the next
  /// time, and in a scene without StressConfig. Valid until the next step, cut or reset.
  const StressField* stressField() const;
  /// Names of the parts built for this scene, of "mesh", "elements", "dynamics", "statics",
  /// "quasi-statics", "contact", "cutting", "fracture", "tools", "stress".
  const std::vector<std::string>& parts() const;
  /// What a user should know about the mesh file.
  const std::vector<std::string>& remarks() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace polyscalpel
