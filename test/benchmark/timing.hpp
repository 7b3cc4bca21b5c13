// SPDX-License-Identifier: BSD-3-Clause
//
// Wall times on a machine that others use too: what is to be compared runs in turns, and the median counts.
#pragma once

#include <functional>
#include <vector>

namespace polyscalpel::report {

/// Median; of an even number of values the mean of the two in the middle. values: at least 1.
double median(std::vector<double> values);

/// Wall time of one call [s].
double secondsOf(const std::function<void()>& task);

/// Seconds of the calling thread's own work since some start: what others do on the machine is not in it.
double threadSeconds();
/// Seconds on the wall since some start.
double wallSeconds();

/// Calls the tasks in turns, `rounds` times after one round that is not counted. Returns each task's median
/// wall time [s].
std::vector<double> medianSeconds(const std::vector<std::function<void()>>& tasks, int rounds);

}  // namespace polyscalpel::report
