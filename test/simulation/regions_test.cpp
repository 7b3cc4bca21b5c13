// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/simulation/regions.hpp"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/simulation/simulation.hpp"
#include "scenes.hpp"

namespace polyscalpel {
namespace {

const std::map<std::string, int> kNoNames;

/// Six unit cubes along x; the mean of cell i's vertices is (i + 1/2, 1/2, 1/2).
PolyhedralMesh row() {
  return makeHexBox({0, 0, 0}, {6, 1, 1}, {6, 1, 1});
}

/// The same as two tets of regions 6 and 8, as from a file.
PolyhedralMesh twoGroups() {
  Eigen::Matrix3Xd points(3, 5);
  points << 0, 1, 0, 0, 1,  //
      0, 0, 1, 0, 1,        //
      0, 0, 0, 1, 1;
  return {points,
          {{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}, {{4, 2, 3}, {4, 1, 2}, {4, 3, 1}, {1, 3, 2}}},
          {6, 8}};
}

RegionConfig region(const std::string& name, const RegionCells& cells, double youngs_modulus_pa = 1e6) {
  RegionConfig config;
  config.name = name;
  config.cells = cells;
  config.material.youngs_modulus_pa = youngs_modulus_pa;
  return config;
}

RegionBox along(double lowest_x, double highest_x) {
  return {{lowest_x, 0, 0}, {highest_x, 1, 1}};
}

SimulationConfig scene(std::vector<RegionConfig> regions) {
  SimulationConfig config;
  config.regions = std::move(regions);
  return config;
}

RegionConfig ordered(RegionConfig config, int order) {
  config.order = order;
  return config;
}

void expectRefused(const PolyhedralMesh& mesh, const SimulationConfig& config,
                   const std::vector<std::string>& words,
                   const std::map<std::string, int>& names = kNoNames) {
  try {
    makeCellKinds(mesh, config, names);
    ADD_FAILURE() << "accepted";
  } catch (const std::invalid_argument& error) {
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << word << " in: " << error.what();
  }
}

TEST(Regions, WithoutAnyEveryCellIsOfTheScenesKind) {
  SimulationConfig config;
  config.material.youngs_modulus_pa = 123;
  config.element.quadrature_points = 11;
  const CellKinds kinds = makeCellKinds(row(), config, kNoNames);
  ASSERT_EQ(kinds.kinds.size(), 1u);
  EXPECT_EQ(kinds.kinds[0].material.youngs_modulus_pa, 123);
  EXPECT_EQ(kinds.kinds[0].element.quadrature_points, 11);
  EXPECT_TRUE(kinds.of_cell.empty());
}

TEST(Regions, HoldTheCellsWhoseVertexMeanLiesInThem) {
  // The bounds belong to both shapes.
  const CellKinds kinds = makeCellKinds(
      row(), scene({region("box", along(0.5, 1.5)), region("ball", RegionSphere{{4, 0.5, 0.5}, 0.5})}),
      kNoNames);
  EXPECT_EQ(kinds.of_cell, std::vector<int>({1, 1, 0, 2, 2, 0}));
  const CellKinds smaller = makeCellKinds(
      row(),
      scene({region("box", along(0.5 + 1e-9, 1.5)), region("ball", RegionSphere{{4 + 1e-9, 0.5, 0.5}, 0.5})}),
      kNoNames);
  EXPECT_EQ(smaller.of_cell, std::vector<int>({0, 1, 0, 0, 2, 0}));
}

TEST(Regions, OverrideTheScenesElement) {
  SimulationConfig config =
      scene({region("stiff", along(0, 1)), region("fine", along(1, 2)), region("cheap", along(2, 3))});
  config.element.stabilisation_scale = 0.7;
  config.element.strain = Strain::kGreen;
  config.regions[1].quadrature_points = 11;
  config.regions[2].formulation = Formulation::kVirtual;
  const CellKinds kinds = makeCellKinds(row(), config, kNoNames);
  ASSERT_EQ(kinds.kinds.size(), 4u);
  for (const CellKind& kind : kinds.kinds) {
    EXPECT_EQ(kind.element.stabilisation_scale, 0.7);
    EXPECT_EQ(kind.element.strain, Strain::kGreen);
  }
  for (const int i : {0, 1, 3}) EXPECT_EQ(kinds.kinds[i].element.quadrature_points, 4);
  EXPECT_EQ(kinds.kinds[2].element.quadrature_points, 11);
  for (const int i : {0, 1, 2}) EXPECT_EQ(kinds.kinds[i].element.formulation, Formulation::kMeanValue);
  EXPECT_EQ(kinds.kinds[3].element.formulation, Formulation::kVirtual);
  EXPECT_EQ(kinds.kinds[0].material.youngs_modulus_pa, IsotropicMaterial().youngs_modulus_pa);
  EXPECT_EQ(kinds.kinds[1].material.youngs_modulus_pa, 1e6);
}

TEST(Regions, ArePhysicalGroupsByNumberOrName) {
  const std::map<std::string, int> names = {{"liver", 6}, {"vein", 8}};
  SimulationConfig config = scene({region("a", RegionGroup{8, ""})});
  config.mesh = MeshFileConfig{"two.msh", 1, 0};
  EXPECT_EQ(makeCellKinds(twoGroups(), config, kNoNames).of_cell, std::vector<int>({0, 1}));
  config.regions[0].cells = RegionGroup{0, "liver"};
  EXPECT_EQ(makeCellKinds(twoGroups(), config, names).of_cell, std::vector<int>({1, 0}));
  config.regions[0].cells = RegionGroup{0, "livre"};
  expectRefused(twoGroups(), config, {"regions[0].group.name", "'livre'", "liver, vein"}, names);
  expectRefused(twoGroups(), config, {"'livre'", "none"});
  config.regions[0].cells = RegionGroup{7, ""};
  expectRefused(twoGroups(), config, {"regions[0] ('a')", "no cell", "6, 8"}, names);
}

TEST(Regions, TheHighestOrderWins) {
  // In every order of the list: of three that share cell 2 the highest, elsewhere the highest that is there.
  std::vector<RegionConfig> regions = {ordered(region("low", along(0, 6), 1), -3),
                                       ordered(region("middle", along(1, 4), 2), 0),
                                       ordered(region("high", along(2, 3), 3), 5)};
  const auto by_modulus = [](const RegionConfig& a, const RegionConfig& b) {
    return a.material.youngs_modulus_pa < b.material.youngs_modulus_pa;
  };
  do {
    const CellKinds kinds = makeCellKinds(row(), scene(regions), kNoNames);
    std::vector<double> moduli;
    for (const int kind : kinds.of_cell) moduli.push_back(kinds.kinds[kind].material.youngs_modulus_pa);
    EXPECT_EQ(moduli, std::vector<double>({1, 2, 3, 2, 1, 1}));
  } while (std::next_permutation(regions.begin(), regions.end(), by_modulus));
}

TEST(Regions, RefuseToShareCellsWithoutDifferentOrders) {
  const RegionConfig a = region("a", along(0, 3)), b = region("b", along(2, 5));
  const std::vector<std::string> words = {"regions[0] ('a')", "regions[1] ('b')", "cell 2", "order"};
  expectRefused(row(), scene({a, b}), words);
  expectRefused(row(), scene({ordered(a, 1), b}), words);
  expectRefused(row(), scene({a, ordered(b, 1)}), words);
  expectRefused(row(), scene({ordered(a, 1), ordered(b, 1)}), words);
  EXPECT_NO_THROW(makeCellKinds(row(), scene({ordered(a, 1), ordered(b, 2)}), kNoNames));
  // A third, higher one does not settle the matter between the two.
  expectRefused(row(), scene({ordered(a, 1), ordered(b, 1), ordered(region("c", along(2, 3)), 9)}), words);
  EXPECT_NO_THROW(makeCellKinds(row(), scene({a, region("d", along(3, 5))}), kNoNames)) << "they only touch";
}

TEST(Regions, RefuseToHoldNothing) {
  expectRefused(row(), scene({region("a", along(0, 1)), region("far", along(7, 8))}),
                {"regions[1] ('far')", "no cell"});
  expectRefused(row(), scene({region("tiny", RegionSphere{{1, 0.5, 0.5}, 0.49})}), {"'tiny'", "no cell"});
  expectRefused(row(),
                scene({ordered(region("hidden", along(2, 3)), 1), ordered(region("over", along(0, 6)), 2)}),
                {"regions[0] ('hidden')", "higher order"});
}

TEST(Regions, ABodySagsBetweenThoseOfItsTwoMaterials) {
  const auto sag = [](const SimulationConfig& config) {
    Simulation simulation(config);
    EXPECT_TRUE(simulation.step({}).converged);
    return (simulation.mesh().restPositions() - simulation.positions()).row(2).maxCoeff();
  };
  SimulationConfig soft = blockScene();
  soft.integration.mode = AnalysisMode::kStatic;
  SimulationConfig stiff = soft;
  stiff.material.youngs_modulus_pa *= 10;
  SimulationConfig both = soft;  // the lower half stiff
  both.regions = {region("base", RegionBox{{0, 0, 0}, {0.1, 0.1, 0.025}}, stiff.material.youngs_modulus_pa)};
  EXPECT_GT(sag(both), 1.1 * sag(stiff));
  EXPECT_LT(sag(both), 0.9 * sag(soft));
  // A region of everything, of the scene's own material, changes nothing.
  SimulationConfig same = soft;
  same.regions = {region("all", RegionBox{{0, 0, 0}, {0.1, 0.1, 0.05}}, soft.material.youngs_modulus_pa)};
  EXPECT_EQ(sag(same), sag(soft));
}

}  // namespace
}  // namespace polyscalpel
