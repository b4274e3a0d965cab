// SPDX-License-Identifier: Apache-2.0
// What a network saw, put into a log once, is what every replay of it sees.
#include "daemon/programs/detect/detect_log.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "daemon/programs/replay/replay.h"
#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/codec.h"
#include "daemon/rim/wire/sensor_conversion.h"
#include "tests/support/synthetic_drive.h"
#include "tests/support/wire_drive.h"
#include "v2vouch/camera_detections_t.hpp"
#include "v2vouch/camera_image_t.hpp"

namespace v2vouch {
namespace {

using testing::WireMessage;

// The boxes that the drive's smart camera told, handed out for pictures of the same number.
class RecordedEyes final : public ObjectDetector {
 public:
  explicit RecordedEyes(const std::vector<WireMessage>& drive) {
    for (const WireMessage& message : drive) {
      if (message.channel == "CAMERA_FRONT") {
        seen_.push_back(*wire::Decode<camera_detections_t>(message.bytes));
      }
    }
  }
  Result<CameraDetections> Detect(const CameraImage& image) override {
    const auto found = std::find_if(seen_.begin(), seen_.end(),
                                    [&](const auto& each) { return each.seq == image.seq; });
    if (found == seen_.end()) return Reason::kBadImage;
    CameraConfig camera;
    RefusalTally dropped;
    camera.image_width_px = found->image_width_px;
    camera.image_height_px = found->image_height_px;
    auto detections = wire::FromWire(*found, camera, image.camera, image.received, dropped);
    detections->stamp = image.stamp;
    return detections;
  }
  [[nodiscard]] std::size_t count() const { return seen_.size(); }

 private:
  std::vector<camera_detections_t> seen_;
};

std::string Path(const char* name) { return ::testing::TempDir() + "v2vouch_detect_log_" + name; }

// The drive with a mono8 picture in place of every box message.
void WriteDrive(const std::vector<WireMessage>& drive, const std::string& path, bool as_pictures,
                std::int64_t clock_ahead_us) {
  std::string error;
  const auto writer = LogWriter::Create(path, error);
  ASSERT_NE(writer, nullptr) << error;
  for (const WireMessage& message : drive) {
    if (message.channel != "CAMERA_FRONT" || !as_pictures) {
      writer->Write(message.received, message.channel, message.bytes);
      continue;
    }
    const auto boxes = wire::Decode<camera_detections_t>(message.bytes);
    camera_image_t image{};
    image.utime = boxes->utime + clock_ahead_us;
    image.seq = boxes->seq;
    image.sensor = boxes->sensor;
    image.width_px = boxes->image_width_px;
    image.height_px = boxes->image_height_px;
    image.encoding = "mono8";
    image.data.resize(static_cast<std::size_t>(image.width_px * image.height_px));
    image.num_bytes = static_cast<std::int32_t>(image.data.size());
    std::vector<std::uint8_t> bytes;
    wire::Encode(image, bytes);
    writer->Write(message.received, "CAMERA_FRONT_IMAGE", bytes);
  }
  ASSERT_TRUE(writer->Close(error)) << error;
}

ReplayResult Replayed(const std::string& path, const DaemonConfig& config) {
  ReplayResult result;
  std::string error;
  EXPECT_TRUE(Replay(
      path, "", config, [](double) { return true; }, result, error))
      << error;
  return result;
}

TEST(DetectLog, ReplayOfWhatWasSeenEqualsASmartCamera) {
  testing::SyntheticDrive drive;
  drive.duration_s = 3.0;
  drive.cars.push_back({.x_m = 30.0, .y_m = 0.0, .speed_mps = 9.0});
  DaemonConfig boxes;
  DaemonConfig pictures = boxes;
  pictures.perception.vehicle.cameras[0].source = CameraSource::kImage;
  // The camera's clock runs a quarter of a second ahead.
  pictures.perception.vehicle.cameras[0].clock_offset_s = -0.25;
  const auto messages = testing::EncodeInputs(testing::MakeInputs(drive), boxes.perception.vehicle);
  WriteDrive(messages, Path("boxes.lcm"), false, 0);
  WriteDrive(messages, Path("pictures.lcm"), true, 250'000);

  const ReplayResult unseen = Replayed(Path("pictures.lcm"), pictures);
  RecordedEyes eyes(messages);
  EXPECT_EQ(unseen.unseen_pictures, static_cast<std::int64_t>(eyes.count()));

  DetectLogResult result;
  std::string error;
  const auto go_on = [](double) { return true; };
  ASSERT_TRUE(
      DetectLog(Path("pictures.lcm"), Path("seen.lcm"), pictures, eyes, go_on, result, error))
      << error;
  EXPECT_EQ(result.pictures, static_cast<std::int64_t>(eyes.count()));
  EXPECT_GT(result.boxes, 10);

  const ReplayResult expected = Replayed(Path("boxes.lcm"), boxes);
  const ReplayResult seen = Replayed(Path("seen.lcm"), pictures);
  EXPECT_EQ(seen.unseen_pictures, 0);
  EXPECT_EQ(seen.digest_local, expected.digest_local);
  EXPECT_NE(seen.digest_local, unseen.digest_local);

  // A second time: what was seen before is not doubled.
  DetectLogResult again;
  ASSERT_TRUE(DetectLog(Path("seen.lcm"), Path("again.lcm"), pictures, eyes, go_on, again, error));
  EXPECT_EQ(std::filesystem::file_size(Path("again.lcm")),
            std::filesystem::file_size(Path("seen.lcm")));
  EXPECT_FALSE(DetectLog(Path("seen.lcm"), Path("seen.lcm"), pictures, eyes, go_on, again, error));
}

}  // namespace
}  // namespace v2vouch
