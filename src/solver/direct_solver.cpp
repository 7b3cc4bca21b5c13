// SPDX-License-Identifier: BSD-3-Clause
//
// Y. Chen, T. Davis, W. Hager, S. Rajamanickam, "Algorithm 887: CHOLMOD, Supernodal Sparse Cholesky
// Factorization and Update/Downdate", ACM Transactions on Mathematical Software 35(3), 2008.
#include "polyscalpel/solver/direct_solver.hpp"

#include <cmath>

#include "cholmod_handles.hpp"
#include "one_thread.hpp"
#include "polyscalpel/core/checks.hpp"
#include "polyscalpel/solver/symbolic_factor.hpp"

namespace polyscalpel {

struct DirectSolver::Impl {
  CholmodCommon common;         // before what it frees
  std::vector<int> free_index;  // of each vertex, -1 where fixed; descending, so that the pattern's lower
                                // part is upper here
  int num_free = 0;
  Ordering ordering = Ordering::kUndecided;
  // Upper part, 3 num_free square: CHOLMOD permutes a lower one by transposing it twice.
  CholmodSparse matrix;
  CholmodFactor factor;
  CholmodDense rhs;
  cholmod_dense* solution = nullptr;  // these three are made and kept by cholmod_solve2
  cholmod_dense* work_y = nullptr;
  cholmod_dense* work_e = nullptr;
  bool has_factor = false;
  Eigen::VectorXd b;  // these three: of the free dofs
  Eigen::VectorXd x;
  Eigen::VectorXd residual;

