// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "benchmark/report.hpp"

namespace polyscalpel::report {

/// cpu, cores, memory, os, compiler, flags; no name of the machine.
Row describeMachine();

}  // namespace polyscalpel::report
