// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/v2vouchd/daemon.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <utility>
#include <vector>

#include "daemon/programs/v2vouchd/background_publisher.h"
#include "daemon/programs/v2vouchd/daemon_log.h"
#include "daemon/programs/v2vouchd/dropped_datagrams.h"
#include "daemon/programs/v2vouchd/foreign_outputs.h"
#include "daemon/programs/v2vouchd/latency_meter.h"
#include "daemon/programs/v2vouchd/message_queue.h"
#include "daemon/programs/v2vouchd/receiver.h"
#include "daemon/programs/v2vouchd/trust_keeper.h"
#include "daemon/programs/v2vouchd/watchdog.h"
#include "daemon/rim/engine/engine.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/service_notifier.h"
#include "daemon/rim/io/socket_figures.h"
#include "daemon/rim/io/stop_signal.h"

namespace v2vouch {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kPopTimeout{20};
constexpr std::chrono::seconds kHousekeeping{1};
constexpr milliseconds kStatusAtLatest{1100};  // Where no message comes.
constexpr milliseconds kSuspended{500};        // Between two turns of the loop.

// Arrival on a clock that is never set.
Timestamp ArrivalTime(Clock::time_point at) {
  return Timestamp(std::chrono::duration_cast<Duration>(at.time_since_epoch()));
}

class Daemon {
 public:
  Daemon(const DaemonConfig& config, ObjectDetector* detector)
      : config_(config),
        engine_(config),
        queue_(static_cast<std::size_t>(config.lcm.own_queue),
               static_cast<std::size_t>(config.lcm.bsm_queue)),
        detect_(engine_.decoder(), detector, queue_),
        trust_(config.state, config.perception.vehicle.id),
        background_(config.lcm.url) {
    const bool has_own_v2v_bus = !config.lcm.v2v_url.empty();
    ports_ = {LcmUdpPort(EffectiveLcmUrl(config.lcm.url))};
    if (has_own_v2v_bus) ports_.push_back(LcmUdpPort(config.lcm.v2v_url));
    std::vector<Receiver::Subscription> own;
    std::vector<Receiver::Subscription> v2v;
    for (const wire::InputChannel& channel : engine_.channels()) {
      (channel.is_v2v() && has_own_v2v_bus ? v2v : own).push_back({channel.name, SinkOf(channel)});
    }
    // Never an input: heard only to notice that another program sends them too.
    for (const std::string* output : WatchedOutputs()) {
      own.push_back({*output, [this](std::span<const std::uint8_t> bytes, std::size_t, Timestamp) {
                       foreign_.Heard(bytes);
                     }});
    }
    own_bus_ = std::make_unique<Receiver>(config.lcm.url, std::move(own));
    if (has_own_v2v_bus) {
      v2v_bus_ =
          std::make_unique<Receiver>(config.lcm.v2v_url, std::move(v2v), Receiver::Priority::kLow);
    }
  }

  DaemonSummary Run(const std::function<bool()>& must_stop) {
    engine_.RestoreTrust(trust_.Load());
    // Ready also without a route: waiting for one is no reason to hold up a boot or to be
    // restarted.
    manager_.Send("READY=1\nSTATUS=waiting for the LCM bus");
    while (!must_stop() && !own_bus_->is_open()) {
      ReportWaiting();
      TellManager(Clock::now(), Clock::now());  // Nothing can be published yet.
      std::this_thread::sleep_for(kPopTimeout);
    }
    manager_.Send("STATUS=running");
    DaemonLog::Start(config_, engine_.channels().size(), ports_);
    engine_.Start(outbox_);
    last_published_ = Clock::now();
    Publish();
    last_list_ = last_status_ = last_housekeeping_ = last_tick_ = Clock::now();
    while (!must_stop()) {
      if (const auto arrival = queue_.Pop(kPopTimeout)) Take(*arrival);
      OnTime(Clock::now());
      TellManager(Clock::now(), last_published_);
    }
    manager_.Send("STOPPING=1");
    trust_.Finish(engine_.TrustToKeep());
    return Summary();
  }

