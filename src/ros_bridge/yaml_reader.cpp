// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/yaml_reader.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

namespace polyscalpel {
namespace {

constexpr const char* kNoDefault = "none";

std::string where(const YamlDocument& document, const YAML::Node& node) {
  const YAML::Mark mark = node.Mark();
  return mark.is_null() ? document.file : document.file + ":" + std::to_string(mark.line + 1);
}

/// A scalar without quotes: "0.1" in quotes is text, not a number.
bool isPlainScalar(const YAML::Node& node) {
  return node.IsScalar() && node.Tag() != "!";
}

std::string valueText(const YAML::Node& node) {
  if (node.IsNull()) return "(empty)";
  if (node.IsScalar()) return isPlainScalar(node) ? node.Scalar() : "\"" + node.Scalar() + "\"";
  return node.IsMap() ? "(a map)" : "(a list)";
}

YamlMap topMap(const YAML::Node& node, const std::string& file) {
  auto document = std::make_shared<YamlDocument>();
  document->file = file;
  if (!node.IsMap()) throw std::invalid_argument(file + ": must be a YAML map of keys and values");
  return {node, "", document};
}

std::string listText(const Eigen::Ref<const Eigen::VectorXd>& values) {
  std::string text = "[";
  for (Eigen::Index i = 0; i < values.size(); ++i) text += (i > 0 ? ", " : "") + toText(values(i));
  return text + "]";
}

}  // namespace

std::string Range::text() const {
  return (lowest_open ? "(" : "[") + toText(lowest) + ", " + toText(highest) + (highest_open ? ")" : "]");
}

bool Range::contains(double value) const {
  return std::isfinite(value) && (lowest_open ? value > lowest : value >= lowest) &&
         (highest_open ? value < highest : value <= highest);
}

std::string toText(double value) {
  if (std::isinf(value)) return value < 0 ? "-inf" : "inf";
  char text[40];
  if (value == std::round(value) && std::abs(value) < 1e10) {
    std::snprintf(text, sizeof(text), "%.0f", value + 0.0);  // no -0
    return text;
  }
  for (int digits = 1; digits <= 17; ++digits) {
    std::snprintf(text, sizeof(text), "%.*g", digits, value);
    if (std::strtod(text, nullptr) == value) break;
  }
  return text;
}

std::string nearestWord(const std::string& word, const std::vector<std::string>& candidates) {
  std::string nearest;
  std::size_t fewest = word.size() / 2 + 2;
  for (const std::string& candidate : candidates) {
    // Levenshtein distance, one row at a time
    std::vector<std::size_t> row(candidate.size() + 1);
    for (std::size_t j = 0; j < row.size(); ++j) row[j] = j;
    for (std::size_t i = 1; i <= word.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i;
      for (std::size_t j = 1; j < row.size(); ++j) {
        const std::size_t replaced = diagonal + (word[i - 1] == candidate[j - 1] ? 0 : 1);
        diagonal = row[j];
        row[j] = std::min({row[j] + 1, row[j - 1] + 1, replaced});
      }
    }
    if (row.back() < fewest) {
      fewest = row.back();
      nearest = candidate;
    }
  }
  return nearest;
}

YamlMap::YamlMap(YAML::Node node, std::string path, std::shared_ptr<YamlDocument> document)
    : node_(std::move(node)), path_(std::move(path)), document_(std::move(document)) {
  if (!node_.IsMap()) refuseNode(node_, path_, "must be a map of keys and values");
  std::vector<std::string> keys;
  for (const auto& entry : node_) {
    if (!entry.first.IsScalar()) refuseNode(entry.first, path_, "every key must be a word");
    keys.push_back(entry.first.Scalar());
    if (std::count(keys.begin(), keys.end(), keys.back()) > 1)
      refuseNode(entry.first, join(keys.back()), "the key must occur once");
  }
}

YamlMap YamlMap::load(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw std::invalid_argument(file + ": the file cannot be opened");
  std::ostringstream text;
  text << stream.rdbuf();
  if (stream.bad()) throw std::invalid_argument(file + ": the file cannot be read");
  return parse(text.str(), file);
}

YamlMap YamlMap::parse(const std::string& text, const std::string& file) {
  YAML::Node node;
  try {
    node = YAML::Load(text);
  } catch (const YAML::Exception& exception) {
    throw std::invalid_argument(file + ":" + std::to_string(exception.mark.line + 1) +
                                ": no valid YAML: " + exception.msg);
  }
  return topMap(node, file);
}

std::string YamlMap::join(const std::string& key) const {
  if (key.empty()) return path_;
  return path_.empty() ? key : path_ + "." + key;
}

void YamlMap::refuseNode(const YAML::Node& node, const std::string& path, const std::string& rule) const {
  std::string place = where(*document_, node);
  // An empty value has no place of its own: that of its key.
  if (node.IsNull() && node_.IsMap())
    for (const auto& entry : node_)
      if (entry.second.is(node)) place = where(*document_, entry.first);
  throw std::invalid_argument(place + ": " + (path.empty() ? "" : path + " = ") + valueText(node) + ": " +
                              rule);
}

void YamlMap::refuse(const std::string& key, const std::string& rule) const {
  const YAML::Node& node = node_;
  refuseNode(key.empty() || !node[key] ? node : node[key], join(key), rule);
}

YAML::Node YamlMap::find(const std::string& key) {
  asked_.push_back(key);
  const YAML::Node& node = node_;  // the const operator[] does not insert the key
  return node[key] ? node[key] : YAML::Node(YAML::NodeType::Undefined);
}

bool YamlMap::has(const std::string& key) {
  return find(key).IsDefined();
}

void YamlMap::record(const std::string& key, const std::string& default_value, const std::string& range) {
  document_->fields.push_back({join(key), default_value, range});
}

void YamlMap::require(const std::string& key) {
  if (!has(key)) throw std::invalid_argument(where(*document_, node_) + ": " + join(key) + " is missing");
}

double YamlMap::toNumber(const std::string& key, const YAML::Node& node, const Range& range,
                         bool whole) const {
  const std::string rule = std::string("must be a ") + (whole ? "whole " : "") + "number in " + range.text();
  double value = 0;
  if (!isPlainScalar(node) || !YAML::convert<double>::decode(node, value)) refuseNode(node, join(key), rule);
  if (!range.contains(value) || (whole && value != std::round(value))) refuseNode(node, join(key), rule);
  return value;
}

void YamlMap::number(const std::string& key, double& value, const Range& range) {
  record(key, toText(value), range.text());
  const YAML::Node node = find(key);
  if (node.IsDefined()) value = toNumber(key, node, range, false);
}

void YamlMap::integer(const std::string& key, int& value, const Range& range) {
  record(key, std::to_string(value), range.text());
  const YAML::Node node = find(key);
  if (node.IsDefined()) value = static_cast<int>(toNumber(key, node, range, true));
}

void YamlMap::optionalNumber(const std::string& key, std::optional<double>& value, const Range& range) {
  record(key, kNoDefault, range.text());
  const YAML::Node node = find(key);
  if (node.IsDefined()) value = toNumber(key, node, range, false);
}

void YamlMap::optionalInteger(const std::string& key, std::optional<int>& value, const Range& range) {
  record(key, kNoDefault, range.text());
  const YAML::Node node = find(key);
  if (node.IsDefined()) value = static_cast<int>(toNumber(key, node, range, true));
}

void YamlMap::boolean(const std::string& key, bool& value) {
  record(key, value ? "true" : "false", "{false, true}");
  const YAML::Node node = find(key);
  if (!node.IsDefined()) return;
  if (!isPlainScalar(node) || (node.Scalar() != "true" && node.Scalar() != "false"))
    refuseNode(node, join(key), "must be true or false");
  value = node.Scalar() == "true";
}

void YamlMap::text(const std::string& key, std::string& value, const std::string& rule) {
  record(key, "\"" + value + "\"", rule);
  const YAML::Node node = find(key);
  if (!node.IsDefined()) return;
  if (!node.IsScalar() || (node.Scalar().empty() && !value.empty()))
    refuseNode(node, join(key), "must be " + rule);
  value = node.Scalar();
}

void YamlMap::choice(const std::string& key, std::string& value, const std::vector<std::string>& words) {
  std::optional<std::string> word;
  choose(key, value, word, words);
  if (word) value = *word;
}

void YamlMap::optionalChoice(const std::string& key, std::optional<std::string>& value,
                             const std::vector<std::string>& words) {
  choose(key, kNoDefault, value, words);
}

void YamlMap::choose(const std::string& key, const std::string& default_value,
                     std::optional<std::string>& value, const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
  record(key, default_value, "{" + list + "}");
  const YAML::Node node = find(key);
  if (!node.IsDefined()) return;
  if (!node.IsScalar() || std::find(words.begin(), words.end(), node.Scalar()) == words.end()) {
    const std::string nearest = node.IsScalar() ? nearestWord(node.Scalar(), words) : "";
    refuseNode(node, join(key),
               "must be one of " + list + (nearest.empty() ? "" : "; did you mean " + nearest + "?"));
  }
  value = node.Scalar();
}

std::vector<YAML::Node> YamlMap::items(const std::string& key, const YAML::Node& node, std::size_t min_count,
                                       const std::string& rule) const {
  if (!node.IsSequence() || node.size() < min_count) refuseNode(node, join(key), rule);
  std::vector<YAML::Node> result;
  for (std::size_t i = 0; i < node.size(); ++i) result.push_back(node[i]);
  return result;
}

void YamlMap::numbers(const std::string& key, Eigen::Ref<Eigen::VectorXd> value, const Range& range) {
  record(key, listText(value), range.text());
  const YAML::Node node = find(key);
  if (!node.IsDefined()) return;
  const auto count = static_cast<std::size_t>(value.size());
  const std::string rule = "must be a list of " + std::to_string(count) + " numbers, each in " + range.text();
  const std::vector<YAML::Node> list = items(key, node, count, rule);
  if (list.size() != count) refuseNode(node, join(key), rule);
  for (std::size_t i = 0; i < count; ++i)
    value(static_cast<Eigen::Index>(i)) =
        toNumber(key + "[" + std::to_string(i) + "]", list[i], range, false);
}

void YamlMap::integers(const std::string& key, Eigen::Ref<Eigen::VectorXi> value, const Range& range) {
  record(key, listText(value.cast<double>()), range.text());
  const YAML::Node node = find(key);
  if (!node.IsDefined()) return;
  const auto count = static_cast<std::size_t>(value.size());
  const std::string rule =
      "must be a list of " + std::to_string(count) + " whole numbers, each in " + range.text();
  const std::vector<YAML::Node> list = items(key, node, count, rule);
  if (list.size() != count) refuseNode(node, join(key), rule);
  for (std::size_t i = 0; i < count; ++i)
    value(static_cast<Eigen::Index>(i)) =
        static_cast<int>(toNumber(key + "[" + std::to_string(i) + "]", list[i], range, true));
}

void YamlMap::integerList(const std::string& key, std::vector<int>& value, const Range& range) {
  record(key, "required", range.text());
  const YAML::Node node = find(key);
  if (!node.IsDefined()) return;
  value.clear();
  const std::string rule = "must be a list of whole numbers, at least one, each in " + range.text();
  for (const YAML::Node& item : items(key, node, 1, rule))
    value.push_back(
        static_cast<int>(toNumber(key + "[" + std::to_string(value.size()) + "]", item, range, true)));
}

void YamlMap::points(const std::string& key, Eigen::Matrix3Xd& value, int min_points) {
  record(key, "required", kAnyNumber.text());
  const YAML::Node node = find(key);
  if (!node.IsDefined()) return;
  const std::string rule = "must be a list of at least " + std::to_string(min_points) + " points [x, y, z]";
  const std::vector<YAML::Node> list = items(key, node, static_cast<std::size_t>(min_points), rule);
  value.resize(3, static_cast<Eigen::Index>(list.size()));
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string item = key + "[" + std::to_string(i) + "]";
    const std::vector<YAML::Node> coordinates = items(item, list[i], 3, "must be a point [x, y, z]");
    if (coordinates.size() != 3) refuseNode(list[i], join(item), "must be a point [x, y, z]");
    for (std::size_t j = 0; j < 3; ++j)
      value(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)) =
          toNumber(item + "[" + std::to_string(j) + "]", coordinates[j], kAnyNumber, false);
  }
}

