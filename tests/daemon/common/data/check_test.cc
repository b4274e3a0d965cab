// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/data/check.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace v2vouch {
namespace {

constexpr int kChecks = static_cast<int>(Check::kCount);

std::string Content(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::stringstream stream;
  stream << file.rdbuf();
  return stream.str();
}

// "kEmptyPlace" of "empty_place".
std::string Enumerator(std::string_view name) {
  std::string text = "k";
  bool is_first = true;
  for (const char letter : name) {
    if (letter == '_') {
      is_first = true;
      continue;
    }
    text += is_first ? static_cast<char>(std::toupper(letter)) : letter;
    is_first = false;
  }
  return text;
}

TEST(Check, TheTableIsInTheOrderOfTheEnum) {
  const std::string header = Content("daemon/common/data/check.h");
  std::size_t from = 0;
  for (int i = 0; i < kChecks; ++i) {
    const std::string_view name = NameOf(static_cast<Check>(i));
    const std::size_t at = header.find("  " + Enumerator(name) + ",", from);
    EXPECT_NE(at, std::string::npos) << name << " is missing or out of order";
    from = at == std::string::npos ? from : at;
  }
}

TEST(Check, IsFoundWhereTheTableSays) {
  for (int i = 0; i < kChecks; ++i) {
    const CheckInfo& info = Describe(static_cast<Check>(i));
    const std::string source = Content("daemon/" + std::string(info.found_in) + ".cc");
    EXPECT_NE(source.find("Check::" + Enumerator(info.name)), std::string::npos)
        << info.name << " in " << info.found_in;
  }
}

TEST(Check, IsOnTheReferencePageWithItsSourceAndClass) {
  const std::string page = Content("docs/reference/checks.md");
  constexpr const char* kClasses[] = {"none",     "beacon", "static",      "security",
                                      "position", "speed",  "acceleration"};
  for (int i = 0; i < kChecks; ++i) {
    const CheckInfo& info = Describe(static_cast<Check>(i));
    const std::string row = "| `" + std::string(info.name) + "` | `" + std::string(info.found_in);
    const std::size_t at = page.find(row);
    ASSERT_NE(at, std::string::npos) << row;
    const std::string line = page.substr(at, page.find('\n', at) - at);
    const std::string standard = std::string("| ") +
                                 kClasses[static_cast<int>(info.etsi_class) + 1] +
                                 (info.is_listed_by_etsi ? "* |" : " |");
    EXPECT_TRUE(line.ends_with(standard)) << line << "\n  should end with " << standard;
  }
}

}  // namespace
}  // namespace v2vouch
