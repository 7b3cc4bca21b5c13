// SPDX-License-Identifier: BSD-3-Clause
#include "one_thread.hpp"

#include <dlfcn.h>

namespace polyscalpel {

namespace {

// Looked up at run time, because any BLAS may stand behind CHOLMOD.
template <class Function>
Function findInProcess(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_DEFAULT, name));
}

using GetDepth = int (*)();
using SetDepth = void (*)(int);

GetDepth getDepth() {
  static const auto function = findInProcess<GetDepth>("omp_get_max_active_levels");
  return function;
}

SetDepth setDepth() {
  static const auto function = findInProcess<SetDepth>("omp_set_max_active_levels");
  return function;
}

bool canLimitDepth() {
  return getDepth() && setDepth();
}

}  // namespace

void keepBlasToOneThread() {
  static const auto set_blas_threads = findInProcess<void (*)(int)>("openblas_set_num_threads");
  static const auto get_blas_threads = findInProcess<int (*)()>("openblas_get_num_threads");
  if (set_blas_threads && get_blas_threads && get_blas_threads() != 1) set_blas_threads(1);
}

OneThread::OneThread() {
  keepBlasToOneThread();
  if (!canLimitDepth()) return;
  depth_before_ = getDepth()();
  setDepth()(0);
}

OneThread::~OneThread() {
  if (canLimitDepth()) setDepth()(depth_before_);
}

}  // namespace polyscalpel
