// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/message_schema/message_schema.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "daemon/rim/message_schema/json_text.h"
#include "daemon/rim/message_schema/walk.h"
#include "daemon/rim/wire/layout.h"
#include "v2vouch/bsm_t.hpp"
#include "v2vouch/camera_image_t.hpp"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/track_list_t.hpp"
#include "v2vouch/truth_list_t.hpp"

namespace v2vouch::message_schema {
namespace {

template <class T>
std::vector<std::uint8_t> Encoded(const T& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

const Field& FieldOf(std::string_view type, std::string_view name) {
  const Type* found = FindType(type);
  return found->fields[static_cast<std::size_t>(FieldIndex(*found, name))];
}

track_list_t SomeTracks() {
  track_list_t list{};
  list.utime = 1'700'000'000'123'456;
  list.num_tracks = 2;
  list.tracks.resize(2);
  list.tracks[0].x_body_m = 12.5;
  list.tracks[0].bridge_budget_s = std::nan("");
  list.tracks[0].v2v_id[0] = 0xAB;
  list.tracks[1].num_sources = 1;
  list.tracks[1].sources.resize(1);
  list.tracks[1].sources[0].name = "front \"A\"\n\xFF";
  return list;
}

TEST(MessageSchema, FingerprintsAreThoseOfTheGeneratedTypes) {
  EXPECT_EQ(FindType("bsm_t")->fingerprint, static_cast<std::uint64_t>(bsm_t::getHash()));
  EXPECT_EQ(FindType("track_list_t")->fingerprint,
            static_cast<std::uint64_t>(track_list_t::getHash()));
  EXPECT_EQ(FindType("daemon_status_t")->fingerprint,
            static_cast<std::uint64_t>(daemon_status_t::getHash()));
  EXPECT_EQ(FindType("truth_list_t")->fingerprint,
            static_cast<std::uint64_t>(truth_list_t::getHash()));
}

TEST(MessageSchema, UnitsComeFromNamesAndFromComments) {
  EXPECT_EQ(FieldOf("ego_motion_t", "speed_mps").unit, "m/s");
  EXPECT_EQ(FieldOf("ego_motion_t", "yaw_rate_radps").unit, "rad/s");
  EXPECT_EQ(FieldOf("ego_motion_t", "utime").unit, "us UTC");
  EXPECT_EQ(FieldOf("bsm_t", "lat").unit, "1e-7 degree");
  EXPECT_EQ(FieldOf("bsm_t", "semiMinor").unit, "0.05 m");  // "as semiMajor".
  EXPECT_EQ(FieldOf("bsm_t", "secMark").unit, "ms");
  EXPECT_EQ(FieldOf("bsm_t", "msgCnt").unit, "");
  EXPECT_EQ(FieldOf("track_t", "id").comment,
            "stable while the track lives; a function of what started it");
}

TEST(MessageSchema, ConstantsHaveNames) {
  EXPECT_EQ(ConstantName(*FindType("track_t"), "TRUST_", 4), "BRIDGED");
  EXPECT_EQ(ConstantName(*FindType("track_t"), "TRUST_", 99), "");
}

TEST(MessageSchema, SourceOfAListHoldsItsNestedTypes) {
  const std::string source = SourceWithNested(*FindType("track_list_t"));
  for (const char* type : {"struct track_list_t", "struct track_t", "struct track_source_t"}) {
    EXPECT_NE(source.find(type), std::string::npos) << type;
  }
}

TEST(JsonText, ValuesOfAListArriveWithNullForNan) {
  const auto bytes = Encoded(SomeTracks());
  ASSERT_EQ(TypeOf(bytes), FindType("track_list_t"));
  const auto text = JsonText(*TypeOf(bytes), bytes);
  ASSERT_TRUE(text.has_value());
  const auto json = nlohmann::json::parse(*text);
  EXPECT_EQ(json["utime"], 1'700'000'000'123'456);
  EXPECT_EQ(json["tracks"][0]["x_body_m"], 12.5);
  EXPECT_TRUE(json["tracks"][0]["bridge_budget_s"].is_null());
  EXPECT_EQ(json["tracks"][0]["v2v_id"], "ab000000");
  EXPECT_EQ(json["tracks"][0]["covariance_body"].size(), 36U);
  EXPECT_EQ(json["tracks"][1]["sources"][0]["name"], "front \"A\"\n\xEF\xBF\xBD");
}

TEST(JsonText, BytesOfAPictureAreBase64) {
  camera_image_t image{};
  image.num_bytes = 4;
  image.data = {'M', 'a', 'n', 'y'};
  const auto bytes = Encoded(image);
  EXPECT_EQ(nlohmann::json::parse(*JsonText(*TypeOf(bytes), bytes))["data"], "TWFueQ==");
}

TEST(JsonSchema, EveryTypeHasOneThatIsJson) {
  for (const Type& type : Types()) {
    const auto schema = nlohmann::json::parse(JsonSchema(type));
    EXPECT_EQ(schema["type"], "object") << type.name;
    EXPECT_EQ(schema["properties"].size(), type.fields.size()) << type.name;
  }
}

TEST(Walk, BytesThatAreNoSuchMessageVisitNothing) {
  struct Counter : Visitor {
    void Name(const Field&) override { ++names; }
    int names = 0;
  };
  const auto good = Encoded(SomeTracks());
  const Type& type = *FindType("track_list_t");
  for (std::size_t size = 0; size < good.size(); ++size) {
    Counter counter;
    ASSERT_FALSE(Walk(type, std::span(good).first(size), counter)) << size;
    ASSERT_EQ(counter.names, 0);
  }
  auto longer = good;
  longer.push_back(0);
  Counter counter;
  EXPECT_FALSE(Walk(type, longer, counter));
  EXPECT_TRUE(Walk(type, good, counter));
}

TEST(Walk, AgreesWithTheDecoderOfTheDaemonOnDamagedMessages) {
  // Property: whatever the daemon's own walk accepts, this one does. It caps no count, so it may
  // accept more.
  std::mt19937_64 rng(20261130);
  const auto good = Encoded(SomeTracks());
  for (int trial = 0; trial < 20'000; ++trial) {
    auto bytes = good;
    const std::size_t at = 8 + rng() % (bytes.size() - 8);
    bytes[at] = static_cast<std::uint8_t>(rng());
    Visitor nobody;
    const bool ours = Walk(*FindType("track_list_t"), bytes, nobody);
    const bool daemons =
        !wire::Walk(wire::LayoutOf<track_list_t>(), std::span(bytes).subspan(8)).has_value();
    ASSERT_TRUE(ours || !daemons) << "byte " << at;
  }
}

}  // namespace
}  // namespace v2vouch::message_schema
