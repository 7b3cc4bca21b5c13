// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/simulation_config.hpp"

#include <algorithm>
#include <cctype>
#include <limits>
#include <set>
#include <stdexcept>

#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {

namespace {

// A nested validate() names the field only; the user needs its path.
template <class Config>
void validateAt(const std::string& path, const Config& config) {
  try {
    validate(config);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(path + "." + error.what());
  }
}

void requirePositiveEach(const std::string& name, const Eigen::Vector3d& value) {
  for (int i = 0; i < 3; ++i) requirePositive(name + "[" + std::to_string(i) + "]", value[i]);
}

struct MeshValidator {
  void operator()(const BoxMeshConfig& box) const {
    requireFinite("mesh.lowest_m", box.lowest_m);
    requirePositiveEach("mesh.size_m", box.size_m);
    for (int i = 0; i < 3; ++i)
      requireIntInRange("mesh.counts[" + std::to_string(i) + "]", box.counts[i], 1, 200);
  }
  void operator()(const BallMeshConfig& ball) const {
    requireFinite("mesh.centre_m", ball.centre_m);
    requirePositive("mesh.radius_m", ball.radius_m);
    requireIntInRange("mesh.half_count", ball.half_count, 1, 40);
  }
  void operator()(const MeshFileConfig& file) const {
    if (file.path.empty()) throw std::invalid_argument("mesh.path: must not be empty");
    requirePositive("mesh.scale", file.scale);
    requireInRange("mesh.cell_size_m", file.cell_size_m, 0, kInfinity);
  }
};

void validateBox(const std::string& path, const Eigen::Vector3d& lowest_m, const Eigen::Vector3d& highest_m) {
  requireFinite(path + ".lowest_m", lowest_m);
  for (int i = 0; i < 3; ++i)
    requireInRange(path + ".highest_m[" + std::to_string(i) + "]", highest_m[i], lowest_m[i], kInfinity);
}

void validateSphere(const std::string& path, const Eigen::Vector3d& centre_m, double radius_m) {
  requireFinite(path + ".centre_m", centre_m);
  requirePositive(path + ".radius_m", radius_m);
}

struct FixedRegionValidator {
  std::string path;

  void operator()(const FixedBox& box) const { validateBox(path, box.lowest_m, box.highest_m); }
  void operator()(const FixedSphere& sphere) const { validateSphere(path, sphere.centre_m, sphere.radius_m); }
  void operator()(const FixedVertices& list) const {
    if (list.vertices.empty()) throw std::invalid_argument(path + ".vertices: must not be empty");
    for (const int vertex : list.vertices) {
      if (vertex < 0) {
        throw std::invalid_argument(path + ".vertices = " + std::to_string(vertex) + ": must be >= 0");
      }
    }
  }
};

struct RegionCellsValidator {
  std::string path;
  bool has_mesh_file = false;

  void operator()(const RegionBox& box) const { validateBox(path, box.lowest_m, box.highest_m); }
  void operator()(const RegionSphere& sphere) const {
    validateSphere(path, sphere.centre_m, sphere.radius_m);
  }
  void operator()(const RegionGroup& group) const {
    if (!has_mesh_file) throw std::invalid_argument(path + ".group: only a mesh file has physical groups");
    if (group.name.empty()) {
      requireIntInRange(path + ".group.number", group.group, 1, std::numeric_limits<int>::max());
    } else if (group.group != 0) {
      throw std::invalid_argument(path + ".group.number = " + std::to_string(group.group) +
                                  ": must not be given beside the name '" + group.name + "'");
    }
  }
};

void validateRegion(const std::string& path, const RegionConfig& region, const SimulationConfig& config) {
  if (region.name.empty()) throw std::invalid_argument(path + ".name: must not be empty");
  std::visit(RegionCellsValidator{path, std::holds_alternative<MeshFileConfig>(config.mesh)}, region.cells);
  validateAt(path + ".material", region.material);
  ElementConfig element = config.element;
  element.formulation = region.formulation.value_or(element.formulation);
  if (!region.quadrature_points) return;
  if (element.formulation == Formulation::kVirtual)
    throw std::invalid_argument(path + ".quadrature_points: a virtual element has none");
  element.quadrature_points = *region.quadrature_points;
  validateAt(path, element);
}

void validateIntegration(const IntegrationConfig& config) {
  requireInRange("integration.time_step_s", config.time_step_s, 1e-6, 1);
  requireInRange("integration.mass_damping_per_s", config.mass_damping_per_s, 0, kInfinity);
  requireInRange("integration.stiffness_damping_s", config.stiffness_damping_s, 0, kInfinity);
  requireFinite("integration.gravity_m_s2", config.gravity_m_s2);
  requireIntInRange("integration.contact_iterations", config.contact_iterations, 1, 20);
  requireInRange("integration.equilibrium_tolerance", config.equilibrium_tolerance, 1e-12, 0.1);
  requireIntInRange("integration.equilibrium_iterations", config.equilibrium_iterations, 1, 1000);
  requireInRange("integration.mass_floor", config.mass_floor, 0, 1);
  requireInRange("integration.sleep_speed_m_s", config.sleep_speed_m_s, 0, kInfinity);
  requireInRange("integration.sleep_after_s", config.sleep_after_s, 0, 1e6);
}

// Conjugate gradients need the matrix of corotated cells (SolverKind).
void validateSolver(const SimulationConfig& config) {
  validate(config.solver);
  const SolverKind kind = config.solver.kind;
  const bool is_for_every_strain = kind == SolverKind::kAuto || kind == SolverKind::kDirect;
  if (is_for_every_strain || config.element.strain == Strain::kCorotated) return;
  throw std::invalid_argument(std::string("solver.kind = ") + toString(kind) +
                              ": must be auto or direct unless element.strain is corotated");
}

// A name that can be a part of a ROS topic: a letter, then letters, digits and _.
bool isRosName(const std::string& name) {
  if (name.empty() || std::isalpha(static_cast<unsigned char>(name.front())) == 0) return false;
  for (const char c : name) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_') return false;
  }
  return true;
}

