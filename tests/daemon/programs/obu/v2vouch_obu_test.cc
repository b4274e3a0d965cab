// SPDX-License-Identifier: Apache-2.0
// The program as users call it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/child_process.h"
#include "tests/support/obu_wrap.h"
#include "tests/support/test_authority.h"

namespace v2vouch {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

Finished Obu(const std::string& arguments) { return Called(V2VOUCH_OBU, arguments); }

std::string Written(const std::string& name, const std::string& content) {
  const std::string path = testing::TempDir() + "v2vouch_obu_" + name;
  std::filesystem::create_directories(std::filesystem::path(path).parent_path());
  std::ofstream(path, std::ios::binary) << content;
  return path;
}

std::vector<json> Objects(const std::string& path, const std::string& more = "") {
  const Finished done = Execute(std::string(V2VOUCH_OBU) + " --json --decode " + path + " " + more);
  EXPECT_EQ(done.code, 0) << path;
  std::vector<json> objects;
  std::istringstream lines(done.output);
  for (std::string line; std::getline(lines, line);) objects.push_back(json::parse(line));
  return objects;
}

// Each field of the core, under the names of bsm_t.
void ExpectCore(const json& bsm, const obu::BsmCore& core, const std::string& which) {
  for (const obu::CoreField& field : obu::CoreFields()) {
    EXPECT_EQ(bsm.at(std::string(field.name)), core.*field.member) << which << " " << field.name;
  }
  const std::vector<int> id = {
      static_cast<int>(core.id >> 24), static_cast<int>(core.id >> 16 & 255),
      static_cast<int>(core.id >> 8 & 255), static_cast<int>(core.id & 255)};
  EXPECT_EQ(bsm.at("id"), json(id)) << which;
}

TEST(V2vouchObu, UsageIsToldWithExitCode2) {
  EXPECT_EQ(Obu("--port 70000").code, 2);
  const Finished config =
      Obu("--config " + Written("bad.yaml", "inputs: [{port: 0, framing: x}]\nchannel: BSM\n"));
  EXPECT_EQ(config.code, 2);
  EXPECT_THAT(config.output, HasSubstr("inputs[0].port = 0: must be at least 1"));
  EXPECT_THAT(config.output, HasSubstr("framing = x: is no framing"));
  EXPECT_THAT(config.output, HasSubstr("channel"));
  EXPECT_EQ(Obu("--decode x --framing wsmpp").code, 2);
  EXPECT_THAT(Obu("--decode x --framing wsmpp").output, HasSubstr("did you mean wsmp?"));
  EXPECT_EQ(Obu("--decode /dev/null --roots /nowhere").code, 2);
  EXPECT_EQ(Obu("--decode /nowhere.pcap").code, 1);
}

// Each would have run, heard or told nobody, and said nothing.
TEST(V2vouchObu, WhatWouldHearOrTellNobodyIsRefusedAtStart) {
  const auto called = [](const std::string& arguments) {
    return Execute("timeout 10 " V2VOUCH_OBU " " + arguments + " 2>&1");
  };
  const Finished done = called("--config " + Written("mute.yaml", R"(
inputs:
  - {port: 6001, allow: [192.168.88.400, 192.168.88.0/24, obu.local, 192.168.88, "", "FE80:0::1"]}
  - {port: 6001, allow: [192.168.88.40, "fe80::1"]}
  - {bind: eth0}
bsm_channel: ""
status_channel: EGO_GNSS
own_bsm: {motion_channel: A B}
)"));
  EXPECT_EQ(done.code, 2);
  for (const char* address : {"192.168.88.400", "192.168.88.0/24", "obu.local", "192.168.88", ""}) {
    EXPECT_THAT(done.output, HasSubstr(std::string("inputs[0].allow: ") + address +
                                       ": must be an address of a unit"));
  }
  EXPECT_THAT(done.output, HasSubstr("FE80:0::1: write it as fe80::1"));
  EXPECT_THAT(done.output, Not(HasSubstr("inputs[1].allow")));
  EXPECT_THAT(done.output, HasSubstr("inputs[1]: 0.0.0.0 port 6001: stands here twice"));
  EXPECT_THAT(done.output, HasSubstr("inputs[2].bind = eth0"));
  EXPECT_THAT(done.output, HasSubstr("bsm_channel: channel \"\""));
  EXPECT_THAT(done.output, HasSubstr("channel EGO_GNSS: is that of status_channel already"));
  EXPECT_THAT(done.output, HasSubstr("own_bsm.motion_channel: channel \"A B\""));
  EXPECT_EQ(called("--json").code, 2);
  EXPECT_EQ(called("--decode /dev/null --port 5398").code, 2);
}

TEST(V2vouchObu, PublishedPayloadsAsHexLinesGiveTheirValuesInJson) {
  V2VOUCH_NEEDS_OBU_DATA();
  std::string text = "# payloads\n\n";
  const auto vectors = BsmVectors();
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const Octets hex = HexText(vectors[i].bytes, i % 2 == 0);
    text += "  " + std::string(hex.begin(), hex.end()) + (i % 3 == 0 ? " \r\n" : "\n");
  }
  const auto objects = Objects(Written("vectors.hex", text));
  ASSERT_EQ(objects.size(), 167u);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    EXPECT_EQ(objects[i].at("framing"), "frame");
    EXPECT_TRUE(objects[i].at("refused").is_null());
    ExpectCore(objects[i].at("bsm"), vectors[i].core, std::to_string(i));
  }
}

