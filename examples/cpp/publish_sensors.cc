// SPDX-License-Identifier: Apache-2.0
// What a car has to send, with one vehicle 30 m ahead that drives as fast as we do.
// Usage: publish_sensors [SECONDS [LCM_URL]]
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <lcm/lcm-cpp.hpp>
#include <limits>
#include <thread>
#include <v2vouch/camera_detections_t.hpp>
#include <v2vouch/ego_motion_t.hpp>
#include <v2vouch/gnss_fix_t.hpp>
#include <v2vouch/object_list_t.hpp>
#include <v2vouch/radar_scan_t.hpp>

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr double kSpeed_mps = 10.0;

std::int64_t Now() {  // Time of measurement, UTC: your sensor's own stamp is better than now.
  using namespace std::chrono;
  return duration_cast<microseconds>(system_clock::now().time_since_epoch()).count();
}

void SendEgo(lcm::LCM& bus, std::int64_t seq) {
  v2vouch::ego_motion_t ego{};  // The braces matter: lcm-gen's constructor sets nothing.
  ego.utime = Now();
  ego.seq = seq;
  ego.speed_mps = kSpeed_mps;
  ego.speed_sigma_mps = 0.05;
  ego.yaw_rate_radps = 0.0;  // Left turn positive.
  ego.yaw_rate_sigma_radps = 0.002;
  ego.accel_long_mps2 = ego.accel_lat_mps2 = kUnknown;
  ego.gear = v2vouch::ego_motion_t::GEAR_FORWARD;
  bus.publish("EGO_MOTION", &ego);
}

void SendRadar(lcm::LCM& bus, std::int64_t seq) {
  v2vouch::radar_scan_t scan{};
  scan.utime = Now();
  scan.seq = seq;
  scan.sensor = "FRONT";
  for (const double across_m : {-0.6, 0.0, 0.6}) {  // The car's rear, seen from the antenna.
    v2vouch::radar_detection_t seen{};
    seen.range_m = std::hypot(30.0, across_m);
    seen.azimuth_rad = std::atan2(across_m, 30.0);
    seen.range_rate_mps = 0.0;  // Away positive; relative to us.
    seen.rcs_dbsm = 10.0;
    seen.snr_db = 25.0;
    seen.track_id = -1;
    scan.detections.push_back(seen);
  }
  scan.num_detections =
      static_cast<int>(scan.detections.size());  // Or encode() reads past the end.
  bus.publish("RADAR_FRONT", &scan);
}

void SendCamera(lcm::LCM& bus, std::int64_t seq) {
  v2vouch::camera_detections_t boxes{};  // Empty ones are worth sending: nothing was seen.
  boxes.utime = Now();
  boxes.seq = seq;
  boxes.sensor = "FRONT";
  boxes.boxes.resize(1);
  boxes.boxes[0].left_px = 612.0;
  boxes.boxes[0].top_px = 355.0;
  boxes.boxes[0].width_px = 57.0;
  boxes.boxes[0].height_px = 48.0;
  boxes.boxes[0].class_name = "car";
  boxes.boxes[0].score = 0.9;
  boxes.num_boxes = 1;
  bus.publish("CAMERA_FRONT", &boxes);
}

void SendObjects(lcm::LCM& bus, std::int64_t seq) {
  v2vouch::object_list_t
      list{};  // From a lidar's detector; the shipped vehicle has none by this name.
  list.utime = Now();
  list.seq = seq;
  v2vouch::object_t car{};
  car.x_m = 34.5;
  car.length_m = 4.5;
  car.width_m = 1.8;
  car.height_m = car.velocity_x_mps = car.velocity_y_mps = kUnknown;
  car.class_name = "car";
  car.id = -1;
  list.objects.push_back(car);
  list.num_objects = 1;
  bus.publish("OBJECTS_LIDAR", &list);
}

void SendGnss(lcm::LCM& bus, std::int64_t seq, double driven_m) {
  v2vouch::gnss_fix_t fix{};
  fix.utime = Now();
  fix.seq = seq;
  fix.latitude_rad = (48.0 + driven_m / 111'200.0) * M_PI / 180.0;  // Northwards.
  fix.longitude_rad = 11.0 * M_PI / 180.0;
  fix.altitude_m = kUnknown;
  fix.covariance_enu_m2[0] = fix.covariance_enu_m2[4] = fix.covariance_enu_m2[8] = 1.0;
  fix.heading_rad = kUnknown;
  fix.velocity_north_mps = kSpeed_mps;
  fix.fix_type = v2vouch::gnss_fix_t::FIX_3D;
  bus.publish("EGO_GNSS", &fix);
}

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 10.0;
  lcm::LCM bus(argc > 2 ? argv[2] : "");
  if (!bus.good()) return 1;
  const auto start = std::chrono::steady_clock::now();
  for (int i = 0; i < seconds * 100; ++i) {  // 100 Hz.
    std::this_thread::sleep_until(start + std::chrono::milliseconds(10 * i));
    if (i % 2 == 0) SendEgo(bus, i / 2);
    if (i % 5 == 1) SendRadar(bus, i / 5);
    if (i % 10 == 3) SendCamera(bus, i / 10);
    if (i % 10 == 4) SendObjects(bus, i / 10);
    if (i % 10 == 6) SendGnss(bus, i / 10, kSpeed_mps * i / 100.0);
  }
}
