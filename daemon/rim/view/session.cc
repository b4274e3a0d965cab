// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/view/session.h"

#include <algorithm>
#include <bit>

#include "daemon/rim/foxglove/messages.h"
#include "daemon/rim/json/json_text.h"
#include "daemon/rim/view/page_frame.h"

namespace v2vouch::view {
namespace {

constexpr std::size_t kMostAnswers = 8;
constexpr int kMostFramesOnTheWay = 2;
constexpr std::int64_t kTicksPerClock = 3;

Outgoing Text(std::string text) {
  return {false, std::make_shared<const std::string>(std::move(text))};
}
Outgoing Binary(std::string bytes) {
  return {true, std::make_shared<const std::string>(std::move(bytes))};
}

template <class T>
void PutLittleEndian(std::string& out, T value) {
  for (std::size_t i = 0; i < sizeof(T); ++i) out += static_cast<char>((value >> (8 * i)) & 255);
}

void PutTime(JsonText& json, std::string_view key, std::int64_t us) {
  json.Key(key).Open('{').Integer("sec", us / 1'000'000).Integer("nsec", us % 1'000'000 * 1000);
  json.Close('}');
}

std::uint64_t Nanoseconds(std::int64_t us) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(us, 0)) * 1000;
}

}  // namespace

Hub::Hub(Scene& scene, Player* player, std::string session_id)
    : scene_(scene),
      player_(player),
      session_id_(std::move(session_id)),
      topics_(FoxgloveTopics(scene.vehicle())),
      messages_(topics_.size()) {}

void Hub::Tick(std::int64_t now_us) {
  ++ticks_;
  live_now_us_ = now_us;
}

std::int64_t Hub::now_us() const {
  return player_ != nullptr ? player_->state().now_us : live_now_us_;
}

std::shared_ptr<const std::string> Hub::Frame() {
  if (frame_.revision != scene_.revision()) {
    frame_ = {scene_.revision(), std::make_shared<const std::string>(PageFrame(scene_))};
  }
  return frame_.text;
}

std::shared_ptr<const std::string> Hub::Message(std::size_t topic, bool clears) {
  if (clears) {
    return std::make_shared<const std::string>(FoxgloveMessage(scene_, topics_[topic], true));
  }
  const std::int64_t revision = FoxgloveRevision(scene_, topics_[topic]);
  Made& made = messages_[topic];
  if (made.revision != revision) {
    made = {revision,
            std::make_shared<const std::string>(FoxgloveMessage(scene_, topics_[topic], false))};
  }
  return made.text;
}

Session::Session(Hub& hub, Protocol protocol)
    : hub_(hub), protocol_(protocol), pictures_sent_(hub.scene().pictures().size()) {}

void Session::TakeText(std::string_view text) { Take(ReadClientText(text)); }
void Session::TakeBinary(std::span<const std::uint8_t> bytes) { Take(ReadClientBinary(bytes)); }

void Session::Complain(const std::string& why) {
  ++faults_;
  if (complaints_.size() < kMostAnswers) complaints_.push_back(why);
}

void Session::Take(const ClientMessage& message) {
  if (const auto* fault = std::get_if<NotUnderstood>(&message)) {
    Complain(fault->why);
  } else if (std::holds_alternative<Drawn>(message)) {
    frames_on_the_way_ = std::max(0, frames_on_the_way_ - 1);
  } else if (const auto* pictures = std::get_if<WantPictures>(&message)) {
    wants_pictures_ = pictures->on;
  } else if (const auto* subscribe = std::get_if<Subscribe>(&message)) {
    for (const Subscribe::Item& item : subscribe->items) {
      if (item.channel < 1 || item.channel > hub_.topics().size()) {
        Complain("subscribe: no such channel");
        continue;
      }
      std::erase_if(subscriptions_, [&](const Subscription& s) { return s.id == item.id; });
      if (subscriptions_.size() >= kMostSubscriptions) {
        Complain("subscribe: more than 64 subscriptions");
        continue;
      }
      subscriptions_.push_back({item.id, item.channel - 1, 0, 0});
    }
  } else if (const auto* unsubscribe = std::get_if<Unsubscribe>(&message)) {
    std::erase_if(subscriptions_, [&](const Subscription& s) {
      return std::ranges::find(unsubscribe->ids, s.id) != unsubscribe->ids.end();
    });
  } else if (const auto* request = std::get_if<PlaybackRequest>(&message)) {
    if (hub_.player() == nullptr) return Complain("playback control: this is a live source");
    hub_.player()->Control(*request);
    if (requests_.size() < kMostAnswers) requests_.push_back(request->id);
  }
}

