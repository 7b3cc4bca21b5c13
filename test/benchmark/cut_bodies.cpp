// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/cut_bodies.hpp"

#include <cmath>
#include <random>

#include <Eigen/Geometry>

#include "benchmark/timing.hpp"
#include "polyscalpel/cutting/cut_mesh.hpp"
#include "polyscalpel/mesh/mesh_checks.hpp"
#include "polyscalpel/mesh/mesh_generation.hpp"
#include "polyscalpel/mesh/mesh_io.hpp"
#include "polyscalpel/mesh/surface.hpp"
#include "polyscalpel/simulation/simulation_config.hpp"

namespace polyscalpel::report {
namespace {

using Eigen::Vector3d;

/// A blade that comes down along -z and turns about z while it wanders sideways: the cut is curved in both
/// directions. Every second one runs across the others.
SweepCut makeSweep(const Vector3d& centre, double radius, double foot_z, int index, int num_cuts,
                   std::mt19937& random) {
  constexpr int kPoses = 25, kEdgePoints = 5;
  std::uniform_real_distribution<double> uniform(-1, 1);
  const int num_along = (num_cuts + 1) / 2;
  const bool is_across = index % 2 == 1;
  const int in_family = index / 2, family_size = is_across ? num_cuts - num_along : num_along;
  const double offset = radius * (1.5 * (in_family + 0.5) / family_size - 0.75 + 0.02 * uniform(random));
  const double twist = 0.15 * uniform(random), wander = 0.05 * radius * uniform(random);

  SweepCut sweep;
  sweep.edge_tool.resize(3, kEdgePoints);
  for (int i = 0; i < kEdgePoints; ++i) {
    const double y = 2.0 * i / (kEdgePoints - 1) - 1;
    sweep.edge_tool.col(i) = Vector3d(0.04 * radius * y * y, 1.3 * radius * y, 0);
  }
  const double top_z = centre.z() + 1.1 * radius;
  for (int i = 0; i < kPoses; ++i) {
    const double t = static_cast<double>(i) / (kPoses - 1);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translate(Vector3d(centre.x(), centre.y(), top_z + t * (foot_z - top_z)));
    T.rotate(Eigen::AngleAxisd(is_across ? EIGEN_PI / 2 : 0, Vector3d::UnitZ()));
    T.translate(Vector3d(offset + wander * std::sin(EIGEN_PI * t), 0, 0));
    T.rotate(Eigen::AngleAxisd(twist * (t - 0.5), Vector3d::UnitZ()));
    sweep.T_world_tool.push_back(T);
  }
  return sweep;
}

/// A blade of several legs that passes the whole body; the first cut of every three comes down along -z, the
/// second runs across it, the third goes along x.
SweepCut makeHairpin(const Vector3d& centre, double radius, int index, int num_cuts, const Hairpins& hairpins,
                     std::mt19937& random) {
  constexpr int kPoses = 25, kPointsPerLeg = 5, kDirections = 3;
  const auto [legs, reach] = hairpins;
  std::uniform_real_distribution<double> uniform(-1, 1);
  const int direction = index % kDirections, in_family = index / kDirections;
  const int family_size = (num_cuts + kDirections - 1 - direction) / kDirections;
  const double gap = 2 * reach * radius / (family_size * legs);
  const double offset = -reach * radius + gap * (legs * (in_family + 0.5) + 0.1 * uniform(random));
  const double twist = 0.15 * uniform(random), wander = 0.05 * radius * uniform(random);

  SweepCut sweep;
  sweep.edge_tool.resize(3, kPointsPerLeg * legs);
  for (int leg = 0; leg < legs; ++leg) {
    for (int i = 0; i < kPointsPerLeg; ++i) {
      const double y = (leg % 2 == 0 ? 1 : -1) * (2.0 * i / (kPointsPerLeg - 1) - 1);
      sweep.edge_tool.col(leg * kPointsPerLeg + i) =
          Vector3d(0.04 * radius * y * y + gap * (leg - 0.5 * (legs - 1)), 1.3 * radius * y, 0);
    }
  }
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  if (direction == 1) R = Eigen::AngleAxisd(EIGEN_PI / 2, Vector3d::UnitZ());
  if (direction == 2) R = Eigen::AngleAxisd(-EIGEN_PI / 2, Vector3d::UnitY());
  for (int i = 0; i < kPoses; ++i) {
    const double t = static_cast<double>(i) / (kPoses - 1);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translate(centre);
    T.rotate(R);
    T.translate(Vector3d(offset + wander * std::sin(EIGEN_PI * t), 0, 1.1 * radius * (1 - 2 * t)));
    T.rotate(Eigen::AngleAxisd(twist * (t - 0.5), Vector3d::UnitZ()));
    sweep.T_world_tool.push_back(T);
  }
  return sweep;
}

double findMassFloor(const CutBody& body) {
  std::vector<double> masses(body.mesh.numVertices());
  for (const CellId id : body.mesh.cells()) {
    const std::vector<VertexId>& vertices = body.mesh.cell(id).vertices;
    const double mass = body.material.density_kg_m3 *
                        volume(makeCellSurface(body.mesh, id, body.mesh.restPositions())) / vertices.size();
    for (const VertexId vertex : vertices) masses[vertex.index()] += mass;
  }
  return IntegrationConfig().mass_floor * median(masses);
}

void cut(CutBody& body, const CutOperation& operation) {
  const Eigen::Matrix3Xd positions = body.mesh.restPositions();
  body.cutting_s += secondsOf([&] {
    const CutResult result = cutMesh(body.mesh, positions, operation, CuttingConfig(), ++body.cuts);
    body.cells_left_whole += result.cells_left_whole;
  });
}

/// Fixes the foot and every piece without three fixed vertices that span a triangle.
void hold(CutBody& body, double foot_z) {
  const PolyhedralMesh& mesh = body.mesh;
  body.fixed.assign(mesh.numVertices(), false);
  body.foot_z_m = foot_z;
  for (int i = 0; i < mesh.numVertices(); ++i) body.fixed[i] = mesh.restPosition(VertexId(i)).z() <= foot_z;
  const Pieces pieces = findPieces(mesh);
  body.pieces = pieces.count;
  std::vector<std::vector<int>> vertices(pieces.count);
  for (const CellId id : mesh.cells())
    for (const VertexId vertex : mesh.cell(id).vertices)
      vertices[pieces.piece_of_cell[id.index()]].push_back(vertex.index());
  for (const std::vector<int>& of_piece : vertices) {
    std::vector<Vector3d> held;
    for (const int vertex : of_piece)
      if (body.fixed[vertex]) held.push_back(mesh.restPosition(VertexId(vertex)));
    double area = 0;
    Vector3d farthest = Vector3d::Zero();
    for (const Vector3d& p : held)
      if ((p - held[0]).norm() > farthest.norm()) farthest = p - held[0];
    for (const Vector3d& p : held) area = std::max(area, farthest.cross(p - held[0]).norm());
    if (area > 1e-3 * farthest.squaredNorm() && farthest.norm() > 0) continue;
    ++body.loose_pieces;
    for (const int vertex : of_piece) body.fixed[vertex] = true;
  }
}

void finish(CutBody& body, double volume_before, double foot_z) {
  body.volume_error = volume(body.mesh, body.mesh.restPositions()) / volume_before - 1;
  body.violations = static_cast<int>(checkMesh(body.mesh).size());
  hold(body, foot_z);
}

/// A body under the cuts that make(index, random) gives.
template <class Make>
CutBody sweepThrough(CutBody body, int num_cuts, double foot_z, const Make& make) {
  body.cells_before = body.mesh.numCells();
  body.gravity_m_s2 = {9.81, 0, 0};
  body.mass_floor_kg = findMassFloor(body);
  const double volume_before = volume(body.mesh, body.mesh.restPositions());
  std::mt19937 random(17);
  for (int i = 0; i < num_cuts; ++i) cut(body, make(i, random));
  finish(body, volume_before, foot_z);
  return body;
}

constexpr double kBallRadius = 0.05;

CutBody makeBall(int half_count) {
  CutBody body;
  body.name = "ball";
  body.mesh = makeTetBall(Vector3d::Zero(), kBallRadius, half_count);
  body.material = {1e4, 0.3, 1000};
  return body;
}

CutBody readBody(const std::string& name, const std::string& path) {
  CutBody body;
  body.name = name;
  body.mesh = readMesh(MeshFileConfig{path, 1, 0}).mesh;
  body.material = {1e4, 0.3, 1000};
  return body;
}

Eigen::AlignedBox3d boxOf(const CutBody& body) {
  const auto points = body.mesh.restPositions();
  return {Vector3d(points.rowwise().minCoeff()), Vector3d(points.rowwise().maxCoeff())};
}

}  // namespace

CutBody makeCutBlock(int n) {
  CutBody body;
  body.name = "block";
  body.mesh = makeHexBox(Vector3d::Zero(), Vector3d::Constant(3), Eigen::Vector3i::Constant(n));
  body.material = {1e6, 0.3, 1000};
  body.gravity_m_s2 = {0, 9.81, 0};
  body.mass_floor_kg = findMassFloor(body);
  body.cells_before = body.mesh.numCells();
  const double volume_before = volume(body.mesh, body.mesh.restPositions());
  cut(body, PlaneCut{{0.5, 0, 0}, Vector3d::UnitX()});
  cut(body, PlaneCut{{1.5, 0, 0}, Vector3d::UnitX()});
  cut(body, PlaneCut{{0, 1.5, 0}, Vector3d::UnitY()});
  finish(body, volume_before, 1e-9);
  return body;
}

CutBody makeCutBall(int half_count, int num_cuts) {
  const auto make = [&](int index, std::mt19937& random) {
    return makeSweep(Vector3d::Zero(), kBallRadius, -0.4 * kBallRadius, index, num_cuts, random);
  };
  return sweepThrough(makeBall(half_count), num_cuts, -0.6 * kBallRadius, make);
}

CutBody makeCutFile(const std::string& name, const std::string& path, int num_cuts) {
  CutBody body = readBody(name, path);
  const Eigen::AlignedBox3d box = boxOf(body);
  const double foot_z = box.min().z(), height = box.sizes().z(), radius = 0.5 * box.sizes().maxCoeff();
  const auto make = [&](int index, std::mt19937& random) {
    return makeSweep(box.center(), radius, foot_z + 0.2 * height, index, num_cuts, random);
  };
  return sweepThrough(std::move(body), num_cuts, foot_z + 0.1 * height, make);
}

CutBody makeHairpinCutBall(int half_count, int num_cuts, const Hairpins& hairpins) {
  const auto make = [&](int index, std::mt19937& random) {
    return makeHairpin(Vector3d::Zero(), kBallRadius, index, num_cuts, hairpins, random);
  };
  return sweepThrough(makeBall(half_count), num_cuts, -0.6 * kBallRadius, make);
}

CutBody makeHairpinCutFile(const std::string& name, const std::string& path, int num_cuts,
                           const Hairpins& hairpins) {
  CutBody body = readBody(name, path);
  const Eigen::AlignedBox3d box = boxOf(body);
  const auto make = [&](int index, std::mt19937& random) {
    return makeHairpin(box.center(), 0.5 * box.sizes().maxCoeff(), index, num_cuts, hairpins, random);
  };
  return sweepThrough(std::move(body), num_cuts, box.min().z() + 0.1 * box.sizes().z(), make);
}

}  // namespace polyscalpel::report
