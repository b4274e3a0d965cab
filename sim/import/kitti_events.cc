// SPDX-License-Identifier: Apache-2.0
#include "sim/import/kitti_events.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/random.h"
#include "daemon/common/data/object_class.h"
#include "daemon/rim/wire/codec.h"
#include "sim/import/kitti_path.h"
#include "v2vouch/camera_detections_t.hpp"
#include "v2vouch/camera_image_t.hpp"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/text_t.hpp"
#include "v2vouch/truth_list_t.hpp"

namespace v2vouch::sim {
namespace {

constexpr std::int64_t kStart_us = 1'316'995'200'000'000;  // 2011-09-26 00:00 UTC.
constexpr double kLeastHeight_px = 12.0;
constexpr int kLargelyHidden = 2;
constexpr double kSpeedSigma_mps = 0.1;
constexpr double kYawRateSigma_radps = 0.005;
constexpr int kDifferenceHalf = 2;  // Frames to both sides of a speed's central difference.

std::optional<ObjectClass> ClassOf(const std::string& type) {
  static const std::map<std::string, ObjectClass> kClasses = {
      {"Car", ObjectClass::kCar},         {"Van", ObjectClass::kVan},
      {"Truck", ObjectClass::kTruck},     {"Tram", ObjectClass::kBus},
      {"Cyclist", ObjectClass::kCyclist}, {"Pedestrian", ObjectClass::kPedestrian}};
  const auto found = kClasses.find(type);
  return found == kClasses.end() ? std::nullopt : std::optional(found->second);
}

class Drive {
 public:
  Drive(const std::vector<KittiLabel>& labels, const KittiCamera& camera,
        const std::vector<KittiMotion>& motion, const KittiOptions& options)
      : camera_(camera), motion_(motion), options_(options), poses_(Integrated(motion)) {
    frames_.resize(motion.size());
    for (const KittiLabel& label : labels) {
      const auto frame = static_cast<std::size_t>(label.frame);
      if (frame >= frames_.size() || !ClassOf(label.type)) continue;
      frames_[frame].push_back(label);
      places_[label.track][label.frame] = PlaceOf(label);
    }
  }

  [[nodiscard]] std::size_t frames() const { return frames_.size(); }

  [[nodiscard]] ego_motion_t Motion(std::int64_t index) const {
    const KittiMotion now =
        MotionAt(motion_, static_cast<double>(index * kMotion_us) / static_cast<double>(kFrame_us));
    ego_motion_t message{};
    message.utime = kStart_us + index * kMotion_us;
    message.seq = index;
    message.speed_mps = now.speed_mps;
    message.speed_sigma_mps = kSpeedSigma_mps;
    message.yaw_rate_radps = now.yaw_rate_radps;
    message.yaw_rate_sigma_radps = kYawRateSigma_radps;
    message.accel_long_mps2 = message.accel_lat_mps2 = std::numeric_limits<double>::quiet_NaN();
    message.accel_long_sigma_mps2 = message.accel_lat_sigma_mps2 =
        std::numeric_limits<double>::quiet_NaN();
    message.gear = ego_motion_t::GEAR_UNKNOWN;
    return message;
  }

  [[nodiscard]] camera_detections_t Boxes(std::size_t frame, Random& random) const {
    camera_detections_t message{};
    message.utime = kStart_us + static_cast<std::int64_t>(frame) * kFrame_us;
    message.seq = static_cast<std::int64_t>(frame);
    message.sensor = options_.camera_name;
    message.image_width_px = options_.image_width_px;
    message.image_height_px = options_.image_height_px;
    for (const KittiLabel& label : frames_[frame]) {
      // As many numbers are drawn for every object, told or not.
      double noise[4];
      for (double& each : noise) each = random.Normal(0.0, options_.edge_sigma_px);
      const bool is_told = random.Bernoulli(DetectionProbability(label));
      if (is_told) AddBox(label, noise, message.boxes);
    }
    for (int i = random.Poisson(options_.clutter_per_image); i > 0; --i) {
      AddClutter(random, message.boxes);
    }
    message.num_boxes = static_cast<std::int32_t>(message.boxes.size());
    return message;
  }