TEST(V2vouchObu, UnitsLogsAsHexLinesGiveTheirValuesInJson) {
  V2VOUCH_NEEDS_OBU_DATA();
  std::string text;
  const auto records = UnitRecords();
  for (const UnitRecord& record : records) text += HexText(record.bytes) + "\n";
  const auto objects = Objects(Written("units.hex", text));
  ASSERT_EQ(objects.size(), records.size());
  int bsms = 0;
  for (std::size_t i = 0; i < records.size(); ++i) {
    if (!records[i].is_bsm) {
      EXPECT_EQ(objects[i].at("refused"), "not_bsm");
      EXPECT_TRUE(objects[i].at("bsm").is_null());
      continue;
    }
    ++bsms;
    ExpectCore(objects[i].at("bsm"), records[i].core, records[i].file);
    EXPECT_EQ(objects[i]["bsm"]["generation_utime"], records[i].generation_utime);
    EXPECT_EQ(objects[i]["bsm"]["signature_state"], 0);
    if (!records[i].digest.empty()) {
      EXPECT_EQ(objects[i]["dot2"]["certificate"], records[i].digest);
    }
  }
  EXPECT_EQ(bsms, 803);
}

TEST(V2vouchObu, RejectsAreObjectsWithAReason) {
  V2VOUCH_NEEDS_OBU_DATA();
  std::string text;
  int lines = 0;
  for (const BsmReject& reject : BsmRejects()) {
    if (reject.bytes.empty()) continue;  // An empty line is no datagram.
    text += HexText(reject.bytes) + "\n";
    ++lines;
  }
  text += "this is no hex\n00142\n";
  const auto objects = Objects(Written("rejects.hex", text));
  ASSERT_EQ(objects.size(), static_cast<std::size_t>(lines) + 2);
  for (const json& object : objects) {
    EXPECT_TRUE(object.at("bsm").is_null());
    EXPECT_TRUE(object.at("refused").is_string());
  }
  EXPECT_EQ(objects.back()["refused"], "bad_text");
}

TEST(V2vouchObu, CapturesGiveFramingsTimesAndSignals) {
  V2VOUCH_NEEDS_OBU_DATA();
  const auto ethernet = Objects(ObuPath("made_here/bsm_signed_wsmp_ethernet.pcap"));
  ASSERT_EQ(ethernet.size(), 120u);
  std::vector<UnitRecord> log;
  for (const UnitRecord& record : UnitRecords()) {
    if (record.file == "bsmLogDuringEvent_commsignia.gz") log.push_back(record);
  }
  for (std::size_t i = 0; i < ethernet.size(); ++i) {
    EXPECT_EQ(ethernet[i]["framing"], "ethernet");
    ExpectCore(ethernet[i]["bsm"], log[i].core, std::to_string(i));
  }
  std::map<std::string, int> framings;
  int with_signal = 0;
  for (const json& object : Objects(ObuPath("made_here/udp_all_framings.pcap"))) {
    ++framings[object["framing"]];
    EXPECT_TRUE(object["refused"].is_null());
    EXPECT_EQ(object["source"], "192.168.88.40:40000");
    with_signal += object["bsm"]["rssi_dbm"].is_number() ? 1 : 0;
  }
  EXPECT_EQ(framings, (std::map<std::string, int>{
                          {"frame", 2}, {"dot2", 2}, {"wsmp", 2}, {"cv2x", 2}, {"c2p", 4}}));
  EXPECT_EQ(with_signal, 4);
  EXPECT_EQ(Objects(ObuPath("made_here/bsm_signed_radiotap.pcap")).size(), 20u);
}

