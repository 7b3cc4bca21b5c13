// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace polyscalpel {

/// Keeps BLAS to the calling thread. OpenBLAS splits work by the number of its threads, and so the order of
/// its sums: with one, machines with other numbers of cores give the same bits. Its number is the process's
/// and stays.
void keepBlasToOneThread();

/// Keeps CHOLMOD too to the calling thread while it lives. It asks OpenMP for four threads, which on fewer
/// cores wait for each other; at the depth of zero set here and taken back afterwards it gets none.
class OneThread {
 public:
  OneThread();
  ~OneThread();
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int depth_before_ = 1;
};

}  // namespace polyscalpel
