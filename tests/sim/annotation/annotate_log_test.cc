// SPDX-License-Identifier: Apache-2.0
#include "sim/annotation/annotate_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/codec.h"
#include "sim/annotation/projection.h"
#include "tests/sim/import/files.h"
#include "v2vouch/camera_detections_t.hpp"
#include "v2vouch/camera_image_t.hpp"
#include "v2vouch/text_t.hpp"
#include "v2vouch/track_list_t.hpp"

namespace v2vouch::sim {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t kStart_us = 1'700'000'000'000'000;
constexpr char kVehicle[] =
    "vehicle:\n  radars: []\n  cameras:\n    - name: FRONT\n      image_width_px: 640\n"
    "      image_height_px: 360\n      fx_px: 500\n      fy_px: 500\n      cx_px: 320\n"
    "      cy_px: 180\ntimeline: {anything: 1}\n";

// Ten frames of a grey street, a box and a LOCAL track 20 m ahead in each.
class Log {
 public:
  Log(const ScratchFolder& folder, bool has_config, bool has_images)
      : path_(folder.path() + "/log.lcm") {
    std::string error;
    writer_ = LogWriter::Create(path_, error);
    if (has_config) {
      text_t config{};
      config.text = kVehicle;
      Write(0, "V2VOUCH_CONFIG", config);
    }
    for (int k = 0; k < 10; ++k) {
      if (has_images) WriteImage(k);
      camera_detections_t boxes{};
      boxes.utime = kStart_us + k * 100'000;
      boxes.num_boxes = 1;
      boxes.boxes.resize(1);
      boxes.boxes[0].left_px = 100;
      boxes.boxes[0].top_px = 200;
      boxes.boxes[0].width_px = 60;
      boxes.boxes[0].height_px = 40;
      boxes.boxes[0].class_name = "car";
      Write(k, has_images ? "CAMERA_FRONT_DETECTED" : "CAMERA_FRONT", boxes);
      track_list_t list{};
      list.utime = boxes.utime;
      list.num_tracks = 1;
      list.tracks.resize(1);
      list.tracks[0].x_body_m = 20.0;
      list.tracks[0].length_m = 4.0;
      list.tracks[0].width_m = 2.0;
      Write(k, "TRACKS_LOCAL", list);
    }
    EXPECT_TRUE(writer_->Close(error));
  }
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  template <class Message>
  void Write(int k, const char* channel, const Message& message) {
    std::vector<std::uint8_t> bytes;
    wire::Encode(message, bytes);
    writer_->Write(FromMicros(kStart_us + k * 100'000), channel, bytes);
  }
  void WriteImage(int k) {
    camera_image_t image{};
    image.utime = kStart_us + k * 100'000;
    image.width_px = 640;
    image.height_px = 360;
    image.encoding = "jpeg";
    cv::imencode(".jpg", cv::Mat(360, 640, CV_8UC3, cv::Scalar::all(100)), image.data);
    if (k == 9) image.data.resize(20);  // Damaged.
    image.num_bytes = static_cast<std::int32_t>(image.data.size());
    Write(k, "CAMERA_FRONT_IMAGE", image);
  }

  std::string path_;
  std::unique_ptr<LogWriter> writer_;
};

bool IsGreen(const cv::Vec3b& c) { return c[1] > 180 && c[0] < 150 && c[2] < 150; }

TEST(AnnotateLog, BoxesAndTracksStandWhereTheyAre) {
  const ScratchFolder folder("annotate");
  const Log log(folder, true, true);
  AnnotationRequest request;
  request.log = log.path();
  AnnotationResult result;
  std::string error;
  std::vector<cv::Mat> pictures;
  const auto take = [&](Timestamp, const cv::Mat& picture) {
    pictures.push_back(picture.clone());
    return true;
  };
  ASSERT_TRUE(AnnotateLog(request, take, result, error)) << error;
  ASSERT_EQ(pictures.size(), 10u);
  EXPECT_TRUE(result.has_images);
  EXPECT_EQ(result.unread, 1);
  const cv::Mat& picture = pictures[0];
  EXPECT_GT(picture.at<cv::Vec3b>(220, 100)[1], 200);  // Left side of the white box.
  // Footprint's near edge: 18 m ahead, between -1 and 1 m.
  CameraConfig camera;
  camera.fx_px = camera.fy_px = 500;
  camera.cx_px = 320;
  camera.cy_px = 180;
  const auto near = PixelOf(camera, {18.0, 0.0, 0.0});
  bool has_edge = false;
  for (int dy = -1; dy <= 1; ++dy) {
    has_edge = has_edge || IsGreen(picture.at<cv::Vec3b>(static_cast<int>(near->y()) + dy,
                                                         static_cast<int>(near->x()) + 5));
  }
  EXPECT_TRUE(has_edge);
  EXPECT_FALSE(IsGreen(picture.at<cv::Vec3b>(300, 320)));
}

TEST(AnnotateLog, AFewSpreadOverTheLogAndEveryNth) {
  const ScratchFolder folder("annotate");
  const Log log(folder, true, false);
  const auto count = [&](int every, int at_most) {
    AnnotationRequest request;
    request.log = log.path();
    request.every = every;
    request.at_most = at_most;
    AnnotationResult result;
    std::string error;
    EXPECT_TRUE(AnnotateLog(
        request, [](Timestamp, const cv::Mat& p) { return p.cols == 640; }, result, error))
        << error;
    EXPECT_FALSE(result.has_images);
    return result.pictures;
  };
  EXPECT_EQ(count(1, 0), 10);
  EXPECT_EQ(count(4, 0), 3);
  EXPECT_EQ(count(1, 3), 3);
  EXPECT_EQ(count(1, 99), 10);
}

TEST(AnnotateLog, WhatIsMissingIsNamed) {
  const ScratchFolder folder("annotate");
  const Log bare(folder, false, false);
  AnnotationRequest request;
  request.log = bare.path();
  AnnotationResult result;
  std::string error;
  const auto take = [](Timestamp, const cv::Mat&) { return true; };
  EXPECT_FALSE(AnnotateLog(request, take, result, error));
  EXPECT_THAT(error, HasSubstr("holds no V2VOUCH_CONFIG"));
  request.config_path = folder.Write("vehicle.yaml", kVehicle);
  EXPECT_TRUE(AnnotateLog(request, take, result, error)) << error;
  request.camera = "REAR";
  EXPECT_FALSE(AnnotateLog(request, take, result, error));
  EXPECT_EQ(error, "the vehicle has no camera REAR; it has FRONT");
  request.config_path = "/nowhere.yaml";
  EXPECT_FALSE(AnnotateLog(request, take, result, error));
  request.log = "/nowhere.lcm";
  EXPECT_FALSE(AnnotateLog(request, take, result, error));
}

}  // namespace
}  // namespace v2vouch::sim
