// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/solver/solver_config.hpp"

#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace polyscalpel {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// The message of the exception, or "" where none is thrown.
std::string complaint(const SolverConfig& config) {
  try {
    validate(config);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

double below(double value) {
  return std::nextafter(value, -kInf);
}

double above(double value) {
  return std::nextafter(value, kInf);
}

struct NumberBound {
  std::string name;
  std::string range;
  std::function<void(SolverConfig&, double)> set;
  std::vector<double> accepted;
  std::vector<double> refused;
};

struct CountBound {
  std::string name;
  int SolverConfig::*field;
  int lowest;
  int highest;
};

TEST(SolverConfig, DefaultsAreValid) {
  EXPECT_EQ(complaint({}), "");
}

TEST(SolverConfig, HoldsEveryBoundOfItsNumbers) {
  const NumberBound bounds[] = {
      {"solver.tolerance",
       "[1e-12, 0.1]",
       [](SolverConfig& c, double v) { c.tolerance = v; },
       {1e-12, above(1e-12), 1e-4, below(0.1), 0.1},
       {below(1e-12), above(0.1), 0, -1e-4}},
      {"solver.error_target",
       "[1e-10, 0.1]",
       [](SolverConfig& c, double v) { c.error_target = v; },
       {1e-10, above(1e-10), 1e-3, below(0.1), 0.1},
       {below(1e-10), above(0.1), 0, -1e-3}},
      {"solver.step_budget_ms",
       "(0, 1e+06]",
       [](SolverConfig& c, double v) { c.step_budget_ms = v; },
       {above(0), 1e-9, 10, below(1e6), 1e6},
       {0, below(0), -10, above(1e6)}},
  };
  for (const NumberBound& bound : bounds) {
    SCOPED_TRACE(bound.name);
    SolverConfig config;
    for (const double good : bound.accepted) {
      bound.set(config, good);
      EXPECT_EQ(complaint(config), "") << good;
    }
    std::vector<double> bad_values = bound.refused;
    bad_values.insert(bad_values.end(), {kNan, kInf, -kInf});
    for (const double bad : bad_values) {
      bound.set(config, bad);
      EXPECT_EQ(complaint(config).find(bound.name + " = "), 0u) << bad;
      EXPECT_NE(complaint(config).find(bound.range), std::string::npos) << complaint(config);
    }
  }
}

TEST(SolverConfig, HoldsEveryBoundOfItsCounts) {
  const CountBound bounds[] = {
      {"solver.max_iterations", &SolverConfig::max_iterations, 1, 100000},
      {"solver.projection", &SolverConfig::projection, 0, 20},
      {"solver.threads", &SolverConfig::threads, 1, 256},
      {"solver.refresh_after_steps", &SolverConfig::refresh_after_steps, 1, 1000000},
  };
  for (const CountBound& bound : bounds) {
    SCOPED_TRACE(bound.name);
    SolverConfig config;
    for (const int good : {bound.lowest, bound.lowest + 1, bound.highest - 1, bound.highest}) {
      config.*bound.field = good;
      EXPECT_EQ(complaint(config), "") << good;
    }
    for (const int bad : {-1000, bound.lowest - 1, bound.highest + 1}) {
      config.*bound.field = bad;
      EXPECT_EQ(complaint(config), bound.name + " = " + std::to_string(bad) + ": must be in [" +
                                       std::to_string(bound.lowest) + ", " + std::to_string(bound.highest) +
                                       "]");
    }
  }
}

TEST(SolverConfig, EveryKindHasAName) {
  EXPECT_STREQ(toString(SolverKind::kAuto), "auto");
  EXPECT_STREQ(toString(SolverKind::kDirect), "direct");
  EXPECT_STREQ(toString(SolverKind::kJacobi), "jacobi");
  EXPECT_STREQ(toString(SolverKind::kFactor), "factor");
  EXPECT_STREQ(toString(SolverKind::kAggregates), "aggregates");
}

}  // namespace
}  // namespace polyscalpel
