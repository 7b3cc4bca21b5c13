// SPDX-License-Identifier: BSD-3-Clause
#include "support/motion_studies.hpp"

#include <gtest/gtest.h>

#include "support/manufactured_solution.hpp"

namespace polyscalpel {
namespace {

ElementConfig formulation(int which) {
  ElementConfig config;
  if (which == 1) config.formulation = Formulation::kVirtual;
  return config;
}

class Pendulum : public testing::TestWithParam<std::tuple<bool, int>> {};

TEST_P(Pendulum, NeverHasMoreEnergyThanAtItsStart) {
  const auto [tetrahedra, which] = GetParam();
  const PendulumResult result = swingPendulum(pendulumScene(tetrahedra, formulation(which), 0.01), 10);
  RecordProperty("largest_rise_in_a_step", std::to_string(result.largest_rise_in_a_step));
  std::printf("rise %g step %g lowest %g swing %g\n", result.largest_rise, result.largest_rise_in_a_step,
              result.lowest_energy, result.largest_swing_m);
  EXPECT_LT(result.largest_rise, 1e-3);
  EXPECT_GT(result.largest_swing_m, 0.15);  // it did swing
}

INSTANTIATE_TEST_SUITE_P(Bodies, Pendulum,
                         testing::Values(std::make_tuple(true, 0), std::make_tuple(false, 0),
                                         std::make_tuple(false, 1)));

class Tumbling : public testing::TestWithParam<std::tuple<bool, int>> {};

TEST_P(Tumbling, KeepsItsMomentumAndLosesAngularMomentumWithTheStepOnly) {
  const auto [tetrahedra, which] = GetParam();
  std::vector<double> steps, losses, errors;
  for (const int steps_a_turn : {100, 200, 400}) {
    const TumblingResult result = tumble(formulation(which), tetrahedra, steps_a_turn);
    EXPECT_GT(result.pieces, 1);
    EXPECT_LT(result.largest_momentum_error, 1e-12);
    EXPECT_GT(result.angular_momentum_loss, 0);
    steps.push_back(1.0 / steps_a_turn);
    losses.push_back(result.angular_momentum_loss);
    errors.push_back(result.angular_momentum_error);
  }
  EXPECT_GT(fittedSlope(steps, losses), 0.9);
  EXPECT_GT(fittedSlope(steps, errors), 0.9);
}

INSTANTIATE_TEST_SUITE_P(Bodies, Tumbling,
                         testing::Values(std::make_tuple(true, 0), std::make_tuple(false, 0),
                                         std::make_tuple(false, 1)));

}  // namespace
}  // namespace polyscalpel
