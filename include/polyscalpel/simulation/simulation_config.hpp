// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Geometry>

#include "polyscalpel/collision/contact_forces.hpp"
#include "polyscalpel/collision/tool_shape.hpp"
#include "polyscalpel/cutting/crack_growth.hpp"
#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/elements/element_config.hpp"
#include "polyscalpel/materials/isotropic_material.hpp"
#include "polyscalpel/mesh/mesh_io.hpp"
#include "polyscalpel/solver/solver_config.hpp"

namespace polyscalpel {

/// A box of cells made by our own generator.
struct BoxMeshConfig {
  Eigen::Vector3d lowest_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d size_m = Eigen::Vector3d::Constant(0.1);  ///< each > 0
  Eigen::Vector3i counts = Eigen::Vector3i::Constant(3);    ///< cells an edge, each in [1, 200]
  bool tetrahedra = false;                                  ///< five tets a cube instead of hexahedra
};

/// A ball of tets made by our own generator.
struct BallMeshConfig {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  double radius_m = 0.05;  ///< > 0
  int half_count = 5;      ///< in [1, 40]: the ball has 5 (2 n)^3 tets
};

using MeshConfig = std::variant<BoxMeshConfig, BallMeshConfig, MeshFileConfig>;

/// Vertices held at their rest positions.
struct FixedBox {
  Eigen::Vector3d lowest_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d highest_m = Eigen::Vector3d::Zero();  ///< each >= lowest; bounds belong to the box
};
struct FixedSphere {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  double radius_m = 0;  ///< > 0
};
struct FixedVertices {
  std::vector<int> vertices;  ///< ids in the uncut mesh
};
using FixedRegion = std::variant<FixedBox, FixedSphere, FixedVertices>;

/// Cells made of another material, chosen in the uncut mesh; what a cut makes of them stays in the region.
/// Exactly one of the three choices.
struct RegionBox {
  Eigen::Vector3d lowest_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d highest_m = Eigen::Vector3d::Zero();  ///< each >= lowest; bounds belong to the box
};
struct RegionSphere {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  double radius_m = 0;  ///< > 0
};
struct RegionGroup {
  int group = 0;     ///< number of a physical group of the mesh file (Cell::region)
  std::string name;  ///< or its name; one of the two
};
using RegionCells = std::variant<RegionBox, RegionSphere, RegionGroup>;

struct RegionConfig {
  std::string name;   ///< not empty, no two alike
  RegionCells cells;  ///< a cell belongs to a box or sphere if the mean of its vertices does
  IsotropicMaterial material;
  std::optional<Formulation> formulation;  ///< none: as in SimulationConfig::element
  std::optional<int> quadrature_points;    ///< none: as in SimulationConfig::element
  /// Where regions overlap, the higher order wins. Overlapping regions without or of equal order are refused.
  std::optional<int> order;
};

enum class AnalysisMode {
  kDynamic,      ///< linearly implicit Euler
  kQuasiStatic,  ///< equilibrium in every step, without inertia and damping; tools move from step to step
  kStatic,       ///< equilibrium under gravity of the uncut or cut body; time does not act
};

struct IntegrationConfig {
  AnalysisMode mode = AnalysisMode::kDynamic;
  double time_step_s = 0.01;          ///< h, in [1e-6, 1]
  double mass_damping_per_s = 0.1;    ///< Rayleigh: D = this * M + stiffness_damping_s * K; >= 0
  double stiffness_damping_s = 0.01;  ///< >= 0
  Eigen::Vector3d gravity_m_s2 = Eigen::Vector3d(0, 0, -9.81);
  int contact_iterations = 3;  ///< in [1, 20]: solves a step, at most, to let go of contacts that would pull
  double equilibrium_tolerance = 1e-6;  ///< in [1e-12, 0.1]: static modes; residual over the applied forces
  int equilibrium_iterations = 50;      ///< in [1, 1000]: static modes; Newton steps at most
  /// In [0, 1]: lowest mass of a vertex that a cut makes or touches, as a part of the median rest mass; taken
  /// from its neighbours (see Assembly).
  double mass_floor = 0.02;
  /// >= 0 [m/s]: a piece of which no vertex has been faster for sleep_after_s sleeps, and costs nothing,
  /// until a tool touches it or it is cut. 0: none ever does. Dynamic scenes.
  double sleep_speed_m_s = 0;
  double sleep_after_s = 0.5;  ///< in [0, 1e6]
};

struct ToolConfig {
  std::string name = "tool";                        ///< a ROS name: letters, digits, _
  std::optional<ShapeConfig> shape;                 ///< none: no contact
  std::optional<Eigen::Matrix3Xd> blade_edge_tool;  ///< 3 x k, k >= 2 [m]; none: does not cut
  double max_jump_m = 0.05;  ///< > 0: a longer way of any part of the tool in one step re-seats the tool: no
                             ///< sweep, no contact force in that step
};

/// Stress, strain and error estimate beside the motion.
struct StressConfig {
  int interval_steps = 1;  ///< in [1, 1000000]: computed after every so many steps
};

/// Everything a simulation is made from. A part that is not asked for is not built.
struct SimulationConfig {
  MeshConfig mesh;
  IsotropicMaterial material;
  ElementConfig element;
  std::vector<RegionConfig> regions;  ///< cells of other materials
  std::vector<FixedRegion> fixed;
  IntegrationConfig integration;
  SolverConfig solver;                   ///< of dynamic scenes; the static modes factor
  std::optional<CuttingConfig> cutting;  ///< none: neither blades nor the cut service
  /// None: nothing tears by itself. Needs cutting and a material with a strength.
  std::optional<FractureConfig> fracture;
  std::optional<ContactConfig> contact;  ///< none: no collision surface, no contact forces
  std::vector<ToolConfig> tools;
  std::optional<StressConfig> stress;  ///< none: no stress is computed
};

/// Throws std::invalid_argument with the field's path, value and range; also for two tools of one name, a
/// blade or fracture without cutting, fracture without a strength, two regions of one name, a static or
/// quasi-static scene with nothing fixed, a static one with contact or tools, conjugate gradients with
/// another strain than corotated.
void validate(const SimulationConfig& config);

}  // namespace polyscalpel