  Impl() = default;
  ~Impl() {
    cholmod_free_dense(&solution, common.get());
    cholmod_free_dense(&work_y, common.get());
    cholmod_free_dense(&work_e, common.get());
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  SolveStatus failure() {
    return common->status == CHOLMOD_NOT_POSDEF ? SolveStatus::kNotPositiveDefinite
                                                : SolveStatus::kOutOfMemory;
  }

  SolveStatus takePattern(const BlockPattern& pattern, const std::vector<bool>& fixed);
  bool makeMatrix(const BlockPattern& pattern);
  bool analyse(const std::vector<int>& vertex_order);
  double updateResidual();
  bool solveWithFactor(const Eigen::VectorXd& right, bool add);
};

// The scalar matrix's pattern. Free indices run against the vertices, so going through the pattern backwards
// gives columns and the rows within them ascending, the diagonal last.
bool DirectSolver::Impl::makeMatrix(const BlockPattern& pattern) {
  std::size_t num_entries = 0;
  for (int column = 0; column < pattern.numVertices(); ++column) {
    if (free_index[column] < 0) continue;
    num_entries += 6;
    for (int k = pattern.column_start[column] + 1; k < pattern.column_start[column + 1]; ++k) {
      if (free_index[pattern.row[k]] >= 0) num_entries += 9;
    }
  }
  const std::size_t size = 3 * static_cast<std::size_t>(num_free);
  matrix = CholmodSparse(
      cholmod_allocate_sparse(size, size, num_entries, 1, 1, 1, CHOLMOD_REAL, common.get()), {common.get()});
  rhs = CholmodDense(cholmod_allocate_dense(size, 1, size, CHOLMOD_REAL, common.get()), {common.get()});
  if (!matrix || !rhs) return false;
  int* const start = static_cast<int*>(matrix->p);
  int* const rows = static_cast<int*>(matrix->i);
  int entry = 0;
  for (int column = pattern.numVertices() - 1; column >= 0; --column) {
    if (free_index[column] < 0) continue;
    for (int c = 0; c < 3; ++c) {
      start[3 * free_index[column] + c] = entry;
      for (int k = pattern.column_start[column + 1] - 1; k >= pattern.column_start[column]; --k) {
        const int row = free_index[pattern.row[k]];
        if (row < 0) continue;
        const int last = row == free_index[column] ? c : 2;
        for (int r = 0; r <= last; ++r) rows[entry++] = 3 * row + r;
      }
    }
  }
  start[size] = entry;
  POLYSCALPEL_ASSERT(entry == static_cast<int>(num_entries));
  return true;
}

bool DirectSolver::Impl::analyse(const std::vector<int>& vertex_order) {
  std::vector<int> order;
  order.reserve(3 * vertex_order.size());
  for (const int vertex : vertex_order) {
    for (int c = 0; c < 3; ++c) order.push_back(3 * free_index[vertex] + c);
  }
  common->nmethods = 1;
  common->method[0].ordering = CHOLMOD_GIVEN;
  common->postorder = 1;
  factor =
      CholmodFactor(cholmod_analyze_p(matrix.get(), order.data(), nullptr, 0, common.get()), {common.get()});
  return factor != nullptr;
}

DirectSolver::DirectSolver() : impl_(std::make_unique<Impl>()) {}
DirectSolver::~DirectSolver() = default;
DirectSolver::DirectSolver(DirectSolver&&) noexcept = default;
DirectSolver& DirectSolver::operator=(DirectSolver&&) noexcept = default;

bool DirectSolver::hasFactor() const {
  return impl_->has_factor;
}

SolveStatus DirectSolver::Impl::takePattern(const BlockPattern& pattern, const std::vector<bool>& fixed) {
  POLYSCALPEL_ASSERT(static_cast<int>(fixed.size()) == pattern.numVertices());
  has_factor = false;
  factor.reset();
  free_index.assign(fixed.size(), -1);
  num_free = 0;
  for (std::size_t i = fixed.size(); i-- > 0;) {
    if (!fixed[i]) free_index[i] = num_free++;
  }
  return num_free == 0 || makeMatrix(pattern) ? SolveStatus::kSolved : failure();
}

// The first pattern decides on the ordering: a later one is the same body with some cuts.
SolveStatus DirectSolver::analyse(const BlockPattern& pattern, const std::vector<bool>& fixed) {
  Impl& s = *impl_;
  SolveStatus status = s.takePattern(pattern, fixed);
  if (status != SolveStatus::kSolved || s.num_free == 0) return status;
  SymbolicFactor symbolic;
  status = polyscalpel::analyse(pattern, fixed, s.ordering, symbolic);
  if (status != SolveStatus::kSolved) return status;
  return s.analyse(symbolic.order) ? SolveStatus::kSolved : s.failure();
}

SolveStatus DirectSolver::factorise(const BlockPattern& pattern, const Blocks& blocks) {
  Impl& s = *impl_;
  POLYSCALPEL_ASSERT(static_cast<int>(s.free_index.size()) == pattern.numVertices());
  POLYSCALPEL_ASSERT(static_cast<int>(blocks.size()) == pattern.numBlocks());
  s.has_factor = false;
  if (s.num_free == 0) {
    s.has_factor = true;
    return SolveStatus::kSolved;
  }
  if (!s.factor) return SolveStatus::kOutOfMemory;
  double* const values = static_cast<double*>(s.matrix->x);
  double zero = 0;  // turns into NaN at the first value that is not finite
  int entry = 0;
  for (int column = pattern.numVertices() - 1; column >= 0; --column) {
    if (s.free_index[column] < 0) continue;
    for (int c = 0; c < 3; ++c) {
      for (int k = pattern.column_start[column + 1] - 1; k >= pattern.column_start[column]; --k) {
        const int row = pattern.row[k];
        if (s.free_index[row] < 0) continue;
        const int last = row == column ? c : 2;
        for (int r = 0; r <= last; ++r) {
          const double value =
              row == column ? blocks[k](c, r) : blocks[k](r, c);  // of a diagonal block the lower part
          zero += value * 0.0;
          values[entry++] = value;
        }
      }
    }
  }
  POLYSCALPEL_ASSERT(entry == static_cast<int*>(s.matrix->p)[3 * s.num_free]);
  if (zero != 0) return SolveStatus::kNotFinite;
  const OneThread one_thread;
  const bool done = cholmod_factorize(s.matrix.get(), s.factor.get(), s.common.get());
  if (!done || s.common->status != CHOLMOD_OK) return s.failure();
  if (s.factor->minor < s.factor->n) return SolveStatus::kNotPositiveDefinite;
  s.has_factor = true;
  return SolveStatus::kSolved;
}

// residual = b - A x; returns |residual| / |b|.
double DirectSolver::Impl::updateResidual() {
  residual = b;
  const int* const start = static_cast<const int*>(matrix->p);
  const int* const rows = static_cast<const int*>(matrix->i);
  const double* const values = static_cast<const double*>(matrix->x);
  for (int column = 0; column < static_cast<int>(b.size()); ++column) {
    const double x_column = x[column];
    const int diagonal = start[column + 1] - 1;
    double sum = values[diagonal] * x_column;
    for (int k = start[column]; k < diagonal; ++k) {
      residual[rows[k]] -= values[k] * x_column;
      sum += values[k] * x[rows[k]];
    }
    residual[column] -= sum;
  }
  return residual.stableNorm() / b.stableNorm();
}

// x = A^-1 right, or x += A^-1 right.
bool DirectSolver::Impl::solveWithFactor(const Eigen::VectorXd& right, bool add) {
  Eigen::Map<Eigen::VectorXd>(static_cast<double*>(rhs->x), right.size()) = right;
  if (!cholmod_solve2(CHOLMOD_A, factor.get(), rhs.get(), nullptr, &solution, nullptr, &work_y, &work_e,
                      common.get())) {
    return false;
  }
  const Eigen::Map<const Eigen::VectorXd> result(static_cast<const double*>(solution->x), right.size());
  if (add) {
    x += result;
  } else {
    x = result;
  }
  return true;
}

SolveResult DirectSolver::solve(const Eigen::Ref<const Eigen::Matrix3Xd>& b, Eigen::Matrix3Xd& x) {
  Impl& s = *impl_;
  POLYSCALPEL_ASSERT(s.has_factor && b.cols() == static_cast<Eigen::Index>(s.free_index.size()));
  x.setZero(3, b.cols());
  SolveResult result;
  s.b.resize(3 * s.num_free);
  for (Eigen::Index i = 0; i < b.cols(); ++i) {
    if (s.free_index[i] >= 0) s.b.segment<3>(3 * s.free_index[i]) = b.col(i);
  }
  if (!s.b.allFinite()) {
    result.status = SolveStatus::kNotFinite;
    return result;
  }
  if ((s.b.array() == 0).all()) return result;
  const OneThread one_thread;
  if (!s.solveWithFactor(s.b, false)) {
    result.status = s.failure();
    return result;
  }
  result.relative_residual = s.updateResidual();
  if (result.relative_residual > kRefinedResidual) {
    const Eigen::VectorXd x_before = s.x;
    if (!s.solveWithFactor(s.residual, true)) {
      result.status = s.failure();
      return result;
    }
    const double refined = s.updateResidual();
    ++result.refinements;
    if (refined < result.relative_residual) {
      result.relative_residual = refined;
    } else {
      s.x = x_before;
    }
  }
  if (!s.x.allFinite() || !std::isfinite(result.relative_residual)) {
    result.status = SolveStatus::kNotFinite;
  } else if (result.relative_residual > kLargestResidual) {
    result.status = SolveStatus::kInaccurate;
  } else {
    for (Eigen::Index i = 0; i < b.cols(); ++i) {
      if (s.free_index[i] >= 0) x.col(i) = s.x.segment<3>(3 * s.free_index[i]);
    }
  }
  return result;
}

}  // namespace polyscalpel