  [[nodiscard]] truth_list_t Truth(std::size_t frame) const {
    const Pose2& pose = poses_[frame];
    truth_list_t truth{};
    truth.utime = kStart_us + static_cast<std::int64_t>(frame) * kFrame_us;
    truth.seq = static_cast<std::int64_t>(frame);
    truth.ego_x_m = pose.x_m;
    truth.ego_y_m = pose.y_m;
    truth.ego_yaw_rad = pose.yaw_rad;
    truth.ego_speed_mps = motion_[frame].speed_mps;
    truth.ego_yaw_rate_radps = motion_[frame].yaw_rate_radps;
    for (const KittiLabel& label : frames_[frame]) truth.objects.push_back(Object(label));
    truth.num_objects = static_cast<std::int32_t>(truth.objects.size());
    return truth;
  }

 private:
  // Footprint's centre and direction in the world.
  [[nodiscard]] Pose2 PlaceOf(const KittiLabel& label) const {
    const Pose2& ego = poses_[static_cast<std::size_t>(label.frame)];
    const double forward = label.z_m + options_.camera_x_m;
    const double left = -(label.x_m + camera_.shift_x_m);
    const double c = std::cos(ego.yaw_rad);
    const double s = std::sin(ego.yaw_rad);
    return {ego.x_m + c * forward - s * left, ego.y_m + s * forward + c * left,
            WrapAngle(ego.yaw_rad - label.rotation_y_rad - std::numbers::pi / 2.0)};
  }

  [[nodiscard]] double DetectionProbability(const KittiLabel& label) const {
    if (label.bottom_px - label.top_px < kLeastHeight_px) return 0.0;
    const double hidden = label.occluded >= kLargelyHidden ? 0.5 : 1.0;
    return hidden * options_.detection_probability;
  }

  void AddBox(const KittiLabel& label, const double (&noise)[4],
              std::vector<camera_box_t>& boxes) const {
    const double width = options_.image_width_px;
    const double height = options_.image_height_px;
    const double left = std::clamp(label.left_px + noise[0], 0.0, width);
    const double right = std::clamp(label.right_px + noise[1], 0.0, width);
    const double top = std::clamp(label.top_px + noise[2], 0.0, height);
    // The labels end at the last whole row: cut there is cut.
    const bool is_cut = label.bottom_px >= height - 2.0;
    const double bottom = is_cut ? height : std::clamp(label.bottom_px + noise[3], 0.0, height);
    if (right - left < 2.0 || bottom - top < 2.0) return;
    camera_box_t box{};
    box.left_px = left;
    box.top_px = top;
    box.width_px = right - left;
    box.height_px = bottom - top;
    box.class_id = -1;
    box.class_name = ObjectClassName(*ClassOf(label.type));
    box.score = 0.9;
    boxes.push_back(std::move(box));
  }

  // A car-sized box on the road somewhere ahead.
  void AddClutter(Random& random, std::vector<camera_box_t>& boxes) const {
    const double distance_m = random.Uniform(8.0, 60.0);
    const double width = 1.8 * camera_.fx_px / distance_m;
    const double height = 1.5 * camera_.fy_px / distance_m;
    const double bottom = camera_.cy_px + options_.camera_z_m * camera_.fy_px / distance_m;
    if (bottom > options_.image_height_px || width > options_.image_width_px) return;
    camera_box_t box{};
    box.left_px = random.Uniform(0.0, options_.image_width_px - width);
    box.top_px = bottom - height;
    box.width_px = width;
    box.height_px = height;
    box.class_id = -1;
    box.class_name = "car";
    box.score = 0.5;
    boxes.push_back(std::move(box));
  }

  [[nodiscard]] truth_object_t Object(const KittiLabel& label) const {
    const Pose2 place = PlaceOf(label);
    truth_object_t object{};
    object.id = label.track + 1;  // 0 means none.
    object.object_class = static_cast<std::int8_t>(*ClassOf(label.type));
    object.x_m = place.x_m;
    object.y_m = place.y_m;
    object.yaw_rad = place.yaw_rad;
    object.length_m = label.length_m;
    object.width_m = label.width_m;
    object.height_m = label.height_m;
    SetMotion(label, place, object);
    truth_sensor_t sensor{};
    sensor.sensor = "CAMERA_" + options_.camera_name;
    sensor.detection_probability = DetectionProbability(label);
    sensor.visible_fraction = label.occluded <= 0 ? 1.0 : label.occluded == 1 ? 0.6 : 0.2;
    object.is_hidden =
        label.occluded >= kLargelyHidden || sensor.detection_probability == 0.0 ? 1 : 0;
    object.sensors.push_back(sensor);
    object.num_sensors = 1;
    return object;
  }

