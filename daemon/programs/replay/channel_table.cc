// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/replay/channel_table.h"

#include <algorithm>

#include "daemon/common/base/did_you_mean.h"
#include "daemon/rim/wire/input_decoder.h"

namespace v2vouch {
namespace {

std::string CountText(std::int64_t count) {
  return std::to_string(count) + (count == 1 ? " message" : " messages");
}

// "FUTURE 12, DUPLICATE 3", the most frequent first.
std::string RefusalText(const std::map<Reason, std::int64_t>& refused) {
  std::vector<std::pair<Reason, std::int64_t>> ordered(refused.begin(), refused.end());
  std::ranges::stable_sort(ordered,
                           [](const auto& a, const auto& b) { return a.second > b.second; });
  std::vector<std::string> words;
  for (const auto& [reason, count] : ordered) {
    words.push_back(std::string(ReasonName(reason)) + " " + std::to_string(count));
  }
  return Listed(words, 4);
}

// A channel of pictures, of what a network saw, or of a recording's own.
bool IsKnownCompanion(const std::string& channel, const DaemonConfig& config) {
  const wire::ChannelNames& names = config.lcm.channels;
  for (const CameraConfig& camera : config.perception.vehicle.cameras) {
    const std::string base = names.camera_prefix + camera.name;
    if (channel == base || channel == base + names.image_suffix ||
        channel == base + names.detected_suffix) {
      return true;
    }
  }
  return channel.starts_with("TRUTH") || channel.starts_with("SIM_");
}

class Judge {
 public:
  Judge(const ChannelTable& channels, const DaemonConfig& config)
      : channels_(channels), config_(config) {
    for (const auto& input : wire::InputChannels(config.perception.vehicle, config.lcm.channels)) {
      if (!input.is_optional()) inputs_.push_back(input.name);
    }
    for (const auto& [name, figures] : channels) {
      events_ += figures.received;
      accepted_ += figures.accepted;
      if (!figures.is_input) {
        others_.push_back(name);
        continue;
      }
      heard_ += figures.received;
      for (const auto& [reason, count] : figures.refused) refused_[reason] += count;
      if (figures.received == 0) unheard_.push_back(name);
    }
  }

  LogVerdict Finish(std::int64_t lists) {
    if (events_ == 0) {
      Problem("the log holds no event");
      return std::move(verdict_);
    }
    NoteOthers();
    if (heard_ == 0) {
      Problem("no event is on a channel of this vehicle, which listens to " + Listed(inputs_) +
              "; the log holds " + Listed(others_) +
              ". Name the channels in lcm.channels, the sensors in vehicle.radars, cameras and "
              "objects");
      return std::move(verdict_);
    }
    if (accepted_ == 0) {
      Problem("none of " + CountText(heard_) + " was accepted: " + RefusalText(refused_));
    }
    NoteUnheard();
    if (lists == 0) NoLists();
    return std::move(verdict_);
  }

 private:
  void Problem(const std::string& text) { verdict_.problems.push_back(text); }
  void Note(const std::string& text) { verdict_.notes.push_back(text); }

  void NoteOthers() {
    const wire::ChannelNames& names = config_.lcm.channels;
    for (const std::string& name : others_) {
      if (IsKnownCompanion(name, config_)) continue;
      const bool is_sensor =
          name.starts_with(names.radar_prefix) || name.starts_with(names.camera_prefix);
      const std::string meant = DidYouMean(name, unheard_);
      if (!is_sensor && meant.empty()) continue;
      Note(name + ": " + CountText(channels_.at(name).received) +
           ", but this vehicle has no such " + (is_sensor ? "sensor" : "input") + meant);
    }
  }

  void NoteUnheard() {
    for (const std::string& name : inputs_) {
      const auto found = channels_.find(name);
      const std::int64_t received = found == channels_.end() ? 0 : found->second.received;
      if (received == 0) {
        Note(name + ": not in the log" + DidYouMean(name, others_));
      } else if (found->second.accepted == 0) {
        Note(name + ": none of " + CountText(received) +
             " accepted: " + RefusalText(found->second.refused));
      }
    }
    for (const CameraConfig& camera : config_.perception.vehicle.cameras) NoteSource(camera);
  }

  // A camera whose configured channel is empty while another one of its channels is not.
  void NoteSource(const CameraConfig& camera) {
    const wire::ChannelNames& names = config_.lcm.channels;
    const std::string base = names.camera_prefix + camera.name;
    const auto has = [&](const std::string& name) {
      const auto found = channels_.find(name);
      return found != channels_.end() && found->second.received > 0;
    };
    const bool wants_boxes = camera.source == CameraSource::kBoxes;
    if (has(wants_boxes ? base : base + names.detected_suffix)) return;
    if (wants_boxes && has(base + names.detected_suffix)) {
      Note("camera " + camera.name + " has source: boxes, but the log holds " + base +
           names.detected_suffix + "; source: detected takes those");
    } else if (!wants_boxes && has(base)) {
      Note("camera " + camera.name + " does not have source: boxes, but the log holds " + base +
           "; source: boxes takes those");
    } else if (has(base + names.image_suffix)) {
      Note("camera " + camera.name +
           ": the log holds pictures that no network has seen; "
           "`v2vouch-detect --log` adds what one sees");
    }
  }

  void NoLists() {
    const std::string& ego = config_.lcm.channels.ego_motion;
    const auto found = channels_.find(ego);
    if (found == channels_.end() || found->second.accepted == 0) {
      Problem("no list was made: without an accepted message on " + ego +
              " nothing can be tracked" +
              (found == channels_.end() || found->second.received == 0
                   ? DidYouMean(ego, others_)
                   : ": " + RefusalText(found->second.refused)));
    } else if (accepted_ > 0) {
      Problem("no list was made: no scan or picture of an own sensor was used");
    }
  }

  const ChannelTable& channels_;
  const DaemonConfig& config_;
  LogVerdict verdict_;
  std::vector<std::string> inputs_;   // In the vehicle's order.
  std::vector<std::string> unheard_;  // Of these, by name.
  std::vector<std::string> others_;
  std::map<Reason, std::int64_t> refused_;
  std::int64_t events_ = 0;
  std::int64_t heard_ = 0;
  std::int64_t accepted_ = 0;
};

}  // namespace

LogVerdict JudgeChannels(const ChannelTable& channels, std::int64_t lists,
                         const DaemonConfig& config) {
  return Judge(channels, config).Finish(lists);
}

}  // namespace v2vouch
