// SPDX-License-Identifier: BSD-3-Clause
//
// A search by the tree gives what a look at every cell gives, bit for bit.
#include "polyscalpel/cutting/blade_sweep.hpp"
#include "polyscalpel/cutting/blade_distance.hpp"

#include <cmath>
#include <map>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "polyscalpel/mesh/mesh_generation.hpp"

namespace polyscalpel {
namespace {

using Eigen::AngleAxisd;
using Eigen::Isometry3d;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Eigen::Vector3i;

class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double number() { return uniform_(random_); }
  Vector3d vector() { return {number(), number(), number()}; }
  Isometry3d pose(double reach, double turn) {
    Isometry3d T = Isometry3d::Identity();
    T.translation() = reach * vector();
    T.linear() = AngleAxisd(turn * number(), vector().normalized()).toRotationMatrix();
    return T;
  }

 private:
  std::mt19937 random_;
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

/// Returns the number of hits.
std::size_t expectSame(const std::vector<Hit>& found, const std::vector<Hit>& expected) {
  EXPECT_EQ(found.size(), expected.size());
  if (found.size() != expected.size()) return 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].edge, expected[i].edge);
    EXPECT_EQ(found[i].weight, expected[i].weight);
    EXPECT_EQ(found[i].sign, expected[i].sign);
    EXPECT_EQ(found[i].alignment, expected[i].alignment);
  }
  return found.size();
}

/// A body that is cut again and again while it turns, bulges and drifts, with its index.
class Patient {
 public:
  explicit Patient(PolyhedralMesh rest)
      : mesh(std::move(rest)), index(mesh), positions_(mesh.restPositions()) {}

