// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/collision/contact_forces.hpp"

#include <functional>
#include <limits>
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

namespace polyscalpel {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class ContactForcesTest : public ::testing::Test {
 protected:
  Eigen::Vector3d randomVector(double scale) {
    return scale * Eigen::Vector3d(coordinate_(generator_), coordinate_(generator_), coordinate_(generator_));
  }
  Contact randomContact() {
    Contact contact;
    contact.face = FaceId(0);
    contact.point_world = randomVector(0.1);
    contact.normal_world = randomVector(1).normalized();
    contact.gap_m = 1e-3 * coordinate_(generator_);
    contact.area_m2 = 1e-5 * (1.1 + coordinate_(generator_));
    return contact;
  }

  std::mt19937 generator_{3};
  std::uniform_real_distribution<double> coordinate_{-1, 1};
  ContactConfig config_;
};

TEST_F(ContactForcesTest, NormalForceIsThePenaltyOfTheGapAtTheEndPlusDamping) {
  config_.friction_coefficient = 0;
  const double h = 0.01;
  int active = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Contact contact = randomContact();
    const Eigen::Vector3d start = randomVector(0.05), tool = randomVector(0.05), end = randomVector(0.05);
    const LinearisedContact linear = lineariseContact(contact, 2, start, tool, h, config_);
    EXPECT_EQ(linear.tool, 2);
    const auto pressure = [&](const Eigen::Vector3d& velocity) {
      const double gap_end = contact.gap_m + h * contact.normal_world.dot(velocity);
      return -config_.stiffness_pa_m * gap_end -
             config_.damping_pa_s_m * contact.normal_world.dot(velocity - tool);
    };
    if (contact.gap_m + h * contact.normal_world.dot(start) >= 0 || pressure(start) <= 0) {
      EXPECT_TRUE(linear.force_0.isZero(0));
      EXPECT_TRUE(linear.B.isZero(0));
      continue;
    }
    ++active;
    const Eigen::Vector3d expected = contact.area_m2 * pressure(end) * contact.normal_world;
    EXPECT_LT((contactForce(linear, end) - expected).norm(), 1e-12 * (1 + expected.norm()));
  }
  EXPECT_GT(active, 100);
}

TEST_F(ContactForcesTest, ToolMotionIsCountedOnceForTissueAtRest) {
  // The gap is measured at the tool's end pose: without damping its velocity must not matter.
  config_.friction_coefficient = 0;
  config_.damping_pa_s_m = 0;
  Contact contact = randomContact();
  contact.gap_m = -1e-3;
  const Eigen::Vector3d rest = Eigen::Vector3d::Zero();
  const Eigen::Vector3d force =
      contactForce(lineariseContact(contact, 0, rest, contact.normal_world, 0.01, config_), rest);
  EXPECT_NEAR(force.dot(contact.normal_world), config_.stiffness_pa_m * 1e-3 * contact.area_m2, 1e-12);
}

TEST_F(ContactForcesTest, MatrixIsSymmetricPositiveSemiDefinite) {
  config_.friction_coefficient = 0.8;
  for (int trial = 0; trial < 200; ++trial) {
    const LinearisedContact linear =
        lineariseContact(randomContact(), 0, randomVector(0.1), randomVector(0.1), 0.01, config_);
    EXPECT_LT((linear.B - linear.B.transpose()).norm(), 1e-15 * (1 + linear.B.norm()));
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(linear.B);
    EXPECT_GE(eigen.eigenvalues().minCoeff(), -1e-14 * (1 + linear.B.norm()));
  }
}

TEST_F(ContactForcesTest, ForceAtTheStartVelocityStaysInTheFrictionConeAndOpposesSlip) {
  config_.friction_coefficient = 0.3;
  int slipping = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Contact contact = randomContact();
    const Eigen::Vector3d start = randomVector(0.1), tool = randomVector(0.1);
    const LinearisedContact linear = lineariseContact(contact, 0, start, tool, 0.01, config_);
    const Eigen::Vector3d force = contactForce(linear, start);
    const double normal_force = force.dot(contact.normal_world);
    const Eigen::Vector3d tangential = force - normal_force * contact.normal_world;
    EXPECT_GE(normal_force, 0);
    EXPECT_LE(tangential.norm(), config_.friction_coefficient * normal_force * (1 + 1e-12) + 1e-15);
    if (normal_force == 0) continue;
    const Eigen::Vector3d relative = start - tool;
    const Eigen::Vector3d slip = relative - contact.normal_world.dot(relative) * contact.normal_world;
    if (slip.norm() < config_.friction_speed_m_s) continue;
    ++slipping;
    // Sliding: the whole of the cone, against the slip.
    EXPECT_NEAR(tangential.dot(slip) / slip.norm(), -config_.friction_coefficient * normal_force,
                1e-12 * normal_force);
  }
  EXPECT_GT(slipping, 50);
}

