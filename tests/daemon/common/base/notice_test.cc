// SPDX-License-Identifier: Apache-2.0
#include "daemon/common/base/notice.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <set>
#include <string>

namespace v2vouch {
namespace {

TEST(Notice, EachHasANameOfItsOwnAndAdvice) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < kNoticeKindCount; ++i) {
    const auto kind = static_cast<NoticeKind>(i);
    EXPECT_TRUE(names.insert(NoticeName(kind)).second) << NoticeName(kind);
    EXPECT_FALSE(NoticeAdvice(kind).empty()) << NoticeName(kind);
    EXPECT_LE(NoticeAdvice(kind).size(), 255u) << NoticeName(kind);  // A status cuts there.
  }
}

TEST(Notice, EachStandsInTheListOfTheDocumentation) {
  std::ifstream file(V2VOUCH_SOURCE_DIR "/docs/reference/notices.md");
  ASSERT_TRUE(file);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto list = text.find("# Notices");
  ASSERT_NE(list, std::string::npos);
  for (std::size_t i = 0; i < kNoticeKindCount; ++i) {
    const std::string name(NoticeName(static_cast<NoticeKind>(i)));
    EXPECT_NE(text.find("`" + name + "`", list), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace v2vouch
