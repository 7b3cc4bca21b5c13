// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/simulation_config.hpp"

#include <functional>
#include <limits>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace polyscalpel {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTiny = 1e-12;

/// A scene with every part.
SimulationConfig fullScene() {
  SimulationConfig config;
  config.mesh = BoxMeshConfig();
  config.fixed = {FixedBox(), FixedSphere{Eigen::Vector3d::Zero(), 0.1}, FixedVertices{{0, 3}}};
  config.cutting = CuttingConfig();
  config.contact = ContactConfig();
  config.regions.resize(2);
  config.regions[0].name = "tumour";
  config.regions[0].cells = RegionSphere{Eigen::Vector3d::Zero(), 0.1};
  config.regions[1].name = "vein";
  config.regions[1].cells = RegionBox();
  config.stress = StressConfig();
  config.fracture = FractureConfig();
  config.material.strength_pa = 1e4;
  ToolConfig tool;
  tool.name = "scalpel_1";
  tool.shape = ShapeConfig();
  tool.blade_edge_tool = (Eigen::Matrix3Xd(3, 2) << 0, 0, 0, 0, 0, 0.1).finished();
  config.tools = {tool};
  return config;
}

using Setter = std::function<void(SimulationConfig&, double)>;

void expectAccepted(const Setter& set, double value) {
  SimulationConfig config = fullScene();
  set(config, value);
  EXPECT_NO_THROW(validate(config)) << value;
}

void expectRefused(const std::string& name, const Setter& set, double value) {
  SimulationConfig config = fullScene();
  set(config, value);
  try {
    validate(config);
    ADD_FAILURE() << name << " = " << value << " was accepted";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
  }
}

struct Bound {
  std::string name;
  Setter set;
  std::vector<double> accepted;
  std::vector<double> refused;
};

void check(const Bound& bound) {
  for (const double value : bound.accepted) expectAccepted(bound.set, value);
  for (const double value : bound.refused) expectRefused(bound.name, bound.set, value);
  expectRefused(bound.name, bound.set, kNan);
  expectRefused(bound.name, bound.set, kInfinity);
}

TEST(SimulationConfig, DefaultsAndAFullSceneAreValid) {
  EXPECT_NO_THROW(validate(SimulationConfig()));
  EXPECT_NO_THROW(validate(fullScene()));
}

