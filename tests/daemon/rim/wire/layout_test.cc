// SPDX-License-Identifier: Apache-2.0
// Keeps the table of layouts equal to the .lcm files, which are the public interface.
#include "daemon/rim/wire/layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>

#include "v2vouch/bsm_t.hpp"
#include "v2vouch/bsm_verdict_t.hpp"
#include "v2vouch/calibration_t.hpp"
#include "v2vouch/camera_detections_t.hpp"
#include "v2vouch/camera_image_t.hpp"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/ego_intent_t.hpp"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"
#include "v2vouch/misbehavior_report_t.hpp"
#include "v2vouch/object_list_t.hpp"
#include "v2vouch/obu_status_t.hpp"
#include "v2vouch/radar_scan_t.hpp"
#include "v2vouch/text_t.hpp"
#include "v2vouch/track_list_t.hpp"
#include "v2vouch/truth_bsm_t.hpp"
#include "v2vouch/truth_list_t.hpp"
#include "v2vouch/warning_list_t.hpp"

namespace v2vouch::wire {
namespace {

// One field as "type name[dimension]".
using Description = std::vector<std::string>;

const std::map<std::string, Kind> kPrimitives = {
    {"byte", Kind::kByte},     {"int8_t", Kind::kInt8},   {"int16_t", Kind::kInt16},
    {"int32_t", Kind::kInt32}, {"int64_t", Kind::kInt64}, {"float", Kind::kFloat},
    {"double", Kind::kDouble}, {"string", Kind::kString}};

std::map<std::string, Description> ParseLcmFiles() {
  std::map<std::string, Description> types;
  for (const auto& entry : std::filesystem::directory_iterator("lcmtypes")) {
    if (entry.path().extension() != ".lcm") continue;
    std::ifstream file(entry.path());
    std::string line;
    std::string text;
    while (std::getline(file, line)) text += line.substr(0, line.find("//")) + " ";
    const auto open = text.find('{');
    Description description;
    std::istringstream body(text.substr(open + 1, text.rfind('}') - open - 1));
    const std::regex field(R"(\s*(\w+)\s+(\w+)\s*(\[\w+\])?\s*)");
    for (std::string statement; std::getline(body, statement, ';');) {
      std::smatch match;
      if (statement.find("const ") != std::string::npos) continue;
      if (statement.find_first_not_of(' ') == std::string::npos) continue;
      EXPECT_TRUE(std::regex_match(statement, match, field)) << entry.path() << statement;
      description.push_back(match.str(1) + " " + match.str(2) + match.str(3));
    }
    types[entry.path().stem().string()] = description;
  }
  return types;
}

void Describe(const Layout& layout, std::map<std::string, Description>& types) {
  Description description;
  std::string previous;
  for (const Field& field : layout.fields) {
    std::string type;
    for (const auto& [name, kind] : kPrimitives) {
      if (kind == field.kind) type = name;
    }
    if (field.kind == Kind::kStruct) {
      type = field.type->name;
      Describe(*field.type, types);
    }
    std::string line = type + " " + std::string(field.name);
    if (field.max_count > 0) line += "[" + previous + "]";
    if (field.fixed > 1) line += "[" + std::to_string(field.fixed) + "]";
    if (field.kind == Kind::kString) {
      EXPECT_GT(field.max_length, 0) << layout.name << "." << field.name;
    }
    description.push_back(line);
    previous = field.name;
  }
  types[std::string(layout.name)] = description;
}

TEST(LayoutTable, EqualsTheLcmFilesFieldByField) {
  const auto files = ParseLcmFiles();
  ASSERT_GT(files.size(), 20u);
  std::map<std::string, Description> table;
  for (const Layout* layout :
       {&LayoutOf<bsm_t>(), &LayoutOf<bsm_verdict_t>(), &LayoutOf<truth_bsm_t>(),
        &LayoutOf<calibration_t>(), &LayoutOf<camera_detections_t>(), &LayoutOf<camera_image_t>(),
        &LayoutOf<daemon_status_t>(), &LayoutOf<ego_motion_t>(), &LayoutOf<gnss_fix_t>(),
        &LayoutOf<misbehavior_report_t>(), &LayoutOf<object_list_t>(), &LayoutOf<obu_status_t>(),
        &LayoutOf<radar_scan_t>(), &LayoutOf<text_t>(), &LayoutOf<track_list_t>(),
        &LayoutOf<truth_list_t>(), &LayoutOf<ego_intent_t>(), &LayoutOf<warning_list_t>()}) {
    EXPECT_GT(layout->max_bytes, layout->min_bytes + 8) << layout->name;
    Describe(*layout, table);
  }
  EXPECT_EQ(files.size(), table.size());
  for (const auto& [name, description] : files) {
    EXPECT_THAT(table[name], testing::ElementsAreArray(description)) << name;
  }
}

}  // namespace
}  // namespace v2vouch::wire