void validateTool(const std::string& path, const ToolConfig& tool, const SimulationConfig& config) {
  if (!isRosName(tool.name)) {
    throw std::invalid_argument(path + ".name = '" + tool.name +
                                "': must be a letter, then letters, digits or _");
  }
  requirePositive(path + ".max_jump_m", tool.max_jump_m);
  if (tool.shape) validateAt(path + ".shape", *tool.shape);
  if (!tool.blade_edge_tool) return;
  const Eigen::Matrix3Xd& edge = *tool.blade_edge_tool;
  const std::string name = path + ".blade_edge_tool";
  if (edge.cols() < 2) throw std::invalid_argument(name + ": must have at least 2 points");
  requireFinite(name, edge);
  if ((edge.colwise() - edge.col(0)).isZero(0))
    throw std::invalid_argument(name + ": must have a length > 0");
  if (!config.cutting)
    throw std::invalid_argument(name + ": a blade needs the scene's cutting, which is not there");
}

void validateFracture(const SimulationConfig& config) {
  if (!config.fracture) return;
  validateAt("fracture", *config.fracture);
  if (!config.cutting) throw std::invalid_argument("fracture: needs the scene's cutting, which is not there");
  const bool can_tear =
      config.material.strength_pa > 0 ||
      std::any_of(config.regions.begin(), config.regions.end(),
                  [](const RegionConfig& region) { return region.material.strength_pa > 0; });
  if (!can_tear) throw std::invalid_argument("fracture: needs a material with strength_pa > 0");
}

// Without inertia nothing but what is fixed keeps a body in its place, and where time does not act nothing
// moves.
void validateMode(const SimulationConfig& config) {
  if (config.integration.mode == AnalysisMode::kDynamic) return;
  if (config.fixed.empty())
    throw std::invalid_argument("fixed: a static or quasi-static scene must hold something");
  if (config.integration.mode == AnalysisMode::kQuasiStatic) return;
  if (config.contact) throw std::invalid_argument("contact: a static scene has none");
  if (!config.tools.empty()) throw std::invalid_argument("tools: a static scene has none");
}

// No two items of a list may have one name. kind: what an item is.
template <class Item>
void requireDistinctNames(const std::string& list, const std::string& kind, const std::vector<Item>& items) {
  std::set<std::string> names;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (names.insert(items[i].name).second) continue;
    throw std::invalid_argument(list + "[" + std::to_string(i) + "].name = '" + items[i].name +
                                "': another " + kind + " has this name");
  }
}

}  // namespace

void validate(const SimulationConfig& config) {
  std::visit(MeshValidator{}, config.mesh);
  validateAt("material", config.material);
  validateAt("element", config.element);
  for (std::size_t i = 0; i < config.regions.size(); ++i)
    validateRegion("regions[" + std::to_string(i) + "]", config.regions[i], config);
  requireDistinctNames("regions", "region", config.regions);
  for (std::size_t i = 0; i < config.fixed.size(); ++i) {
    std::visit(FixedRegionValidator{"fixed[" + std::to_string(i) + "]"}, config.fixed[i]);
  }
  validateIntegration(config.integration);
  validateSolver(config);
  if (config.cutting) validateAt("cutting", *config.cutting);
  validateFracture(config);
  if (config.contact) validateAt("contact", *config.contact);
  for (std::size_t i = 0; i < config.tools.size(); ++i)
    validateTool("tools[" + std::to_string(i) + "]", config.tools[i], config);
  requireDistinctNames("tools", "tool", config.tools);
  if (config.stress) requireIntInRange("stress.interval_steps", config.stress->interval_steps, 1, 1000000);
  validateMode(config);
}

}  // namespace polyscalpel