YamlMap YamlMap::map(const std::string& key) {
  require(key);
  const YAML::Node node = find(key);
  if (node.IsNull())
    refuseNode(node, join(key),
               "must be a map of keys and values; write {} for all defaults, or leave the key out");
  return {node, join(key), document_};
}

std::vector<YamlMap> YamlMap::maps(const std::string& key) {
  const YAML::Node node = find(key);
  std::vector<YamlMap> result;
  if (!node.IsDefined()) return result;
  for (const YAML::Node& item : items(key, node, 0, "must be a list"))
    result.emplace_back(item, join(key) + "[" + std::to_string(result.size()) + "]", document_);
  return result;
}

std::string YamlMap::oneOf(const std::vector<std::string>& keys) {
  std::string found;
  std::string list;
  int count = 0;
  for (const std::string& key : keys) {
    list += (list.empty() ? "" : ", ") + key;
    if (!has(key)) continue;
    found = key;
    ++count;
  }
  if (count != 1) {
    std::string hint;
    for (const auto& entry : node_) {
      const std::string nearest = count == 0 ? nearestWord(entry.first.Scalar(), keys) : "";
      if (!nearest.empty()) hint = "; instead of " + entry.first.Scalar() + " did you mean " + nearest + "?";
    }
    refuse("", "must hold exactly one of " + list + hint);
  }
  return found;
}

void YamlMap::finish() const {
  for (const auto& entry : node_) {
    const std::string key = entry.first.Scalar();
    if (std::find(asked_.begin(), asked_.end(), key) != asked_.end()) continue;
    const std::string nearest = nearestWord(key, asked_);
    std::string known;
    for (std::size_t i = 0; i < asked_.size(); ++i)
      if (std::find(asked_.begin(), asked_.begin() + static_cast<std::ptrdiff_t>(i), asked_[i]) ==
          asked_.begin() + static_cast<std::ptrdiff_t>(i))
        known += (known.empty() ? "" : ", ") + asked_[i];
    throw std::invalid_argument(where(*document_, entry.first) + ": " + join(key) + ": unknown key; " +
                                (nearest.empty() ? "known here: " + known : "did you mean " + nearest + "?"));
  }
}

}  // namespace polyscalpel
