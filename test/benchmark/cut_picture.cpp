// SPDX-License-Identifier: BSD-3-Clause
//
// The body of the study of cell counts, after its 17 bowed cuts and after its 17 bent like hairpins, as a bag
// of markers for rviz, the pieces coloured and drawn apart: polyscalpel_cut_picture <bag> [<mesh of the
// bunny>]. Without a mesh the ball stands in. `./run report` calls it.
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include <rosbag/bag.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include "benchmark/cut_bodies.hpp"
#include "polyscalpel/ros_bridge/piece_colours.hpp"
#include "polyscalpel/ros_bridge/tissue_markers.hpp"

namespace polyscalpel::report {
namespace {

constexpr int kCuts = 17;
constexpr int kBallHalfCount = 6;
/// From one body's middle to the other's.
constexpr double kPitch_m = 0.15;
/// How far pieces are drawn apart: each by this part of its distance from the middle.
constexpr double kApart = 0.3;
const Eigen::Vector4d kSurface(0.62, 0.20, 0.17, 1), kCutFaces(0.93, 0.55, 0.50, 1);

/// Rest positions, 3 x n [m], the middle of the box at the origin, each piece moved away from it as a whole.
Eigen::Matrix3Xd drawApart(const PolyhedralMesh& mesh, const Pieces& pieces) {
  Eigen::Matrix3Xd positions = mesh.restPositions();
  const Eigen::Vector3d middle = 0.5 * (positions.rowwise().minCoeff() + positions.rowwise().maxCoeff());
  positions.colwise() -= middle;
  std::vector<Eigen::Vector3d> sums(static_cast<std::size_t>(pieces.count), Eigen::Vector3d::Zero());
  std::vector<int> counts(sums.size()), piece_of_vertex(static_cast<std::size_t>(mesh.numVertices()), -1);
  for (const CellId id : mesh.cells()) {
    const int piece = pieces.piece_of_cell[static_cast<std::size_t>(id.index())];
    for (const VertexId vertex : mesh.cell(id).vertices) {
      int& of_vertex = piece_of_vertex[static_cast<std::size_t>(vertex.index())];
      if (of_vertex >= 0) continue;
      of_vertex = piece;
      sums[static_cast<std::size_t>(piece)] += positions.col(vertex.index());
      ++counts[static_cast<std::size_t>(piece)];
    }
  }
  for (int i = 0; i < mesh.numVertices(); ++i) {
    const int piece = piece_of_vertex[static_cast<std::size_t>(i)];
    if (piece < 0) continue;
    const auto p = static_cast<std::size_t>(piece);
    positions.col(i) += kApart / counts[p] * sums[p];
  }
  return positions;
}

void addMarkers(const CutBody& body, const Eigen::Vector3d& place, visualization_msgs::MarkerArray& array) {
  const Pieces pieces = findPieces(body.mesh);
  const Eigen::Matrix3Xd positions = drawApart(body.mesh, pieces).colwise() + place;
  for (const bool cut_faces : {false, true}) {
    const SurfaceTriangles triangles = makeSurfaceTriangles(body.mesh, positions, cut_faces);
    visualization_msgs::Marker marker = makeTriangleMarker(triangles, cut_faces ? kCutFaces : kSurface);
    colourByPieces(marker, body.mesh, triangles, pieces);
    marker.ns = cut_faces ? "cut_faces" : "surface";
    marker.id = static_cast<int>(array.markers.size());
    array.markers.push_back(std::move(marker));
  }
}

tf2_msgs::TFMessage makeFrame(const ros::Time& stamp) {
  geometry_msgs::TransformStamped transform;
  transform.header.frame_id = "world";
  transform.header.stamp = stamp;
  transform.child_frame_id = "tissue";
  transform.transform.rotation.w = 1;
  tf2_msgs::TFMessage message;
  message.transforms.push_back(transform);
  return message;
}

int run(const std::string& bag_path, const std::string& bunny) {
  const std::vector<CutBody> bodies =
      bunny.empty() ? std::vector<CutBody>{makeCutBall(kBallHalfCount, kCuts),
                                           makeHairpinCutBall(kBallHalfCount, kCuts, kHairpinsInBall)}
                    : std::vector<CutBody>{makeCutFile("bunny", bunny, kCuts),
                                           makeHairpinCutFile("bunny", bunny, kCuts, kHairpinsInBunny)};
  visualization_msgs::MarkerArray array;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    addMarkers(bodies[i], (static_cast<double>(i) - 0.5) * kPitch_m * Eigen::Vector3d::UnitX(), array);
  const ros::Time start(1), end(2);
  for (visualization_msgs::Marker& marker : array.markers) {
    marker.header.frame_id = "world";
    marker.header.stamp = start;
  }
  rosbag::Bag bag(bag_path, rosbag::bagmode::Write);
  bag.write("/tf", start, makeFrame(start));
  bag.write("/mesh", start, array);
  bag.write("/tf", end, makeFrame(end));
  bag.close();
  std::printf(
      "%s of %d tetrahedra after %d bowed cuts, %d cells in %d pieces, and after %d bent like hairpins, %d "
      "cells in %d pieces; "
      "the pieces are drawn apart\n",
      bodies[0].name.c_str(), bodies[0].cells_before, bodies[0].cuts, bodies[0].mesh.numCells(),
      bodies[0].pieces, bodies[1].cuts, bodies[1].mesh.numCells(), bodies[1].pieces);
  return 0;
}

}  // namespace
}  // namespace polyscalpel::report

int main(int argc, char** argv) {
  if (argc < 2 || argc > 3) {
    std::fprintf(stderr, "usage: %s <bag> [<mesh of the bunny>]\n", argv[0]);
    return 2;
  }
  try {
    return polyscalpel::report::run(argv[1], argc == 3 ? argv[2] : "");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    return 1;
  }
}
