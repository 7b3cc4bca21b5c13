// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/cutting/blade_way.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "polyscalpel/core/types.hpp"

namespace polyscalpel {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Positions = Eigen::Ref<const Matrix3Xd>;

/// What is remembered of a long stroke: the latest. All of them move with the tissue in every step.
constexpr std::size_t kMostPlaces = 500;
/// By how much the flat strip between two places is longer at either end, as part of its length, so that
/// there is no gap outside a bend.
constexpr double kOverlap = 0.25;

double dot(const Positions& a, const Positions& b) {
  return a.cwiseProduct(b).sum();
}

}  // namespace

void BladeWay::follow(const Eigen::Isometry3d& tissue_motion) {
  if (tissue_motion.matrix().isIdentity(0)) return;
  for (Matrix3Xd& place : places_) place = tissue_motion * place;
}

void BladeWay::goOn(const Positions& blade_world, double spacing_m) {
  if (!places_.empty() && (blade_world - places_.back()).colwise().norm().maxCoeff() < spacing_m) return;
  if (places_.size() == kMostPlaces) places_.erase(places_.begin(), places_.begin() + kMostPlaces / 2);
  places_.emplace_back(blade_world);
}

double BladeWay::distance(const Positions& blade_world) const {
  double largest = 0;
  for (Index i = 0; i < blade_world.cols(); ++i) largest = std::max(largest, distance(i, blade_world.col(i)));
  return largest;
}

double BladeWay::distance(Index point, const Vector3d& position) const {
  double nearest = kInfinity;
  for (std::size_t j = 0; j + 1 < places_.size(); ++j) {
    const Index segment = std::min(point, places_[j].cols() - 2);
    const Vector3d along = (places_[j].col(segment + 1) - places_[j].col(segment)).normalized();
    const Vector3d from = places_[j].col(point), way = places_[j + 1].col(point) - from;
    const Vector3d across = way - along.dot(way) * along;
    const double length = across.norm();
    if (length == 0) continue;
    const double at = across.dot(position - from) / (length * length);
    if (at > 1 + kOverlap || (at < -kOverlap && j > 0)) continue;
    nearest = std::min(nearest, std::abs(along.cross(across).dot(position - from)) / length);
  }
  return nearest;
}

bool BladeTurn::startsAt(const BladeFront& front, const Positions& way_world) {
  return dot(front.travel_world, way_world) < 0;
}

bool BladeTurn::isPassedBy(const Positions& blade_world) const {
  return dot(front.travel_world, blade_world - front.blade_world) >= 0;
}

void BladeTurn::follow(const Eigen::Isometry3d& tissue_motion) {
  front.blade_world = tissue_motion * front.blade_world;
  front.travel_world = tissue_motion.linear() * front.travel_world;
  T_in_slit = tissue_motion * T_in_slit;
}

}  // namespace polyscalpel