TEST(V2vouchObu, TextTellsLayersUnitsAndReasons) {
  V2VOUCH_NEEDS_OBU_DATA();
  const Finished done = Obu("--decode " + ObuPath("made_here/udp_all_framings.pcap"));
  EXPECT_EQ(done.code, 0);
  for (const char* part :
       {"192.168.88.40:40000 to port 5398", "40.4740535 deg", "1505.8 m", "12a7aa31",
        "certificate afc46273f760137e", "12 packets, 12 messages of 1 senders"}) {
    EXPECT_THAT(done.output, HasSubstr(part));
  }
  const Finished refused =
      Obu("--decode " + Written("map.hex", "001203aabbcc\nffffffff\n") + " 2>&1");
  EXPECT_THAT(refused.output, HasSubstr("REFUSED: not_bsm: messageId (18)"));
  EXPECT_THAT(refused.output, HasSubstr("unknown_framing"));
  EXPECT_THAT(refused.output, HasSubstr("MAP"));
}

TEST(V2vouchObu, SignaturesAreCheckedUpToTheGivenRoots) {
  const TestCertificate root = RootCertificate({.name = "root", .may_issue = true});
  const TestCertificate issuer = ExplicitCertificate(root, {.name = "pca", .may_issue = true});
  const TestCertificate car = ImplicitCertificate(issuer, {.name = "car"});
  TestCertificate forger = car;
  forger.key = KeyOf("forger");
  const Octets frame =
      FromHex("001425067c0eb5842562e66e8a2b9ea6c96408b97fffffff900027d9637d07d0007fff8000640fa0");
  std::string lines;
  for (int i = 0; i < 3; ++i) {
    lines += HexText(SignedBy(car, frame, 700000000000000, i == 0)) + "\n";
  }
  lines += HexText(SignedBy(forger, frame, 700000000000000, false)) + "\n";
  const std::string path = Written("signed.hex", lines);
  Written("roots/root.coer", std::string(root.bytes.begin(), root.bytes.end()));
  Written("issuers/pca.hex", HexText(issuer.bytes));
  const std::string folder = testing::TempDir() + "v2vouch_obu_";
  const auto states = [&](const std::string& more) {
    std::vector<int> found;
    for (const json& object : Objects(path, more))
      found.push_back(object["bsm"]["signature_state"]);
    return found;
  };
  EXPECT_EQ(states("--roots " + folder + "roots --issuers " + folder + "issuers"),
            (std::vector<int>{1, 1, 1, 2}));
  EXPECT_EQ(states(""), (std::vector<int>{0, 0, 0, 0}));
}

TEST(V2vouchObu, CaptureThatEndsInAPacketIsPrintedAndTold) {
  V2VOUCH_NEEDS_OBU_DATA();
  const Octets whole = ObuFile("made_here/bsm_signed_radiotap.pcap");
  const std::string path = Written("cut.pcap", std::string(whole.begin(), whole.end() - 10));
  const Finished done = Obu("--decode " + path);
  EXPECT_EQ(done.code, 1);
  EXPECT_THAT(done.output, HasSubstr("19 packets, 19 messages"));
}

TEST(V2vouchObu, DatagramOverSeveralLinesIsHintedAtAndJoined) {
  V2VOUCH_NEEDS_OBU_DATA();
  const std::string path = ObuPath("ieee1609/unsecured_bsm.coer.hex");
  EXPECT_THAT(Obu("--decode " + path).output, HasSubstr("--join"));
  const auto objects = Objects(path, "--join");
  ASSERT_EQ(objects.size(), 1u);
  EXPECT_TRUE(objects[0]["refused"].is_null());
}

}  // namespace
}  // namespace v2vouch