 private:
  LcmBus::Handler SinkOf(const wire::InputChannel& channel) {
    return
        [this, channel](std::span<const std::uint8_t> bytes, std::size_t size, Timestamp received) {
          Arrival arrival{.channel = channel.name,
                          .content = Refusal(Reason::kTooLarge),
                          .received = received,
                          .arrived = Clock::now()};
          if (bytes.size() == size) arrival.content = Arrival::Bytes(bytes.begin(), bytes.end());
          if (channel.is_v2v()) {
            queue_.PushBsm(std::move(arrival));
          } else if (channel.kind == wire::InputKind::kCameraImage) {
            detect_.Offer(std::move(arrival));
          } else {
            queue_.PushOwn(std::move(arrival));
          }
        };
  }

  void Take(const Arrival& arrival) {
    const auto started = Clock::now();
    queue_wait_.Add(started - arrival.arrived);
    outbox_.Clear();
    if (const auto* bytes = std::get_if<Arrival::Bytes>(&arrival.content)) {
      engine_.OnMessage(arrival.channel, *bytes, ArrivalTime(arrival.arrived), outbox_);
    } else if (const auto* boxes = std::get_if<CameraDetections>(&arrival.content)) {
      image_to_boxes_.Add(arrival.looked);
      engine_.OnDetections(arrival.channel, *boxes, ArrivalTime(arrival.arrived), outbox_);
    } else {
      engine_.OnRefused(arrival.channel, std::get<Refusal>(arrival.content),
                        ArrivalTime(arrival.arrived));
    }
    step_.Add(Clock::now() - started);
    Publish();
    if (engine_.has_lists()) {
      const auto now = Clock::now();
      input_to_list_.Add(now - arrival.arrived);
      last_list_ = now;
      stale_round_ = 0;
      ++summary_.lists;
    }
  }

  // Lists go on without frames, marked stale; a status comes even where no message does.
  void OnTime(Clock::time_point now) {
    // After a suspension of the process its inputs still wait in the sockets: no silence yet.
    if (now - last_tick_ > kSuspended) {
      last_list_ = now;
      stale_round_ = 0;
    }
    last_tick_ = now;
    const Duration stale_after = FromSeconds(config_.perception.timeline.stale_after_s);
    if (!queue_.has_own() && now - last_list_ >= stale_after * (stale_round_ + 1)) {
      ++stale_round_;
      outbox_.Clear();
      engine_.PublishStale(std::chrono::duration_cast<Duration>(now - last_list_), outbox_);
      if (!outbox_.messages().empty()) ++summary_.stale_lists;
      Publish();
    }
    if (now - last_status_ >= kStatusAtLatest) {
      outbox_.Clear();
      engine_.AdvanceTo(ArrivalTime(now));
      engine_.PublishStatus(outbox_);
      Publish();
    }
    if (trust_.IsDue(now)) trust_.Keep(engine_.TrustToKeep(), now);
    DaemonLog::Notices(engine_.TakeNoticeChanges());
    if (now - last_housekeeping_ >= kHousekeeping) {
      last_housekeeping_ = now;
      dropped_.Take(*own_bus_, v2v_bus_.get());
      RefreshFigures();
      log_.Refusals(engine_.refusal_details());
      log_.QueueDrops(queue_.own_drops(), queue_.bsm_drops());
      log_.Mounts(config_.perception.vehicle.radars, engine_.mounts());
      ReportWaiting();
    }
  }

  // Feeds the watchdog while all parts go on; answers SIGHUP.
  void TellManager(Clock::time_point now, Clock::time_point last_published) {
    std::array<std::int64_t, 2> ticks{own_bus_->ticks(), v2v_bus_ ? v2v_bus_->ticks() : 0};
    const std::size_t buses = v2v_bus_ ? 2 : 1;
    if (watchdog_.IsToBeFed(now, std::span(ticks).first(buses), last_published)) {
      manager_.Send("WATCHDOG=1");
    }
    if (TakeReloadAsked()) {
      spdlog::warn(
          "event=reload_asked hint=\"settings are read at start only: restart me (systemctl "
          "restart v2vouchd); lists come again within a second\"");
    }
  }

  void Publish() {
    for (const Outbox::Message& message : outbox_.messages()) {
      const bool is_watched = std::ranges::any_of(
          WatchedOutputs(), [&](const std::string* output) { return message.channel == *output; });
      if (is_watched) foreign_.Sent(message.bytes);
      if (message.channel == config_.lcm.channels.tracks_v2v) {
        background_.Offer(message.channel, message.bytes);
        continue;
      }
      own_bus_->Publish(message.channel, message.bytes);
      last_published_ = Clock::now();
      if (message.channel == config_.lcm.channels.status) last_status_ = Clock::now();
    }
  }

