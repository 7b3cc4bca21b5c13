// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "polyscalpel/simulation/simulation.hpp"
#include "scenes.hpp"

namespace polyscalpel {
namespace {

constexpr double kCell = 0.01;           // [m]
constexpr double kNotchHeight = 0.0537;  // within a layer of cells
constexpr double kStrength = 2.8e4;      // the load is 2e4 over the whole width

Eigen::Vector3d permuted(double across, double through, double along, int axis) {
  return axis == 2 ? Eigen::Vector3d(across, through, along) : Eigen::Vector3d(along, across, through);
}

/// A plate of 8 x 2 x 10 cells that hangs by a grip, from which nothing tears, with a weight below: tension
/// along the axis (2: z, 0: x), 2e4 Pa at g = 9.81.
SimulationConfig plateScene(bool tetrahedra, int axis = 2, double gravity = 9.81) {
  SimulationConfig config;
  BoxMeshConfig box;
  box.size_m = permuted(8 * kCell, 2 * kCell, 10 * kCell, axis);
  box.counts = permuted(8, 2, 10, axis).cast<int>();
  box.tetrahedra = tetrahedra;
  config.mesh = box;
  config.material.youngs_modulus_pa = 1e6;
  config.material.poisson_ratio = 0.3;
  config.material.strength_pa = kStrength;
  RegionConfig weight, grip;
  weight.name = "weight";
  weight.cells = RegionBox{Eigen::Vector3d::Constant(-1), permuted(1, 1, 2 * kCell, axis)};
  weight.material = config.material;
  weight.material.strength_pa = 0;
  weight.material.density_kg_m3 = 1e5;
  grip.name = "grip";
  grip.cells = RegionBox{permuted(-1, -1, 8 * kCell, axis), Eigen::Vector3d::Ones()};
  grip.material = config.material;
  grip.material.strength_pa = 0;
  config.regions = {weight, grip};
  config.fixed = {FixedBox{permuted(-1, -1, 10 * kCell - 1e-9, axis), Eigen::Vector3d::Ones()}};
  config.integration.gravity_m_s2 = permuted(0, 0, -gravity, axis);
  config.integration.time_step_s = 0.005;
  config.cutting = CuttingConfig();
  config.fracture = FractureConfig();
  return config;
}

/// A slit in the middle of the plate's width, half as wide.
void notch(Simulation& simulation, int axis = 2) {
  PolygonCut cut;
  cut.corners_world.resize(3, 4);
  const double ends[2] = {2 * kCell, 6 * kCell};
  for (int i = 0; i < 4; ++i)
    cut.corners_world.col(i) = permuted(ends[i == 1 || i == 2], i < 2 ? -1 : 1, kNotchHeight, axis);
  ASSERT_EQ(simulation.cut(cut).status, CutStatus::kCut);
}

struct Outcome {
  int steps = 0;  // up to the last split
  int splits = 0;
  bool was_limited = false;
};

/// Runs until the plate has parted or the steps are over, and looks at every event.
Outcome run(Simulation& simulation, int steps) {
  Outcome outcome;
  for (int step = 0; step < steps && simulation.pieces().count == 1; ++step) {
    const StepReport report = simulation.step({});
    EXPECT_TRUE(report.converged) << report.message;
    EXPECT_GT(report.times.fracture_s, 0);
    outcome.was_limited |= report.fracture_limited;
    for (const CutReport& event : report.cuts) {
      EXPECT_EQ(event.cause, CutCause::kFracture);
      EXPECT_EQ(event.tool, -1);
      EXPECT_EQ(event.result.status, CutStatus::kCut);
      EXPECT_TRUE(checkMesh(simulation.mesh()).empty()) << checkMesh(simulation.mesh()).front();
      EXPECT_EQ(simulation.pieces().count, findPieces(simulation.mesh()).count);
      EXPECT_LT(event.balance.momentum_change.norm(), 1e-15);  // of some 3 kg at 0.05 m/s
      EXPECT_LT(event.balance.kinetic_energy_change_j, 1e-15);
      outcome.steps = step + 1;
      outcome.splits += event.result.cells_split;
    }
  }
  EXPECT_EQ(simulation.fracture().cells_split, outcome.splits);
  EXPECT_EQ(simulation.fracture().cells_left_whole, 0);
  EXPECT_NEAR(volume(simulation.mesh(), simulation.mesh().restPositions()), simulation.restVolume_m3(),
              1e-12 * simulation.restVolume_m3());
  return outcome;
}

/// Largest distance of faces with this cut's number from the notch's plane [m].
double distanceFromNotch(const Simulation& simulation, int cut, int axis) {
  double largest = 0;
  for (int i = 0; i < simulation.mesh().faceCapacity(); ++i) {
    const Face& face = simulation.mesh().face(FaceId(i));
    if (!face.isAlive() || face.cut != cut) continue;
    for (const VertexId v : face.loop)
      largest = std::max(largest, std::abs(simulation.mesh().restPosition(v)[axis] - kNotchHeight));
  }
  return largest;
}

TEST(Fracture, ANotchedPlateInTensionCracksStraight) {
  for (const AnalysisMode mode : {AnalysisMode::kDynamic, AnalysisMode::kStatic}) {
    for (const bool tetrahedra : {false, true}) {
      for (const int axis : {2, 0}) {
        SCOPED_TRACE(::testing::Message() << static_cast<int>(mode) << tetrahedra << axis);
        SimulationConfig config = plateScene(tetrahedra, axis);
        config.integration.mode = mode;
        Simulation simulation(config);
        notch(simulation, axis);
        run(simulation, 40);
        EXPECT_EQ(simulation.pieces().count, 2);
        EXPECT_EQ(simulation.numCuts(), 2) << "the notch, and one crack from both of its ends";
        EXPECT_LT(distanceFromNotch(simulation, 2, axis), 0.1 * kCell);
        EXPECT_NEAR(simulation.fracture().area_m2, 4 * kCell * 2 * kCell, 0.01 * 8 * kCell * kCell);
        const double below = simulation.pieceTable()[0].volume_m3;
        EXPECT_NEAR(below, 8 * kCell * 2 * kCell * kNotchHeight, 0.02 * below);
      }
    }
  }
}

TEST(Fracture, AnUnnotchedPlatePartsInOneCrack) {
  for (const bool tetrahedra : {false, true}) {
    SimulationConfig config = plateScene(tetrahedra);
    config.material.strength_pa = 1.5e4;
    Simulation simulation(config);
    run(simulation, 60);
    EXPECT_EQ(simulation.pieces().count, 2);
    EXPECT_EQ(simulation.numCuts(), 1);
    EXPECT_NEAR(simulation.fracture().area_m2, 16 * kCell * kCell, 0.02 * 16 * kCell * kCell);
  }
}

TEST(Fracture, NothingTearsBelowTheStrengthNorWhereThereIsNone) {
  for (const bool tetrahedra : {false, true}) {
    SimulationConfig strong = plateScene(tetrahedra);
    strong.material.strength_pa = 1e6;
    SimulationConfig without = plateScene(tetrahedra);
    without.material.strength_pa = 0;
    without.regions[0].material.strength_pa = 1e9;  // the weight's, which bears little
    SimulationConfig off = plateScene(tetrahedra);
    off.fracture.reset();
    Simulation first(strong), second(without), third(off);
    for (Simulation* simulation : {&first, &second, &third}) notch(*simulation);
    for (int step = 0; step < 20; ++step) {
      const StepReport report = first.step({});
      EXPECT_GT(report.times.fracture_s, 0);
      EXPECT_TRUE(report.cuts.empty());
      EXPECT_TRUE(second.step({}).cuts.empty());
      const StepReport without_option = third.step({});
      EXPECT_EQ(without_option.times.fracture_s, 0);
      EXPECT_TRUE(without_option.cuts.empty());
      ASSERT_EQ(first.positions(), third.positions()) << "the motion does not know of it";
      ASSERT_EQ(second.positions(), third.positions());
    }
    const std::vector<std::string> parts = third.parts(), with = first.parts();
    EXPECT_EQ(std::count(parts.begin(), parts.end(), "fracture"), 0);
    EXPECT_EQ(std::count(with.begin(), with.end(), "fracture"), 1);
    EXPECT_EQ(third.fracture().cells_split, 0);
  }
}

TEST(Fracture, AHigherToughnessNeedsALargerLoad) {
  for (const bool tetrahedra : {false, true}) {
    const double loads[] = {2, 4, 8, 16};
    int last_first = 0;
    std::vector<int> firsts;  // the smallest load under which the crack runs
    for (const double toughness : {0.5, 4.0, 32.0}) {
      int first = 4;
      for (int i = 3; i >= 0; --i) {
        SimulationConfig config = plateScene(tetrahedra, 2, loads[i]);
        config.integration.mode = AnalysisMode::kStatic;
        config.material.strength_pa = 100;
        config.material.fracture_toughness_j_m2 = toughness;
        Simulation simulation(config);
        notch(simulation);
        simulation.step({});
        const bool runs = simulation.fracture().cells_split > 0;
        EXPECT_TRUE(runs ? first == i + 1 : true) << "a larger load parts what a smaller one does";
        if (runs) first = i;
      }
      EXPECT_GE(first, last_first);
      last_first = first;
      firsts.push_back(first);
    }
    EXPECT_LT(firsts.front(), firsts.back());
    EXPECT_LT(firsts.back(), 4);
  }
}

TEST(Fracture, TheCriticalLoadIsThatOfLinearFractureMechanics) {
  // K of a slit of 2 a in a strip of width W under sigma (C. E. Feddersen, 1966):
  // K^2 = sigma^2 pi a sec(pi a / W), G = K^2 / E. The stress ahead of the front is that of a few cells.
  const double a = 2 * kCell, width = 8 * kCell, area = width * 2 * kCell;
  for (const bool tetrahedra : {false, true}) {
    SimulationConfig config = plateScene(tetrahedra);
    config.integration.mode = AnalysisMode::kStatic;
    config.material.strength_pa = 100;
    config.material.youngs_modulus_pa = 1e8;
    const double mass = 2 * kCell * area * 1e5 + 0.034 * area * 1000;
    const double sigma = mass * 9.81 / area;
    const double release = sigma * sigma * M_PI * a / std::cos(M_PI * a / width) / 1e8;
    for (const auto& [part, runs] : {std::pair(0.4, true), std::pair(1.5, false)}) {
      config.material.fracture_toughness_j_m2 = part * release;
      Simulation simulation(config);
      notch(simulation);
      simulation.step({});
      EXPECT_EQ(simulation.fracture().cells_split > 0, runs) << tetrahedra << " " << part;
    }
  }
}

TEST(Fracture, TheRateIsHeldAndSaidToBe) {
  SimulationConfig config = plateScene(true);
  Simulation free(config);
  notch(free);
  const Outcome all = run(free, 60);
  EXPECT_FALSE(all.was_limited);
  config.fracture->max_splits_per_step = 1;
  Simulation slow(config);
  notch(slow);
  bool was_limited = false;
  for (int step = 0; step < 100 && slow.pieces().count == 1; ++step) {
    const int before = slow.fracture().cells_split;
    const StepReport report = slow.step({});
    EXPECT_LE(slow.fracture().cells_split, before + 1);
    was_limited |= report.fracture_limited;
  }
  EXPECT_TRUE(was_limited);
  EXPECT_EQ(slow.pieces().count, 2);
}

TEST(Fracture, ResetAndReplayAreBitForBit) {
  Simulation simulation(plateScene(true)), other(plateScene(true));
  std::vector<Eigen::Matrix3Xd> first;
  for (int round = 0; round < 2; ++round) {
    notch(simulation);
    if (round == 0) notch(other);
    for (int step = 0; step < 15; ++step) {
      simulation.step({});
      if (round == 0) {
        other.step({});
        first.push_back(simulation.positions());
        ASSERT_EQ(simulation.positions(), other.positions()) << step;
      } else {
        ASSERT_EQ(simulation.positions(), first[step]) << step;
      }
    }
    EXPECT_GT(simulation.fracture().cells_split, 0);
    simulation.reset();
    EXPECT_EQ(simulation.fracture().cells_split, 0);
    EXPECT_EQ(simulation.fracture().area_m2, 0);
    EXPECT_EQ(simulation.numCuts(), 0);
  }
}

TEST(Fracture, CracksRunWhileABladeCutsTheSameCells) {
  for (const bool tetrahedra : {false, true}) {
    SimulationConfig config = plateScene(tetrahedra);
    config.material.strength_pa = 1.5e4;
    ToolConfig tool;
    tool.name = "blade";
    tool.blade_edge_tool = (Eigen::Matrix3Xd(3, 2) << 0, 0, -0.1, 0.1, 0, 0).finished();
    config.tools = {tool};
    Simulation simulation(config);
    int by_blade = 0, by_stress = 0;
    for (int step = 0; step < 60; ++step) {
      const StepReport report = simulation.step({poseAt({-0.01 + 3e-3 * step, 0.01, 0.049})});
      ASSERT_TRUE(report.converged) << report.message;
      ASSERT_TRUE(checkMesh(simulation.mesh()).empty()) << checkMesh(simulation.mesh()).front();
      for (const CutReport& event : report.cuts)
        ++(event.cause == CutCause::kFracture ? by_stress : by_blade);
    }
    EXPECT_GT(by_blade, 0);
    EXPECT_GT(by_stress, 0);
    EXPECT_GE(simulation.pieces().count, 2);
    EXPECT_NEAR(volume(simulation.mesh(), simulation.mesh().restPositions()), simulation.restVolume_m3(),
                1e-9 * simulation.restVolume_m3());
  }
}

}  // namespace
}  // namespace polyscalpel