  /// Moves every vertex to a place that depends on the time alone.
  Matrix3Xd positionsAt(double time) const {
    Isometry3d T = Isometry3d::Identity();
    T.translation() = Vector3d(0.3 * time, -0.1 * time, 0);
    T.linear() = AngleAxisd(0.2 * time, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    Matrix3Xd x = mesh.restPositions();
    x.row(2) += 0.1 * std::min(time, 1.0) * x.row(0).cwiseAbs2();
    return T * x;
  }

  void cut(const CutOperation& operation) {
    const CutResult result = cutMesh(mesh, positions_, operation, {}, ++num_cuts_, &index);
    extendByNewVertices(result.change.new_vertices, positions_);
    EXPECT_EQ(result.pieces_after, findPieces(mesh).count);
  }

  void moveTo(double time) { positions_ = positionsAt(time); }
  const Matrix3Xd& positions() const { return positions_; }

  PolyhedralMesh mesh;
  MeshIndex index;

 private:
  Matrix3Xd positions_;
  int num_cuts_ = 0;
};

/// Near the centre of a ball of radius 1.
PlaneCut randomPlane(Dice& dice, const Vector3d& middle) {
  return {middle + 0.7 * dice.vector(), dice.vector()};
}

PolygonCut randomPolygon(Dice& dice, const Vector3d& middle) {
  const Vector3d centre = middle + dice.vector(), u = dice.vector(), v = dice.vector().cross(u);
  PolygonCut polygon;
  polygon.corners_world.resize(3, 4);
  polygon.corners_world << centre - u - v, centre + u - v, centre + u + v, centre - u + v;
  return polygon;
}

struct Tally {
  std::size_t moving = 0, still = 0, plane = 0, polygon = 0;
  int in_tissue = 0;
};

/// Searches of all kinds between two times.
void expectSearchesAgree(Patient& patient, Dice& dice, double start, double end, Tally& tally) {
  const PolyhedralMesh& mesh = patient.mesh;
  const Matrix3Xd x0 = patient.positionsAt(start), x1 = patient.positionsAt(end);
  Matrix3Xd edge(3, 3);
  edge << -0.3, 0, 0.3, 0, 0.1, 0, 0, 0, 0;
  const Isometry3d T0 = Eigen::Translation3d(x0.rowwise().mean()) * dice.pose(1.5, 3),
                   T1 = T0 * dice.pose(0.5, 1);
  CellTree& tree = patient.index.tree;
  tree.fit(mesh, x0, x1, reachOf(edge, T0, T1));
  ASSERT_FALSE(tree.isEmpty());
  const BladeMotion motion{edge, T0, T1, x0, x1};
  tally.moving += expectSame(*findHits(mesh, tree, motion, 0.25), *findHits(mesh, {}, motion, 0.25));
  const BladeMotion still{edge, T0, T1, x1, x1};
  tally.still += expectSame(*findHits(mesh, tree, still, 0.25), *findHits(mesh, {}, still, 0.25));
  const Matrix3Xd blade = T1 * edge;
  for (const double margin : {0.0, 0.5, 2.0}) {
    const auto cells = cellsAtBlade(mesh, {}, x1, blade, margin);
    EXPECT_EQ(cellsAtBlade(mesh, tree, x1, blade, margin), cells);
    tally.in_tissue += !cells.empty();
  }
  tree.fit(mesh, x1);
  for (const Matrix3Xd* x : {&x0, &x1}) {
    tree.fit(mesh, *x);
    const PlaneCut plane = randomPlane(dice, x->rowwise().mean());
    tally.plane += expectSame(findHits(mesh, tree, *x, plane), findHits(mesh, {}, *x, plane));
    const PolygonCut polygon = randomPolygon(dice, x->rowwise().mean());
    tally.polygon += expectSame(findHits(mesh, tree, *x, polygon), findHits(mesh, {}, *x, polygon));
  }
}

TEST(BladeSweep, ATreeChangesNoHitWhileTheBodyMovesAndIsCut) {
  Dice dice(3);
  Patient patient(makeTetBall(Vector3d::Zero(), 1, 3));
  Tally tally;
  double time = 0;
  for (int i = 0; i < 25; ++i) {
    for (const double step : {0.001, 0.02, 0.5}) {
      expectSearchesAgree(patient, dice, time, time + step, tally);
      time += step;
    }
    patient.moveTo(time);
    patient.index.tree.fit(patient.mesh, patient.positions());
    const Vector3d middle = patient.positions().rowwise().mean();
    patient.cut(randomPolygon(dice, middle));
    // Cells of the cut are found without another fit.
    const PlaneCut plane = randomPlane(dice, middle);
    expectSame(findHits(patient.mesh, patient.index.tree, patient.positions(), plane),
               findHits(patient.mesh, {}, patient.positions(), plane));
  }
  for (const std::size_t hits : {tally.moving, tally.still, tally.plane, tally.polygon})
    EXPECT_GT(hits, 100u);
  EXPECT_GT(tally.in_tissue, 20);
  EXPECT_LT(tally.in_tissue, 200) << "of 225";
}

TEST(BladeSweep, ATreeChangesNoHitAtTies) {
  // Planes along faces and through vertices of a regular body, where every box touches.
  const PolyhedralMesh mesh = makeHexBox(Vector3d::Zero(), Vector3d::Constant(4), Vector3i::Constant(4));
  const Matrix3Xd positions = mesh.restPositions();
  CellTree tree;
  tree.fit(mesh, positions);
  for (const Vector3d& normal : {Vector3d(1, 0, 0), Vector3d(0, -1, 0), Vector3d(1, 1, 0), Vector3d(1, 1, 1),
                                 Vector3d(1e-300, 0, 0), Vector3d(0, 1e300, 0)}) {
    for (const double at : {0.0, 1.0, 2.0, 4.0}) {
      const PlaneCut plane{Vector3d::Constant(at), normal};
      expectSame(findHits(mesh, tree, positions, plane), findHits(mesh, {}, positions, plane));
      PolygonCut polygon;
      const Vector3d u = normal.stableNormalized().unitOrthogonal(), v = normal.stableNormalized().cross(u);
      polygon.corners_world.resize(3, 4);
      polygon.corners_world << Vector3d::Constant(at) - u - v, Vector3d::Constant(at) + u - v,
          Vector3d::Constant(at) + u + v, Vector3d::Constant(at) - u + v;
      expectSame(findHits(mesh, tree, positions, polygon), findHits(mesh, {}, positions, polygon));
    }
  }
}

TEST(BladeSweep, ABladeThatStopsOnAnEdgeLosesNoHit) {
  // The surface has its border outside of the body: every face's outline crosses it to and fro equally often.
  const PolyhedralMesh mesh = makeTetBox(Vector3d::Zero(), Vector3d(1, 0.5, 0.5), Vector3i(4, 2, 2));
  const Matrix3Xd positions = mesh.restPositions();
  Matrix3Xd blade(3, 2);
  blade << 0, 0, 0, 0, -2, 2;
  Dice dice(7);
  int num_hits = 0;
  for (int index = 0; index < mesh.faceCapacity(); ++index) {
    const auto& loop = mesh.face(FaceId(index)).loop;
    const Vector3d a = mesh.restPosition(loop[0]), b = mesh.restPosition(loop[1]);
    Eigen::Matrix3d axes;
    axes.col(2) = (b - a).normalized();
    axes.col(1) = axes.col(2).cross(dice.vector()).normalized();
    axes.col(0) = axes.col(1).cross(axes.col(2));
    std::map<Edge, int> sums;
    std::vector<Isometry3d> poses(9, Isometry3d::Identity());  // on the edge in the middle one
    for (int step = 0; step < 9; ++step) {
      poses[step].linear() = axes;
      poses[step].translation() = a + 3.0 * (step - 4) / 4 * axes.col(0);
    }
    for (int step = 0; step < 8; ++step) {
      const auto hits =
          findHits(mesh, {}, BladeMotion{blade, poses[step], poses[step + 1], positions, positions}, 0.25);
      ASSERT_TRUE(hits);
      num_hits += static_cast<int>(hits->size());
      for (const Hit& hit : *hits) sums[hit.edge] += hit.sign;
    }
    for (int other = 0; other < mesh.faceCapacity(); ++other) {
      const auto& around = mesh.face(FaceId(other)).loop;
      int sum = 0;
      for (std::size_t i = 0; i < around.size(); ++i) {
        const VertexId from = around[i], to = around[(i + 1) % around.size()];
        sum += from < to ? sums[makeEdge(from, to)] : -sums[makeEdge(from, to)];
      }
      EXPECT_EQ(sum, 0) << "face " << other << " of a blade on the edge " << loop[0].index() << "-"
                        << loop[1].index();
    }
  }
  EXPECT_GT(num_hits, 1000);
}

TEST(BladeSweep, ALongBladeThatTurnsPassesEdgesOnItsRuledSurface) {
  // A blade of 18 cells' length about the middle of a cube, which it goes through while it turns by 80
  // degrees.
  constexpr int kCells = 6;
  constexpr double kSize = 1.0 / kCells, kTurn = 80 * EIGEN_PI / 180;
  const PolyhedralMesh mesh = makeTetBox(Vector3d::Zero(), Vector3d::Ones(), Vector3i::Constant(kCells));
  const Matrix3Xd positions = mesh.restPositions();
  Matrix3Xd blade(3, 2);
  blade << 0, 0, 0, 0, -9 * kSize, 9 * kSize;
  const auto poseAt = [](double s) {
    Isometry3d T = Isometry3d::Identity();
    T.linear() = Eigen::AngleAxisd(kTurn * s, Vector3d::UnitX()).toRotationMatrix();
    T.translation() = Vector3d(1.2 * s - 0.1, 0.5, 0.5);
    return T;
  };
  const Isometry3d start = poseAt(0), end = poseAt(1);
  const auto hits = findHits(mesh, {}, BladeMotion{blade, start, end, positions, positions}, 0.25);
  ASSERT_TRUE(hits);
  EXPECT_GT(hits->size(), 100u);
  for (const Hit& hit : *hits) {
    const Vector3d point = (1 - hit.weight) * mesh.restPosition(hit.edge.first) +
                           hit.weight * mesh.restPosition(hit.edge.second);
    const double across = (poseAt((point.x() + 0.1) / 1.2).inverse() * point).y();
    EXPECT_LT(std::abs(across), 0.01 * kSize) << "at " << point.transpose();
  }
}

TEST(BladeSweep, ASweepWithATreeCutsAsWithout) {
  SweepCut sweep;
  sweep.edge_tool.resize(3, 2);
  sweep.edge_tool << 0, 0, -1.5, 1.5, 0, 0;
  for (int i = 0; i <= 12; ++i) {
    Isometry3d T = Isometry3d::Identity();
    T.translation() = Vector3d(0.2 * std::sin(0.4 * i), 0, 1.2 - 0.2 * i);
    sweep.T_world_tool.push_back(T);
  }
  PolyhedralMesh with = makeTetBall(Vector3d::Zero(), 1, 3), without = with;
  const Matrix3Xd positions = with.restPositions();
  Matrix3Xd edge = sweep.edge_tool;
  BladeCut blade(edge, {}), blade_without(edge, {});
  MeshIndex index(with);
  Matrix3Xd x = positions;
  for (int i = 0; i < 12; ++i) {
    index.tree.fit(with, x);
    const CutResult a =
        blade.advance(with, x, x, sweep.T_world_tool[i], sweep.T_world_tool[i + 1], 1, &index);
    const CutResult b =
        blade_without.advance(without, x, x, sweep.T_world_tool[i], sweep.T_world_tool[i + 1], 1);
    EXPECT_EQ(a.message, b.message);
    EXPECT_EQ(a.pieces_before, b.pieces_before);
    EXPECT_EQ(a.pieces_after, b.pieces_after);
    ASSERT_EQ(a.change.new_vertices.size(), b.change.new_vertices.size());
    extendByNewVertices(a.change.new_vertices, x);
  }
  EXPECT_EQ(with.restPositions(), without.restPositions());
  EXPECT_EQ(with.numCells(), without.numCells());

  // The same as one operation, for which the tree is built on the way.
  PolyhedralMesh whole = makeTetBall(Vector3d::Zero(), 1, 3);
  cutMesh(whole, positions, sweep, {}, 1);
  EXPECT_EQ(findPieces(whole).count, findPieces(with).count);
}

}  // namespace
}  // namespace polyscalpel
