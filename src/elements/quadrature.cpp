// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/elements/quadrature.hpp"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include <Eigen/Geometry>

namespace polyscalpel {
namespace {

TetrahedronRule makeOnePointRule() {
  TetrahedronRule rule;
  rule.degree = 1;
  rule.barycentric = Eigen::Vector4d::Constant(0.25);
  rule.weights = Eigen::VectorXd::Ones(1);
  return rule;
}

TetrahedronRule makeFourPointRule() {
  const double near = (5 + 3 * std::sqrt(5.0)) / 20;
  TetrahedronRule rule;
  rule.degree = 2;
  rule.barycentric = Eigen::Matrix4d::Constant((1 - near) / 3);
  rule.barycentric.diagonal().setConstant(near);
  rule.weights = Eigen::VectorXd::Constant(4, 0.25);
  return rule;
}

// The one rule of degree 4 with the full symmetry of the tetrahedron and eleven points (Keast 1986) has a
// negative weight. Xiao and Gimbutas ("A numerical algorithm for the construction of efficient quadrature
// rules in two and higher dimensions", 2010) showed that eleven positive ones suffice. This rule keeps the
// symmetry of the triangle under the apex: two points on the axis and three rings of three. These are 13
// unknowns for the 11 moments of degree <= 4 with that symmetry; they were found by Newton's method, the
// height of the first axis point and the offset of the last ring being set by hand. The tests hold it against
// the exact integrals.
TetrahedronRule makeElevenPointRule() {
  struct AxisPoint {
    double weight, apex;
  };
  struct Ring {
    double weight, apex, single;  // barycentric (apex, single, rest, rest) and its rotations
  };
  constexpr AxisPoint kAxis[] = {{0.14452847748478940119, 0.076},
                                 {0.06343753521873907553, 0.74460632350835287999}};
  constexpr Ring kRings[] = {{0.05313409851159213099, 0.06328601388526454644, 0.76227779924737129873},
                             {0.13621689051307926948, 0.38558573873331892945, 0.42216377457292860215},
                             {0.07466034007415244063, 0.10769679885224348782, 0.038}};
  TetrahedronRule rule;
  rule.degree = 4;
  rule.barycentric.resize(4, 11);
  rule.weights.resize(11);
  int i = 0;
  for (const AxisPoint& point : kAxis) {
    const double rest = (1 - point.apex) / 3;
    rule.barycentric.col(i) << point.apex, rest, rest, rest;
    rule.weights(i++) = point.weight;
  }
  for (const Ring& ring : kRings) {
    for (int turn = 1; turn <= 3; ++turn) {
      rule.barycentric.col(i).setConstant((1 - ring.apex - ring.single) / 2);
      rule.barycentric(0, i) = ring.apex;
      rule.barycentric(turn, i) = ring.single;
      rule.weights(i++) = ring.weight;
    }
  }
  return rule;
}

}  // namespace

const TetrahedronRule& tetrahedronRule(int num_points) {
  static const TetrahedronRule kOne = makeOnePointRule();
  static const TetrahedronRule kFour = makeFourPointRule();
  static const TetrahedronRule kEleven = makeElevenPointRule();
  switch (num_points) {
    case 1:
      return kOne;
    case 4:
      return kFour;
    case 11:
      return kEleven;
    default:
      throw std::invalid_argument("quadrature_points = " + std::to_string(num_points) +
                                  ": must be 1, 4 or 11");
  }
}

CellQuadrature makeCellQuadrature(const CellSurface& surface, const TetrahedronRule& rule) {
  return makeCellQuadrature(surface, rule, starCentre(surface));
}

CellQuadrature makeCellQuadrature(const CellSurface& surface, const TetrahedronRule& rule,
                                  const Eigen::Vector3d& apex) {
  const Eigen::Index num_points = rule.weights.size();
  CellQuadrature quadrature;
  quadrature.points.resize(3, num_points * surface.triangles.size());
  quadrature.weights.resize(num_points * surface.triangles.size());
  Eigen::Index first = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    Eigen::Matrix3d corners;
    corners << surface.points.col(a) - apex, surface.points.col(b) - apex, surface.points.col(c) - apex;
    const double volume = corners.col(0).dot(corners.col(1).cross(corners.col(2))) / 6;
    if (!(volume > 0)) {
      std::ostringstream message;
      message << "volume of the tetrahedron (vertex mean, surface triangle " << a << " " << b << " " << c
              << ") = " << volume << ": must be finite and in (0, inf), the cell is not star-shaped";
      throw std::invalid_argument(message.str());
    }
    quadrature.points.middleCols(first, num_points).noalias() =
        corners.lazyProduct(rule.barycentric.bottomRows<3>());
    quadrature.weights.segment(first, num_points) = volume * rule.weights;
    first += num_points;
  }
  return quadrature;
}

}  // namespace polyscalpel
