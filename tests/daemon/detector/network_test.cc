// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "daemon/detector/darknet_cfg.h"
#include "daemon/detector/network_detector.h"
#include "tests/daemon/detector/onnx_file.h"
#include "tests/support/data_folder.h"

namespace v2vouch {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class TemporaryFolder {
 public:
  TemporaryFolder() : path_(fs::path(testing::TempDir()) / "v2vouch_network_test") {
    fs::create_directories(path_);
  }
  ~TemporaryFolder() { fs::remove_all(path_); }
  std::string Write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
    return (path_ / name).string();
  }

 private:
  fs::path path_;
};

std::string ReadAll(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::vector<std::string> ProblemsOf(const DetectorConfig& config) {
  std::vector<std::string> problems;
  EXPECT_EQ(NetworkDetector::Load(config, problems), nullptr);
  return problems;
}

// A darknet network of one convolution, seven parameters.
constexpr char kSmallCfg[] =
    "[net]\nwidth=32\nheight=32\nchannels=3\n# a comment\n[convolutional]\nfilters=1\nsize=1\n"
    "stride=1\npad=0\nactivation=linear\n";

TEST(DarknetWeightBytes, CountsByHand) {
  EXPECT_EQ(DarknetWeightBytes(kSmallCfg), 20 + 4 * (3 + 1));
  EXPECT_EQ(DarknetWeightBytes("[net]\n[convolutional]\nbatch_normalize=1\nfilters=4\nsize=3\n"
                               "[convolutional]\nfilters=4\ngroups=4\nsize=3\n[route]\n"
                               "layers=-1,-2\n[convolutional]\nfilters = 2\nsize=1\n"),
            20 + 4 * ((3 * 4 * 9 + 16) + (4 * 9 + 4) + (8 * 2 + 2)));
  for (const char* text :
       {"", "hello", "[convolutional]\n", "[net]\n[transformer]\n", "[net]\n[route]\nlayers=-1\n",
        "[net]\n[convolutional]\nfilters=-1\n", "[net]\n[convolutional]\nfilters=9999999999999\n",
        "[net]\n[convolutional]\nfilters=2\ngroups=2\n"}) {
    EXPECT_FALSE(DarknetWeightBytes(text)) << text;
  }
}

// Sizes of the official files as published with them.
TEST(DarknetWeightBytes, PublishedNetworks) {
  const fs::path models = DataFolder() / "models";
  if (!fs::exists(models)) GTEST_SKIP() << "SKIPPED: no models under V2VOUCH_DATA";
  for (const auto& [name, bytes] : {std::pair{"yolov4.cfg", 257'717'640},
                                    {"yolov4-tiny.cfg", 24'251'276},
                                    {"yolo-fastest-1.1.cfg", 1'384'268},
                                    {"yolo-fastest-1.1-xl.cfg", 3'693'964}}) {
    EXPECT_EQ(DarknetWeightBytes(ReadAll(models / name)), bytes) << name;
  }
}

TEST(Network, FilesThatCannotBeUsedAreNamed) {
  const TemporaryFolder folder;
  DetectorConfig config;
  config.input_width_px = config.input_height_px = 32;
  config.model = "/nowhere/yolov4.weights";
  EXPECT_THAT(ProblemsOf(config),
              ElementsAre(HasSubstr("detector.model: /nowhere/yolov4.weights: no such file"),
                          HasSubstr("detector.network: /nowhere/yolov4.cfg: no such file")));
  config.model = folder.Write("net.pb", "x");
  EXPECT_THAT(ProblemsOf(config), ElementsAre(HasSubstr("must end in .weights or .onnx")));
  config.model = folder.Write("net.weights", std::string(35, '\0'));
  folder.Write("net.cfg", kSmallCfg);
  EXPECT_THAT(ProblemsOf(config),
              ElementsAre(testing::AllOf(HasSubstr("has 35 bytes"), HasSubstr("need 36"))));
  folder.Write("net.weights", std::string(36, '\0'));
  EXPECT_THAT(ProblemsOf(config), ElementsAre(HasSubstr("cannot be used at 32 x 32")));
  config.model = folder.Write("net.onnx", "no protobuf at all");
  EXPECT_THAT(ProblemsOf(config), ElementsAre(HasSubstr("cannot be used at 32 x 32")));
  config.input_width_px = 50;
  EXPECT_THAT(ProblemsOf(config), ElementsAre(HasSubstr("must be multiples of 32")));
}

TEST(Network, OnnxOfYoloxShapeSeesWhiteCells) {
  const TemporaryFolder folder;
  DetectorConfig config;
  config.input_width_px = 128;
  config.input_height_px = 64;
  config.fit = PictureFit::kLetterbox;
  config.clahe_clip = 0.0;
  config.refine_bottom = false;
  config.min_score = 0.8;
  config.classes = {{1, ObjectClass::kCar}};
  config.model = folder.Write("tiny.onnx", TinyYolox(128, 64));
  std::vector<std::string> problems;
  const auto detector = NetworkDetector::Load(config, problems);
  ASSERT_NE(detector, nullptr) << testing::PrintToString(problems);
  // Twice the input's width, less than twice its height: the picture is halved, the rest is grey.
  cv::Mat bgr(100, 256, CV_8UC3, cv::Scalar::all(0));
  bgr(cv::Rect(96, 32, 16, 16)).setTo(cv::Scalar::all(255));  // One cell of stride 8.
  const auto boxes = detector->Look(bgr);
  ASSERT_EQ(boxes.size(), 1u);
  EXPECT_NEAR(boxes[0].left_px, 96.0, 0.01);
  EXPECT_NEAR(boxes[0].top_px, 32.0, 0.01);
  EXPECT_NEAR(boxes[0].width_px, 16.0, 0.01);
  EXPECT_NEAR(boxes[0].height_px, 16.0, 0.01);
  EXPECT_NEAR(boxes[0].score, 0.9, 0.01);
  config.input_width_px = 96;  // The file's own size is another one.
  EXPECT_FALSE(ProblemsOf(config).empty());
}

class RealNetwork : public testing::Test {
 protected:
  void SetUp() override {
    data_ = DataFolder();
    if (!fs::exists(data_ / "models")) GTEST_SKIP() << "SKIPPED: no models under V2VOUCH_DATA";
    config_.model = (data_ / "models/yolo-fastest-1.1-xl.weights").string();
    config_.input_width_px = config_.input_height_px = 320;
    detector_ = NetworkDetector::Load(config_, problems_);
    ASSERT_NE(detector_, nullptr) << testing::PrintToString(problems_);
  }
  fs::path data_;
  DetectorConfig config_;
  std::vector<std::string> problems_;
  std::unique_ptr<NetworkDetector> detector_;
};

// The well-known picture: a bicycle in front, a pick-up truck behind it at the upper right, and a
// dog that is none of our classes.
TEST_F(RealNetwork, SeesBicycleAndTruckOfTheKnownPicture) {
  CameraImage image;
  image.encoding = ImageEncoding::kJpeg;
  const std::string jpeg = ReadAll(data_ / "images/darknet_dog.jpg");
  image.bytes.assign(jpeg.begin(), jpeg.end());
  image.width_px = 768;
  image.height_px = 576;
  image.seq = 7;
  image.camera = 2;
  const auto detections = detector_->Detect(image);
  ASSERT_TRUE(detections);
  EXPECT_EQ(detections->seq, 7);
  EXPECT_EQ(detections->camera, 2);
  EXPECT_EQ(detections->image_width_px, 768);
  bool has_bicycle = false;
  bool has_truck = false;
  for (const CameraBox& box : detections->boxes) {
    const double x = box.left_px + 0.5 * box.width_px;
    const double y = box.top_px + 0.5 * box.height_px;
    if (box.object_class == ObjectClass::kCyclist) has_bicycle = std::abs(x - 345) < 40;
    if (box.object_class == ObjectClass::kCar || box.object_class == ObjectClass::kTruck) {
      has_truck = has_truck || (std::abs(x - 580) < 40 && std::abs(y - 125) < 30);
    }
    EXPECT_GE(box.left_px, 0.0);
    EXPECT_LE(box.left_px + box.width_px, 768.0);
    EXPECT_LE(box.top_px + box.height_px, 576.0);
  }
  EXPECT_TRUE(has_bicycle);
  EXPECT_TRUE(has_truck);
  image.bytes.pop_back();
  EXPECT_EQ(detector_->Detect(image).reason(), Reason::kBadImage);
}

TEST_F(RealNetwork, TheSamePictureGivesTheSameBoxes) {
  const cv::Mat bgr = cv::imread((data_ / "images/kitti_tracking/0001_000010.png").string());
  const auto once = detector_->Look(bgr);
  const auto again = detector_->Look(bgr);
  ASSERT_FALSE(once.empty());
  ASSERT_EQ(once.size(), again.size());
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_EQ(once[i].left_px, again[i].left_px);
    EXPECT_EQ(once[i].score, again[i].score);
    EXPECT_LE(once[i].score, once[i > 0 ? i - 1 : 0].score);
  }
}

}  // namespace
}  // namespace v2vouch
