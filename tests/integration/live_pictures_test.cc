// SPDX-License-Identifier: Apache-2.0
// v2vouchd with a real network, fed with real pictures over UDP in a private network.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "daemon/rim/io/lcm_bus.h"
#include "daemon/rim/wire/codec.h"
#include "tests/integration/program.h"
#include "tests/support/data_folder.h"
#include "v2vouch/camera_detections_t.hpp"
#include "v2vouch/camera_image_t.hpp"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/track_list_t.hpp"

namespace v2vouch {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::Eventually;
using ::testing::HasSubstr;
using testing::Program;

constexpr std::int64_t kStart_us = 1'700'000'000'000'000;

class LivePictures : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::getenv("V2VOUCH_PRIVATE_LCM") == nullptr || std::getenv("V2VOUCH_BIN") == nullptr) {
      GTEST_SKIP() << "SKIPPED: not inside scripts/with_private_lcm";
    }
    std::string pattern = (fs::temp_directory_path() / "live_pictures_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }

  std::string Config(const std::string& detector) const {
    const std::string path = (folder_ / "vehicle.yaml").string();
    std::ofstream(path) << "vehicle:\n  radars: []\n  cameras:\n    - source: image\n"
                           "      image_width_px: 1242\n      image_height_px: 375\n"
                           "      fx_px: 721.5\n      fy_px: 721.5\n      cx_px: 609.6\n"
                           "      cy_px: 172.9\n      z_m: 1.65\n"
                        << detector;
    return path;
  }
  std::unique_ptr<Program> Start(const std::string& config) const {
    return std::make_unique<Program>(
        std::vector<std::string>{std::string(std::getenv("V2VOUCH_BIN")) + "/v2vouchd", "--config",
                                 config},
        (folder_ / "daemon.txt").string());
  }

  fs::path folder_;
};

// What comes out of the daemon.
class Listener {
 public:
  Listener() : bus_(LcmBus::Open("")) {
    const auto keep = [this](auto& kept, const char* channel) {
      bus_->Subscribe(channel,
                      [&kept](std::span<const std::uint8_t> bytes, std::size_t, Timestamp) {
                        using Message = std::remove_reference_t<decltype(kept)>::value_type;
                        if (auto message = wire::Decode<Message>(bytes))
                          kept.push_back(std::move(*message));
                      });
    };
    keep(detected, "CAMERA_FRONT_DETECTED");
    keep(local, "TRACKS_LOCAL");
    keep(status, "V2VOUCH_STATUS");
  }
  template <class Message>
  void Send(const char* channel, const Message& message) {
    std::vector<std::uint8_t> bytes;
    wire::Encode(message, bytes);
    bus_->Publish(channel, bytes);
  }
  bool Until(const std::function<bool()>& condition) {
    return Eventually(
        [&] {
          for (int i = 0; i < 50 && bus_->Handle(1); ++i) {
          }
          return condition();
        },
        20s);
  }
  [[nodiscard]] std::int64_t Refusals(const std::string& reason) const {
    if (status.empty()) return 0;
    for (const count_t& refusal : status.back().refusals) {
      if (refusal.name == reason) return refusal.count;
    }
    return 0;
  }

  std::vector<camera_detections_t> detected;
  std::vector<track_list_t> local;
  std::vector<daemon_status_t> status;

 private:
  std::unique_ptr<LcmBus> bus_;
};

camera_image_t Picture(int k, std::vector<std::uint8_t> jpeg) {
  camera_image_t image{};
  image.utime = kStart_us + k * 100'000;
  image.seq = k;
  image.sensor = "FRONT";
  image.width_px = 1242;
  image.height_px = 375;
  image.encoding = "jpeg";
  image.data = std::move(jpeg);
  image.num_bytes = static_cast<std::int32_t>(image.data.size());
  return image;
}

