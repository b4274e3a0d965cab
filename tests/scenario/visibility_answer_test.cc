// SPDX-License-Identifier: Apache-2.0
// The visibility answer itself against TRUTH: after every own-sensor frame of a shipped scenario,
// in order of measurement, each sensor's map is asked about each confirmed LOCAL track, and the
// answer held against the detection probability that TRUTH gives that sensor for the vehicle.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>

#include "daemon/local/perception/local_perception.h"
#include "daemon/rim/engine/daemon_config.h"
#include "daemon/rim/wire/codec.h"
#include "daemon/rim/wire/input_decoder.h"
#include "tests/scenario/recording.h"
#include "v2vouch/truth_list_t.hpp"

namespace v2vouch::testing {
namespace {

constexpr std::array kAnswers = {View::kClear, View::kOccluded, View::kUnknown, View::kOutOfView};
constexpr std::array kNames = {"clear", "occluded", "unknown", "out of view"};
// A track farther from every vehicle than this is nobody's.
constexpr double kMatch_m = 4.0;
// Detected in a look at least this often: seen; never: not seen; in between nobody is wrong.
constexpr double kSeen = 0.5;

/// How often each answer met a vehicle that the sensor sees, sees now and then, or cannot see.
struct Answers {
  std::array<std::array<int, 3>, 4> count{};

  void Add(View answer, double detection_probability) {
    const std::size_t is = detection_probability >= kSeen ? 0 : detection_probability > 0.0 ? 1 : 2;
    ++count[static_cast<std::size_t>(answer)][is];
  }
  [[nodiscard]] int Total(View answer) const {
    const auto& row = count[static_cast<std::size_t>(answer)];
    return row[0] + row[1] + row[2];
  }
  /// Share of the decided cases (seen or not seen at all) in which "clear" was seen, or "occluded"
  /// and "out of view" were not.
  [[nodiscard]] double Right(View answer) const {
    const auto& row = count[static_cast<std::size_t>(answer)];
    const int decided = row[0] + row[2];
    const int right = answer == View::kClear ? row[0] : row[2];
    return decided > 0 ? static_cast<double>(right) / decided : 1.0;
  }
};

void Print(const char* name, const Answers& answers) {
  std::printf("%-22s %9s %9s %9s %8s\n", name, "seen", "at times", "never", "right");
  for (std::size_t a = 0; a < kAnswers.size(); ++a) {
    const auto& row = answers.count[a];
    std::printf("  %-20s %9d %9d %9d", kNames[a], row[0], row[1], row[2]);
    if (kAnswers[a] == View::kUnknown) {
      std::printf(" %8s\n", "-");
    } else {
      std::printf(" %7.1f%%\n", 100.0 * answers.Right(kAnswers[a]));
    }
  }
}

/// The newest TRUTH not after `stamp`.
const truth_list_t* InForce(const std::vector<truth_list_t>& truths, Timestamp stamp) {
  const std::int64_t utime = ToMicros(stamp);
  const auto after =
      std::upper_bound(truths.begin(), truths.end(), utime,
                       [](std::int64_t t, const truth_list_t& truth) { return t < truth.utime; });
  return after == truths.begin() ? nullptr : &*(after - 1);
}

const truth_object_t* NearestTo(const truth_list_t& truth, const Point<Body>& p_B) {
  const double c = std::cos(truth.ego_yaw_rad), s = std::sin(truth.ego_yaw_rad);
  const double x = truth.ego_x_m + c * p_B.x_m - s * p_B.y_m;
  const double y = truth.ego_y_m + s * p_B.x_m + c * p_B.y_m;
  const truth_object_t* nearest = nullptr;
  double reach_m = kMatch_m;
  for (const truth_object_t& object : truth.objects) {
    const double distance = std::hypot(object.x_m - x, object.y_m - y);
    if (distance >= reach_m) continue;
    reach_m = distance;
    nearest = &object;
  }
  return nearest;
}

double ProbabilityOf(const truth_object_t& object, const std::string& channel) {
  for (const truth_sensor_t& sensor : object.sensors) {
    if (sensor.sensor == channel) return sensor.detection_probability;
  }
  return 0.0;
}

class AskedScenario {
 public:
  void Run(const std::string& scenario, std::uint64_t seed) {
    std::vector<std::string> problems;
    ASSERT_TRUE(LoadDaemonConfig("", config_, problems));
    Sort(Record(scenario, seed));
    LocalPerception local(config_.perception.local());
    LocalFrame frame;
    for (const Input& input : inputs_) {
      RadarPreparation prepared;
      bool is_frame = false;
      if (const auto* motion = std::get_if<EgoMotion>(&input)) {
        local.OnEgoMotion(*motion);
      } else if (const auto* scan = std::get_if<RadarScan>(&input)) {
        is_frame = !local.OnRadarScan(*scan, prepared, frame);
      } else if (const auto* boxes = std::get_if<CameraDetections>(&input)) {
        is_frame = !local.OnCameraDetections(*boxes, frame);
      }
      if (is_frame) Ask(local.visibility(), frame);
    }
  }

