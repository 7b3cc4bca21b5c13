// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/materials/isotropic_material.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace polyscalpel {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

/// The message of the exception, or "" where none is thrown.
std::string complaint(const IsotropicMaterial& material) {
  try {
    validate(material);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(IsotropicMaterial, DefaultsAreValid) {
  EXPECT_EQ(complaint({}), "");
}

TEST(IsotropicMaterial, BoundsOfYoungsModulusAndDensity) {
  for (const double good : {1e-300, 1.0, 1e12}) {
    EXPECT_EQ(complaint({good, 0.3, 1000}), "");
    EXPECT_EQ(complaint({1e4, 0.3, good}), "");
  }
  for (const double bad : {0.0, -1e-300, -1.0, kNan, kInf, -kInf}) {
    EXPECT_NE(complaint({bad, 0.3, 1000}).find("youngs_modulus_pa = "), std::string::npos) << bad;
    EXPECT_NE(complaint({1e4, 0.3, bad}).find("density_kg_m3 = "), std::string::npos) << bad;
  }
}

TEST(IsotropicMaterial, BoundsOfPoissonRatio) {
  for (const double good : {std::nextafter(-1.0, 0.0), -0.5, 0.0, 0.3, std::nextafter(0.5, 0.0)})
    EXPECT_EQ(complaint({1e4, good, 1000}), "") << good;
  for (const double bad : {-1.0, 0.5, -1.1, 0.6, kNan, kInf, -kInf}) {
    const std::string message = complaint({1e4, bad, 1000});
    EXPECT_NE(message.find("poisson_ratio = "), std::string::npos) << bad;
    EXPECT_NE(message.find("(-1, 0.5)"), std::string::npos) << bad;
  }
}

TEST(IsotropicMaterial, BoundsOfStrengthAndToughness) {
  for (const double good : {0.0, 1e-300, 1.0, 1e5}) {
    EXPECT_EQ(complaint({1e4, 0.3, 1000, good, 0}), "") << good;
    EXPECT_EQ(complaint({1e4, 0.3, 1000, 0, good}), "") << good;
  }
  EXPECT_EQ(complaint({1e4, 0.3, 1000, 1e12, 0}), "");
  for (const double bad : {-1e-300, -1.0, kNan, kInf, -kInf}) {
    EXPECT_NE(complaint({1e4, 0.3, 1000, bad, 0}).find("strength_pa = "), std::string::npos) << bad;
    EXPECT_NE(complaint({1e4, 0.3, 1000, 0, bad}).find("[0, 100000]"), std::string::npos) << bad;
  }
  EXPECT_NE(complaint({1e4, 0.3, 1000, 0, std::nextafter(1e5, kInf)}).find("fracture_toughness_j_m2 = "),
            std::string::npos);
}

TEST(IsotropicMaterial, UniaxialStressGivesYoungsModulusAndPoissonRatio) {
  for (const double nu : {-0.5, 0.0, 0.3, 0.49}) {
    const IsotropicMaterial material{2e5, nu, 1000};
    Eigen::Matrix<double, 6, 1> stress = Eigen::Matrix<double, 6, 1>::Zero();
    stress(0) = 3;
    const Eigen::Matrix<double, 6, 1> strain = elasticityMatrix(material).inverse() * stress;
    EXPECT_NEAR(strain(0), 3 / 2e5, 1e-13 * 3 / 2e5);
    EXPECT_NEAR(strain(1), -nu * strain(0), 1e-13 * strain(0));
    EXPECT_NEAR(strain(2), -nu * strain(0), 1e-13 * strain(0));
    EXPECT_EQ(strain.tail<3>().norm(), 0);
  }
}

TEST(IsotropicMaterial, MatrixIsTheTensorLaw) {
  const IsotropicMaterial material{7e3, 0.4, 1000};
  Eigen::Matrix3d strain;
  strain << 0.1, 0.2, -0.3, 0.2, -0.4, 0.5, -0.3, 0.5, 0.6;
  const Eigen::Matrix3d stress = lameLambda(material) * strain.trace() * Eigen::Matrix3d::Identity() +
                                 2 * shearModulus(material) * strain;
  Eigen::Matrix<double, 6, 1> engineering, expected;
  engineering << strain(0, 0), strain(1, 1), strain(2, 2), 2 * strain(1, 2), 2 * strain(2, 0),
      2 * strain(0, 1);
  expected << stress(0, 0), stress(1, 1), stress(2, 2), stress(1, 2), stress(2, 0), stress(0, 1);
  EXPECT_LE((elasticityMatrix(material) * engineering - expected).norm(), 1e-14 * expected.norm());
}

TEST(IsotropicMaterial, MatrixIsPositiveDefiniteInTheWholeRange) {
  for (const double nu : {-0.99, -0.5, 0.0, 0.3, 0.499}) {
    const Eigen::Matrix<double, 6, 6> C = elasticityMatrix({1e4, nu, 1000});
    EXPECT_EQ(C, C.transpose());
    EXPECT_GT((Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>>(C).eigenvalues().minCoeff()), 0)
        << nu;
  }
}

}  // namespace
}  // namespace polyscalpel
