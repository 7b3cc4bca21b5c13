// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace polyscalpel::testing {

/// Expects std::invalid_argument with every one of the words in its message.
template <class Function>
void expectRefused(const Function& function, const std::vector<std::string>& words) {
  try {
    function();
  } catch (const std::invalid_argument& exception) {
    const std::string message = exception.what();
    for (const std::string& word : words)
      EXPECT_NE(message.find(word), std::string::npos) << "no \"" << word << "\" in: " << message;
    return;
  }
  ADD_FAILURE() << "not refused; expected a message with " << (words.empty() ? "" : words.front());
}

}  // namespace polyscalpel::testing