  Answers radars, cameras;
  int listed = 0;
  int unseen_though_measured = 0;  ///< Flag "hidden" or "out of view" within 0.1 s of a hit.

 private:
  void Sort(const Recording& recording) {
    const wire::InputDecoder decoder(config_.perception.vehicle, config_.lcm.channels);
    RefusalTally dropped;
    for (const sim::SimEvent& event : recording) {
      if (event.channel == "TRUTH") {
        if (auto truth = wire::Decode<truth_list_t>(event.bytes)) truths_.push_back(*truth);
      }
      const auto channel = decoder.Find(event.channel);
      if (!channel) continue;
      auto decoded = decoder.Decode(*channel, event.bytes, event.arrival, dropped);
      if (!decoded) continue;
      if (auto* input = std::get_if<Input>(&*decoded)) inputs_.push_back(std::move(*input));
    }
    std::stable_sort(inputs_.begin(), inputs_.end(), [](const Input& a, const Input& b) {
      return HeaderOf(a).stamp < HeaderOf(b).stamp;
    });
  }

  void Ask(const VisibilityMap& map, const LocalFrame& frame) {
    const truth_list_t* truth = InForce(truths_, frame.stamp);
    if (truth == nullptr) return;
    const VehicleConfig& vehicle = config_.perception.vehicle;
    for (const LocalTrack& track : frame.tracks) {
      if (!track.is_confirmed) continue;
      ++listed;
      if (track.visibility != Visibility::kVisible && track.start < frame.stamp &&
          ToSeconds(frame.stamp - track.support.last()) <= 0.1) {
        ++unseen_though_measured;
      }
      const Point<Odometry> p_O{track.state_O.mean[kX], track.state_O.mean[kY]};
      const truth_object_t* object = NearestTo(*truth, frame.ego.X_OB.Inverse() * p_O);
      if (object == nullptr) continue;
      const Occluder footprint = FootprintOf(track);
      for (std::size_t i = 0; i < vehicle.radars.size(); ++i) {
        radars.Add(map.From({SensorKind::kRadar, static_cast<int>(i)}, footprint).view,
                   ProbabilityOf(*object, "RADAR_" + vehicle.radars[i].name));
      }
      for (std::size_t i = 0; i < vehicle.cameras.size(); ++i) {
        cameras.Add(map.From({SensorKind::kCamera, static_cast<int>(i)}, footprint).view,
                    ProbabilityOf(*object, "CAMERA_" + vehicle.cameras[i].name));
      }
    }
  }

  DaemonConfig config_;
  std::vector<Input> inputs_;
  std::vector<truth_list_t> truths_;
};

class VisibilityAnswer : public ::testing::TestWithParam<const char*> {};

TEST_P(VisibilityAnswer, SaysClearOnlyOfWhatIsSeen) {
  AskedScenario asked;
  asked.Run(GetParam(), 101);
  EXPECT_GT(asked.listed, 2000);
  // The flag is set before a frame's hits are known: it may be one look late.
  EXPECT_LT(asked.unseen_though_measured, 0.01 * asked.listed);
  for (const auto& [name, answers] :
       {std::pair("radars", &asked.radars), std::pair("cameras", &asked.cameras)}) {
    Print((std::string(GetParam()) + ", " + name).c_str(), *answers);
    EXPECT_GT(answers->Total(View::kClear), 500) << name;
    // "Clear" turns a miss into evidence against the vehicle: it must hardly ever be wrong.
    EXPECT_GT(answers->Right(View::kClear), 0.98) << name;
    EXPECT_GT(answers->Right(View::kOutOfView), 0.9) << name;
  }
}

INSTANTIATE_TEST_SUITE_P(All, VisibilityAnswer,
                         ::testing::Values("left_turn", "urban", "highway", "occlusion"),
                         [](const auto& param) { return std::string(param.param); });

}  // namespace
}  // namespace v2vouch::testing