  // Along the label's own direction, from places up to two frames to both sides.
  void SetMotion(const KittiLabel& label, const Pose2& place, truth_object_t& object) const {
    const auto& places = places_.at(label.track);
    const auto at = places.find(label.frame);
    auto first = at;
    auto last = at;
    for (int i = 0; i < kDifferenceHalf; ++i) {
      if (first != places.begin() && std::prev(first)->first == first->first - 1) --first;
      if (std::next(last) != places.end() && std::next(last)->first == last->first + 1) ++last;
    }
    if (first == last) return;
    const double time_s = (last->first - first->first) * kFrame_s;
    const double dx = last->second.x_m - first->second.x_m;
    const double dy = last->second.y_m - first->second.y_m;
    object.speed_mps = (dx * std::cos(place.yaw_rad) + dy * std::sin(place.yaw_rad)) / time_s;
    object.yaw_rate_radps = AngleDifference(last->second.yaw_rad, first->second.yaw_rad) / time_s;
  }

  KittiCamera camera_;
  std::vector<KittiMotion> motion_;
  KittiOptions options_;
  std::vector<Pose2> poses_;
  std::vector<std::vector<KittiLabel>> frames_;
  std::map<int, std::map<int, Pose2>> places_;  // By track, then frame.
};

template <class Message>
ImportedEvent MakeEvent(std::int64_t at_us, std::string channel, const Message& message) {
  ImportedEvent event{FromMicros(at_us), std::move(channel), {}};
  wire::Encode(message, event.bytes);
  return event;
}

text_t Scenario(const std::string& name, const KittiCamera& camera, const KittiOptions& options) {
  char text[512];
  std::snprintf(text, sizeof(text),
                "vehicle:\n  radars: []\n  cameras:\n    - name: %s\n      x_m: %g\n      z_m: %g\n"
                "      image_width_px: %d\n      fx_px: %g\n      fy_px: %g\n"
                "      edge_sigma_px: %g\n",
                options.camera_name.c_str(), options.camera_x_m, options.camera_z_m,
                options.image_width_px, camera.fx_px, camera.fy_px, options.edge_sigma_px);
  text_t message{};
  message.utime = kStart_us;
  message.name = "scenario";
  message.text = "name: " + name + "\n" + text;
  return message;
}

}  // namespace

std::vector<ImportedEvent> KittiEvents(const std::string& name,
                                       const std::vector<KittiLabel>& labels,
                                       const KittiCamera& camera,
                                       const std::vector<KittiMotion>& motion,
                                       const KittiOptions& options, const KittiPictures& pictures) {
  const Drive drive(labels, camera, motion, options);
  Random random(options.seed);
  std::vector<ImportedEvent> events;
  events.push_back(MakeEvent(kStart_us, "SIM_SCENARIO", Scenario(name, camera, options)));
  const auto samples = static_cast<std::int64_t>(drive.frames()) * (kFrame_us / kMotion_us);
  for (std::int64_t i = 0; i < samples; ++i) {
    events.push_back(MakeEvent(kStart_us + i * kMotion_us, "EGO_MOTION", drive.Motion(i)));
  }
  const std::string channel = "CAMERA_" + options.camera_name;
  for (std::size_t frame = 0; frame < drive.frames(); ++frame) {
    const std::int64_t at_us = kStart_us + static_cast<std::int64_t>(frame) * kFrame_us;
    events.push_back(MakeEvent(at_us, "TRUTH", drive.Truth(frame)));
    if (!pictures) {
      events.push_back(MakeEvent(at_us, channel, drive.Boxes(frame, random)));
      continue;
    }
    camera_image_t image{};
    image.data = pictures(static_cast<int>(frame));
    if (image.data.empty()) continue;
    image.utime = at_us;
    image.seq = static_cast<std::int64_t>(frame);
    image.sensor = options.camera_name;
    image.width_px = options.image_width_px;
    image.height_px = options.image_height_px;
    image.encoding = "jpeg";
    image.num_bytes = static_cast<std::int32_t>(image.data.size());
    events.push_back(MakeEvent(at_us, channel + "_IMAGE", image));
  }
  std::stable_sort(
      events.begin(), events.end(),
      [](const ImportedEvent& a, const ImportedEvent& b) { return a.received < b.received; });
  return events;
}

}  // namespace v2vouch::sim
