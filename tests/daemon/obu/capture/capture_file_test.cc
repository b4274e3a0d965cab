// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/capture/capture_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/obu_samples.h"

namespace v2vouch::obu {
namespace {

using testing::HasSubstr;

std::string Written(const std::string& name, const std::string& content) {
  const std::string path = testing::TempDir() + "obu_capture_" + name;
  std::ofstream(path, std::ios::binary) << content;
  return path;
}

struct Read {
  std::vector<std::string> packets;  // Hex, or the fault.
  std::vector<std::int64_t> lines;
  std::string error;
};
Read ReadAll(const std::string& path, bool join = false) {
  Read read;
  const auto file = CaptureFile::Open(path, join, read.error);
  if (!file) return read;
  while (const auto captured = file->Next(read.error)) {
    read.packets.push_back(captured->fault ? FaultText(captured->fault) : HexText(captured->bytes));
    read.lines.push_back(captured->line);
  }
  return read;
}

TEST(HexFile, HoldsOneDatagramALineAndBadLinesAreToldNotTheEnd) {
  const Read read = ReadAll(Written("lines.hex",
                                    "# made by hand\n"
                                    "\n"
                                    "  00142AfF\t\r\n"
                                    "0014zz\n"
                                    "0x0380 # unsecured\n"
                                    "   \n"
                                    "038\n"
                                    "0381"));
  EXPECT_EQ(read.packets, (std::vector<std::string>{"00142aff", "bad_text: not a hex digit", "0380",
                                                    "bad_text: odd number of hex digits", "0381"}));
  EXPECT_EQ(read.lines, (std::vector<std::int64_t>{3, 4, 5, 7, 8}));
}

TEST(HexFile, LineWithoutEndTakesNoMemoryWithoutEnd) {
  const Read read = ReadAll(Written("long.hex", std::string(3000000, '0') + "\n0014\n"));
  ASSERT_EQ(read.packets.size(), 2u);
  EXPECT_THAT(read.packets[0], HasSubstr("too_long"));
  EXPECT_EQ(read.packets[1], "0014");
}

TEST(HexFile, LinesOfOneDatagramAreJoinedWhereAsked) {
  const Read read = ReadAll(Written("wrapped.hex", "0014\n25\n\nff\n"), true);
  EXPECT_EQ(read.packets, std::vector<std::string>{"001425ff"});
}

TEST(HexFile, ByteOrderMarkOfAnEditorIsPassedOver) {
  EXPECT_EQ(ReadAll(Written("bom.hex",
                            "\xEF\xBB\xBF"
                            "0014\n"))
                .packets,
            std::vector<std::string>{"0014"});
}

TEST(CaptureFile, OtherBytesAreOneDatagram) {
  const std::string bytes("\x03\x80\x02\x00\x14", 5);
  EXPECT_EQ(ReadAll(Written("raw.coer", bytes)).packets, std::vector<std::string>{"0380020014"});
}

TEST(CaptureFile, WhatCannotBeReadIsTold) {
  EXPECT_THAT(ReadAll("/nowhere.pcap").error, HasSubstr("No such file"));
  EXPECT_THAT(ReadAll(testing::TempDir()).error, HasSubstr("is a folder"));
  EXPECT_THAT(ReadAll(Written("empty.pcap", "")).error, HasSubstr("is empty"));
  EXPECT_THAT(ReadAll(Written("big.bin", std::string(5000, '\x01'))).error, HasSubstr("neither"));
  EXPECT_FALSE(ReadAll(Written("head.pcap", std::string("\xD4\xC3\xB2\xA1\x02", 5))).error.empty());
}

TEST(PcapFile, PacketsBeforeTheBreakAreGivenThenTheBreakIsTold) {
  V2VOUCH_NEEDS_OBU_DATA();
  const Octets whole = ObuFile("made_here/bsm_signed_radiotap.pcap");
  std::string error;
  const auto file = CaptureFile::Open(ObuPath("made_here/bsm_signed_radiotap.pcap"), false, error);
  ASSERT_TRUE(file) << error;
  int packets = 0;
  while (const auto captured = file->Next(error)) {
    ++packets;
    EXPECT_EQ(captured->link_type, 127);
    EXPECT_GT(captured->utime, 1694000000000000);
    EXPECT_FALSE(captured->is_cut);
  }
  EXPECT_EQ(packets, 20);
  EXPECT_EQ(error, "");
  const Read cut = ReadAll(Written("cut.pcap", std::string(whole.begin(), whole.end() - 10)));
  EXPECT_EQ(cut.packets.size(), 19u);
  EXPECT_FALSE(cut.error.empty());
}

}  // namespace
}  // namespace v2vouch::obu
