// SPDX-License-Identifier: BSD-3-Clause
//
// Y. Chen, T. Davis, W. Hager, S. Rajamanickam, "Algorithm 887: CHOLMOD, Supernodal Sparse Cholesky
// Factorization and Update/Downdate", ACM Transactions on Mathematical Software 35(3), 2008.
#include "polyscalpel/solver/direct_solver.hpp"

#include <dlfcn.h>

#include <cmath>
#include <utility>

#include <cholmod.h>

#include "polyscalpel/core/checks.hpp"

namespace polyscalpel {

namespace {

struct SparseDeleter {
  cholmod_common* common = nullptr;
  void operator()(cholmod_sparse* matrix) const { cholmod_free_sparse(&matrix, common); }
};
struct DenseDeleter {
  cholmod_common* common = nullptr;
  void operator()(cholmod_dense* matrix) const { cholmod_free_dense(&matrix, common); }
};
struct FactorDeleter {
  cholmod_common* common = nullptr;
  void operator()(cholmod_factor* factor) const { cholmod_free_factor(&factor, common); }
};
using Sparse = std::unique_ptr<cholmod_sparse, SparseDeleter>;
using Dense = std::unique_ptr<cholmod_dense, DenseDeleter>;
using Factor = std::unique_ptr<cholmod_factor, FactorDeleter>;

template <class Function>
Function findInProcess(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_DEFAULT, name));
}

// Keeps BLAS and CHOLMOD to the calling thread. OpenBLAS splits work by the number of its threads, and so the
// order of its sums: with one, machines with other numbers of cores give the same bits. CHOLMOD asks OpenMP
// for four threads, which on fewer cores wait for each other; at the depth of zero set here and taken back
// afterwards it gets none. Both are looked up at run time, because any BLAS may stand behind CHOLMOD.
// OpenBLAS's number is the process's and stays.
class OneThread {
 public:
  OneThread() {
    static const auto set_blas_threads = findInProcess<void (*)(int)>("openblas_set_num_threads");
    static const auto get_blas_threads = findInProcess<int (*)()>("openblas_get_num_threads");
    if (set_blas_threads && get_blas_threads && get_blas_threads() != 1) set_blas_threads(1);
    if (!canLimitDepth()) return;
    depth_before_ = getDepth()();
    setDepth()(0);
  }
  ~OneThread() {
    if (canLimitDepth()) setDepth()(depth_before_);
  }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  using GetDepth = int (*)();
  using SetDepth = void (*)(int);
  static GetDepth getDepth() {
    static const auto function = findInProcess<GetDepth>("omp_get_max_active_levels");
    return function;
  }
  static SetDepth setDepth() {
    static const auto function = findInProcess<SetDepth>("omp_set_max_active_levels");
    return function;
  }
  static bool canLimitDepth() { return getDepth() && setDepth(); }

  int depth_before_ = 1;
};

enum class Ordering { kUndecided, kMinimumDegree, kNestedDissection };

}  // namespace

const char* toString(SolveStatus status) {
  switch (status) {
    case SolveStatus::kSolved:
      return "solved";
    case SolveStatus::kNotPositiveDefinite:
      return "the matrix is not positive definite";
    case SolveStatus::kOutOfMemory:
      return "the factor does not fit into memory";
    case SolveStatus::kNotFinite:
      return "the matrix, the right-hand side or the solution is not finite";
    case SolveStatus::kInaccurate:
      return "the residual is too large";
  }
  POLYSCALPEL_ASSERT(false);
  return "";
}

struct DirectSolver::Impl {
  cholmod_common common;
  std::vector<int> free_index;  // of each vertex, -1 where fixed; descending, so that the pattern's lower
                                // part is upper here
  int num_free = 0;
  Ordering ordering = Ordering::kUndecided;
  Sparse matrix;  // upper part, 3 num_free square: CHOLMOD permutes a lower one by transposing it twice
  Factor factor;
  Dense rhs;
  cholmod_dense* solution = nullptr;  // these three are made and kept by cholmod_solve2
  cholmod_dense* work_y = nullptr;
  cholmod_dense* work_e = nullptr;
  bool has_factor = false;
  Eigen::VectorXd b;  // these three: of the free dofs
  Eigen::VectorXd x;
  Eigen::VectorXd residual;

