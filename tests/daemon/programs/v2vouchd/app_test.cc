// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>

#include "daemon/programs/v2vouchd/detect_thread.h"
#include "daemon/programs/v2vouchd/foreign_outputs.h"
#include "daemon/programs/v2vouchd/latency_meter.h"
#include "daemon/programs/v2vouchd/message_queue.h"
#include "daemon/rim/wire/codec.h"
#include "v2vouch/camera_image_t.hpp"

namespace v2vouch {
namespace {

using namespace std::chrono_literals;

Arrival Named(const std::string& channel) {
  Arrival arrival;
  arrival.channel = channel;
  return arrival;
}

TEST(MessageQueue, PopsInOrderOfArrivalOverBothQueues) {
  MessageQueue queue(10, 10);
  queue.PushOwn(Named("a"));
  queue.PushBsm(Named("b"));
  queue.PushBsm(Named("c"));
  queue.PushOwn(Named("d"));
  for (const char* expected : {"a", "b", "c", "d"}) EXPECT_EQ(queue.Pop(0ms)->channel, expected);
  EXPECT_FALSE(queue.Pop(0ms));
}

// A backlog of the radio's must not stand before a radar scan.
TEST(MessageQueue, OwnSensorsOvertakeABacklogOfBsms) {
  MessageQueue queue(1000, 1000);
  for (int i = 0; i < 500; ++i) queue.PushBsm(Named("bsm"));
  queue.PushOwn(Named("radar"));
  queue.PushOwn(Named("camera"));
  EXPECT_EQ(queue.Pop(0ms)->channel, "radar");
  EXPECT_EQ(queue.Pop(0ms)->channel, "camera");
  int left = 0;
  while (queue.Pop(0ms)) ++left;
  EXPECT_EQ(left, 500);
  EXPECT_EQ(queue.bsm_drops(), 0);
}

// After a pause of the whole process: many wait, but few before each own message.
TEST(MessageQueue, ABacklogOfAllKeepsTheOrderOfArrival) {
  MessageQueue queue(1000, 1000);
  std::vector<std::string> expected;
  for (int i = 0; i < 20; ++i) {
    for (std::size_t k = 0; k < MessageQueue::kMostAhead; ++k) {
      queue.PushBsm(Named(expected.emplace_back("bsm" + std::to_string(i))));
    }
    queue.PushOwn(Named(expected.emplace_back("radar" + std::to_string(i))));
  }
  for (const std::string& channel : expected) EXPECT_EQ(queue.Pop(0ms)->channel, channel);
}

TEST(MessageQueue, FloodOfBsmsDropsOldBsmsAndNoOwnSensor) {
  MessageQueue queue(4, 3);
  queue.PushOwn(Named("radar"));
  for (int i = 0; i < 10; ++i) queue.PushBsm(Named("bsm" + std::to_string(i)));
  EXPECT_EQ(queue.own_drops(), 0);
  EXPECT_EQ(queue.bsm_drops(), 7);
  for (const char* expected : {"radar", "bsm7", "bsm8", "bsm9"}) {
    EXPECT_EQ(queue.Pop(0ms)->channel, expected);
  }
}

std::vector<std::uint8_t> Message(std::uint8_t content) { return {1, 2, content}; }

TEST(ForeignOutputs, OwnMessagesComeBackOnceAndAreNotForeign) {
  ForeignOutputs outputs;
  for (std::uint8_t i = 0; i < 200; ++i) outputs.Sent(Message(i));
  for (std::uint8_t i = 0; i < 200; ++i) outputs.Heard(Message(i));
  EXPECT_EQ(outputs.count(), 0);
}

// A second daemon that hears the same sensors sends the same lists, bit for bit.
TEST(ForeignOutputs, ASecondCopyIsAnothersWhicheverComesFirst) {
  ForeignOutputs outputs;
  outputs.Heard(Message(1));
  outputs.Sent(Message(1));
  outputs.Heard(Message(1));
  outputs.Sent(Message(2));
  outputs.Heard(Message(2));
  outputs.Heard(Message(2));
  EXPECT_EQ(outputs.count(), 2);
}

TEST(LatencyMeter, ReportsNearestRankAndStartsAgain) {
  LatencyMeter meter("step");
  for (int i = 1; i <= 200; ++i) meter.Add(std::chrono::microseconds(i));
  const auto latency = meter.Report();
  EXPECT_EQ(latency.stage, "step");
  EXPECT_DOUBLE_EQ(latency.p50_us, 100.0);
  EXPECT_DOUBLE_EQ(latency.p99_us, 198.0);
  EXPECT_DOUBLE_EQ(latency.max_us, 200.0);
  EXPECT_EQ(meter.Report().max_us, 0.0);
}

VehicleConfig VehicleWithPictures() {
  VehicleConfig vehicle;
  vehicle.cameras[0].source = CameraSource::kImage;
  vehicle.cameras[0].image_width_px = vehicle.cameras[0].image_height_px = 2;
  return vehicle;
}

Arrival Picture(std::int64_t seq, const std::string& sensor = "FRONT") {
  camera_image_t image{};
  image.utime = 1'700'000'000'000'000;
  image.seq = seq;
  image.sensor = sensor;
  image.width_px = image.height_px = 2;
  image.encoding = "mono8";
  image.data.assign(4, 0);
  image.num_bytes = 4;
  Arrival arrival = Named("CAMERA_" + sensor + "_IMAGE");
  arrival.arrived = std::chrono::steady_clock::now();
  Arrival::Bytes bytes;
  wire::Encode(image, bytes);
  arrival.content = bytes;
  return arrival;
}

// Sees one box in every picture once it may go on.
class GatedDetector final : public ObjectDetector {
 public:
  Result<CameraDetections> Detect(const CameraImage& image) override {
    std::unique_lock lock(mutex_);
    ++looks_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return is_open_; });
    if (image.seq == 99) throw std::runtime_error("cannot read this picture");
    CameraDetections detections;
    static_cast<MessageHeader&>(detections) = image;
    detections.camera = image.camera;
    detections.boxes.resize(1);
    return detections;
  }
  void WaitForLook() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return looks_ > 0; });
  }
  void Open() {
    const std::lock_guard lock(mutex_);
    is_open_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int looks_ = 0;
  bool is_open_ = false;
};