std::optional<Outgoing> Session::Next() {
  if (protocol_ == Protocol::kFoxglove && greetings_ == 0) {
    ++greetings_;
    return Text(ServerInfo());
  }
  if (protocol_ == Protocol::kFoxglove && greetings_ == 1) {
    ++greetings_;
    return Text(Advertise());
  }
  if (!complaints_.empty()) {
    JsonText json;
    json.Open('{').Text("op", "status").Integer("level", 1).Text("message", complaints_.front());
    json.Close('}');
    complaints_.erase(complaints_.begin());
    return Text(json.Take());
  }
  if (auto state = StateOfPlayback()) return Binary(std::move(*state));
  return protocol_ == Protocol::kPage ? NextOfPage() : NextOfFoxglove();
}

std::optional<Outgoing> Session::NextOfPage() {
  Scene& scene = hub_.scene();
  if (auto clock = Clock()) return Text(std::move(*clock));
  if (scene.map().revision != map_sent_) {
    map_sent_ = scene.map().revision;
    return Text(PageMap(*scene.map().message));
  }
  if (events_sent_ < scene.events().next_number()) {
    return Text(PageEvents(scene.events(), events_sent_, events_sent_));
  }
  if (scene.status().revision != status_sent_ && scene.status().message) {
    status_sent_ = scene.status().revision;
    return Text(PageStatus(scene));
  }
  if (frames_on_the_way_ < kMostFramesOnTheWay && scene.revision() != frame_sent_ &&
      frame_tick_ != hub_.ticks() && scene.list_utime() != 0) {
    frame_tick_ = hub_.ticks();
    frame_sent_ = scene.revision();
    ++frames_on_the_way_;
    return Outgoing{false, hub_.Frame()};
  }
  for (std::size_t i = 0; wants_pictures_ && i < pictures_sent_.size(); ++i) {
    const auto& picture = scene.pictures()[i];
    if (picture.revision == pictures_sent_[i]) continue;
    pictures_sent_[i] = picture.revision;
    std::string bytes = PagePicture(scene, i);
    if (!bytes.empty()) return Binary(std::move(bytes));
  }
  return std::nullopt;
}

std::optional<std::string> Session::Clock() {
  if (hub_.ticks() - ticks_sent_ < kTicksPerClock) return std::nullopt;
  ticks_sent_ = hub_.ticks();
  JsonText json;
  json.Open('{').Text("k", "clock").Integer("now", hub_.now_us());
  json.Integer("rx", hub_.scene().list_received());
  json.Bool("live", hub_.player() == nullptr).Bool("open", hub_.is_source_open);
  json.Text("source", hub_.source_name);
  if (hub_.player() != nullptr) {
    const PlaybackState state = hub_.player()->state();
    json.Integer("begin", state.begin_us).Integer("end", state.end_us);
    json.Number("speed", state.speed).Integer("status", static_cast<int>(state.status));
    json.Integer("seeks", state.seeks);
  }
  json.Close('}');
  return json.Take();
}

