// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/dividing_planes.hpp"

#include <utility>

#include <Eigen/Eigenvalues>

#include "polyscalpel/cutting/plane_hit.hpp"
#include "polyscalpel/geometry/predicates.hpp"
#include "polyscalpel/mesh/surface.hpp"

namespace polyscalpel {
namespace {

std::vector<DividingPlane> makeDividingPlanes() {
  // A plane through a point that sees all of the cell's surface leaves two parts that see theirs from near
  // that point.
  constexpr std::pair<bool, double> kPlaces[] = {{false, 0},   {true, 0},     {false, 0.4}, {false, -0.4},
                                                 {false, 0.2}, {false, -0.2}, {false, 0.7}, {false, -0.7}};
  constexpr int kEighths[][4] = {{0, 4, 2, 6}, {1, 5, 3, 7}};  // of a half turn
  std::vector<DividingPlane> planes;
  for (const auto& eighths : kEighths) {
    for (const auto& [is_in_star_centre, shift] : kPlaces) {
      for (const int eighth : eighths) planes.push_back({eighth * M_PI / 8, is_in_star_centre, shift});
    }
  }
  return planes;
}

}  // namespace

const std::vector<DividingPlane>& dividingPlanes() {
  static const std::vector<DividingPlane> planes = makeDividingPlanes();
  return planes;
}

std::vector<Hit> hitsAcross(const PolyhedralMesh& mesh, CellId cell, const std::vector<VertexId>& border,
                            const DividingPlane& plane) {
  Eigen::Matrix3Xd points(3, border.size());
  for (std::size_t i = 0; i < border.size(); ++i) points.col(i) = mesh.restPosition(border[i]);
  Eigen::Vector3d middle = points.rowwise().mean();
  points.colwise() -= middle;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(points * points.transpose());
  // An axis has no sense of its own: it points to the later vertices, however the body lies.
  Eigen::Vector3d to_later = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < border.size(); ++i) to_later += border[i].index() * points.col(i);
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (const auto& [axis, part] :
       {std::make_pair(2, std::cos(plane.angle_rad)), std::make_pair(1, std::sin(plane.angle_rad))}) {
    const Eigen::Vector3d direction = axes.eigenvectors().col(axis);
    normal += (direction.dot(to_later) < 0 ? -part : part) * direction;
  }
  normal.normalize();
  if (plane.is_in_star_centre) middle = starCentre(makeCellSurface(mesh, cell, mesh.restPositions()));
  middle += plane.shift * (normal.transpose() * points).cwiseAbs().maxCoeff() * normal;
  std::vector<Hit> hits;
  for (const Edge& edge : mesh.edges(cell)) {
    const Eigen::Vector3d a = mesh.restPosition(edge.first), b = mesh.restPosition(edge.second);
    const int side_a = sideOfPlane(a, middle, normal), side_b = sideOfPlane(b, middle, normal);
    if (side_a == side_b) continue;
    hits.push_back(hitOnPlane(edge, a, b, middle, normal, side_b));
  }
  return hits;
}

}  // namespace polyscalpel
