// SPDX-License-Identifier: BSD-3-Clause
#include "benchmark/report.hpp"

#include <cmath>
#include <sstream>

namespace polyscalpel::report {
namespace {

/// A row may carry several rules; it holds if all do.
void addRule(Row& row, const std::string& rule, bool holds) {
  row["held"] = row.contains("held") ? row["held"].get<std::string>() + "; " + rule : rule;
  row["holds"] = (!row.contains("holds") || row["holds"].get<bool>()) && holds;
}

/// NaN where there is no finite number.
double finiteValue(const Row& row, const std::string& name) {
  const bool is_number = row.contains(name) && row[name].is_number();
  const double value = is_number ? row[name].get<double>() : NAN;
  return std::isfinite(value) ? value : NAN;
}

std::string ruleOf(const std::string& name, const std::string& relation, double limit) {
  std::ostringstream rule;
  rule << name << ' ' << relation << ' ' << limit;
  return rule.str();
}

}  // namespace

void holdAtMost(Row& row, const std::string& name, double limit) {
  addRule(row, ruleOf(name, "<=", limit), finiteValue(row, name) <= limit);
}

void holdAtLeast(Row& row, const std::string& name, double limit) {
  addRule(row, ruleOf(name, ">=", limit), finiteValue(row, name) >= limit);
}

void holdEqual(Row& row, const std::string& name, int expected) {
  const bool is_number = row.contains(name) && row[name].is_number_integer();
  addRule(row, name + " = " + std::to_string(expected), is_number && row[name].get<int>() == expected);
}

void holdFailed(Row& row, const std::string& why) {
  addRule(row, why, false);
}

std::vector<std::string> brokenRules(const std::string& section, const Rows& rows) {
  std::vector<std::string> broken;
  for (const Row& row : rows)
    if (row.contains("holds") && !row["holds"].get<bool>())
      broken.push_back(section + ": " + row["held"].get<std::string>() + " does not hold in " + row.dump());
  return broken;
}

}  // namespace polyscalpel::report
