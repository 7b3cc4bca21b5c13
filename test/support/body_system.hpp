// SPDX-License-Identifier: BSD-3-Clause
//
// A body's step as solvers see it, without the simulation around it.
#pragma once

#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Core>

#include "polyscalpel/elements/assembly.hpp"
#include "polyscalpel/solver/direct_solver.hpp"
#include "polyscalpel/solver/step_solver.hpp"

namespace polyscalpel {

/// M + h^2 K of a body of which the vertices at the lowest x are held.
class BodySystem final : public StepSystem {
 public:
  explicit BodySystem(const PolyhedralMesh& mesh, double step_s = 1.0 / 60, const ElementConfig& element = {})
      : assembly_(mesh, kMaterial, element, 0),
        step_s_(step_s),
        positions_(mesh.restPositions()),
        masses_(assembly_.vertexMasses()) {
    findActive();
  }

  void follow(const PolyhedralMesh& mesh, const MeshChange& change) {
    assembly_.update(mesh, change);
    masses_ = assembly_.vertexMasses();
    findActive();
  }

  /// Takes cells out and leaves vertices as they are: what is left may hang together by one vertex, where a
  /// mesh would have copies of it. Masses are lumped.
  void takeOut(const PolyhedralMesh& mesh, const std::vector<CellId>& cells) {
    for (const CellId cell : cells) {
      const std::vector<VertexId>& vertices = mesh.cell(cell).vertices;
      for (std::size_t i = 0; i < vertices.size(); ++i)
        masses_[vertices[i].index()] -=
            kMaterial.density_kg_m3 * assembly_.elementMatrices(cell).shape_integral[i];
    }
    body().update(mesh.numVertices(), cells, {});
    findActive();
  }

  std::vector<DifferenceMatrix<double>::Tie> ties;
  std::vector<Hold> holds;  ///< as of contacts

  CorotatedBody& body() { return *assembly_.corotatedBody(); }
  void linearise(const Eigen::Matrix3Xd& positions) {
    positions_ = positions;
    body().linearise(positions, true);
  }
  const Eigen::VectorXd& masses() const { return masses_; }
  std::vector<bool> fixed() const {
    std::vector<bool> fixed(masses_.size(), true);
    for (const int i : active_) fixed[i] = false;
    return fixed;
  }

  const RowPattern& pattern() const override { return assembly_.corotatedBody()->pattern(); }
  const std::vector<int>& movable() const override { return active_; }
  const std::vector<int>& active() const override { return active_; }
  const Eigen::Matrix3Xd& restPositions() const override { return assembly_.restPositions(); }
  void assemble(DifferenceMatrix<float>& matrix) override { assembleIn(matrix); }
  void assemble(DifferenceMatrix<double>& matrix) override { assembleIn(matrix); }
  void assembleAtRest(DifferenceMatrix<double>& matrix) override {
    body().assembleAtRest(masses_, 1, step_s_ * step_s_, {}, matrix);
  }
  void assembleBody(DifferenceMatrix<double>& matrix, std::vector<float>& rotations) override {
    body().assembleAt(positions_, masses_, 1, step_s_ * step_s_, {}, matrix, rotations);
  }
  void vertexRotations(std::vector<float>& rotations) override { body().vertexRotations(rotations); }

 private:
  static constexpr IsotropicMaterial kMaterial{1e5, 0.4, 1000};

  template <class Scalar>
  void assembleIn(DifferenceMatrix<Scalar>& matrix) {
    body().assemble(masses_, 1, step_s_ * step_s_, matrix);
    for (const auto& tie : ties) matrix.ties.push_back({tie.vertex, tie.stiffness});
    for (const Hold& hold : holds) addHold(pattern(), hold, matrix);
  }
  void findActive() {
    active_.clear();
    const double lowest = restPositions().row(0).minCoeff();
    for (int i = 0; i < pattern().numVertices(); ++i) {
      if (pattern().rows[i].count > 0 && restPositions()(0, i) > lowest + 1e-9) active_.push_back(i);
    }
  }

  mutable Assembly assembly_;  // corotatedBody() is not const
  double step_s_;
  Eigen::Matrix3Xd positions_;  // of the last linearisation
  Eigen::VectorXd masses_;
  std::vector<int> active_;
};

/// What a cut's new vertices are to solvers.
inline std::vector<AddedVertex> addedBy(const MeshChange& change) {
  std::vector<AddedVertex> added;
  for (const NewVertex& vertex : change.new_vertices)
    added.push_back(
        {vertex.vertex.index(), {vertex.parents[0].index(), vertex.parents[1].index()}, vertex.weight});
  return added;
}

/// Weight and a little noise: a right-hand side that is smooth for the most part, as those of steps are.
inline Eigen::Matrix3Xd someLoad(const BodySystem& system, unsigned seed) {
  Eigen::Matrix3Xd load = Eigen::Vector3d(0.1, 0.2, -1) * system.masses().transpose();
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  for (int i = 0; i < load.cols(); ++i) {
    for (int c = 0; c < 3; ++c) load(c, i) *= 1 + 0.3 * normal(engine);
  }
  return load;
}

/// A^-1 b by a factor in double precision.
inline Eigen::Matrix3Xd solveByFactor(BodySystem& system, const Eigen::Matrix3Xd& b) {
  DifferenceMatrix<double> matrix;
  system.assemble(matrix);
  const BlockPattern pattern = toBlockPattern(system.pattern());
  Blocks blocks;
  convert(system.pattern(), matrix, pattern, blocks);
  DirectSolver solver;
  EXPECT_EQ(solver.analyse(pattern, system.fixed()), SolveStatus::kSolved);
  EXPECT_EQ(solver.factorise(pattern, blocks), SolveStatus::kSolved);
  Eigen::Matrix3Xd x;
  EXPECT_EQ(solver.solve(b, x).status, SolveStatus::kSolved);
  return x;
}

/// 3 numbers a vertex, zero where none is active, and one more.
template <class Scalar>
Eigen::Matrix<Scalar, Eigen::Dynamic, 1> toPadded(const BodySystem& system, const Eigen::Matrix3Xd& values) {
  Eigen::Matrix<Scalar, Eigen::Dynamic, 1> padded;
  padded.setZero(paddedSize(system.pattern().numVertices()));
  for (const int i : system.active()) padded.template segment<3>(3 * i) = values.col(i).cast<Scalar>();
  return padded;
}

}  // namespace polyscalpel
