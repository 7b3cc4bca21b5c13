// SPDX-License-Identifier: BSD-3-Clause
//
// Pieces: their table, and those that are taken away as debris.
#include <algorithm>
#include <sstream>

#include <gtest/gtest.h>

#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "polyscalpel/simulation/simulation.hpp"
#include "scenes.hpp"

namespace polyscalpel {
namespace {

const double kDensity = IsotropicMaterial().density_kg_m3;

/// The block, a blade, a ball that may press it, and no piece below a tenth of it.
SimulationConfig debrisScene(bool tetrahedra) {
  SimulationConfig config = pressingScene(tetrahedra);
  config.cutting = CuttingConfig();
  config.cutting->debris_volume_m3 = 5e-5;
  config.tools.push_back(cuttingScene().tools.front());
  config.stress = StressConfig();
  return config;
}

void expectSoundTable(const Simulation& simulation) {
  const Pieces pieces = findPieces(simulation.mesh());
  std::vector<PieceProperties> table = simulation.pieceTable();
  ASSERT_EQ(static_cast<int>(table.size()), pieces.count);
  std::vector<PieceProperties> expected(pieces.count);
  for (const CellId cell : simulation.mesh().cells()) {
    PieceProperties& piece = expected[pieces.piece_of_cell[cell.index()]];
    if (!piece.smallest_cell.isValid() || cell < piece.smallest_cell) piece.smallest_cell = cell;
    ++piece.num_cells;
    piece.volume_m3 += volume(makeCellSurface(simulation.mesh(), cell, simulation.mesh().restPositions()));
  }
  // findPieces() numbers by the smallest cell, the table as the pieces came into being.
  std::sort(table.begin(), table.end(), [](const PieceProperties& a, const PieceProperties& b) {
    return a.smallest_cell < b.smallest_cell;
  });
  for (int i = 0; i < pieces.count; ++i) {
    EXPECT_EQ(table[i].smallest_cell, expected[i].smallest_cell);
    EXPECT_EQ(table[i].num_cells, expected[i].num_cells);
    EXPECT_NEAR(table[i].volume_m3, expected[i].volume_m3, 1e-12 * expected[i].volume_m3);
    EXPECT_NEAR(table[i].mass_kg, kDensity * expected[i].volume_m3, 1e-12 * table[i].mass_kg);
  }
}

TEST(PieceTable, TellsVolumeAndMassOfEveryPiece) {
  SimulationConfig config = cuttingScene();
  Simulation simulation(config);
  expectSoundTable(simulation);
  EXPECT_NEAR(simulation.pieceTable().front().volume_m3, 5e-4, 1e-16);
  const CutReport event =
      simulation.cutAll({PlaneCut{{0.03, 0, 0}, {1, 0, 0}}, PlaneCut{{0, 0, 0.04}, {0, 0, 1}}});
  ASSERT_EQ(event.result.status, CutStatus::kCut) << event.result.message;
  EXPECT_EQ(simulation.numCuts(), 2);
  expectSoundTable(simulation);
  std::vector<double> volumes;
  for (const PieceProperties& piece : event.pieces) volumes.push_back(piece.volume_m3);
  std::sort(volumes.begin(), volumes.end());
  ASSERT_EQ(volumes.size(), 4u);
  const double expected[] = {0.03 * 0.1 * 0.01, 0.07 * 0.1 * 0.01, 0.03 * 0.1 * 0.04, 0.07 * 0.1 * 0.04};
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(volumes[i], expected[i], 1e-12 * 5e-4);
  simulation.reset();
  expectSoundTable(simulation);
}

TEST(PieceTable, ACutIsInheritedByItsChildren) {
  SimulationConfig config = cuttingScene();
  RegionConfig hard;
  hard.name = "hard";
  hard.cells = RegionBox{{0, 0, 0}, {0.05, 0.1, 0.05}};
  hard.material.density_kg_m3 = 3 * kDensity;
  config.regions = {hard};
  Simulation simulation(config);
  const double mass = simulation.pieceTable().front().mass_kg;
  EXPECT_NEAR(mass, 2 * kDensity * 5e-4, 1e-12 * mass);
  const CutReport event = simulation.cutAll({PlaneCut{{0.05, 0.043, 0.02}, {0.2, 1, 0.3}}});
  ASSERT_EQ(event.result.status, CutStatus::kCut);
  double sum = 0;
  for (const PieceProperties& piece : event.pieces) sum += piece.mass_kg;
  EXPECT_NEAR(sum, mass, 1e-12 * mass) << "children keep the region's material";
  // Copies of held vertices are held, and vertices between two of them.
  int held = 0;
  for (const NewVertex& vertex : event.result.change.new_vertices) {
    const bool expected = simulation.mesh().restPosition(vertex.vertex).z() == 0;
    EXPECT_EQ(simulation.fixedVertices()[vertex.vertex.index()], expected);
    held += expected;
  }
  EXPECT_GT(held, 4);
  // The new faces, and no others, carry the cut's number.
  for (int i = 0; i < simulation.mesh().faceCapacity(); ++i) {
    const Face& face = simulation.mesh().face(FaceId(i));
    if (!face.isAlive()) continue;
    double off_plane = 0;
    for (const VertexId v : face.loop) {
      const Eigen::Vector3d offset = simulation.mesh().restPosition(v) - Eigen::Vector3d(0.05, 0.043, 0.02);
      off_plane = std::max(off_plane, std::abs(Eigen::Vector3d(0.2, 1, 0.3).dot(offset)));
    }
    EXPECT_EQ(face.cut, off_plane < 0.05 * 0.025 ? 1 : 0);
  }
}

TEST(Debris, SmallPiecesGoAndTheRestGoesOnAsIfTheyHadNotBeen) {
  for (const bool tetrahedra : {false, true}) {
    Simulation simulation(debrisScene(tetrahedra));
    for (int step = 0; step < 30; ++step) simulation.step({pressingPose(step), std::nullopt});
    const CutReport event = simulation.cutAll({PlaneCut{{0.095, 0, 0}, {1, 0, 0}}});  // 5 % of the block
    ASSERT_EQ(event.result.status, CutStatus::kCut) << event.result.message;
    EXPECT_EQ(event.result.pieces_after, 2);
    EXPECT_EQ(event.debris.num_pieces, 1);
    EXPECT_NEAR(event.debris.volume_m3, 2.5e-5, 0.1 * 2.5e-5);  // the block is bent when it is cut
    EXPECT_NEAR(event.debris.mass_kg, kDensity * event.debris.volume_m3, 1e-12);
    EXPECT_FALSE(event.debris.change.removed_cells.empty());
    EXPECT_FALSE(event.debris.change.retired_vertices.empty());
    EXPECT_EQ(event.pieces.size(), 1u);
    EXPECT_EQ(simulation.pieces().count, 1);
    EXPECT_EQ(simulation.debris().num_pieces, 1);
    EXPECT_EQ(simulation.debris().volume_m3, event.debris.volume_m3);
    EXPECT_TRUE(checkMesh(simulation.mesh()).empty()) << checkMesh(simulation.mesh()).front();
    EXPECT_NEAR(volume(simulation.mesh(), simulation.mesh().restPositions()) + event.debris.volume_m3, 5e-4,
                1e-12 * 5e-4);
    expectSoundTable(simulation);
    const Eigen::Matrix3Xd before = simulation.positions();
    int contacts = 0;
    for (int step = 30; step < 80; ++step) {
      const StepReport report = simulation.step({pressingPose(step), cuttingPose(step - 30)});
      ASSERT_TRUE(report.converged) << report.message;
      contacts += static_cast<int>(report.contacts.size());
      ASSERT_TRUE(checkMesh(simulation.mesh()).empty()) << checkMesh(simulation.mesh()).front();
    }
    EXPECT_GT(contacts, 0);
    EXPECT_TRUE(simulation.positions().allFinite());
    for (const VertexId vertex : event.debris.change.retired_vertices) {
      EXPECT_EQ(simulation.positions().col(vertex.index()), before.col(vertex.index()));
      EXPECT_TRUE(simulation.fixedVertices()[vertex.index()]);
    }
    ASSERT_NE(simulation.stressField(), nullptr);
    EXPECT_TRUE(simulation.stressField()->vertex_stresses.allFinite());
  }
}

TEST(Debris, MayFallFromABladeInTheMiddleOfAStroke) {
  SimulationConfig config = cuttingScene(true);
  config.cutting->debris_volume_m3 = 1e-4;
  config.tools.push_back(config.tools[0]);
  config.tools[1].name = "second";
  Simulation simulation(config);
  int events = 0;
  // Two blades that leave a slice of 4 mm between them, and a part above it.
  for (int step = 0; step <= kCuttingSteps + 5; ++step) {
    const Eigen::Isometry3d lower = poseAt({-0.02 + 3e-3 * (step - 3), 0.05, 0.027});
    const StepReport report = simulation.step({cuttingPose(step), lower});
    ASSERT_TRUE(report.converged) << report.message;
    ASSERT_TRUE(checkMesh(simulation.mesh()).empty()) << checkMesh(simulation.mesh()).front();
    for (const CutReport& event : report.cuts) events += event.debris.num_pieces;
  }
  EXPECT_EQ(events, 1);
  EXPECT_EQ(simulation.debris().num_pieces, 1);
  EXPECT_EQ(simulation.pieces().count, 2);
}

TEST(Debris, IsKeptByDefaultAndTheLargestPieceAlways) {
  SimulationConfig config = cuttingScene();
  Simulation keeping(config);
  keeping.cut(PlaneCut{{0.095, 0, 0}, {1, 0, 0}});
  EXPECT_EQ(keeping.pieces().count, 2);
  EXPECT_EQ(keeping.debris().num_pieces, 0);
  config.cutting->debris_volume_m3 = 1;
  Simulation greedy(config);
  const CutReport event =
      greedy.cutAll({PlaneCut{{0.06, 0, 0}, {1, 0, 0}}, PlaneCut{{0, 0.05, 0}, {0, 1, 0}}});
  EXPECT_EQ(event.debris.num_pieces, 3);
  ASSERT_EQ(greedy.pieceTable().size(), 1u);
  EXPECT_NEAR(greedy.pieceTable().front().volume_m3, 0.06 * 0.05 * 0.05, 1e-16);
}

TEST(Debris, LeavesAStaticBodyWithWhatIsHeld) {
  SimulationConfig config = cuttingScene();
  config.tools.clear();
  config.integration.mode = AnalysisMode::kStatic;
  config.cutting->debris_volume_m3 = 2e-4;
  config.material.youngs_modulus_pa = 1e5;
  Simulation simulation(config);
  ASSERT_TRUE(simulation.step({}).converged);
  ASSERT_EQ(simulation.cut(PlaneCut{{0, 0, 0.038}, {0, 0, 1}}).status, CutStatus::kCut);
  EXPECT_EQ(simulation.debris().num_pieces, 1);
  const StepReport report = simulation.step({});
  EXPECT_TRUE(report.converged) << report.message;
}

std::string fingerprint(const Simulation& simulation) {
  std::ostringstream text;
  text << std::hexfloat;
  const PolyhedralMesh& mesh = simulation.mesh();
  text << mesh.numVertices() << ' ' << mesh.faceCapacity() << ' ' << mesh.cellCapacity() << '\n';
  for (int i = 0; i < mesh.numVertices(); ++i) {
    text << mesh.restPosition(VertexId(i)).transpose() << ' ' << mesh.localSize(VertexId(i)) << ' '
         << mesh.isRetired(VertexId(i)) << ' ' << simulation.positions().col(i).transpose() << ' '
         << simulation.velocities().col(i).transpose() << ' ' << simulation.fixedVertices()[i];
    for (const FaceId f : mesh.facesAround(VertexId(i))) text << ' ' << f.index();
    text << '\n';
  }
  for (int i = 0; i < mesh.faceCapacity(); ++i) {
    const Face& face = mesh.face(FaceId(i));
    for (std::size_t k = 0; k < face.loop.size(); ++k)
      text << face.loop[k].index() << ' ' << static_cast<int>(face.is_corner[k]) << ' ';
    text << face.cells[0].index() << ' ' << face.cells[1].index() << ' ' << face.cut << '\n';
  }
  for (int i = 0; i < mesh.cellCapacity(); ++i) {
    for (const FaceId f : mesh.cell(CellId(i)).faces) text << f.index() << ' ';
    text << mesh.cell(CellId(i)).region << '\n';
  }
  text << simulation.totalEnergy_j() << ' ' << simulation.movedMass_kg() << ' ' << simulation.numCuts() << ' '
       << simulation.cellsLeftWhole() << ' ' << simulation.debris().num_pieces << ' '
       << simulation.debris().volume_m3 << ' ' << simulation.stepCount() << '\n';
  for (const PieceProperties& piece : simulation.pieceTable())
    text << piece.smallest_cell.index() << ' ' << piece.volume_m3 << ' ' << piece.mass_kg << '\n';
  const std::optional<MeshQuality> quality = simulation.quality();
  if (quality) {
    text << quality->shortest_edge_m << ' ' << quality->shortest_edge_relative << ' '
         << quality->smallest_cell_volume_relative << ' ' << quality->largest_stiffness_over_mass_1_s2;
  }
  return text.str();
}

TEST(Debris, ResetAfterCutsDebrisAndAStrokeUnderWayIsBitForBit) {
  for (const bool tetrahedra : {false, true}) {
    Simulation simulation(debrisScene(tetrahedra));
    const std::string start = fingerprint(simulation);
    std::vector<std::string> first;
    for (int round = 0; round < 3; ++round) {
      std::vector<std::string> run;
      for (int step = 0; step < 28; ++step) {
        const StepReport report = simulation.step({pressingPose(step), cuttingPose(step)});
        ASSERT_TRUE(report.converged) << report.message;
        if (step == 12) {  // through vertices, along faces, over the slit, and slices thin enough to go
          const Eigen::Vector3d corner = simulation.positions().col(60);
          simulation.cutAll({PlaneCut{corner, {1, 1, 1}}});
          simulation.cutAll({PlaneCut{{0.05, 0, 0}, {1, 0, 0}}, PlaneCut{{0.052, 0, 0}, {1, 1e-3, 0}}});
          EXPECT_THROW(simulation.cut(PlaneCut{corner, {0, 0, 0}}), std::invalid_argument);
        }
        run.push_back(fingerprint(simulation));
      }
      EXPECT_GT(simulation.debris().num_pieces, 0);
      EXPECT_GT(simulation.step({std::nullopt, cuttingPose(28)}).tools[1].pending_crossings, 0);
      if (round == 0) first = run;
      ASSERT_EQ(run, first) << "round " << round;
      simulation.reset();
      ASSERT_EQ(fingerprint(simulation), start);
    }
  }
}

TEST(Simulation, ABladesMotionThatIsTooLongIsRefusedAndSaidSo) {
  SimulationConfig config = cuttingScene();
  config.tools[0].max_jump_m = 1e9;
  Simulation simulation(config);
  for (int step = 0; step < 15; ++step) simulation.step({cuttingPose(step)});
  const int vertices = simulation.mesh().numVertices();
  StepReport report = simulation.step({poseAt({1e6, 0.05, 0.031})});
  EXPECT_TRUE(report.converged);
  EXPECT_FALSE(report.tools[0].refusal.empty());
  EXPECT_EQ(report.tools[0].pending_crossings, 0);
  EXPECT_EQ(simulation.mesh().numVertices(), vertices);
  report = simulation.step({poseAt({1e6, 0.05, 0.031})});
  EXPECT_TRUE(report.tools[0].refusal.empty());
}

}  // namespace
}  // namespace polyscalpel
