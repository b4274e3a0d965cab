// SPDX-License-Identifier: Apache-2.0
// What drivers really send: each edits a good recording of the left turn, and one unknown figure
// costs neither LOCAL nor PRIORITY anything.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "daemon/common/base/angle.h"
#include "daemon/rim/wire/codec.h"
#include "tests/scenario/recording.h"
#include "v2vouch/bsm_t.hpp"
#include "v2vouch/camera_detections_t.hpp"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"
#include "v2vouch/radar_scan_t.hpp"

namespace v2vouch::testing {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

// Every message of the channels that begin with `channel`, changed; `index` counts them.
template <class T>
Recording Edited(Recording recording, const std::string& channel,
                 const std::function<void(T&, int)>& change) {
  int index = 0;
  for (sim::SimEvent& event : recording) {
    if (!event.channel.starts_with(channel)) continue;
    auto message = wire::Decode<T>(event.bytes);
    EXPECT_TRUE(message);
    if (!message) continue;
    change(*message, index++);
    wire::Encode(*message, event.bytes);
  }
  return recording;
}

class UnknownFigures : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    recording_ = new Recording(Record("left_turn", 101));
    good_ = new Outcome(Perceive(*recording_));
  }
  static void TearDownTestSuite() {
    delete recording_;
    delete good_;
  }
  static Recording Ego(const std::function<void(ego_motion_t&, int)>& change) {
    return Edited<ego_motion_t>(*recording_, "EGO_MOTION", change);
  }
  static Recording Gnss(const std::function<void(gnss_fix_t&, int)>& change) {
    return Edited<gnss_fix_t>(*recording_, "EGO_GNSS", change);
  }
  static Recording Radio(const std::function<void(bsm_t&, int)>& change) {
    return Edited<bsm_t>(*recording_, "BSM", change);
  }
  static Recording Radar(const std::function<void(radar_scan_t&, int)>& change) {
    return Edited<radar_scan_t>(*recording_, "RADAR_", change);
  }

  // As without the edit, within `share` of the tracks.
  static void ExpectAsGood(const Recording& recording, const std::string& what,
                           double share = 0.9) {
    const Outcome outcome = Perceive(recording);
    EXPECT_GT(static_cast<double>(outcome.local_tracks),
              share * static_cast<double>(good_->local_tracks))
        << what;
    EXPECT_GT(static_cast<double>(outcome.priority_tracks),
              share * static_cast<double>(good_->priority_tracks))
        << what;
    EXPECT_LT(static_cast<double>(outcome.priority_tracks),
              1.1 * static_cast<double>(good_->priority_tracks))
        << what;
    EXPECT_EQ(outcome.not_finite, 0) << what;
    EXPECT_EQ(outcome.vouched, good_->vouched) << what;
  }

  static Recording* recording_;
  static Outcome* good_;
};
Recording* UnknownFigures::recording_ = nullptr;
Outcome* UnknownFigures::good_ = nullptr;

TEST_F(UnknownFigures, OfTheEgosMotion) {
  ExpectAsGood(Ego([](auto& m, int) { m.speed_sigma_mps = m.yaw_rate_sigma_radps = 0.0; }),
               "sigmas 0");
  ExpectAsGood(Ego([](auto& m, int) { m.speed_sigma_mps = m.yaw_rate_sigma_radps = kNone; }),
               "sigmas NaN");
  ExpectAsGood(Ego([](auto& m, int) {
                 m.accel_long_mps2 = kInf;
                 m.accel_lat_mps2 = -kInf;
                 m.gear = -1;
                 m.seq = -m.seq;
               }),
               "accelerations infinite, gear -1, counter negative");
  ExpectAsGood(Ego([](auto& m, int i) {
                 if (i % 5 == 2) m.yaw_rate_radps = kNone;
               }),
               "every fifth yaw rate NaN");
  ExpectAsGood(Ego([](auto& m, int i) {
                 if (i % 5 == 2) m.speed_mps = kNone;
               }),
               "every fifth speed NaN");
}