TEST_F(ContactForcesTest, ReactionBalancesForceAndTorqueInAnyFrame) {
  for (int trial = 0; trial < 50; ++trial) {
    Eigen::Isometry3d T_world_tool = Eigen::Isometry3d::Identity();
    T_world_tool.linear() =
        Eigen::AngleAxisd(coordinate_(generator_) * 3, randomVector(1).normalized()).matrix();
    T_world_tool.translation() = randomVector(1);
    Wrench wrench;
    Eigen::Vector3d force_sum = Eigen::Vector3d::Zero();
    Eigen::Vector3d torque_sum = Eigen::Vector3d::Zero();  // about the world's origin
    for (int i = 0; i < 5; ++i) {
      const Eigen::Vector3d force = randomVector(2), point = randomVector(1);
      addReaction(wrench, force, point, T_world_tool);
      force_sum += force;
      torque_sum += point.cross(force);
    }
    const Eigen::Vector3d force_world = T_world_tool.linear() * wrench.force;
    const Eigen::Vector3d torque_world =
        T_world_tool.linear() * wrench.torque + T_world_tool.translation().cross(force_world);
    EXPECT_LT((force_world + force_sum).norm(), 1e-13);
    EXPECT_LT((torque_world + torque_sum).norm(), 1e-13);
  }
}

TEST_F(ContactForcesTest, TorqueOfAKnownLever) {
  Eigen::Isometry3d T_world_tool = Eigen::Isometry3d::Identity();
  T_world_tool.translation() = Eigen::Vector3d(1, 0, 0);
  T_world_tool.linear() = Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()).matrix();  // tool x = world y
  Wrench wrench;
  addReaction(wrench, {0, 0, -3}, {1, 2, 0}, T_world_tool);  // arm 2 along tool x, reaction +3 z
  EXPECT_LT((wrench.force - Eigen::Vector3d(0, 0, 3)).norm(), 1e-14);
  EXPECT_LT((wrench.torque - Eigen::Vector3d(0, -6, 0)).norm(), 1e-14);
}

struct Bound {
  std::string name;
  std::function<void(ContactConfig&, double)> set;
  std::vector<double> good;
  std::vector<double> bad;
};

TEST(ContactConfigTest, EveryBoundIsHeld) {
  EXPECT_NO_THROW(validate(ContactConfig()));
  const std::vector<Bound> bounds = {
      {"stiffness_pa_m", [](ContactConfig& c, double v) { c.stiffness_pa_m = v; }, {1e-9, 1e12}, {0, -1}},
      {"damping_pa_s_m", [](ContactConfig& c, double v) { c.damping_pa_s_m = v; }, {0, 1e-9, 1e9}, {-1e-9}},
      {"friction_coefficient",
       [](ContactConfig& c, double v) { c.friction_coefficient = v; },
       {0, 1e-9, 9.99, 10},
       {-1e-9, 10.01}},
      {"friction_speed_m_s",
       [](ContactConfig& c, double v) { c.friction_speed_m_s = v; },
       {1e-9, 1},
       {0, -1}},
      {"margin_m", [](ContactConfig& c, double v) { c.margin_m = v; }, {1e-9, 1}, {0, -1}},
  };
  for (const Bound& bound : bounds) {
    for (const double value : bound.good) {
      ContactConfig config;
      bound.set(config, value);
      EXPECT_NO_THROW(validate(config)) << bound.name << " " << value;
    }
    std::vector<double> bad = bound.bad;
    bad.insert(bad.end(), {kNaN, std::numeric_limits<double>::infinity()});
    for (const double value : bad) {
      ContactConfig config;
      bound.set(config, value);
      try {
        validate(config);
        FAIL() << bound.name << " " << value;
      } catch (const std::invalid_argument& error) {
        EXPECT_NE(std::string(error.what()).find(bound.name), std::string::npos);
      }
    }
  }
}

}  // namespace
}  // namespace polyscalpel
