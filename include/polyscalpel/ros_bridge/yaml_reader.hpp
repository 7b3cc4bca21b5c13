// SPDX-License-Identifier: BSD-3-Clause
//
// Strict reading of YAML files: whatever is not understood is refused with file, line, key path, value and
// what is allowed.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <yaml-cpp/yaml.h>
#include <Eigen/Core>

namespace polyscalpel {

/// Allowed values of a number. Bounds belong to the range unless open.
struct Range {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  bool lowest_open = false;
  bool highest_open = false;

  /// In interval notation, for example "(0, inf)".
  std::string text() const;
  /// Whether value is finite and inside.
  bool contains(double value) const;
};

const Range kAnyNumber{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
                       true, true};
const Range kPositive{0, std::numeric_limits<double>::infinity(), true, true};
const Range kNotNegative{0, std::numeric_limits<double>::infinity(), false, true};

/// A field that a reader knows: what a test compares the documented scene with.
struct FieldRecord {
  std::string path;           ///< "integration.time_step_s"
  std::string default_value;  ///< as text; "required" or "none" where there is none
  std::string range;          ///< as text
};

/// What all nodes of one document share.
struct YamlDocument {
  std::string file;
  std::vector<FieldRecord> fields;  ///< in the order in which they were asked for
};

/// A map in a YAML document. Each field is asked for once; finish() then refuses every key that nobody asked
/// for. All members throw std::invalid_argument "file:line: path = value: must be ..." .
class YamlMap {
 public:
  /// path: of this map in the document, empty at the top.
  YamlMap(YAML::Node node, std::string path, std::shared_ptr<YamlDocument> document);

  /// Reads a file whose top is a map.
  static YamlMap load(const std::string& file);

  /// The same for text; `file` is the name in messages.
  static YamlMap parse(const std::string& text, const std::string& file);

  bool has(const std::string& key);

  /// Each reads a field into `value`, which holds the default and keeps it when the key is absent.
  void number(const std::string& key, double& value, const Range& range);
  void integer(const std::string& key, int& value, const Range& range);
  void boolean(const std::string& key, bool& value);
  /// rule: what the text must be, for messages; empty text is refused unless the default is empty.
  void text(const std::string& key, std::string& value, const std::string& rule);
  /// One of several words.
  void choice(const std::string& key, std::string& value, const std::vector<std::string>& words);
  /// The same without a default: `value` stays as it is when the key is absent.
  void optionalNumber(const std::string& key, std::optional<double>& value, const Range& range);
  void optionalInteger(const std::string& key, std::optional<int>& value, const Range& range);
  void optionalChoice(const std::string& key, std::optional<std::string>& value,
                      const std::vector<std::string>& words);
  /// A list of as many numbers as value has, each in the range.
  void numbers(const std::string& key, Eigen::Ref<Eigen::VectorXd> value, const Range& range);
  void integers(const std::string& key, Eigen::Ref<Eigen::VectorXi> value, const Range& range);
  /// A list of at least one integer.
  void integerList(const std::string& key, std::vector<int>& value, const Range& range);
  /// A list of at least min_points points [x, y, z]: 3 x n.
  void points(const std::string& key, Eigen::Matrix3Xd& value, int min_points);

  /// Makes a field that has no default obligatory: throws unless the key is there.
  void require(const std::string& key);

  /// A map inside this one, which must be there.
  YamlMap map(const std::string& key);
  /// The maps of a list inside this one; none when the key is absent.
  std::vector<YamlMap> maps(const std::string& key);

  /// Of the given keys the one that is there; throws unless it is exactly one.
  std::string oneOf(const std::vector<std::string>& keys);

  /// Refuses every key that was not asked for, naming the nearest one that was.
  void finish() const;

  /// Throws std::invalid_argument for the field `key` (this map itself when empty): file, line, path, value,
  /// rule.
  [[noreturn]] void refuse(const std::string& key, const std::string& rule) const;

  const std::string& path() const { return path_; }
  const YamlDocument& document() const { return *document_; }

 private:
  YAML::Node find(const std::string& key);
  void record(const std::string& key, const std::string& default_value, const std::string& range);
  void choose(const std::string& key, const std::string& default_value, std::optional<std::string>& value,
              const std::vector<std::string>& words);
  double toNumber(const std::string& key, const YAML::Node& node, const Range& range, bool whole) const;
  [[noreturn]] void refuseNode(const YAML::Node& node, const std::string& path,
                               const std::string& rule) const;
  std::string join(const std::string& key) const;
  /// Items of a list field; throws unless it is a list with at least min_count items.
  std::vector<YAML::Node> items(const std::string& key, const YAML::Node& node, std::size_t min_count,
                                const std::string& rule) const;

  YAML::Node node_;
  std::string path_;
  std::shared_ptr<YamlDocument> document_;
  std::vector<std::string> asked_;
};

/// A number as short as it can be read back, for example "0.05".
std::string toText(double value);

/// Of the candidates the one with the fewest edits to `word`, or empty when all are further than half its
/// length.
std::string nearestWord(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace polyscalpel
