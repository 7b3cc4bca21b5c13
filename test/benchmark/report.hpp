// SPDX-License-Identifier: BSD-3-Clause
//
// What the sections of the report share: rows of measurements, values that must hold, and how thorough to be.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "benchmark/progress.hpp"

namespace polyscalpel::report {

/// One measurement: a flat object, values by name, each name ending in its unit.
using Row = nlohmann::ordered_json;
using Rows = std::vector<Row>;

enum class Mode {
  kQuick,    ///< under 3 minutes: coarse meshes, few repetitions
  kDefault,  ///< under 20 minutes
  kFull,     ///< up to 90 minutes: long statistics
};

struct Context {
  Mode mode = Mode::kDefault;
  std::string bunny_mesh;     ///< path of the bunny as a volume mesh; empty: it could not be had
  std::string bunny_note;     ///< how the bunny was made, or why it is not there
  std::string meshes_folder;  ///< of meshes with known displacements (see knownSubjects); empty: none
  Progress* progress = nullptr;

  /// One of three values by mode.
  template <class T>
  T byMode(T quick, T standard, T full) const {
    return mode == Mode::kQuick ? quick : mode == Mode::kDefault ? standard : full;
  }
};

/// Marks a row with the rule "name <= limit" for one of its values: where it does not hold, or the value is
/// not finite, the report fails.
void holdAtMost(Row& row, const std::string& name, double limit);
/// The same for "name >= limit".
void holdAtLeast(Row& row, const std::string& name, double limit);
/// The same for "name = expected".
void holdEqual(Row& row, const std::string& name, int expected);
/// Marks a row that has no values because something failed; the report fails too.
void holdFailed(Row& row, const std::string& why);

/// Rules that were broken, one line each.
std::vector<std::string> brokenRules(const std::string& section, const Rows& rows);

Rows studyFormulations(const Context& context);
Rows studyCutting(const Context& context);
Rows studyCellCounts(const Context& context);
Rows studyIntegration(const Context& context);
Rows studyStages(const Context& context);
Rows studyPeers(const Context& context);
Rows studySolvers(const Context& context);
Rows studyScaling(const Context& context);
Rows studyAfterCuts(const Context& context);
Rows studyLimits(const Context& context);
Rows studyHardCases(const Context& context);
Rows studyHardSolvers(const Context& context);
Rows studyTorture(const Context& context);

}  // namespace polyscalpel::report
