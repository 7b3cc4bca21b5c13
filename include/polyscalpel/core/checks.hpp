// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <Eigen/Core>

namespace polyscalpel {

/// Ends the program with a message; called by POLYSCALPEL_ASSERT only.
[[noreturn]] void failAssertion(const char* condition, const char* file, int line);

/// Throws std::invalid_argument "name = value: must be in [lowest, highest]" unless value is finite and
/// inside.
void requireInRange(const std::string& name, double value, double lowest, double highest);

/// Throws std::invalid_argument "name = value: must be in [lowest, highest]" unless value is inside.
void requireIntInRange(const std::string& name, int value, int lowest, int highest);

/// Throws std::invalid_argument unless value is finite and > 0.
void requirePositive(const std::string& name, double value);

/// Throws std::invalid_argument unless every component of value is finite.
void requireFinite(const std::string& name, const Eigen::Ref<const Eigen::MatrixXd>& value);

}  // namespace polyscalpel

/// A broken invariant of our own code. On in every build, tests included, unless POLYSCALPEL_DISABLE_ASSERTS
/// is defined.
#ifndef POLYSCALPEL_DISABLE_ASSERTS
#define POLYSCALPEL_ASSERT(condition) \
  ((condition) ? static_cast<void>(0) : ::polyscalpel::failAssertion(#condition, __FILE__, __LINE__))
#else
#define POLYSCALPEL_ASSERT(condition) static_cast<void>(0)
#endif