  // One of frames, one of time: enough to notice a second daemon in whatever state it is.
  [[nodiscard]] std::array<const std::string*, 2> WatchedOutputs() const {
    return {&config_.lcm.channels.tracks_local, &config_.lcm.channels.status};
  }

  // What the core cannot know. Each holds for the second in which it was seen.
  std::vector<Notice> Notices() {
    std::vector<Notice> notices;
    const auto note = [&](NoticeKind kind, std::int64_t total, std::int64_t& before) {
      if (total > before) {
        notices.push_back(
            {.kind = kind, .subject = {}, .value = static_cast<double>(total - before)});
      }
      before = total;
    };
    note(NoticeKind::kForeignOutputs, foreign_.count(), foreign_before_);
    note(NoticeKind::kRadioFlood, queue_.bsm_drops(), bsm_drops_before_);
    return notices;
  }

  void RefreshFigures() {
    const SocketFigures sockets = ReadSocketFigures(ports_);
    engine_.SetShellFigures({.queue_drops_own = queue_.own_drops(),
                             .queue_drops_bsm = queue_.bsm_drops(),
                             .images_replaced = detect_.replaced(),
                             .kernel_drops = sockets.kernel_drops,
                             .receive_buffer_bytes = sockets.receive_buffer_bytes,
                             .latencies = {queue_wait_.Report(), step_.Report(),
                                           input_to_list_.Report(), image_to_boxes_.Report()},
                             .notices = Notices(),
                             .dropped = dropped_.rows()});
  }

  void ReportWaiting() {
    log_.Waiting(0, *own_bus_, config_.lcm.url);
    if (v2v_bus_) log_.Waiting(1, *v2v_bus_, config_.lcm.v2v_url);
  }

  DaemonSummary Summary() {
    dropped_.Take(*own_bus_, v2v_bus_.get());
    summary_.dropped = dropped_.rows();
    summary_.accepted = engine_.accepted();
    summary_.withheld_lists = engine_.withheld();
    summary_.queue_drops_own = queue_.own_drops();
    summary_.queue_drops_bsm = queue_.bsm_drops();
    summary_.refused = engine_.refusals();
    summary_.refused[static_cast<std::size_t>(Reason::kImageReplaced)] +=
        static_cast<std::uint64_t>(detect_.replaced());
    summary_.digest_local = engine_.digest_local();
    summary_.digest_priority = engine_.digest_priority();
    return summary_;
  }

  DaemonConfig config_;
  Engine engine_;
  Outbox outbox_;
  MessageQueue queue_;
  DetectThread detect_;
  TrustKeeper trust_;
  BackgroundPublisher background_;
  LatencyMeter queue_wait_{"queue_wait"};
  LatencyMeter step_{"step"};
  LatencyMeter input_to_list_{"input_to_list"};  // From the network: its boxes to the list.
  LatencyMeter image_to_boxes_{"image_to_boxes"};
  DaemonSummary summary_;
  DaemonLog log_;
  ForeignOutputs foreign_;
  std::int64_t foreign_before_ = 0;
  std::int64_t bsm_drops_before_ = 0;
  DroppedDatagramTable dropped_;
  std::vector<int> ports_;  // That we receive on.
  int stale_round_ = 0;
  Clock::time_point last_list_{};
  Clock::time_point last_tick_{};
  Clock::time_point last_published_{};
  ServiceNotifier manager_ = ServiceNotifier::FromEnvironment();
  Watchdog watchdog_{manager_.watchdog(), Clock::now()};
  Clock::time_point last_status_{};
  Clock::time_point last_housekeeping_{};
  // Last, so that they stop before anything they push into is gone.
  std::unique_ptr<Receiver> own_bus_;
  std::unique_ptr<Receiver> v2v_bus_;
};

}  // namespace

DaemonSummary RunDaemon(const DaemonConfig& config, ObjectDetector* detector,
                        const std::function<bool()>& must_stop) {
  return Daemon(config, detector).Run(must_stop);
}

}  // namespace v2vouch
