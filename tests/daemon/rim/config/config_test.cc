// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "daemon/rim/config/yaml_reader.h"
#include "daemon/rim/config/yaml_writer.h"

namespace v2vouch::config {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

enum class Mode { kSlow, kFast };

struct Inner {
  double eps_m = 1.2;
  int min_points = 3;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("eps_m", eps_m, {.above = 0.0, .at_most = 10.0});
    a.Field("min_points", min_points, {.at_least = 1});
  }
};

struct Settings {
  Inner dbscan;
  std::optional<Inner> extra{};
  std::vector<std::uint32_t> ids{};
  bool is_on = true;
  double yaw_rad = FromDegrees(60.0);
  std::string name = "FRONT";
  Mode mode = Mode::kSlow;
  std::uint32_t own_id = 0;
  std::uint64_t seed = 1;
  std::vector<double> numbers = {1.0};
  std::vector<Inner> parts = {Inner{}};

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("dbscan", dbscan);
    a.Field("extra", extra);
    a.Field("ids", ids, {.at_least = 1});
    a.Field("is_on", is_on);
    a.Degrees("yaw_deg", yaw_rad, {.at_least = -180.0, .at_most = 180.0});
    a.Text("name", name);
    a.Choice("mode", mode, {{"slow", Mode::kSlow}, {"fast", Mode::kFast}});
    a.Field("own_id", own_id);
    a.Field("seed", seed);
    a.Field("numbers", numbers, {.at_least = -5.0});
    a.Field("parts", parts);
    a.Ignore("of_others");
  }
};

struct Reading {
  Settings settings;
  std::vector<std::string> problems;
};

Reading Read(const std::string& text) {
  Reading reading;
  const bool good = Parse(text, "a.yaml", reading.settings, reading.problems);
  EXPECT_EQ(good, reading.problems.empty());
  return reading;
}

TEST(YamlReader, AnOptionalSectionIsThereOnlyWhereItsKeyIs) {
  EXPECT_FALSE(Read("ids: [3, 4000000000]").settings.extra.has_value());
  const Reading reading = Read("extra: {min_points: 8}\nids: [3, 4000000000]");
  ASSERT_TRUE(reading.settings.extra.has_value());
  EXPECT_EQ(reading.settings.extra->min_points, 8);
  EXPECT_EQ(reading.settings.extra->eps_m, 1.2);
  EXPECT_THAT(Read("extra: {min_point: 8}").problems,
              ElementsAre(HasSubstr("extra.min_point: unknown key")));
  const std::string text = Print(reading.settings);
  EXPECT_THAT(text, HasSubstr("extra:\n  eps_m: 1.2\n  min_points: 8\nids: [3, 4000000000]\n"));
  EXPECT_EQ(Print(Read(text + "of_others: 1").settings), text);
  EXPECT_THAT(Print(Settings{}), testing::Not(HasSubstr("extra")));
}

TEST(YamlReader, EveryKindOfValueIsRead) {
  const Reading reading = Read(R"(
dbscan: {eps_m: 2.5e0, min_points: 7}
is_on: false
yaw_deg: -90
name: "REAR LEFT"
mode: fast
own_id: 4294967295
seed: 18446744073709551615
numbers: [1, -2.5, +3]
parts:
  - eps_m: 4
  - min_points: 9
of_others: {anything: [goes, here]}
)");
  EXPECT_THAT(reading.problems, IsEmpty());
  const Settings& s = reading.settings;
  EXPECT_EQ(s.dbscan.eps_m, 2.5);
  EXPECT_EQ(s.dbscan.min_points, 7);
  EXPECT_FALSE(s.is_on);
  EXPECT_DOUBLE_EQ(s.yaw_rad, -kPi / 2);
  EXPECT_EQ(s.name, "REAR LEFT");
  EXPECT_EQ(s.mode, Mode::kFast);
  EXPECT_EQ(s.own_id, 4294967295u);
  EXPECT_EQ(s.seed, 18446744073709551615u);
  EXPECT_THAT(s.numbers, ElementsAre(1.0, -2.5, 3.0));
  ASSERT_EQ(s.parts.size(), 2u);
  EXPECT_EQ(s.parts[0].eps_m, 4.0);
  EXPECT_EQ(s.parts[0].min_points, 3);  // The struct's own default.
  EXPECT_EQ(s.parts[1].min_points, 9);
}

TEST(YamlReader, EmptyFileKeepsTheDefaults) {
  EXPECT_THAT(Read("").problems, IsEmpty());
  EXPECT_EQ(Read("# only a comment\n").settings.name, "FRONT");
}

TEST(YamlReader, AllProblemsAreNamedAtOnceWithFileLineKeyValueAndBounds) {
  const Reading reading = Read(
      "dbscan:\n"
      "  eps_m: -0.5\n"
      "  min_point: 3\n"
      "is_on: yes\n"
      "yaw_deg: 270\n"
      "mode: fats\n"
      "own_id: 4294967296\n"
      "name: [A]\n"
      "numbers: 3\n"
      "parts:\n"
      "  - eps_m: 11\n"
      "  - 5\n"
      "weather: 1\n");
  EXPECT_THAT(reading.problems,
              ElementsAre("a.yaml:2: dbscan.eps_m = -0.5: must be above 0, at most 10",
                          "a.yaml:3: dbscan.min_point: unknown key (did you mean min_points?)",
                          "a.yaml:4: is_on = yes: must be true or false",
                          "a.yaml:5: yaw_deg = 270: must be at least -180, at most 180",
                          "a.yaml:8: name = a list: must be a text",
                          "a.yaml:6: mode = fats: must be one of slow, fast (did you mean fast?)",
                          "a.yaml:7: own_id = 4294967296: must be a whole number",
                          "a.yaml:9: numbers = 3: must be a list",
                          "a.yaml:11: parts[0].eps_m = 11: must be above 0, at most 10",
                          "a.yaml:12: parts[1] = 5: must be a section of keys and values",
                          "a.yaml:13: weather: unknown key"));
}