TEST(DetectThread, NewestPictureWinsWhileTheDetectorIsBusy) {
  const wire::InputDecoder decoder(VehicleWithPictures(), wire::ChannelNames{});
  MessageQueue queue(10, 10);
  GatedDetector detector;
  DetectThread thread(decoder, &detector, queue);
  thread.Offer(Picture(1));
  detector.WaitForLook();
  for (const int seq : {2, 3, 4}) thread.Offer(Picture(seq));
  EXPECT_EQ(thread.replaced(), 2);
  detector.Open();
  for (const int seq : {1, 4}) {
    const auto arrival = queue.Pop(10s);
    ASSERT_TRUE(arrival);
    const auto* detections = std::get_if<CameraDetections>(&arrival->content);
    ASSERT_NE(detections, nullptr);
    EXPECT_EQ(detections->seq, seq);
  }
}

// A camera that floods must not keep the network from looking through the others.
TEST(DetectThread, CamerasTakeTurns) {
  VehicleConfig vehicle = VehicleWithPictures();
  vehicle.cameras.push_back(vehicle.cameras[0]);
  vehicle.cameras[1].name = "REAR";
  const wire::InputDecoder decoder(vehicle, wire::ChannelNames{});
  MessageQueue queue(10, 10);
  GatedDetector detector;
  DetectThread thread(decoder, &detector, queue);
  thread.Offer(Picture(1));
  detector.WaitForLook();
  thread.Offer(Picture(2));
  thread.Offer(Picture(3, "REAR"));
  thread.Offer(Picture(4));
  detector.Open();
  for (const char* channel : {"CAMERA_FRONT_IMAGE", "CAMERA_REAR_IMAGE", "CAMERA_FRONT_IMAGE"}) {
    const auto arrival = queue.Pop(10s);
    ASSERT_TRUE(arrival);
    EXPECT_EQ(arrival->channel, channel);
    EXPECT_GT(arrival->looked.count(), 0);
  }
}

TEST(DetectThread, RefusalsAndExceptionsBecomeReasons) {
  const wire::InputDecoder decoder(VehicleWithPictures(), wire::ChannelNames{});
  MessageQueue queue(10, 10);
  const auto reason_of = [&](ObjectDetector* detector, Arrival picture) {
    DetectThread thread(decoder, detector, queue);
    thread.Offer(std::move(picture));
    const auto arrival = queue.Pop(10s);
    return arrival ? std::get<Refusal>(arrival->content).reason : Reason::kCount;
  };
  EXPECT_EQ(reason_of(nullptr, Picture(1)), Reason::kNoDetector);
  GatedDetector detector;
  detector.Open();
  EXPECT_EQ(reason_of(&detector, Picture(99)), Reason::kBadImage);
  Arrival damaged = Picture(1);
  std::get<Arrival::Bytes>(damaged.content).pop_back();
  EXPECT_EQ(reason_of(&detector, damaged), Reason::kBadLength);
  Arrival large = Picture(1);
  large.content = Reason::kTooLarge;  // Refused on the way: the reason stays what it was.
  EXPECT_EQ(reason_of(&detector, large), Reason::kTooLarge);
}

}  // namespace
}  // namespace v2vouch
