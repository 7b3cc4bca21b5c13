// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include <cholmod.h>

namespace polyscalpel {

/// CHOLMOD's settings and statistics, of which every object of its is freed.
class CholmodCommon {
 public:
  CholmodCommon() {
    cholmod_start(&common_);
    common_.print = 0;
    common_.error_handler = nullptr;
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.quick_return_if_not_posdef = 1;
  }
  ~CholmodCommon() { cholmod_finish(&common_); }
  CholmodCommon(const CholmodCommon&) = delete;
  CholmodCommon& operator=(const CholmodCommon&) = delete;

  cholmod_common* get() { return &common_; }
  cholmod_common* operator->() { return &common_; }

 private:
  cholmod_common common_;
};

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
using CholmodSparse = std::unique_ptr<cholmod_sparse, SparseDeleter>;
using CholmodDense = std::unique_ptr<cholmod_dense, DenseDeleter>;
using CholmodFactor = std::unique_ptr<cholmod_factor, FactorDeleter>;

}  // namespace polyscalpel
