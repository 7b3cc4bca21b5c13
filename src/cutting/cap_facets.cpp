// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/cap_facets.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

#include <Eigen/Geometry>

namespace polyscalpel {
namespace {

using Eigen::Vector3d;

/// A loop is planar when no corner lies further from its plane than this times its extent, or than the
/// rounding of the coordinates: what a plane that cuts a cell in rest shape leaves.
constexpr double kPlanar = 1e-12;
constexpr double kRoundings = 16;
/// Triangles that are as good as each other are told apart by so much at most, as part of their cost.
constexpr double kTie = 1e-6;
/// Of a chord that is to be avoided: above any sum that the sub-tets may cost.
constexpr double kMostCost = 1e30;
/// A sub-tet below this part of the largest counts as flat or folded.
constexpr double kSmallestWorth = 1e-6;

/// Whether the loop is planar and convex. A fan around the mean of its corners may bear a bay, but not those
/// of the two parts in which a later cut leaves it.
bool isOneFace(const Eigen::Matrix3Xd& points) {
  const Vector3d mean = points.rowwise().mean();
  Vector3d area = Vector3d::Zero();
  const Eigen::Index n = points.cols();
  for (Eigen::Index i = 0; i < n; ++i) {
    area += (points.col(i) - mean).cross(points.col((i + 1) % n) - mean);
  }
  if (area.isZero(0)) return false;
  const Eigen::Matrix3Xd arms = points.colwise() - mean;
  const Vector3d normal = area.normalized();
  const double bend = (normal.transpose() * arms).cwiseAbs().maxCoeff();
  const double extent = arms.colwise().norm().maxCoeff();
  const double rounding = kRoundings * std::numeric_limits<double>::epsilon() * points.cwiseAbs().maxCoeff();
  const double limit = std::max(kPlanar * extent, rounding);
  if (bend > limit) return false;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vector3d here = arms.col((i + 1) % n);
    const Vector3d before = here - arms.col(i), after = arms.col((i + 2) % n) - here;
    // How far the corner lies behind the line of its neighbours, times their distance.
    if (normal.dot(before.cross(after)) < -limit * (before + after).norm()) return false;
  }
  return true;
}

/// Which of several triangles is to be taken that are as good as each other, in [0, 1): by their corners
/// alone, so that a loop that runs the other way round gets the same ones.
double rankOf(VertexId a, VertexId b, VertexId c) {
  std::uint64_t rank = 0;
  for (const VertexId v : {a, b, c}) {
    // The finaliser of Steele, Lea and Flood 2014, Fast splittable pseudorandom number generators.
    std::uint64_t mixed = static_cast<std::uint64_t>(v.index()) + 0x9E3779B97F4A7C15u;
    mixed = (mixed ^ (mixed >> 30)) * 0xBF58476D1CE4E5B9u;
    mixed = (mixed ^ (mixed >> 27)) * 0x94D049BB133111EBu;
    rank += mixed ^ (mixed >> 31);
  }
  return static_cast<double>(rank >> 11) * 0x1p-53;
}

}  // namespace

std::vector<std::vector<VertexId>> makeCapFacets(const PolyhedralMesh& mesh,
                                                 const std::vector<VertexId>& cap_loop,
                                                 const Vector3d& apex_behind, const Vector3d& apex_before,
                                                 const std::vector<int>& sides) {
  const int n = static_cast<int>(cap_loop.size());
  Eigen::Matrix3Xd points(3, n);
  for (int i = 0; i < n; ++i) points.col(i) = mesh.restPosition(cap_loop[i]);
  if (n == 3 || isOneFace(points)) return {cap_loop};

  // Sixfold volume of the smaller sub-tet on a triangle, as part of the largest that may be.
  const double largest = (points.colwise() - points.rowwise().mean()).colwise().squaredNorm().maxCoeff() *
                         (apex_before - apex_behind).norm();
  const auto costOf = [&](int i, int j, int k) {
    const Vector3d a = points.col(i), normal = (points.col(j) - a).cross(points.col(k) - a);
    const double worth = std::min(normal.dot(a - apex_behind), normal.dot(apex_before - a)) / largest;
    const double rank = 1 + kTie * rankOf(cap_loop[i], cap_loop[j], cap_loop[k]);
    if (worth > kSmallestWorth) return rank / (worth * worth);
    return rank * (2 - worth / kSmallestWorth) / (kSmallestWorth * kSmallestWorth);
  };
  const auto costOfChord = [&](int i, int j) {
    return !sides.empty() && sides[i] * sides[j] < 0 ? kMostCost : 0;
  };
  // least(i, j): smallest cost of a triangulation of the corners i ... j; apex(i, j): third corner of the
  // triangle at the chord from i to j in that one.
  Eigen::MatrixXd least = Eigen::MatrixXd::Zero(n, n);
  Eigen::MatrixXi apex = Eigen::MatrixXi::Constant(n, n, -1);
  for (int width = 2; width < n; ++width) {
    for (int i = 0; i + width < n; ++i) {
      const int j = i + width;
      for (int k = i + 1; k < j; ++k) {
        const double cost =
            least(i, k) + least(k, j) + costOf(i, k, j) + costOfChord(i, k) + costOfChord(k, j);
        if (apex(i, j) >= 0 && cost >= least(i, j)) continue;
        least(i, j) = cost;
        apex(i, j) = k;
      }
    }
  }
  std::vector<std::vector<VertexId>> facets;
  std::vector<std::pair<int, int>> chords{{0, n - 1}};
  while (!chords.empty()) {
    const auto [i, j] = chords.back();
    chords.pop_back();
    if (j - i < 2) continue;
    const int k = apex(i, j);
    facets.push_back({cap_loop[i], cap_loop[k], cap_loop[j]});
    chords.emplace_back(i, k);
    chords.emplace_back(k, j);
  }
  return facets;
}

}  // namespace polyscalpel