std::optional<std::string> Session::StateOfPlayback() {
  if (hub_.player() == nullptr) return std::nullopt;
  const PlaybackState state = hub_.player()->state();
  if (requests_.empty() && state.changes == changes_sent_) return std::nullopt;
  std::string id;
  if (!requests_.empty()) {
    id = requests_.front();
    requests_.erase(requests_.begin());
  }
  std::string out(1, '\x05');
  out += static_cast<char>(state.status);
  PutLittleEndian(out, Nanoseconds(state.now_us));
  PutLittleEndian(out, std::bit_cast<std::uint32_t>(static_cast<float>(state.speed)));
  out += state.seeks != seeks_sent_ ? '\x01' : '\x00';
  PutLittleEndian(out, static_cast<std::uint32_t>(id.size()));
  out += id;
  changes_sent_ = state.changes;
  seeks_sent_ = state.seeks;
  return out;
}

std::string Session::ServerInfo() const {
  JsonText json;
  json.Open('{').Text("op", "serverInfo").Text("name", "v2vouch-view " + hub_.source_name);
  json.Key("capabilities").Open('[').Text("time");
  if (hub_.player() != nullptr) json.Text("playbackControl");
  json.Close(']').Key("supportedEncodings").Open('[').Close(']');
  json.Key("metadata").Open('{').Close('}').Text("sessionId", hub_.session_id());
  if (hub_.player() != nullptr) {
    PutTime(json, "dataStartTime", hub_.player()->state().begin_us);
    PutTime(json, "dataEndTime", hub_.player()->state().end_us);
  }
  json.Close('}');
  return json.Take();
}

std::string Session::Advertise() const {
  JsonText json;
  json.Open('{').Text("op", "advertise").Key("channels").Open('[');
  for (std::size_t i = 0; i < hub_.topics().size(); ++i) {
    const FoxgloveTopic& topic = hub_.topics()[i];
    json.Open('{').Integer("id", static_cast<std::int64_t>(i) + 1).Text("topic", topic.topic);
    json.Text("encoding", "json").Text("schemaName", topic.schema);
    json.Text("schema", foxglove::Schema(topic.schema)).Text("schemaEncoding", "jsonschema");
    json.Close('}');
  }
  json.Close(']').Close('}');
  return json.Take();
}

std::optional<Outgoing> Session::NextOfFoxglove() {
  const std::int64_t now = hub_.now_us();
  if (ticks_sent_ != hub_.ticks()) {
    ticks_sent_ = hub_.ticks();
    std::string out(1, '\x02');
    PutLittleEndian(out, Nanoseconds(now));
    return Binary(std::move(out));
  }
  const std::int64_t seeks = hub_.player() != nullptr ? hub_.player()->state().seeks : 0;
  for (std::size_t i = 0; i < subscriptions_.size(); ++i) {
    turn_ = (turn_ + 1) % subscriptions_.size();  // Nobody waits behind a busy topic.
    Subscription& subscription = subscriptions_[turn_];
    const FoxgloveTopic& topic = hub_.topics()[subscription.topic];
    std::shared_ptr<const std::string> message;
    if (topic.content == FoxgloveTopic::Content::kLog) {
      for (const ViewEvent& event : hub_.scene().events().events()) {
        if (event.number < subscription.sent) continue;
        subscription.sent = event.number + 1;
        message = std::make_shared<const std::string>(FoxgloveLog(event));
        break;
      }
    } else {
      if (subscription.tick == hub_.ticks()) continue;
      const std::int64_t revision = FoxgloveRevision(hub_.scene(), topic);
      if (revision == 0 || revision == subscription.sent) continue;
      const bool clears = subscription.seeks != seeks;
      subscription.tick = hub_.ticks();
      subscription.sent = revision;
      subscription.seeks = seeks;
      message = hub_.Message(subscription.topic, clears);
    }
    if (!message) continue;
    std::string out(1, '\x01');
    PutLittleEndian(out, subscription.id);
    PutLittleEndian(out, Nanoseconds(now));
    out += *message;
    return Binary(std::move(out));
  }
  return std::nullopt;
}

}  // namespace v2vouch::view
