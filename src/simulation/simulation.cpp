// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/simulation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/core/stage_timer.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "polyscalpel/simulation/regions.hpp"
#include "scene_mesh.hpp"
#include "simulation_impl.hpp"

namespace polyscalpel {

namespace {

BoundingSphere boundingSphere(const Eigen::Matrix3Xd& points) {
  BoundingSphere sphere;
  if (points.cols() == 0) return sphere;
  sphere.centre = (points.rowwise().minCoeff() + points.rowwise().maxCoeff()) / 2;
  sphere.radius = (points.colwise() - sphere.centre).colwise().norm().maxCoeff();
  return sphere;
}

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

Simulation::Impl::Impl(const SimulationConfig& given) : config(given) {
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
  if (config.fracture) parts.push_back("fracture");
  if (!tools.empty()) parts.push_back("tools");
  if (config.stress) parts.push_back("stress");
  reset();
}

void Simulation::Impl::reset() {
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
  fracture = FractureCounts();
  if (config.fracture) cracks.emplace(*config.fracture, config.cutting->snap_tolerance);
  if (isDynamic()) integrator.emplace(config.integration, config.solver);
  if (maySleep()) {
    sleep.emplace(config.integration);
    sleep->follow(mesh, index.pieces.pieces(), nullptr, state);
  }
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
      s.growCracks(report);
      s.recoverStressWhenDue(report);
    }
  }
  return report;
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
const FractureCounts& Simulation::fracture() const {
  return impl_->fracture;
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
