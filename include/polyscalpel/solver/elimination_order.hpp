// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "polyscalpel/solver/turned_factor.hpp"

namespace polyscalpel {

/// A good order of elimination of a body makes a good one of the same body after cuts: an added vertex shares
/// cells with what its parents shared cells with, so it follows the one of them that is eliminated first, and
/// separators of the body stay separators. order: of vertices, each once; added: ascending, parents before
/// their children. Those of which no parent is in the order come first.
std::vector<int> followCuts(const std::vector<int>& order, const std::vector<AddedVertex>& added);

}  // namespace polyscalpel
