// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/obu/live.h"

#include <poll.h>

#include <algorithm>
#include <chrono>
#include <iostream>

#include "daemon/obu/gateway/gateway.h"
#include "daemon/programs/obu/input_door.h"
#include "daemon/programs/obu/own_output.h"
#include "daemon/rim/io/lcm_bus.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/stop_signal.h"
#include "daemon/rim/wire/codec.h"

namespace v2vouch::obu {
namespace {

constexpr std::int64_t kStatusPeriod_us = 1000000;
constexpr int kLongestWait_ms = 100;  // How soon a stop is noticed.

std::int64_t Now() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

void Log(const std::string& line) { std::cerr << "v2vouch-obu: " << line << '\n'; }

// Sockets in, LCM out.
class Loop {
 public:
  Loop(const GatewayConfig& config, TrustAnchors anchors)
      : config_(config), gateway_(config, std::move(anchors), Now()) {}

  bool Open() {
    for (const InputConfig& input : config_.inputs) {
      std::string error;
      auto door = InputDoor::Open(input, doors_.size(), error);
      if (!door) {
        Log(error);
        return false;
      }
      Log("event=listening " + door->text() + " framing=" + input.framing +
          " buffer_bytes=" + std::to_string(door->buffer_bytes()) +
          (input.allow.empty() ? " allow=anybody"
                               : " allow=" + std::to_string(input.allow.size())));
      waits_.push_back({door->descriptor(), POLLIN, 0});
      doors_.push_back(std::move(door));
    }
    std::string error;
    own_ = OwnOutput::Start(config_, Log, error);
    if (!error.empty()) Log(error);
    return error.empty();
  }

  void Run() {
    std::int64_t status_due = Now() + kStatusPeriod_us;
    while (!IsStopAsked()) {
      const std::int64_t before = Now();
      const std::int64_t due = std::min(gateway_.due().value_or(status_due), status_due);
      const auto wait_ms = static_cast<int>(
          std::clamp<std::int64_t>((due - before + 999) / 1000, 0, kLongestWait_ms));
      poll(waits_.data(), waits_.size(), wait_ms);
      for (std::size_t i = 0; i < doors_.size(); ++i) {
        const bool was_open = waits_[i].fd >= 0;
        const bool is_open = doors_[i]->Receive([&](const Arrival& arrival) {
          gateway_.OnDatagram(arrival, out_);
          const auto id = gateway_.TakeUnitSent();
          if (id && own_) own_->OnUnitSent(*id, Now());
        });
        waits_[i].fd = doors_[i]->descriptor();
        if (is_open != was_open) {
          Log((is_open ? "event=interface_back " : "event=interface_gone ") + doors_[i]->text());
        }
      }
      const std::int64_t now = Now();
      gateway_.Flush(now, out_);
      PublishAll();
      // A clock set back must not silence the status.
      if (now >= status_due || status_due - now > 2 * kStatusPeriod_us) {
        PublishStatus(now);
        status_due = now + kStatusPeriod_us;
      }
    }
    const obu_status_t last = StatusNow(Now());
    Log("event=stopped datagrams=" + std::to_string(last.datagrams) + " published=" +
        std::to_string(last.published) + " duplicates=" + std::to_string(last.duplicates) +
        " kernel_drops=" + std::to_string(last.kernel_drops) + " publish_failures=" +
        std::to_string(last.publish_failures) + " own_sent=" + std::to_string(last.own_sent));
    for (const count_t& refusal : last.refusals) {
      Log("event=refused_in_all reason=" + refusal.name +
          " total=" + std::to_string(refusal.count));
    }
  }

 private:
  template <class Message>
  bool Publish(const std::string& channel, const Message& message) {
    wire::Encode(message, bytes_);
    return bus_ && bus_->Publish(channel, bytes_);
  }

  void PublishAll() {
    if (out_.empty()) return;
    EnsureBus();
    for (const bsm_t& message : out_) failures_ += Publish(config_.bsm_channel, message) ? 0 : 1;
    out_.clear();
  }

  // With what only the sockets know.
  obu_status_t StatusNow(std::int64_t now) {
    obu_status_t status = gateway_.Status(now);
    status.publish_failures = failures_;
    const OwnOutput::Figures own = own_ ? own_->figures() : OwnOutput::Figures{};
    status.own_state = static_cast<std::int8_t>(own.state);
    for (int i = 0; i < 4; ++i) {
      status.own_id[i] = static_cast<std::uint8_t>(own.id >> (24 - 8 * i));
    }
    status.own_sent = own.sent;
    status.own_send_failures = own.failures;
    status.kernel_drops = 0;
    for (const auto& door : doors_) {
      status.kernel_drops += door->kernel_drops();
      if (status.receive_buffer_bytes < 0 || door->buffer_bytes() < status.receive_buffer_bytes) {
        status.receive_buffer_bytes = door->buffer_bytes();
      }
    }
    return status;
  }

  void PublishStatus(std::int64_t now) {
    EnsureBus();
    const obu_status_t status = StatusNow(now);
    Publish(config_.status_channel, status);
    for (const std::string& line : gateway_.TakeLog()) Log(line);
    if (was_silent_ != status.obu_silent) {
      Log(status.obu_silent != 0 ? "event=obu_silent" : "event=obu_talks");
    }
    was_silent_ = status.obu_silent;
    if (was_suspect_ != status.clock_suspect) {
      Log((status.clock_suspect != 0 ? "event=clock_suspect offset_s="
                                     : "event=clock_good offset_s=") +
          std::to_string(status.clock_offset_s));
    }
    was_suspect_ = status.clock_suspect;
  }

  // There may be no way out yet while a machine boots.
  void EnsureBus() {
    if (bus_) return;
    const std::int64_t now = Now();
    if (now - tried_utime_ < kStatusPeriod_us && now >= tried_utime_) return;
    tried_utime_ = now;
    bus_ = LcmBus::Open(config_.lcm_url);
    if (!bus_ && !has_complained_)
      Log("event=lcm_not_open url=" + EffectiveLcmUrl(config_.lcm_url));
    has_complained_ = true;
  }

  GatewayConfig config_;
  Gateway gateway_;
  std::vector<std::unique_ptr<InputDoor>> doors_;
  std::vector<pollfd> waits_;  // Of each door; poll() passes over -1.
  std::unique_ptr<LcmBus> bus_;
  std::unique_ptr<OwnOutput> own_;
  std::vector<bsm_t> out_;
  std::vector<std::uint8_t> bytes_;
  std::int64_t failures_ = 0;
  std::int64_t tried_utime_ = 0;
  bool has_complained_ = false;
  std::int8_t was_silent_ = 0;
  std::int8_t was_suspect_ = 0;
};

}  // namespace

int RunGateway(const GatewayConfig& config, TrustAnchors anchors) {
  HandleStopSignals();
  Loop loop(config, std::move(anchors));
  if (!loop.Open()) return 1;
  loop.Run();
  return 0;
}

}  // namespace v2vouch::obu
