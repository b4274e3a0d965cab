// SPDX-License-Identifier: Apache-2.0
// A thousand damaged pictures as messages, through decoder and detector: every one ends as boxes
// inside the picture or as a counted refusal, soon, and none takes memory that its size does not
// explain (the sanitizers watch the rest).
#include <gtest/gtest.h>

#include <chrono>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "daemon/detector/network_detector.h"
#include "daemon/rim/wire/codec.h"
#include "daemon/rim/wire/input_decoder.h"
#include "v2vouch/camera_image_t.hpp"

namespace v2vouch {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 64;

// Sees one box per picture, where the picture is brightest: looks at every pixel.
class Brightest final : public Network {
 public:
  std::vector<CameraBox> Look(const cv::Mat& bgr) override {
    cv::Mat grey;
    cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
    cv::Point place;
    cv::minMaxLoc(grey, nullptr, nullptr, nullptr, &place);
    return {{place.x - 20.0, place.y - 10.0, 40.0, 20.0, ObjectClass::kCar, 0.9}};
  }
};

camera_image_t GoodPicture(std::mt19937_64& rng) {
  cv::Mat bgr(kHeight, kWidth, CV_8UC3);
  cv::RNG(rng()).fill(bgr, cv::RNG::UNIFORM, 0, 255);
  cv::GaussianBlur(bgr, bgr, {}, 3.0);
  camera_image_t image{};
  image.utime = 1'700'000'000'000'000;
  image.sensor = "FRONT";
  image.width_px = kWidth;
  image.height_px = kHeight;
  switch (rng() % 4) {
    case 0:
      image.encoding = "bgr8";
      image.data.assign(bgr.data, bgr.data + bgr.total() * 3);
      break;
    case 1:
      image.encoding = "mono8";
      image.data.assign(bgr.data, bgr.data + bgr.total());
      break;
    default:
      image.encoding = "jpeg";
      cv::imencode(".jpg", bgr, image.data,
                   {cv::IMWRITE_JPEG_PROGRESSIVE, static_cast<int>(rng() % 2),
                    cv::IMWRITE_JPEG_RST_INTERVAL, static_cast<int>(rng() % 3)});
  }
  return image;
}

// Damage of the kinds that radio, disk and enemies do. Bits are turned in the header more often
// than in what follows: that is where sizes and tables stand.
void Damage(camera_image_t& image, std::mt19937_64& rng) {
  const std::size_t size = image.data.size();
  switch (rng() % 6) {
    case 0:
      image.data.resize(rng() % (size + 1));
      break;
    case 1:
      image.data.insert(image.data.end(), rng() % 1000, static_cast<std::uint8_t>(rng()));
      break;
    case 2:
      image.width_px = static_cast<std::int32_t>(rng() % 70000) - 100;
      break;
    default: {
      const std::size_t reach = rng() % 2 == 0 ? std::min<std::size_t>(size, 700) : size;
      for (std::uint64_t i = 0; i <= rng() % 20; ++i) {
        image.data[rng() % reach] = static_cast<std::uint8_t>(rng());
      }
    }
  }
}

TEST(PictureFuzz, AThousandDamagedPicturesEndAsBoxesOrRefusals) {
  VehicleConfig vehicle;
  vehicle.cameras[0].source = CameraSource::kImage;
  vehicle.cameras[0].image_width_px = kWidth;
  vehicle.cameras[0].image_height_px = kHeight;
  const wire::InputDecoder decoder(vehicle, wire::ChannelNames{});
  DetectorConfig config;
  config.tiles = 2;
  config.clahe_clip = 2.0;
  config.edge_gain = 0.5;
  config.refine_bottom = true;
  NetworkDetector detector(std::make_unique<Brightest>(), config);

  std::mt19937_64 rng(20240611);
  int seen = 0;
  int refused = 0;
  for (int i = 0; i < 1000; ++i) {
    camera_image_t message = GoodPicture(rng);
    const bool is_good = i % 20 == 0;
    if (!is_good) Damage(message, rng);
    message.num_bytes = static_cast<std::int32_t>(message.data.size());
    std::vector<std::uint8_t> bytes;
    wire::Encode(message, bytes);
    RefusalTally dropped;
    const auto started = std::chrono::steady_clock::now();
    const auto decoded =
        decoder.Decode(*decoder.Find("CAMERA_FRONT_IMAGE"), bytes, Timestamp{}, dropped);
    const auto detections = decoded ? detector.Detect(*std::get_if<CameraImage>(&*decoded))
                                    : Result<CameraDetections>(decoded.reason());
    EXPECT_LT(std::chrono::steady_clock::now() - started, std::chrono::seconds(5))
        << "picture " << i;
    EXPECT_TRUE(detections || !is_good) << "picture " << i;
    ++(detections ? seen : refused);
    if (!detections) continue;
    for (const CameraBox& box : detections->boxes) {
      EXPECT_GE(box.left_px, 0.0);
      EXPECT_GE(box.top_px, 0.0);
      EXPECT_LE(box.left_px + box.width_px, kWidth);
      EXPECT_GT(box.height_px, 0.0);
    }
  }
  // Both ways out were taken, or the test tests nothing.
  EXPECT_GT(seen, 200);
  EXPECT_GT(refused, 200);
}

}  // namespace
}  // namespace v2vouch