TEST_F(UnknownFigures, OfTheEgosReceiver) {
  ExpectAsGood(Gnss([](auto& m, int) { m.altitude_m = kNone; }), "altitude NaN");
  ExpectAsGood(Gnss([](auto& m, int i) {
                 if (i % 4 == 0) m.altitude_m = kNone;
               }),
               "every fourth altitude NaN");
  ExpectAsGood(Gnss([](auto& m, int) { m.velocity_sigma_mps = m.heading_sigma_rad = 0.0; }),
               "sigmas 0");
  ExpectAsGood(Gnss([](auto& m, int) { m.velocity_sigma_mps = m.heading_sigma_rad = kNone; }),
               "sigmas NaN");
  ExpectAsGood(Gnss([](auto& m, int) {
                 m.covariance_enu_m2[8] = kNone;
                 m.altitude_m = kNone;
               }),
               "up unknown");
  ExpectAsGood(Gnss([](auto& m, int) {
                 for (double& element : m.covariance_enu_m2) element = kNone;
               }),
               "covariance NaN");
  ExpectAsGood(Gnss([](auto& m, int) { m.covariance_enu_m2[0] = -1.0; }), "covariance -1");
  ExpectAsGood(Gnss([](auto& m, int) {
                 if (m.heading_rad > kPi) m.heading_rad -= 2.0 * kPi;
                 m.seq = -m.seq;
                 m.fix_type = 1;
               }),
               "heading from -pi to pi, fix type 1");
  ExpectAsGood(Gnss([](auto& m, int) { m.heading_rad = m.heading_sigma_rad = kNone; }),
               "no heading");
}

TEST_F(UnknownFigures, OfTheEgosReceiverAtTheStart) {
  ExpectAsGood(Gnss([](auto& m, int i) {
                 if (i == 0) m.latitude_rad = m.longitude_rad = 0.0;
               }),
               "first fix at 0, 0");
  ExpectAsGood(Gnss([](auto& m, int i) {
                 if (i < 20) m.longitude_rad += FromDegrees(7.1);
               }),
               "first 2 s 500 km off", 0.8);
  ExpectAsGood(Gnss([](auto& m, int i) {
                 if (i == 0) m.latitude_rad += FromDegrees(0.009);
               }),
               "first fix 1 km off");
  ExpectAsGood(Gnss([](auto& m, int i) {
                 if (i % 3 == 0) {
                   m.latitude_rad = m.longitude_rad = 0.0;
                   m.altitude_m = 47.0;
                 }
               }),
               "every third fix at 0, 0");
}

TEST_F(UnknownFigures, OfRadarAndCamera) {
  ExpectAsGood(Radar([](auto& m, int) {
                 for (auto& d : m.detections) {
                   d.rcs_dbsm = kInf;
                   d.track_id = -7;
                   if (d.azimuth_rad < 0.0) d.azimuth_rad += 2.0 * kPi;
                 }
                 m.sensor.clear();
                 m.seq = -m.seq;
               }),
               "rcs infinite, azimuth from 0 to 2 pi, counter negative");
  ExpectAsGood(Edited<camera_detections_t>(*recording_, "CAMERA_",
                                           [](auto& m, int) {
                                             for (auto& b : m.boxes) {
                                               b.score = kNone;
                                               b.class_id = -1;
                                             }
                                             m.image_width_px = m.image_height_px = 0;
                                           }),
               "score NaN, picture size 0");
}

TEST_F(UnknownFigures, OfSenders) {
  ExpectAsGood(Radio([](auto& m, int) {
                 m.orientation = 70000;
                 m.transmission = 9;
                 m.angle = -3000;
                 m.accelSet_vert = 999;
                 m.wheelBrakes = 99;
                 m.abs = m.scs = m.traction = 77;
                 m.rssi_dbm = std::numeric_limits<float>::infinity();
                 m.signature_state = 9;
                 m.seq = -m.seq;
               }),
               "fields outside their ranges");
  ExpectAsGood(Radio([](auto& m, int) { m.generation_utime /= 1000; }), "generation in ms");
}

TEST_F(UnknownFigures, HeightsWithAnotherZero) {
  ExpectAsGood(Gnss([](auto& m, int) { m.altitude_m -= 47.0; }), "ego above sea level", 0.75);
  ExpectAsGood(Radio([](auto& m, int) { m.elev -= 470; }), "senders above sea level", 0.75);
  ExpectAsGood(Radio([](auto& m, int) { m.elev = 0; }), "elevation left at 0", 0.75);
}

}  // namespace
}  // namespace v2vouch::testing
