// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/crossed_edge.hpp"

#include <algorithm>
#include <cmath>

namespace polyscalpel {
namespace {

/// A bent surface that comes back through an edge meets it at a flat angle. One that comes back with a larger
/// |cos| of the angle between edge and normal is folded, more narrowly than the cells tell: the first
/// crossing stands for the fold.
constexpr double kLargestAlignmentOfBend = 0.5;

/// Smallest |cos| of the angle between the normals of two sheets where they lie on each other.
constexpr double kSmallestCosineInSheet = 0.8;

/// Length of the way along a hit's edge to where it is crossed already, in snap distances.
double wayToFormer(const PolyhedralMesh& mesh, const Hit& hit, const CrossedEdge& crossed,
                   double snap_tolerance) {
  const auto [a, b] = hit.edge;
  const double part =
      std::min(std::abs(crossed.weight - hit.weight), std::abs(crossed.second_weight - hit.weight));
  return part * (mesh.restPosition(b) - mesh.restPosition(a)).norm() /
         (snap_tolerance * std::min(mesh.localSize(a), mesh.localSize(b)));
}

}  // namespace

CrossedEdge CrossedEdge::reversed() const {
  CrossedEdge other = *this;
  other.weight = 1 - weightAt(false);
  other.sign = -sideAt(false);
  if (isTwice()) other.second_weight = 1 - weight;
  return other;
}

std::optional<CrossedEdge> CrossedEdge::upTo(double end) const {
  if (weight > end) return {};
  CrossedEdge part = *this;
  part.weight /= end;
  part.second_weight = second_weight < end ? second_weight / end : std::numeric_limits<double>::infinity();
  return part;
}

void CrossedEdge::addSecond(const Hit& hit) {
  if (hit.sign != -sign || isTwice()) return;
  if (std::max(alignment, hit.alignment) > kLargestAlignmentOfBend && !isComingBack(hit.normal, normal))
    return;
  second_weight = std::max(weight, hit.weight);
  if (hit.weight > weight) return;
  weight = hit.weight;
  sign = hit.sign;
}

bool isSamePlace(const PolyhedralMesh& mesh, const Hit& hit, const CrossedEdge& crossed,
                 double snap_tolerance) {
  return hit.alignment * wayToFormer(mesh, hit, crossed, snap_tolerance) < 1;
}

bool isGrazed(const PolyhedralMesh& mesh, const Hit& hit, const CrossedEdge& crossed, double snap_tolerance) {
  return hit.sign == -crossed.sign && !crossed.isTwice() && hit.normal.dot(crossed.normal) > 0 &&
         isSamePlace(mesh, hit, crossed, snap_tolerance);
}

bool isComingBack(const Eigen::Vector3d& normal, const Eigen::Vector3d& former) {
  return normal.dot(former) < 0;
}

bool isAtAngle(const Eigen::Vector3d& normal, const Eigen::Vector3d& other) {
  return !normal.isZero(0) && !other.isZero(0) && std::abs(normal.dot(other)) < kSmallestCosineInSheet;
}

bool isSameSheet(const Eigen::Vector3d& normal, const Eigen::Vector3d& other) {
  return normal.dot(other) > 0 && !isAtAngle(normal, other);
}

}  // namespace polyscalpel