  Impl() {
    cholmod_start(&common);
    common.print = 0;
    common.error_handler = nullptr;
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.quick_return_if_not_posdef = 1;
  }
  ~Impl() {
    cholmod_free_dense(&solution, &common);
    cholmod_free_dense(&work_y, &common);
    cholmod_free_dense(&work_e, &common);
    matrix.reset();
    factor.reset();
    rhs.reset();
    cholmod_finish(&common);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  SolveStatus failure() const {
    return common.status == CHOLMOD_NOT_POSDEF ? SolveStatus::kNotPositiveDefinite
                                               : SolveStatus::kOutOfMemory;
  }

  SolveStatus takePattern(const BlockPattern& pattern, const std::vector<bool>& fixed);
  bool makeMatrix(const BlockPattern& pattern);
  bool orderVertices(const BlockPattern& pattern, Ordering ordering, std::vector<int>& order);
  Factor makeSymbolicFactor(const std::vector<int>& vertex_order);
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
  matrix =
      Sparse(cholmod_allocate_sparse(size, size, num_entries, 1, 1, 1, CHOLMOD_REAL, &common), {&common});
  rhs = Dense(cholmod_allocate_dense(size, 1, size, CHOLMOD_REAL, &common), {&common});
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

// The graph of vertices is nine times smaller than that of the dofs and has the same good orderings.
bool DirectSolver::Impl::orderVertices(const BlockPattern& pattern, Ordering ordering,
                                       std::vector<int>& order) {
  const std::size_t size = static_cast<std::size_t>(num_free);
  Sparse graph(cholmod_allocate_sparse(size, size, pattern.row.size(), 1, 1, 1, CHOLMOD_PATTERN, &common),
               {&common});
  if (!graph) return false;
  int* const start = static_cast<int*>(graph->p);
  int* const rows = static_cast<int*>(graph->i);
  int entry = 0;
  for (int column = pattern.numVertices() - 1; column >= 0; --column) {
    if (free_index[column] < 0) continue;
    start[free_index[column]] = entry;
    for (int k = pattern.column_start[column + 1] - 1; k >= pattern.column_start[column]; --k) {
      if (free_index[pattern.row[k]] >= 0) rows[entry++] = free_index[pattern.row[k]];
    }
  }
  start[size] = entry;
  order.resize(size);
  return ordering == Ordering::kNestedDissection
             ? cholmod_metis(graph.get(), nullptr, 0, 1, order.data(), &common)
             : cholmod_amd(graph.get(), nullptr, 0, order.data(), &common);
}

Factor DirectSolver::Impl::makeSymbolicFactor(const std::vector<int>& vertex_order) {
  std::vector<int> order;
  order.reserve(3 * vertex_order.size());
  for (const int vertex : vertex_order) {
    for (int c = 0; c < 3; ++c) order.push_back(3 * vertex + c);
  }
  common.nmethods = 1;
  common.method[0].ordering = CHOLMOD_GIVEN;
  common.postorder = 1;
  return Factor(cholmod_analyze_p(matrix.get(), order.data(), nullptr, 0, &common), {&common});
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

SolveStatus DirectSolver::analyse(const BlockPattern& pattern, const std::vector<bool>& fixed,
                                  const std::vector<int>& order) {
  Impl& s = *impl_;
  const SolveStatus status = s.takePattern(pattern, fixed);
  if (status != SolveStatus::kSolved || s.num_free == 0) return status;
  POLYSCALPEL_ASSERT(static_cast<int>(order.size()) == s.num_free);
  std::vector<int> free_order;
  free_order.reserve(order.size());
  for (const int vertex : order) free_order.push_back(s.free_index[vertex]);
  s.factor = s.makeSymbolicFactor(free_order);
  return s.factor ? SolveStatus::kSolved : s.failure();
}

SolveStatus DirectSolver::analyse(const BlockPattern& pattern, const std::vector<bool>& fixed) {
  Impl& s = *impl_;
  const SolveStatus status = s.takePattern(pattern, fixed);
  if (status != SolveStatus::kSolved || s.num_free == 0) return status;
  // Minimum degree takes a millisecond or two; nested dissection takes ten times that after every cut, so it
  // must earn it. Decided once: a later pattern is the same body with some cuts.
  constexpr double kWorthDissection = 0.7;
  const auto analyse_by = [&](Ordering ordering) {
    std::vector<int> order;
    if (s.orderVertices(pattern, ordering, order)) s.factor = s.makeSymbolicFactor(order);
    return s.factor != nullptr;
  };
  if (s.ordering != Ordering::kUndecided) return analyse_by(s.ordering) ? SolveStatus::kSolved : s.failure();
  if (!analyse_by(Ordering::kMinimumDegree)) return s.failure();
  constexpr int kFewVertices = 1000;  // their factor takes less time than dissection
  if (s.num_free <= kFewVertices) return SolveStatus::kSolved;
  const double operations = s.common.fl;
  Factor by_degree = std::move(s.factor);
  if (analyse_by(Ordering::kNestedDissection) && s.common.fl < kWorthDissection * operations) {
    s.ordering = Ordering::kNestedDissection;
  } else {
    s.ordering = Ordering::kMinimumDegree;
    s.factor = std::move(by_degree);
  }
  return SolveStatus::kSolved;
}

std::size_t DirectSolver::factorSize() const {
  return impl_->factor ? impl_->factor->xsize : 0;
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
  const bool done = cholmod_factorize(s.matrix.get(), s.factor.get(), &s.common);
  if (!done || s.common.status != CHOLMOD_OK) return s.failure();
  if (s.factor->minor < s.factor->n) return SolveStatus::kNotPositiveDefinite;
  s.has_factor = true;
  return SolveStatus::kSolved;
}

FactorPanels DirectSolver::panels() {
  Impl& s = *impl_;
  POLYSCALPEL_ASSERT(s.has_factor);
  FactorPanels panels;
  if (s.num_free == 0) return panels;
  const cholmod_factor& L = *s.factor;
  POLYSCALPEL_ASSERT(L.is_super && L.xtype == CHOLMOD_REAL);
  const int* const super = static_cast<const int*>(L.super);
  const int* const first_row = static_cast<const int*>(L.pi);
  const int* const first_value = static_cast<const int*>(L.px);
  const int* const rows = static_cast<const int*>(L.s);
  double* const values = static_cast<double*>(L.x);
  for (std::size_t k = 0; k < L.nsuper; ++k) {
    panels.supernodes.push_back({super[k], super[k + 1] - super[k], first_row[k + 1] - first_row[k],
                                 rows + first_row[k], values + first_value[k]});
  }
  std::vector<int> vertex_of_free(s.num_free);
  for (std::size_t i = 0; i < s.free_index.size(); ++i) {
    if (s.free_index[i] >= 0) vertex_of_free[s.free_index[i]] = static_cast<int>(i);
  }
  const int* const permutation = static_cast<const int*>(L.Perm);
  panels.places.reserve(L.n);
  for (std::size_t k = 0; k < L.n; ++k)
    panels.places.push_back(3 * vertex_of_free[permutation[k] / 3] + permutation[k] % 3);
  return panels;
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
                      &common)) {
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
