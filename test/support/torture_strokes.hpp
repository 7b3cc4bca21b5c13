// SPDX-License-Identifier: BSD-3-Clause
//
// The kinds of torture that are drawn by a blade, and random things that all kinds share.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "support/torture_cuts.hpp"

namespace polyscalpel {

std::vector<TortureKind> tortureStrokes();

/// A direction of length 1, all alike.
Eigen::Vector3d someDirection(TortureRandom& random);

/// A right-handed frame, one axis a column.
Eigen::Matrix3d someFrame(TortureRandom& random);

/// A deformation with waves of the body's size that stretches by less than half.
SmoothDeformation someDeformation(const TortureBody& body, TortureRandom& random);

}  // namespace polyscalpel