TEST(SimulationConfig, FractureNeedsCuttingAStrengthAndARate) {
  const auto refusal = [](const SimulationConfig& config) -> std::string {
    try {
      validate(config);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  SimulationConfig config = fullScene();
  for (const int good : {1, 2, 1000000}) {
    config.fracture->max_splits_per_step = good;
    EXPECT_EQ(refusal(config), "");
  }
  for (const int bad : {0, -1, 1000001}) {
    config.fracture->max_splits_per_step = bad;
    EXPECT_EQ(refusal(config),
              "fracture.max_splits_per_step = " + std::to_string(bad) + ": must be in [1, 1000000]");
  }
  config = fullScene();
  config.material.strength_pa = 0;
  EXPECT_EQ(refusal(config), "fracture: needs a material with strength_pa > 0");
  config.regions[1].material.strength_pa = 1;
  EXPECT_EQ(refusal(config), "");
  config.fracture.reset();
  config.regions[1].material.strength_pa = 0;
  EXPECT_EQ(refusal(config), "") << "no strength is needed where nothing tears";
  config = fullScene();
  config.cutting.reset();
  config.tools[0].blade_edge_tool.reset();
  EXPECT_EQ(refusal(config), "fracture: needs the scene's cutting, which is not there");
}

TEST(SimulationConfig, HoldsEveryBoundOfItsNumbers) {
  const Bound bounds[] = {
      {"integration.time_step_s",
       [](SimulationConfig& c, double v) { c.integration.time_step_s = v; },
       {1e-6, 1e-6 + kTiny, 1, 1 - kTiny},
       {1e-6 - kTiny, 1 + kTiny, 0, -0.01}},
      {"integration.mass_damping_per_s",
       [](SimulationConfig& c, double v) { c.integration.mass_damping_per_s = v; },
       {0, kTiny, 1e6},
       {-kTiny}},
      {"integration.stiffness_damping_s",
       [](SimulationConfig& c, double v) { c.integration.stiffness_damping_s = v; },
       {0, kTiny, 1e6},
       {-kTiny}},
      {"integration.gravity_m_s2",
       [](SimulationConfig& c, double v) { c.integration.gravity_m_s2[1] = v; },
       {0, -20, 20},
       {-kInfinity}},
      {"integration.mass_floor",
       [](SimulationConfig& c, double v) { c.integration.mass_floor = v; },
       {0, kTiny, 1, 1 - kTiny},
       {-kTiny, 1 + kTiny}},
      {"integration.sleep_speed_m_s",
       [](SimulationConfig& c, double v) { c.integration.sleep_speed_m_s = v; },
       {0, kTiny, 1e6},
       {-kTiny}},
      {"integration.sleep_after_s",
       [](SimulationConfig& c, double v) { c.integration.sleep_after_s = v; },
       {0, kTiny, 1e6 - 1e-6, 1e6},
       {-kTiny, 1e6 + 1e-6}},
      {"integration.equilibrium_tolerance",
       [](SimulationConfig& c, double v) { c.integration.equilibrium_tolerance = v; },
       {1e-12, 1.001e-12, 0.1, 0.1 - kTiny},
       {0.999e-12, 0.1 + kTiny, 0, -1e-6}},
      {"regions[0].radius_m",
       [](SimulationConfig& c, double v) { std::get<RegionSphere>(c.regions[0].cells).radius_m = v; },
       {kTiny, 1},
       {0, -kTiny}},
      {"regions[0].centre_m",
       [](SimulationConfig& c, double v) { std::get<RegionSphere>(c.regions[0].cells).centre_m[1] = v; },
       {-1, 1},
       {-kInfinity}},
      {"regions[1].lowest_m",
       [](SimulationConfig& c, double v) {
         c.regions[1].cells = RegionBox{{0, 0, v}, {1, 1, 1}};
       },
       {-1, 1},
       {-kInfinity}},
      {"regions[1].highest_m[2]",
       [](SimulationConfig& c, double v) {
         c.regions[1].cells = RegionBox{{0, 0, 0}, {1, 1, v}};
       },
       {0, kTiny},
       {-kTiny}},
      {"regions[1].material.density_kg_m3",
       [](SimulationConfig& c, double v) { c.regions[1].material.density_kg_m3 = v; },
       {1},
       {0}},
      {"tools[0].max_jump_m",
       [](SimulationConfig& c, double v) { c.tools[0].max_jump_m = v; },
       {kTiny, 10},
       {0, -kTiny}},
      {"tools[0].blade_edge_tool",
       [](SimulationConfig& c, double v) { (*c.tools[0].blade_edge_tool)(2, 1) = v; },
       {0.1, -0.1},
       {0}},
      {"mesh.size_m[2]",
       [](SimulationConfig& c, double v) { std::get<BoxMeshConfig>(c.mesh).size_m[2] = v; },
       {kTiny, 10},
       {0, -kTiny}},
      {"mesh.lowest_m",
       [](SimulationConfig& c, double v) { std::get<BoxMeshConfig>(c.mesh).lowest_m[0] = v; },
       {-1, 0, 1},
       {-kInfinity}},
      {"mesh.centre_m",
       [](SimulationConfig& c, double v) {
         c.mesh = BallMeshConfig{{0, v, 0}, 1, 2};
       },
       {-1, 0},
       {}},
      {"mesh.radius_m",
       [](SimulationConfig& c, double v) {
         c.mesh = BallMeshConfig{{0, 0, 0}, v, 2};
       },
       {kTiny, 1},
       {0, -kTiny}},
      {"mesh.scale",
       [](SimulationConfig& c, double v) {
         c.mesh = MeshFileConfig{"a.msh", v, 0};
       },
       {kTiny, 1000},
       {0, -kTiny}},
      {"mesh.cell_size_m",
       [](SimulationConfig& c, double v) {
         c.mesh = MeshFileConfig{"a.msh", 1, v};
       },
       {0, kTiny, 1},
       {-kTiny}},
      {"fixed[0].lowest_m",
       [](SimulationConfig& c, double v) {
         c.fixed[0] = FixedBox{{0, v, 0}, {1, 1, 1}};
       },
       {-1, 1},
       {-kInfinity}},
      {"fixed[0].highest_m[1]",
       [](SimulationConfig& c, double v) {
         c.fixed[0] = FixedBox{{0, 0, 0}, {1, v, 1}};
       },
       {0, kTiny},
       {-kTiny}},
      {"fixed[1].radius_m",
       [](SimulationConfig& c, double v) {
         c.fixed[1] = FixedSphere{{0, 0, 0}, v};
       },
       {kTiny, 1},
       {0, -kTiny}},
      {"fixed[1].centre_m",
       [](SimulationConfig& c, double v) {
         c.fixed[1] = FixedSphere{{v, 0, 0}, 1};
       },
       {-1, 1},
       {}},
      // One of each nested struct: it is looked at, and its path is told. Their own tests hold all their
      // bounds.
      {"material.youngs_modulus_pa",
       [](SimulationConfig& c, double v) { c.material.youngs_modulus_pa = v; },
       {1},
       {0}},
      {"material.poisson_ratio",
       [](SimulationConfig& c, double v) { c.material.poisson_ratio = v; },
       {0.49},
       {0.5, -1}},
      {"element.stabilisation_scale",
       [](SimulationConfig& c, double v) { c.element.stabilisation_scale = v; },
       {2},
       {0}},
      {"solver.tolerance", [](SimulationConfig& c, double v) { c.solver.tolerance = v; }, {1e-8}, {0, -1e-8}},
      {"solver.step_budget_ms",
       [](SimulationConfig& c, double v) { c.solver.step_budget_ms = v; },
       {10},
       {0}},
      {"material.strength_pa",
       [](SimulationConfig& c, double v) { c.material.strength_pa = v; },
       {kTiny, 1e9},
       {-kTiny}},
      {"regions[1].material.fracture_toughness_j_m2",
       [](SimulationConfig& c, double v) { c.regions[1].material.fracture_toughness_j_m2 = v; },
       {0, 1e5},
       {-kTiny, 1.01e5}},
      {"cutting.debris_volume_m3",
       [](SimulationConfig& c, double v) { c.cutting->debris_volume_m3 = v; },
       {0, kTiny, 1e6},
       {-kTiny}},
      {"cutting.snap_tolerance",
       [](SimulationConfig& c, double v) { c.cutting->snap_tolerance = v; },
       {0.1},
       {0.21, 0}},
      {"contact.stiffness_pa_m",
       [](SimulationConfig& c, double v) { c.contact->stiffness_pa_m = v; },
       {1},
       {0}},
      {"tools[0].shape.radius_m",
       [](SimulationConfig& c, double v) { c.tools[0].shape->radius_m = v; },
       {1},
       {0}},
  };
  for (const Bound& bound : bounds) check(bound);
}

TEST(SimulationConfig, HoldsEveryBoundOfItsCounts) {
  const auto set_counts = [](SimulationConfig& c, double v) {
    std::get<BoxMeshConfig>(c.mesh).counts[1] = int(v);
  };
  const auto set_ball = [](SimulationConfig& c, double v) { c.mesh = BallMeshConfig{{0, 0, 0}, 1, int(v)}; };
  const auto set_solves = [](SimulationConfig& c, double v) { c.integration.contact_iterations = int(v); };
  const auto set_vertex = [](SimulationConfig& c, double v) { c.fixed[2] = FixedVertices{{4, int(v)}}; };
  const auto set_newton = [](SimulationConfig& c, double v) {
    c.integration.equilibrium_iterations = int(v);
  };
  const auto set_interval = [](SimulationConfig& c, double v) { c.stress->interval_steps = int(v); };
  const auto set_points = [](SimulationConfig& c, double v) { c.regions[1].quadrature_points = int(v); };
  const auto set_group = [](SimulationConfig& c, double v) {
    c.mesh = MeshFileConfig{"a.msh", 1, 0};
    c.regions[1].cells = RegionGroup{int(v), ""};
  };
  for (const double value : {1, 2, 999, 1000}) expectAccepted(set_newton, value);
  for (const double value : {-1, 0, 1001})
    expectRefused("integration.equilibrium_iterations", set_newton, value);
  for (const double value : {1, 2, 999999, 1000000}) expectAccepted(set_interval, value);
  for (const double value : {-1, 0, 1000001}) expectRefused("stress.interval_steps", set_interval, value);
  for (const double value : {1, 4, 11}) expectAccepted(set_points, value);
  for (const double value : {-4, 0, 2, 5, 10, 12})
    expectRefused("regions[1].quadrature_points", set_points, value);
  for (const double value : {1, 2, 2147483647}) expectAccepted(set_group, value);
  for (const double value : {-1, 0}) expectRefused("regions[1].group.number", set_group, value);
  for (const double value : {1, 2, 199, 200}) expectAccepted(set_counts, value);
  for (const double value : {-1, 0, 201}) expectRefused("mesh.counts[1]", set_counts, value);
  for (const double value : {1, 2, 39, 40}) expectAccepted(set_ball, value);
  for (const double value : {-1, 0, 41}) expectRefused("mesh.half_count", set_ball, value);
  for (const double value : {1, 2, 19, 20}) expectAccepted(set_solves, value);
  for (const double value : {-1, 0, 21}) expectRefused("integration.contact_iterations", set_solves, value);
  for (const double value : {0, 1}) expectAccepted(set_vertex, value);
  expectRefused("fixed[2].vertices", set_vertex, -1);
}

TEST(SimulationConfig, ConjugateGradientsNeedCorotatedCells) {
  for (const SolverKind kind : {SolverKind::kAuto, SolverKind::kDirect, SolverKind::kJacobi,
                                SolverKind::kFactor, SolverKind::kAggregates}) {
    for (const Strain strain : {Strain::kLinear, Strain::kCorotated, Strain::kGreen}) {
      SimulationConfig config = fullScene();
      config.solver.kind = kind;
      config.element.strain = strain;
      const bool fits =
          strain == Strain::kCorotated || kind == SolverKind::kAuto || kind == SolverKind::kDirect;
      std::string complaint;
      try {
        validate(config);
      } catch (const std::invalid_argument& error) {
        complaint = error.what();
      }
      EXPECT_EQ(complaint, fits ? ""
                                : std::string("solver.kind = ") + toString(kind) +
                                      ": must be auto or direct unless element.strain is corotated");
    }
  }
}

TEST(SimulationConfig, RefusesWhatDoesNotGoTogether) {
  const auto refuse = [](const std::string& name, const std::function<void(SimulationConfig&)>& change) {
    expectRefused(
        name, [&](SimulationConfig& config, double) { change(config); }, 0);
  };
  refuse("tools[1].name", [](SimulationConfig& c) { c.tools.push_back(c.tools[0]); });
  for (const char* name : {"", "1st", "my tool", "a/b", "_a", "a-b"}) {
    refuse("tools[0].name", [&](SimulationConfig& c) { c.tools[0].name = name; });
  }
  refuse("tools[0].blade_edge_tool", [](SimulationConfig& c) {
    c.fracture.reset();
    c.cutting.reset();
  });
  refuse("tools[0].blade_edge_tool",
         [](SimulationConfig& c) { c.tools[0].blade_edge_tool = Eigen::Matrix3Xd(3, 1); });
  refuse("mesh.path", [](SimulationConfig& c) { c.mesh = MeshFileConfig(); });
  refuse("fixed[2].vertices", [](SimulationConfig& c) { c.fixed[2] = FixedVertices(); });
  refuse("regions[1].name", [](SimulationConfig& c) { c.regions[1].name = c.regions[0].name; });
  refuse("regions[1].name", [](SimulationConfig& c) { c.regions[1].name.clear(); });
  refuse("regions[0].group", [](SimulationConfig& c) { c.regions[0].cells = RegionGroup{1, ""}; });
  refuse("regions[0].group", [](SimulationConfig& c) { c.regions[0].cells = RegionGroup{0, "vein"}; });
  refuse("regions[0].group.number", [](SimulationConfig& c) {
    c.mesh = MeshFileConfig{"a.msh", 1, 0};
    c.regions[0].cells = RegionGroup{1, "vein"};
  });
  refuse("regions[0].quadrature_points", [](SimulationConfig& c) {
    c.regions[0].formulation = Formulation::kVirtual;
    c.regions[0].quadrature_points = 4;
  });
  refuse("regions[0].quadrature_points", [](SimulationConfig& c) {
    c.element.formulation = Formulation::kVirtual;
    c.regions[0].quadrature_points = 4;
  });
  const auto make_static = [](SimulationConfig& c) {
    c.integration.mode = AnalysisMode::kStatic;
    c.contact.reset();
    c.tools.clear();
  };
  SimulationConfig config = fullScene();
  make_static(config);
  EXPECT_NO_THROW(validate(config));
  refuse("contact", [&](SimulationConfig& c) { make_static(c), c.contact = ContactConfig(); });
  refuse("tools", [&](SimulationConfig& c) { make_static(c), c.tools.resize(1); });
  refuse("fixed", [&](SimulationConfig& c) { make_static(c), c.fixed.clear(); });
  config = fullScene();
  config.integration.mode = AnalysisMode::kQuasiStatic;
  EXPECT_NO_THROW(validate(config)) << "tools, blades and contact act from step to step";
  refuse("fixed", [&](SimulationConfig& c) {
    c.integration.mode = AnalysisMode::kQuasiStatic;
    c.fixed.clear();
  });
}

}  // namespace
}  // namespace polyscalpel
