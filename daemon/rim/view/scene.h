// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/common/base/time.h"
#include "daemon/common/data/vehicle.h"
#include "daemon/rim/view/event_list.h"
#include "daemon/rim/view/road_map.h"
#include "daemon/rim/wire/channels.h"
#include "v2vouch/camera_detections_t.hpp"
#include "v2vouch/camera_image_t.hpp"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"
#include "v2vouch/object_list_t.hpp"
#include "v2vouch/radar_scan_t.hpp"
#include "v2vouch/track_list_t.hpp"
#include "v2vouch/truth_list_t.hpp"
#include "v2vouch/warning_list_t.hpp"

namespace v2vouch::view {

/// A frame in another one on flat ground.
struct FlatPose {
  double x_m = 0.0;
  double y_m = 0.0;
  double yaw_rad = 0.0;

  [[nodiscard]] MapPoint ToOuter(double x_inner_m, double y_inner_m) const;
};

/// A message with its place in the order of messages, so that a reader knows whether it is new.
template <class T>
struct Newest {
  std::optional<T> message;
  std::int64_t revision = 0;  ///< 0 = none yet.
};

/// What was said about one sender, the newest ten.
struct SenderVerdict {
  std::int64_t utime = 0;
  std::string text;
  int times = 1;  ///< The same in a row.
};

/// What there is to see at this moment: the newest message of each kind, nothing older. Pure: no
/// clock, file or thread. Takes bytes that may be hostile; memory is bounded whatever comes.
class Scene {
 public:
  Scene(VehicleConfig vehicle, const wire::ChannelNames& names);

  /// @return false where the channel is none of ours or the message was refused.
  bool Take(std::string_view channel, std::span<const std::uint8_t> bytes, Timestamp received);
  /// Before another stretch of time: forgets all but the map and the events.
  void Forget();

  enum class List { kLocal, kPriority, kV2v };
  [[nodiscard]] const Newest<track_list_t>& list(List list) const {
    return lists_[static_cast<std::size_t>(list)];
  }
  [[nodiscard]] const Newest<daemon_status_t>& status() const { return status_; }
  [[nodiscard]] const Newest<truth_list_t>& truth() const { return truth_; }
  [[nodiscard]] const Newest<warning_list_t>& warnings() const { return warnings_; }
  [[nodiscard]] const Newest<gnss_fix_t>& gnss() const { return gnss_; }
  [[nodiscard]] const Newest<ego_motion_t>& ego_motion() const { return ego_motion_; }
  /// One per radar, source of objects and camera of the vehicle, in their order.
  [[nodiscard]] const std::vector<Newest<radar_scan_t>>& radars() const { return radars_; }
  [[nodiscard]] const std::vector<Newest<object_list_t>>& objects() const { return objects_; }
  [[nodiscard]] const std::vector<Newest<camera_detections_t>>& boxes() const { return boxes_; }
  [[nodiscard]] const std::vector<Newest<camera_image_t>>& pictures() const { return pictures_; }
  [[nodiscard]] const VehicleConfig& vehicle() const { return vehicle_; }
  [[nodiscard]] const Newest<RoadMap>& map() const { return map_; }
  [[nodiscard]] EventList& events() { return events_; }
  [[nodiscard]] const EventList& events() const { return events_; }
  [[nodiscard]] const std::deque<SenderVerdict>* VerdictsOf(std::uint32_t sender) const;
  /// Whether a message of the simulator says that this sender belongs to an attacker.
  [[nodiscard]] bool IsLiar(std::uint32_t sender) const;
  [[nodiscard]] std::int64_t refused() const { return refused_; }

  /// Grows with every message that was taken.
  [[nodiscard]] std::int64_t revision() const { return revision_; }
  /// When the newest list arrived, microseconds; 0 = none yet.
  [[nodiscard]] std::int64_t list_received() const { return list_received_; }
  /// Newest time of validity of a list; 0 = none.
  [[nodiscard]] std::int64_t list_utime() const { return list_utime_; }
  /// The ego in the odometry frame at `utime`, moved on from the newest list at most a second.
  [[nodiscard]] std::optional<FlatPose> EgoAt(std::int64_t utime) const;
  /// The world frame of TRUTH in the odometry frame.
  [[nodiscard]] std::optional<FlatPose> WorldInOdom() const;
  /// Where the ego was, oldest first, at least 1 m apart.
  [[nodiscard]] const std::deque<MapPoint>& trail() const { return trail_; }

  /// Every channel that Take() knows; what a live source has to subscribe.
  [[nodiscard]] std::vector<std::string> Channels() const;

 private:
  enum class Kind {
    kList,
    kRadar,
    kObjects,
    kBoxes,
    kPicture,
    kEgoMotion,
    kGnss,
    kStatus,
    kReport,
    kVerdict,
    kWarnings,
    kTruth,
    kTruthBsm,
    kScenario
  };
  struct Channel {
    Kind kind = Kind::kList;
    std::size_t index = 0;
  };
  template <class T>
  bool Keep(std::span<const std::uint8_t> bytes, Newest<T>& newest);
  bool TakeList(std::span<const std::uint8_t> bytes, std::size_t index);
  bool TakeReport(std::span<const std::uint8_t> bytes);
  bool TakeVerdict(std::span<const std::uint8_t> bytes);
  bool TakeTruthBsm(std::span<const std::uint8_t> bytes);
  bool TakeScenario(std::span<const std::uint8_t> bytes);
  void NoteVerdict(std::uint32_t sender, std::int64_t utime, std::string text);
  void ExtendTrail(const track_list_t& list);

  VehicleConfig vehicle_;
  std::map<std::string, Channel, std::less<>> channels_;
  Newest<track_list_t> lists_[3];
  std::vector<Newest<radar_scan_t>> radars_;
  std::vector<Newest<object_list_t>> objects_;
  std::vector<Newest<camera_detections_t>> boxes_;
  std::vector<Newest<camera_image_t>> pictures_;
  Newest<ego_motion_t> ego_motion_;
  Newest<gnss_fix_t> gnss_;
  Newest<daemon_status_t> status_;
  Newest<truth_list_t> truth_;
  Newest<warning_list_t> warnings_;
  Newest<RoadMap> map_;
  EventList events_;
  std::map<std::uint32_t, std::deque<SenderVerdict>> verdicts_;
  std::map<std::uint32_t, bool> liars_;
  std::deque<MapPoint> trail_;
  std::int64_t received_ = 0;  // Of the message being taken.
  std::int64_t list_received_ = 0;
  std::int64_t list_utime_ = 0;
  std::int64_t revision_ = 0;
  std::int64_t refused_ = 0;
};

}  // namespace v2vouch::view