TEST(YamlReader, WronglyTypedNumbersAreProblems) {
  for (const char* text :
       {"\"1\"", "one", "1.5.2", "nan", ".inf", "inf", "1e999", "0x10", "", "{}", "[1]", "~"}) {
    const Reading reading = Read(std::string("dbscan: {eps_m: ") + text + "}");
    EXPECT_EQ(reading.problems.size(), 1u) << text;
    EXPECT_EQ(reading.settings.dbscan.eps_m, 1.2) << text;
  }
  for (const char* text : {"1.5", "1e3", "99999999999999999999", "-1", "0"}) {
    EXPECT_EQ(Read(std::string("dbscan: {min_points: ") + text + "}").problems.size(), 1u) << text;
  }
}

TEST(YamlReader, RepeatedKeysAreProblems) {
  EXPECT_THAT(Read("is_on: true\nis_on: false\n").problems,
              ElementsAre("a.yaml:2: is_on = false: stands here a second time, first in line 1"));
}

TEST(YamlReader, WhatIsNotOurYamlIsOneProblem) {
  EXPECT_THAT(Read("- a\n- b\n").problems,
              ElementsAre("a.yaml:1: the file = a list: must be a section of keys and values"));
  for (const char* text :
       {"a: [1, 2", "a: b: c", "\t- x", "a: &x 1\nb: *x\n", "a: !!str 1", "? {a: 1}\n: 2\n",
        "is_on: true\n---\nis_on: false\n", "\"a", "name: \"a\\0b\""}) {
    EXPECT_EQ(Read(text).problems.size(), 1u) << text;
  }
}

TEST(YamlReader, DepthAndSizeAreBounded) {
  for (const char* opening : {"[", "{a: ", "- ", "? "}) {
    std::string deep;
    for (int i = 0; i < 100'000; ++i) deep += opening;
    EXPECT_THAT(Read(deep).problems,
                ElementsAre(testing::AnyOf(HasSubstr("nested too deeply"),
                                           HasSubstr("a key must be a plain word"))));
  }
  EXPECT_THAT(Read(std::string(kMaxFileBytes + 1, ' ')).problems,
              ElementsAre(HasSubstr("larger than")));
}

TEST(YamlReader, FilesThatCannotBeReadSayWhy) {
  Settings settings;
  std::vector<std::string> problems;
  EXPECT_FALSE(Load("no/such/file.yaml", settings, problems));
  EXPECT_FALSE(Load("/", settings, problems));
  EXPECT_THAT(problems,
              ElementsAre("no/such/file.yaml: No such file or directory", "/: is a folder"));
}

TEST(YamlWriter, PrintsDegreesAndNumbersAsAUserWouldWriteThem) {
  Settings settings;
  settings.dbscan.eps_m = 0.1;
  EXPECT_EQ(Print(settings),
            "dbscan:\n"
            "  eps_m: 0.1\n"
            "  min_points: 3\n"
            "ids: []\n"
            "is_on: true\n"
            "yaw_deg: 60\n"
            "name: FRONT\n"
            "mode: slow\n"
            "own_id: 0\n"
            "seed: 1\n"
            "numbers: [1]\n"
            "parts:\n"
            "  - eps_m: 1.2\n"
            "    min_points: 3\n");
}

// Property: what is printed reads back as the same settings, bit for bit, awkward texts included.
TEST(YamlWriterProperty, RoundTrip) {
  std::mt19937_64 rng(20240611);
  const std::vector<std::string> texts = {"",  "true", "12",       "a: b", "#x",      "\"quoted\"",
                                          "~", "a\\b", "\n\t\x1B", "ä",    " space ", "- x"};
  for (int trial = 0; trial < 500; ++trial) {
    Settings before;
    before.dbscan.eps_m = 10.0 * static_cast<double>(rng() + 1) / 18446744073709551616.0;
    before.yaw_rad = FromDegrees(static_cast<double>(static_cast<std::int64_t>(rng())) * 1.9e-17);
    before.name = texts[rng() % texts.size()];
    before.numbers = {1e-300, 1e300, static_cast<double>(rng())};
    before.parts.resize(rng() % 3);
    const Reading after = Read(Print(before));
    ASSERT_THAT(after.problems, IsEmpty()) << Print(before);
    EXPECT_EQ(Print(after.settings), Print(before));
    EXPECT_EQ(after.settings.dbscan.eps_m, before.dbscan.eps_m);
    EXPECT_EQ(after.settings.yaw_rad, before.yaw_rad);
    EXPECT_EQ(after.settings.name, before.name);
    EXPECT_EQ(after.settings.numbers, before.numbers);
    EXPECT_EQ(after.settings.parts.size(), before.parts.size());
  }
}

// Whatever bytes stand in a file: problems or settings, never a crash.
TEST(YamlReaderProperty, RandomDamageIsSurvived) {
  std::mt19937_64 rng(7);
  const std::string good = Print(Settings{});
  constexpr char kSyntax[] = "{}[]:,-?&*!|>'\"%@`# \n\t\x01\xFF";
  int refused = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    std::string text = good;
    for (std::uint64_t edits = 1 + rng() % 6; edits > 0; --edits) {
      text[rng() % text.size()] = kSyntax[rng() % (sizeof(kSyntax) - 1)];
    }
    Settings settings;
    std::vector<std::string> problems;
    if (!Parse(text, "a.yaml", settings, problems)) ++refused;
  }
  EXPECT_GT(refused, 1500);
}

}  // namespace
}  // namespace v2vouch::config
