// SPDX-License-Identifier: BSD-3-Clause
#include "polyscalpel/ros_bridge/yaml_reader.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "ros_bridge/expect_refused.hpp"

namespace polyscalpel {
namespace {

using testing::expectRefused;

YamlMap parse(const std::string& text) {
  return YamlMap::parse(text, "scene.yaml");
}

TEST(YamlReader, ReadsWhatIsThereAndKeepsDefaults) {
  YamlMap map = parse("a: 1e-3\nb: true\nc: [1, 2.5, -3]\nd: word\ne: 7\n");
  double a = 9, absent = 4;
  bool b = false;
  Eigen::Vector3d c(0, 0, 0);
  std::string d = "x";
  int e = 0;
  map.number("a", a, kPositive);
  map.number("absent", absent, kPositive);
  map.boolean("b", b);
  map.numbers("c", c, kAnyNumber);
  map.text("d", d, "a word");
  map.integer("e", e, {0, 10});
  map.finish();
  EXPECT_EQ(a, 1e-3);
  EXPECT_EQ(absent, 4);
  EXPECT_TRUE(b);
  EXPECT_EQ(c, Eigen::Vector3d(1, 2.5, -3));
  EXPECT_EQ(d, "word");
  EXPECT_EQ(e, 7);
  ASSERT_EQ(map.document().fields.size(), 6u);
  EXPECT_EQ(map.document().fields[1].path, "absent");
  EXPECT_EQ(map.document().fields[1].default_value, "4");
  EXPECT_EQ(map.document().fields[1].range, "(0, inf)");
}

TEST(YamlReader, FieldsWithoutADefaultStayAsTheyAre) {
  YamlMap map = parse("a: 3\nb: left\nc: 0.5\n");
  std::optional<int> a, no_a;
  std::optional<std::string> b, no_b;
  std::optional<double> c, no_c;
  map.optionalInteger("a", a, {0, 10});
  map.optionalInteger("no_a", no_a, {0, 10});
  map.optionalChoice("b", b, {"left", "right"});
  map.optionalChoice("no_b", no_b, {"left", "right"});
  map.optionalNumber("c", c, {0, 10, true, false});
  map.optionalNumber("no_c", no_c, {0, 10, true, false});
  map.finish();
  EXPECT_EQ(a, 3);
  EXPECT_EQ(b, "left");
  EXPECT_FALSE(no_a.has_value());
  EXPECT_FALSE(no_b.has_value());
  EXPECT_EQ(c, 0.5);
  EXPECT_FALSE(no_c.has_value());
  for (const FieldRecord& field : map.document().fields) EXPECT_EQ(field.default_value, "none");
  EXPECT_EQ(map.document().fields[3].range, "{left, right}");
  EXPECT_EQ(map.document().fields[5].range, "(0, 10]");
  expectRefused(
      [] {
        std::optional<double> d;
        parse("d: 0\n").optionalNumber("d", d, {0, 10, true, false});
      },
      {"scene.yaml:1", "d = 0", "(0, 10]"});
  expectRefused(
      [] {
        std::optional<int> c;
        parse("c: 11\n").optionalInteger("c", c, {0, 10});
      },
      {"scene.yaml:1", "c = 11", "[0, 10]"});
  expectRefused(
      [] {
        std::optional<std::string> c;
        parse("c: lift\n").optionalChoice("c", c, {"left", "right"});
      },
      {"scene.yaml:1", "c = lift", "left, right", "did you mean left?"});
}

TEST(YamlReader, NamesFileLinePathValueAndRange) {
  expectRefused(
      [] {
        YamlMap map = parse("outer:\n  inner:\n    h: -2\n").map("outer");
        YamlMap inner = map.map("inner");
        double h = 1;
        inner.number("h", h, {0, 5});
      },
      {"scene.yaml:3", "outer.inner.h", "-2", "[0, 5]"});
}

TEST(YamlReader, RefusesNumbersThatAreNone) {
  for (const std::string value :
       {".nan", ".inf", "-.inf", "abc", "\"1\"", "1 m", "[1]", "{a: 1}", "", "true"}) {
    SCOPED_TRACE(value);
    expectRefused(
        [&] {
          YamlMap map = parse("h: " + value + "\n");
          double h = 1;
          map.number("h", h, kAnyNumber);
        },
        {"scene.yaml:1", "h = "});
  }
}

TEST(YamlReader, HoldsEveryBound) {
  const auto accepts = [](const Range& range, double value) { return range.contains(value); };
  const Range closed{-1, 2};
  EXPECT_TRUE(accepts(closed, -1));
  EXPECT_TRUE(accepts(closed, 2));
  EXPECT_FALSE(accepts(closed, std::nextafter(-1.0, -2.0)));
  EXPECT_FALSE(accepts(closed, std::nextafter(2.0, 3.0)));
  const Range open{-1, 2, true, true};
  EXPECT_FALSE(accepts(open, -1));
  EXPECT_FALSE(accepts(open, 2));
  EXPECT_TRUE(accepts(open, std::nextafter(-1.0, 0.0)));
  EXPECT_TRUE(accepts(open, std::nextafter(2.0, 0.0)));
  EXPECT_FALSE(accepts(kAnyNumber, std::nan("")));
  EXPECT_FALSE(accepts(kAnyNumber, std::numeric_limits<double>::infinity()));
  EXPECT_EQ(open.text(), "(-1, 2)");
}

TEST(YamlReader, RefusesUnknownKeysWithTheNearestKnown) {
  expectRefused(
      [] {
        YamlMap map = parse("a_known_key: 1\na_knwon_key: 2\n");
        double a = 0;
        map.number("a_known_key", a, kAnyNumber);
        map.finish();
      },
      {"scene.yaml:2", "a_knwon_key", "unknown key", "did you mean a_known_key?"});
}

TEST(YamlReader, RefusesAKeyGivenTwice) {
  expectRefused([] { parse("a: 1\nb: 2\na: 3\n"); }, {"scene.yaml", "a", "once"});
}

TEST(YamlReader, RefusesWhatIsNoMap) {
  expectRefused([] { parse("- 1\n- 2\n"); }, {"scene.yaml", "map"});
  expectRefused([] { parse(""); }, {"scene.yaml", "map"});
  expectRefused([] { parse("a: [1, 2\nb: 3\n"); }, {"scene.yaml", "no valid YAML"});
  expectRefused([] { parse("cutting:\n").map("cutting"); },
                {"scene.yaml:1", "cutting", "{} for all defaults"});
  expectRefused([] { YamlMap::load("/no/such/file.yaml"); }, {"/no/such/file.yaml", "cannot be opened"});
}

TEST(YamlReader, RefusesListsOfTheWrongLength) {
  expectRefused(
      [] {
        YamlMap map = parse("c: [1, 2]\n");
        Eigen::Vector3d c(0, 0, 0);
        map.numbers("c", c, kAnyNumber);
      },
      {"c = ", "3 numbers"});
  expectRefused(
      [] {
        YamlMap map = parse("c: [1, .nan, 3]\n");
        Eigen::Vector3d c(0, 0, 0);
        map.numbers("c", c, kAnyNumber);
      },
      {"c[1]", ".nan"});
  expectRefused(
      [] {
        YamlMap map = parse("c: [[0, 0, 0]]\n");
        Eigen::Matrix3Xd c;
        map.points("c", c, 2);
      },
      {"c = ", "at least 2 points"});
  expectRefused(
      [] {
        YamlMap map = parse("e: 1.5\n");
        int e = 0;
        map.integer("e", e, {0, 3});
      },
      {"e = 1.5", "whole number"});
}

TEST(YamlReader, ChoosesAmongWordsAndKeys) {
  expectRefused(
      [] {
        YamlMap map = parse("mode: dynamik\n");
        std::string mode = "dynamic";
        map.choice("mode", mode, {"dynamic", "static"});
      },
      {"mode = dynamik", "dynamic, static", "did you mean dynamic?"});
  EXPECT_EQ(parse("box: {}\n").oneOf({"box", "ball"}), "box");
  expectRefused([] { parse("box: {}\nball: {}\n").oneOf({"box", "ball"}); }, {"exactly one of box, ball"});
  expectRefused(
      [] {
        parse("bxo: {}\n").oneOf({"box", "ball"});
      },
      {"exactly one of box, ball", "did you mean box?"});
}

TEST(YamlReader, WritesNumbersThatReadBack) {
  for (const double value : {0.0, 0.1, 1e-6, -9.81, 5e6, 1.0 / 3.0, 1e300})
    EXPECT_EQ(std::stod(toText(value)), value) << toText(value);
}

TEST(YamlReader, FindsTheNearestWord) {
  EXPECT_EQ(nearestWord("time_stp_s", {"time_step_s", "mode"}), "time_step_s");
  EXPECT_EQ(nearestWord("xyz", {"time_step_s", "mode"}), "");
}

}  // namespace
}  // namespace polyscalpel
