// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/fine_reference.hpp"

#include <algorithm>
#include <cstdint>
#include <unordered_map>

#include <Eigen/LU>

#include "polyscalpel/core/block_matrix.hpp"
#include "polyscalpel/solver/direct_solver.hpp"

namespace polyscalpel::report {
namespace {

/// Linear tetrahedra in closed form, assembled straight into blocks: an Assembly of a million cells would
/// keep matrices that are not needed here.
struct System {
  BlockPattern pattern;
  Blocks stiffness;
  Eigen::VectorXd masses;
  std::vector<bool> fixed;
};

System assemble(const Tetrahedra& body, const std::vector<bool>& fixed, const IsotropicMaterial& material) {
  const int n = static_cast<int>(body.points.cols());
  System system;
  system.fixed = fixed;
  system.masses = Eigen::VectorXd::Zero(n);
  std::vector<std::vector<int>> rows(n);
  for (const std::array<int, 4>& cell : body.cells)
    for (const int column : cell)
      for (const int row : cell)
        if (row >= column) rows[column].push_back(row);
  for (std::vector<int>& column : rows) {
    std::sort(column.begin(), column.end());
    column.erase(std::unique(column.begin(), column.end()), column.end());
    system.pattern.row.insert(system.pattern.row.end(), column.begin(), column.end());
    system.pattern.column_start.push_back(static_cast<int>(system.pattern.row.size()));
    std::vector<int>().swap(column);
  }
  system.stiffness.assign(system.pattern.numBlocks(), Eigen::Matrix3d::Zero());
  const double lambda = lameLambda(material), mu = shearModulus(material);
  for (const std::array<int, 4>& cell : body.cells) {
    Eigen::Matrix3d edges;
    for (int i = 0; i < 3; ++i) edges.col(i) = body.points.col(cell[i + 1]) - body.points.col(cell[0]);
    const double volume = edges.determinant() / 6;
    Eigen::Matrix<double, 3, 4> gradients;
    gradients.rightCols<3>() = edges.inverse().transpose();
    gradients.col(0) = -gradients.rightCols<3>().rowwise().sum();
    for (int a = 0; a < 4; ++a) {
      system.masses[cell[a]] += material.density_kg_m3 * volume / 4;
      for (int b = 0; b < 4; ++b) {
        if (cell[a] < cell[b]) continue;
        const Eigen::Vector3d g = gradients.col(a), h = gradients.col(b);
        system.stiffness[system.pattern.find(cell[a], cell[b])] +=
            volume * (lambda * g * h.transpose() + mu * h * g.transpose() +
                      mu * g.dot(h) * Eigen::Matrix3d::Identity());
      }
    }
  }
  return system;
}

/// Parents of the points that refinement adds, each at the middle of an edge.
using Parents = std::vector<std::array<int, 2>>;

Tetrahedra divideIntoEight(const Tetrahedra& body, Parents& parents) {
  std::unordered_map<std::int64_t, int> middles;
  std::vector<Eigen::Vector3d> points;
  const std::int64_t n = body.points.cols();
  const auto middle = [&](int a, int b) {
    if (a > b) std::swap(a, b);
    const auto [found, is_new] = middles.try_emplace(a * n + b, static_cast<int>(n + points.size()));
    if (is_new) {
      points.push_back(0.5 * (body.points.col(a) + body.points.col(b)));
      parents.push_back({a, b});
    }
    return found->second;
  };
  const auto pointOf = [&](int i) -> Eigen::Vector3d {
    return i < n ? Eigen::Vector3d(body.points.col(i)) : points[i - n];
  };
  Tetrahedra fine;
  fine.cells.reserve(8 * body.cells.size());
  for (const auto& [a, b, c, d] : body.cells) {
    const int ab = middle(a, b), ac = middle(a, c), ad = middle(a, d), bc = middle(b, c), bd = middle(b, d),
              cd = middle(c, d);
    fine.cells.insert(fine.cells.end(), {{a, ab, ac, ad}, {ab, b, bc, bd}, {ac, bc, c, cd}, {ad, bd, cd, d}});
    // The octahedron inside, along its shortest diagonal: the four edges around it, in order.
    const std::array<std::array<int, 6>, 3> diagonals = {
        {{ab, cd, ac, ad, bd, bc}, {ac, bd, ad, ab, bc, cd}, {ad, bc, ab, ac, cd, bd}}};
    const auto length = [&](const std::array<int, 6>& around) {
      return (pointOf(around[0]) - pointOf(around[1])).squaredNorm();
    };
    const auto& [p, q, r0, r1, r2, r3] =
        *std::min_element(diagonals.begin(), diagonals.end(),
                          [&](const auto& s, const auto& t) { return length(s) < length(t); });
    fine.cells.insert(fine.cells.end(), {{p, q, r0, r1}, {p, q, r1, r2}, {p, q, r2, r3}, {p, q, r3, r0}});
  }
  fine.points.resize(3, n + static_cast<Eigen::Index>(points.size()));
  fine.points.leftCols(n) = body.points;
  for (std::size_t i = 0; i < points.size(); ++i)
    fine.points.col(n + static_cast<Eigen::Index>(i)) = points[i];
  for (std::array<int, 4>& cell : fine.cells) {
    Eigen::Matrix3d edges;
    for (int i = 0; i < 3; ++i) edges.col(i) = fine.points.col(cell[i + 1]) - fine.points.col(cell[0]);
    if (edges.determinant() < 0) std::swap(cell[2], cell[3]);
  }
  return fine;
}

Eigen::Matrix3Xd weights(const System& system, const Eigen::Vector3d& gravity) {
  Eigen::Matrix3Xd forces = gravity * system.masses.transpose();
  for (std::size_t i = 0; i < system.fixed.size(); ++i)
    if (system.fixed[i]) forces.col(static_cast<Eigen::Index>(i)).setZero();
  return forces;
}

/// z = D^-1 r + P Kc^-1 P^T r, P the interpolation from the coarse body, D the block diagonal.
class TwoLevel {
 public:
  TwoLevel(const System& fine, const Parents& parents, DirectSolver& coarse, int num_coarse)
      : fine_(fine), parents_(parents), coarse_(coarse), num_coarse_(num_coarse) {
    for (int i = 0; i < fine.pattern.numVertices(); ++i)
      inverse_diagonal_.push_back(fine.stiffness[fine.pattern.column_start[i]].inverse());
  }

