// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>

#include "polyscalpel/cutting/cut_mesh.hpp"

namespace polyscalpel {

/// Each throws std::invalid_argument that names what is wrong, for input that is no cut (see cutMesh).
void validate(const PlaneCut& plane);
void validate(const PolygonCut& polygon);
void validate(const SweepCut& sweep);
void validateBladeEdge(const Eigen::Ref<const Eigen::Matrix3Xd>& edge_tool);

}  // namespace polyscalpel
