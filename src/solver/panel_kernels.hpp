// SPDX-License-Identifier: BSD-3-Clause
//
// Products with the dense panels of a factor. Compiled once for every machine and once for wider registers
// (panel_kernels_avx2.cpp), with the same roundings; all functions have internal linkage, so that nothing
// compiled for wide registers ends up elsewhere in the program.
#pragma once

#include <cstring>

namespace polyscalpel {

constexpr int kPanelLanes = 8;    ///< rows of a panel are a multiple of it
constexpr int kPanelColumns = 4;  ///< taken together; columns are a multiple of it, filled up with zeros

/// A panel lies column by column, leading rows each; its upper triangle is zero.
struct PanelKernels {
  /// y = P x. x: columns, y: leading.
  void (*multiply)(const float* panel, int leading, int columns, const float* x, float* y);
  /// y = P^T x. x: leading, y: columns.
  void (*multiplyTransposed)(const float* panel, int leading, int columns, const float* x, float* y);
};

const PanelKernels& panelKernels();
/// With 8 floats in a register, or nullptr where compiler or processor cannot.
const PanelKernels* avx2PanelKernels();

typedef float PanelRow __attribute__((vector_size(4 * kPanelLanes)));

static inline PanelRow loadPanelRow(const float* from) {
  PanelRow row;
  std::memcpy(&row, from, sizeof row);
  return row;
}

static void multiplyPanel(const float* panel, int leading, int columns, const float* x, float* y) {
  std::memset(y, 0, sizeof(float) * leading);
  for (int j = 0; j < columns; j += kPanelColumns) {
    const float* const p0 = panel + static_cast<long>(j) * leading;
    const float* const p1 = p0 + leading;
    const float* const p2 = p1 + leading;
    const float* const p3 = p2 + leading;
    const float x0 = x[j], x1 = x[j + 1], x2 = x[j + 2], x3 = x[j + 3];
    for (int i = j / kPanelLanes * kPanelLanes; i < leading; i += kPanelLanes) {
      const PanelRow sum = loadPanelRow(y + i) + (loadPanelRow(p0 + i) * x0 + loadPanelRow(p1 + i) * x1) +
                           (loadPanelRow(p2 + i) * x2 + loadPanelRow(p3 + i) * x3);
      std::memcpy(y + i, &sum, sizeof sum);
    }
  }
}

static inline float sumOf(const PanelRow& row) {
  return ((row[0] + row[4]) + (row[1] + row[5])) + ((row[2] + row[6]) + (row[3] + row[7]));
}

static void multiplyPanelTransposed(const float* panel, int leading, int columns, const float* x, float* y) {
  for (int j = 0; j < columns; j += kPanelColumns) {
    const float* const p0 = panel + static_cast<long>(j) * leading;
    const float* const p1 = p0 + leading;
    const float* const p2 = p1 + leading;
    const float* const p3 = p2 + leading;
    PanelRow s0 = {}, s1 = {}, s2 = {}, s3 = {};
    for (int i = j / kPanelLanes * kPanelLanes; i < leading; i += kPanelLanes) {
      const PanelRow x_i = loadPanelRow(x + i);
      s0 += loadPanelRow(p0 + i) * x_i;
      s1 += loadPanelRow(p1 + i) * x_i;
      s2 += loadPanelRow(p2 + i) * x_i;
      s3 += loadPanelRow(p3 + i) * x_i;
    }
    y[j] = sumOf(s0);
    y[j + 1] = sumOf(s1);
    y[j + 2] = sumOf(s2);
    y[j + 3] = sumOf(s3);
  }
}

static inline PanelKernels makePanelKernels() {
  return {&multiplyPanel, &multiplyPanelTransposed};
}

}  // namespace polyscalpel