  Eigen::Matrix3Xd operator()(const Eigen::Matrix3Xd& r) {
    Eigen::Matrix3Xd coarse_r = r.leftCols(num_coarse_), coarse_z;
    for (std::size_t i = 0; i < parents_.size(); ++i)
      for (const int parent : parents_[i])
        coarse_r.col(parent) += 0.5 * r.col(num_coarse_ + static_cast<Eigen::Index>(i));
    coarse_.solve(coarse_r, coarse_z);
    Eigen::Matrix3Xd z(3, r.cols());
    z.leftCols(num_coarse_) = coarse_z;
    for (std::size_t i = 0; i < parents_.size(); ++i)
      z.col(num_coarse_ + static_cast<Eigen::Index>(i)) =
          0.5 * (coarse_z.col(parents_[i][0]) + coarse_z.col(parents_[i][1]));
    for (Eigen::Index i = 0; i < r.cols(); ++i) {
      if (fine_.fixed[i])
        z.col(i).setZero();
      else
        z.col(i) += inverse_diagonal_[i] * r.col(i);
    }
    return z;
  }

 private:
  const System& fine_;
  const Parents& parents_;
  DirectSolver& coarse_;
  const int num_coarse_;
  std::vector<Eigen::Matrix3d> inverse_diagonal_;
};

double dot(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  return (a.array() * b.array()).sum();
}

}  // namespace

double meanSag(const Eigen::Ref<const Eigen::Matrix3Xd>& displacements, const Eigen::VectorXd& masses,
               const std::vector<bool>& fixed, const Eigen::Vector3d& gravity_m_s2) {
  double work = 0, weight = 0;
  for (std::size_t i = 0; i < fixed.size(); ++i) {
    if (fixed[i]) continue;
    work += masses[static_cast<Eigen::Index>(i)] *
            gravity_m_s2.dot(displacements.col(static_cast<Eigen::Index>(i)));
    weight += masses[static_cast<Eigen::Index>(i)] * gravity_m_s2.norm();
  }
  return work / weight;
}

SagReference findSagReference(const Tetrahedra& tetrahedra, const std::vector<bool>& fixed,
                              const IsotropicMaterial& material, const Eigen::Vector3d& gravity_m_s2) {
  constexpr int kMostIterations = 2000;
  // The sag's error is the square of this: the work of the load is stationary at the solution.
  constexpr double kTolerance = 1e-5;
  SagReference reference;
  const System coarse = assemble(tetrahedra, fixed, material);
  DirectSolver solver;
  SolveStatus status = solver.analyse(coarse.pattern, fixed);
  if (status == SolveStatus::kSolved) status = solver.factorise(coarse.pattern, coarse.stiffness);
  Eigen::Matrix3Xd u;
  if (status == SolveStatus::kSolved) status = solver.solve(weights(coarse, gravity_m_s2), u).status;
  if (status != SolveStatus::kSolved) {
    reference.message = toString(status);
    return reference;
  }
  reference.coarse_sag_m = meanSag(u, coarse.masses, fixed, gravity_m_s2);

  Parents parents;
  const Tetrahedra finer = divideIntoEight(tetrahedra, parents);
  std::vector<bool> fine_fixed = fixed;
  for (const auto& [a, b] : parents) fine_fixed.push_back(fixed[a] && fixed[b]);
  const System fine = assemble(finer, fine_fixed, material);
  reference.fine_cells = static_cast<int>(finer.cells.size());
  TwoLevel precondition(fine, parents, solver, static_cast<int>(tetrahedra.points.cols()));

  Eigen::Matrix3Xd x = Eigen::Matrix3Xd::Zero(3, finer.points.cols());
  Eigen::Matrix3Xd r = weights(fine, gravity_m_s2);
  Eigen::Matrix3Xd z = precondition(r), p = z;
  double rz = dot(r, z);
  const double first_rz = rz;
  while (rz > kTolerance * kTolerance * first_rz && reference.iterations < kMostIterations) {
    Eigen::Matrix3Xd q = multiply(fine.pattern, fine.stiffness, p);
    for (std::size_t i = 0; i < fine_fixed.size(); ++i)
      if (fine_fixed[i]) q.col(static_cast<Eigen::Index>(i)).setZero();
    const double alpha = rz / dot(p, q);
    x += alpha * p;
    r -= alpha * q;
    z = precondition(r);
    const double next = dot(r, z);
    p = z + next / rz * p;
    rz = next;
    ++reference.iterations;
  }
  if (reference.iterations == kMostIterations) reference.message = "the iteration did not converge";
  reference.fine_sag_m = meanSag(x, fine.masses, fine_fixed, gravity_m_s2);
  return reference;
}

}  // namespace polyscalpel::report
