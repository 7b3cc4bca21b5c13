// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "polyscalpel/cutting/front_closure.hpp"

namespace polyscalpel {

/// Where a blade has come through the tissue, as it lies now: to tell whether the blade comes back in its own
/// slit.
class BladeWay {
 public:
  /// Goes with the tissue around the blade.
  void follow(const Eigen::Isometry3d& tissue_motion);

  /// The blade (3 x k [m]) has gone on to here. Places nearer than spacing_m to the one before are left out.
  void goOn(const Eigen::Ref<const Eigen::Matrix3Xd>& blade_world, double spacing_m);

  /// How far off the surface that it has swept a blade stands there (3 x k [m]): the largest of its points
  /// [m]. It may stand further along itself, or before where the way began.
  double distance(const Eigen::Ref<const Eigen::Matrix3Xd>& blade_world) const;

  void clear() { places_.clear(); }

 private:
  double distance(Eigen::Index point, const Eigen::Vector3d& position) const;

  std::vector<Eigen::Matrix3Xd> places_;  // 3 x k [m], in the order of passing
};

/// A blade that comes back, as seen from where it has been furthest.
struct BladeTurn {
  BladeFront front;             ///< where the surface ends that it has swept
  Eigen::Isometry3d T_in_slit;  ///< where it was in its own slit, no more than a local size ago: T_world_tool

  /// Whether a blade at a front comes back from there. way_world: of its points relative to the tissue, 3 x k
  /// [m].
  static bool startsAt(const BladeFront& front, const Eigen::Ref<const Eigen::Matrix3Xd>& way_world);

  /// Whether a blade that stands there (3 x k [m]) is beyond.
  bool isPassedBy(const Eigen::Ref<const Eigen::Matrix3Xd>& blade_world) const;

  /// Goes with the tissue around the blade.
  void follow(const Eigen::Isometry3d& tissue_motion);
};

}  // namespace polyscalpel
