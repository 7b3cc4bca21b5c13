// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include <Eigen/Core>

#include "polyscalpel/cutting/cut_mesh.hpp"

namespace polyscalpel {

/// Each throws std::invalid_argument that names what is wrong, for input that is no cut (see cutMesh).
void validate(const PlaneCut& plane);
void validate(const PolygonCut& polygon);
void validate(const SweepCut& sweep);

/// The same for a list, which must not be empty; of several operations it names the number.
void validate(const std::vector<CutOperation>& operations);

/// A polyline blade: at least 2 points, each once (the last may be the first, for a ring).
void validateBladeEdge(const Eigen::Ref<const Eigen::Matrix3Xd>& edge_tool);

}  // namespace polyscalpel
