// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/core/checks.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

namespace polyscalpel {

void failAssertion(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "%s:%d: invariant broken: %s\n", file, line, condition);
  std::abort();
}

void requireInRange(const std::string& name, double value, double lowest, double highest) {
  if (std::isfinite(value) && value >= lowest && value <= highest) return;
  std::ostringstream message;
  message << name << " = " << value << ": must be finite and in [" << lowest << ", " << highest << "]";
  throw std::invalid_argument(message.str());
}

void requireIntInRange(const std::string& name, int value, int lowest, int highest) {
  if (value >= lowest && value <= highest) return;
  throw std::invalid_argument(name + " = " + std::to_string(value) + ": must be in [" +
                              std::to_string(lowest) + ", " + std::to_string(highest) + "]");
}

void requirePositive(const std::string& name, double value) {
  if (std::isfinite(value) && value > 0) return;
  std::ostringstream message;
  message << name << " = " << value << ": must be finite and in (0, inf)";
  throw std::invalid_argument(message.str());
}

namespace {

/// All coordinates of a body are looked at in every step of a blade. Where they follow on one another, 0
/// times each is summed up in wide registers; allFinite() takes them one by one.
bool isFinite(const Eigen::Ref<const Eigen::MatrixXd>& value) {
  if (value.outerStride() != value.rows()) return value.allFinite();
  return (0 * Eigen::Map<const Eigen::ArrayXd>(value.data(), value.size())).sum() == 0;
}

}  // namespace

void requireFinite(const std::string& name, const Eigen::Ref<const Eigen::MatrixXd>& value) {
  if (isFinite(value)) return;
  std::ostringstream message;
  message << name << " = [" << value.reshaped().transpose() << "]: every component must be finite";
  throw std::invalid_argument(message.str());
}

}  // namespace polyscalpel
