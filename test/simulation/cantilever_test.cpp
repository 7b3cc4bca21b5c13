// SPDX-License-Identifier: BSD-3-Clause
#include "support/cantilever.hpp"

#include <string>

#include <gtest/gtest.h>

namespace polyscalpel {
namespace {

ElementConfig virtualElement() {
  ElementConfig config;
  config.formulation = Formulation::kVirtual;
  return config;
}

class Cantilever : public testing::TestWithParam<double> {
 protected:
  static constexpr int kCellsAcross = 4;

  double ratio(BodyKind kind, const ElementConfig& config) {
    const PolyhedralMesh mesh = makeCantileverMesh(kind, kCellsAcross, kCellsAcross);
    const CantileverResult result = bendCantilever(mesh, GetParam(), config);
    RecordProperty("error_of_" + toString(kind), std::to_string(result.error));
    return ratioToTetrahedra(result, tetrahedra_);
  }

  const std::vector<CantileverResult> tetrahedra_ = bendTetrahedra(GetParam(), {4, 6});
};

// The figure of merit of polyhedra: at as many unknowns, a third of the error of linear tetrahedra at most.
TEST_P(Cantilever, HexahedraHaveAThirdOfTheErrorOfTetrahedra) {
  EXPECT_LT(ratio(BodyKind::kHexahedra, ElementConfig()), 1.0 / 3);
  EXPECT_LT(ratio(BodyKind::kHexahedra, virtualElement()), 1.0 / 3);
}

TEST_P(Cantilever, SoTheyHaveWhenSliced) {
  EXPECT_LT(ratio(BodyKind::kSlicedHexahedra, ElementConfig()), 1.0 / 3);
  EXPECT_LT(ratio(BodyKind::kSlicedHexahedra, virtualElement()), 1.0 / 3);
}

// What slices leave of a tetrahedron bends better than it did, but the most of the body is tetrahedra still.
TEST_P(Cantilever, SlicingMakesTetrahedraNoStiffer) {
  const PolyhedralMesh mesh = makeCantileverMesh(BodyKind::kSlicedTetrahedra, kCellsAcross, kCellsAcross);
  EXPECT_LT(std::abs(bendCantilever(mesh, GetParam(), ElementConfig()).error),
            std::abs(tetrahedra_.front().error));
}

// The stabilising part sees strains that bending does not have; with lambda in it, it holds them the harder
// the less compressible the material is.
TEST_P(Cantilever, StabilisingWithTheShearModulusBendsNoWorse) {
  ElementConfig full;
  full.stabilisation_modulus = StabilisationModulus::kFull;
  for (const BodyKind kind : {BodyKind::kHexahedra, BodyKind::kSlicedHexahedra})
    EXPECT_LT(ratio(kind, ElementConfig()), 0.6 * ratio(kind, full)) << toString(kind);
}

INSTANTIATE_TEST_SUITE_P(PoissonRatios, Cantilever, testing::Values(0.3, 0.49, 0.499));

TEST(CantileverStudy, InterpolatesInLogarithms) {
  std::vector<CantileverResult> series(3);
  for (int i = 0; i < 3; ++i) {
    series[i].unknowns = i == 0 ? 100 : series[i - 1].unknowns * 10;
    series[i].error = -3 * std::pow(series[i].unknowns, -2.0 / 3);
  }
  for (const int unknowns : {10, 100, 500, 1000, 3000, 1000000})
    EXPECT_NEAR(errorAt(series, unknowns), 3 * std::pow(unknowns, -2.0 / 3), 1e-12) << unknowns;
}

}  // namespace
}  // namespace polyscalpel