ego_motion_t Standing(int k) {
  ego_motion_t ego{};
  ego.utime = kStart_us + k * 50'000;
  ego.seq = k;
  ego.speed_sigma_mps = 0.1;
  ego.yaw_rate_sigma_radps = 0.01;
  ego.accel_long_mps2 = ego.accel_lat_mps2 = std::numeric_limits<double>::quiet_NaN();
  ego.gear = ego_motion_t::GEAR_UNKNOWN;
  return ego;
}

TEST_F(LivePictures, SourceImageWithoutANetworkIsAConfigurationError) {
  const auto daemon = Start(Config(""));
  EXPECT_EQ(daemon->Wait(10s), 2);
  EXPECT_THAT(daemon->Output(), HasSubstr("camera FRONT has source: image, but detector.model"));
  const auto absent = Start(Config("detector: {model: absent.weights}\n"));
  EXPECT_EQ(absent->Wait(10s), 2);
  EXPECT_THAT(absent->Output(), HasSubstr("absent.weights: no such file"));
}

TEST_F(LivePictures, FromPixelsToTracksAndRefusals) {
  const fs::path data = fs::absolute(DataFolder());
  const cv::Mat street = cv::imread((data / "images/kitti_seq/0000000000.png").string());
  if (street.empty()) GTEST_SKIP() << "SKIPPED: no pictures under V2VOUCH_DATA";
  std::vector<std::uint8_t> jpeg;
  cv::imencode(".jpg", street, jpeg, {cv::IMWRITE_JPEG_QUALITY, 80});

  const auto daemon =
      Start(Config("detector:\n  model: " + (data / "models/yolo-fastest-1.1-xl.weights").string() +
                   "\n  input_width_px: 640\n  input_height_px: 192\n"));
  ASSERT_TRUE(
      Eventually([&] { return daemon->Output().find("event=started") != std::string::npos; }, 20s))
      << daemon->Output();
  EXPECT_THAT(daemon->Output(), HasSubstr("event=network"));

  Listener listener;
  for (int k = 0; k < 10; ++k) {
    listener.Send("EGO_MOTION", Standing(2 * k));
    listener.Send("EGO_MOTION", Standing(2 * k + 1));
    listener.Send("CAMERA_FRONT_IMAGE", Picture(k, jpeg));
    ASSERT_TRUE(listener.Until([&] { return listener.detected.size() == std::size_t(k) + 1; }))
        << "picture " << k << "\n"
        << daemon->Output();
    EXPECT_EQ(listener.detected.back().utime, kStart_us + k * 100'000);
    EXPECT_EQ(listener.detected.back().seq, k);
    EXPECT_GE(listener.detected.back().num_boxes, 2);
  }
  // The car right ahead in the queue becomes a track.
  EXPECT_TRUE(listener.Until(
      [&] { return !listener.local.empty() && listener.local.back().num_tracks > 0; }));

  // Cut, absurd, of another size; then a burst: the newest wins.
  std::vector<std::uint8_t> cut(jpeg.begin(), jpeg.begin() + 2000);
  listener.Send("CAMERA_FRONT_IMAGE", Picture(10, cut));
  camera_image_t large = Picture(11, jpeg);
  large.width_px = 16000;
  std::this_thread::sleep_for(300ms);
  listener.Send("CAMERA_FRONT_IMAGE", large);
  std::this_thread::sleep_for(300ms);
  for (int k = 12; k < 20; ++k) listener.Send("CAMERA_FRONT_IMAGE", Picture(k, jpeg));
  EXPECT_TRUE(listener.Until([&] {
    return !listener.detected.empty() && listener.detected.back().seq == 19 &&
           listener.Refusals("bad_image") == 1 && listener.Refusals("out_of_range") == 1 &&
           listener.Refusals("image_replaced") >= 1;
  })) << daemon->Output();
  EXPECT_LT(listener.detected.size(), 18u);
  daemon->Signal(SIGTERM);
  EXPECT_EQ(daemon->Wait(5s), 0);
  EXPECT_THAT(daemon->Output(), HasSubstr("reason=image_replaced"));
}

}  // namespace
}  // namespace v2vouch
