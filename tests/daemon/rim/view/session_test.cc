// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/view/session.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <random>

#include "daemon/rim/wire/codec.h"
#include "tests/daemon/rim/view/view_messages.h"

namespace v2vouch::view {
namespace {

using nlohmann::json;

class FakePlayer : public Player {
 public:
  void Control(const PlaybackRequest& request) override {
    requests.push_back(request);
    now.status = request.play ? PlaybackState::Status::kPlaying : PlaybackState::Status::kPaused;
    if (request.seek_us) ++now.seeks;
    ++now.changes;
  }
  [[nodiscard]] PlaybackState state() const override { return now; }
  PlaybackState now;
  std::vector<PlaybackRequest> requests;
};

void TakeList(Scene& scene, std::int64_t utime) {
  std::vector<std::uint8_t> bytes;
  wire::Encode(List(utime, {Track(1, 10, 0)}), bytes);
  scene.Take("TRACKS_LOCAL", bytes, FromMicros(utime));
}

std::vector<std::string> All(Session& session) {
  std::vector<std::string> messages;
  while (const auto next = session.Next()) messages.push_back(*next->bytes);
  return messages;
}

int Scenes(const std::vector<std::string>& messages) {
  int count = 0;
  for (const std::string& message : messages)
    count += message.starts_with("{\"k\":\"scene\"") ? 1 : 0;
  return count;
}

std::vector<std::uint8_t> Request(std::uint8_t command, float speed, bool seeks, std::uint64_t ns,
                                  const std::string& id) {
  std::vector<std::uint8_t> bytes = {3, command};
  const auto put = [&](std::uint64_t value, int size) {
    for (int i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  };
  put(std::bit_cast<std::uint32_t>(speed), 4);
  put(seeks ? 1 : 0, 1);
  put(ns, 8);
  put(id.size(), 4);
  bytes.insert(bytes.end(), id.begin(), id.end());
  return bytes;
}

TEST(Session, ASlowClientGetsTheNewestFrameAndNoQueue) {
  Scene scene({}, {});
  Hub hub(scene, nullptr, "s");
  Session session(hub, Session::Protocol::kPage);
  int frames = 0;
  for (int i = 1; i <= 100; ++i) {  // It never says that it has drawn one.
    hub.Tick(i);
    TakeList(scene, i);
    frames += Scenes(All(session));
  }
  EXPECT_EQ(frames, 2);
  session.TakeText(R"({"op":"drawn"})");
  const auto messages = All(session);
  ASSERT_EQ(Scenes(messages), 1);
  EXPECT_NE(messages.back().find("\"t\":100,"), std::string::npos);
}

TEST(Session, AFrameIsSentOncePerTickAtMost) {
  Scene scene({}, {});
  Hub hub(scene, nullptr, "s");
  Session session(hub, Session::Protocol::kPage);
  hub.Tick(1);
  TakeList(scene, 1);
  EXPECT_EQ(Scenes(All(session)), 1);
  TakeList(scene, 2);
  EXPECT_EQ(Scenes(All(session)), 0);
}

TEST(Session, FoxgloveIsGreetedAndGetsWhatItSubscribed) {
  Scene scene({}, {});
  Hub hub(scene, nullptr, "boot");
  Session session(hub, Session::Protocol::kFoxglove);
  const auto greeting = All(session);
  ASSERT_EQ(greeting.size(), 2u);
  EXPECT_EQ(json::parse(greeting[0])["op"], "serverInfo");
  const json channels = json::parse(greeting[1])["channels"];
  EXPECT_EQ(channels[0]["topic"], "/v2vouch/local");
  EXPECT_TRUE(json::accept(channels[0]["schema"].get<std::string>()));
  session.TakeText(R"({"op":"subscribe","subscriptions":[{"id":77,"channelId":1}]})");
  TakeList(scene, 5'000'000);
  const auto messages = All(session);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0][0], 1);
  EXPECT_EQ(messages[0][1], 77);
  const json update = json::parse(messages[0].substr(13));
  EXPECT_EQ(update["entities"][0]["cubes"][0]["pose"]["position"]["x"], 10.0);
  EXPECT_EQ(update["entities"][0]["timestamp"]["sec"], 5);
  session.TakeText(R"({"op":"unsubscribe","subscriptionIds":[77]})");
  hub.Tick(2);
  TakeList(scene, 6'000'000);
  EXPECT_EQ(All(session).size(), 1u);  // The time alone.
}

TEST(Session, PlaybackIsControlledAndAnswered) {
  Scene scene({}, {});
  FakePlayer player;
  Hub hub(scene, &player, "s");
  Session session(hub, Session::Protocol::kFoxglove);
  const auto greeting = All(session);
  EXPECT_NE(greeting[0].find("playbackControl"), std::string::npos);
  session.TakeBinary(Request(1, 2.0F, true, 7'000'000'000, "q"));
  ASSERT_EQ(player.requests.size(), 1u);
  EXPECT_FALSE(player.requests[0].play);
  EXPECT_EQ(player.requests[0].speed, 2.0);
  EXPECT_EQ(player.requests[0].seek_us, 7'000'000);
  const auto answer = All(session);
  ASSERT_EQ(answer.size(), 1u);
  EXPECT_EQ(answer[0][0], 5);
  EXPECT_EQ(answer[0][1], 1);   // Paused.
  EXPECT_EQ(answer[0][14], 1);  // It jumped.
  EXPECT_EQ(answer[0].back(), 'q');
}

TEST(Session, WhatWouldChangeAnythingIsRefused) {
  Scene scene({}, {});
  Hub hub(scene, nullptr, "s");
  Session session(hub, Session::Protocol::kFoxglove);
  All(session);
  for (const char* text :
       {R"({"op":"advertise","channels":[]})", R"({"op":"setParameters"})", "{", "[]", "null",
        R"({"op":"subscribe","subscriptions":[{"id":-1,"channelId":1}]})",
        R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":9999}]})"}) {
    session.TakeText(text);
    const auto answer = All(session);
    ASSERT_EQ(answer.size(), 1u) << text;
    EXPECT_EQ(json::parse(answer[0])["op"], "status") << text;
  }
  session.TakeBinary(std::vector<std::uint8_t>{1, 0, 0});
  session.TakeBinary(Request(0, 1.0F, false, 0, ""));  // A live source cannot be paused.
  EXPECT_EQ(All(session).size(), 2u);
}

TEST(ClientMessage, OddPlaybackRequestsAreNotUnderstood) {
  const auto is_understood = [](const std::vector<std::uint8_t>& bytes) {
    return std::holds_alternative<PlaybackRequest>(ReadClientBinary(bytes));
  };
  EXPECT_TRUE(is_understood(Request(0, 1.0F, false, 0, "")));
  EXPECT_FALSE(is_understood(Request(2, 1.0F, false, 0, "")));
  EXPECT_FALSE(is_understood(Request(0, NAN, false, 0, "")));
  EXPECT_FALSE(is_understood(Request(0, -1.0F, false, 0, "")));
  EXPECT_FALSE(is_understood(Request(0, 1.0F, false, 0, std::string(300, 'x'))));
  auto longer = Request(0, 1.0F, false, 0, "ab");
  longer.push_back(0);
  EXPECT_FALSE(is_understood(longer));
}

// V2VOUCH_FUZZ_MUTATIONS sets how many (default 10000).
TEST(ClientMessageFuzz, DamagedMessagesNeitherCrashNorChangeAnything) {
  const char* const asked = std::getenv("V2VOUCH_FUZZ_MUTATIONS");
  const int mutations = asked != nullptr ? std::atoi(asked) : 10000;
  const std::vector<std::uint8_t> binary = Request(0, 1.0F, true, 5, "id");
  std::vector<std::vector<std::uint8_t>> seeds = {binary};
  for (const std::string text :
       {R"({"op":"subscribe","subscriptions":[{"id":1,"channelId":2},{"id":3,"channelId":4}]})",
        R"({"op":"unsubscribe","subscriptionIds":[1,2,3]})", R"({"op":"pictures","on":true})",
        R"({"op":"drawn","a":{"b":[1,{"c":[[[[[[]]]]]]}]}})"}) {
    seeds.emplace_back(text.begin(), text.end());
  }
  seeds.emplace_back(16000, '[');
  Scene scene({}, {});
  Hub hub(scene, nullptr, "s");
  std::mt19937_64 rng(20261130);
  for (int i = 0; i < mutations; ++i) {
    std::vector<std::uint8_t> bytes =
        seeds[rng() % (i % 50 == 0 ? seeds.size() : seeds.size() - 1)];
    const auto changes = rng() % 6;
    for (std::uint64_t c = 0; c < changes && !bytes.empty(); ++c) {
      const auto at = static_cast<std::ptrdiff_t>(rng() % bytes.size());
      switch (rng() % 4) {
        case 0:
          bytes[static_cast<std::size_t>(at)] = static_cast<std::uint8_t>(rng());
          break;
        case 1:
          bytes.erase(bytes.begin() + at);
          break;
        case 2:
          bytes.insert(bytes.begin() + at, bytes[rng() % bytes.size()]);
          break;
        default:
          bytes.resize(static_cast<std::size_t>(at));
      }
    }
    // In memory of exactly its size, so that a sanitizer sees a read too far.
    const auto exact = std::make_unique<std::uint8_t[]>(bytes.size());
    std::ranges::copy(bytes, exact.get());
    Session session(hub, Session::Protocol::kFoxglove);
    session.TakeBinary({exact.get(), bytes.size()});
    session.TakeText({reinterpret_cast<const char*>(exact.get()), bytes.size()});
    for (int n = 0; n < 8 && session.Next(); ++n) {
    }
  }
  EXPECT_EQ(scene.revision(), 0);
}

}  // namespace
}  // namespace v2vouch::view
