// SPDX-License-Identifier: BSD-3-Clause
//
// Random cuts of every kind that is known to hurt, for a body as it is after the cuts before.
#pragma once

#include <random>
#include <string>
#include <vector>

#include "support/torture_body.hpp"

namespace polyscalpel {

using TortureRandom = std::mt19937;

/// A kind of cut, and how one of it is made up.
struct TortureKind {
  std::string name;
  /// last: the cut before, nullptr for the first.
  TortureCut (*make)(const TortureBody& body, const TortureCut* last, TortureRandom& random);
};

/// All kinds, in the order of the table.
const std::vector<TortureKind>& tortureKinds();

/// A cut of the kind; one in four through a deformed body.
TortureCut makeTortureCut(const TortureKind& kind, const TortureBody& body, const TortureCut* last,
                          TortureRandom& random);

}  // namespace polyscalpel
