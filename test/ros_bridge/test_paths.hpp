// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace polyscalpel::testing {

/// A path in the source tree.
inline std::string sourcePath(const std::string& path) {
  return (std::filesystem::path(__FILE__).parent_path().parent_path().parent_path() / path).string();
}

}  // namespace polyscalpel::testing
