// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/rim/view/client_message.h"
#include "daemon/rim/view/foxglove_messages.h"
#include "daemon/rim/view/playback.h"
#include "daemon/rim/view/scene.h"

namespace v2vouch::view {

/// What all clients share.
class Hub {
 public:
  /// @param player nullptr for a live source.
  /// @param session_id tells clients a restart from a reconnection.
  Hub(Scene& scene, Player* player, std::string session_id);

  /// Again and again (25 Hz): a client gets at most one message of a kind per tick, and sees time
  /// pass while nothing comes.
  /// `now_us`: the live source's clock; a recorded drive has its own.
  void Tick(std::int64_t now_us);

  [[nodiscard]] Scene& scene() { return scene_; }
  [[nodiscard]] Player* player() { return player_; }
  [[nodiscard]] const std::string& session_id() const { return session_id_; }
  [[nodiscard]] const std::vector<FoxgloveTopic>& topics() const { return topics_; }
  [[nodiscard]] std::int64_t ticks() const { return ticks_; }
  [[nodiscard]] std::int64_t now_us() const;
  /// Whether the source is there; the page says so where it is not.
  bool is_source_open = true;
  std::string source_name;

  /// The page's frame and a topic's message, made once per state however many clients ask.
  std::shared_ptr<const std::string> Frame();
  std::shared_ptr<const std::string> Message(std::size_t topic, bool clears);

 private:
  struct Made {
    std::int64_t revision = -1;
    std::shared_ptr<const std::string> text;
  };
  Scene& scene_;
  Player* player_;
  std::string session_id_;
  std::vector<FoxgloveTopic> topics_;
  std::int64_t ticks_ = 0;
  std::int64_t live_now_us_ = 0;
  Made frame_;
  std::vector<Made> messages_;
};

struct Outgoing {
  bool is_binary = false;
  std::shared_ptr<const std::string> bytes;
};

/// One client. Nothing waits in a queue: the server asks for the next message when the one before
/// has left, and gets the newest of what this client has not seen. A slow client sees fewer frames,
/// and costs no memory.
class Session {
 public:
  enum class Protocol { kPage, kFoxglove };
  Session(Hub& hub, Protocol protocol);

  void TakeText(std::string_view text);
  void TakeBinary(std::span<const std::uint8_t> bytes);
  std::optional<Outgoing> Next();
  /// It has sent so much nonsense that it is better cut off.
  [[nodiscard]] bool is_hopeless() const { return faults_ > 100; }

 private:
  struct Subscription {
    std::uint32_t id = 0;
    std::size_t topic = 0;
    std::int64_t sent = 0;   // Revision, or the number of the next event.
    std::int64_t seeks = 0;  // At the last message: a jump clears the picture.
    std::int64_t tick = -1;  // Of the last message.
  };
  void Take(const ClientMessage& message);
  void Complain(const std::string& why);
  std::optional<Outgoing> NextOfPage();
  std::optional<Outgoing> NextOfFoxglove();
  [[nodiscard]] std::string ServerInfo() const;
  [[nodiscard]] std::string Advertise() const;
  std::optional<std::string> Clock();
  std::optional<std::string> StateOfPlayback();

  Hub& hub_;
  Protocol protocol_;
  int faults_ = 0;
  int greetings_ = 0;
  std::vector<std::string> complaints_;  // At most 8.
  std::vector<std::string> requests_;    // Ids of playback requests to be answered, at most 8.
  std::int64_t ticks_sent_ = 0;
  std::int64_t changes_sent_ = -1;
  std::int64_t seeks_sent_ = 0;

  // Page.
  std::int64_t map_sent_ = 0;
  std::int64_t status_sent_ = 0;
  std::int64_t frame_sent_ = 0;
  std::int64_t frame_tick_ = -1;
  std::int64_t events_sent_ = 0;
  int frames_on_the_way_ = 0;
  bool wants_pictures_ = false;
  std::vector<std::int64_t> pictures_sent_;

  // Foxglove.
  std::vector<Subscription> subscriptions_;
  std::size_t turn_ = 0;
};

}  // namespace v2vouch::view
