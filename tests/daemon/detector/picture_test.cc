// SPDX-License-Identifier: Apache-2.0
#include "daemon/detector/picture.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace v2vouch {
namespace {

CameraImage Image(const cv::Mat& picture, ImageEncoding encoding) {
  CameraImage image;
  image.width_px = picture.cols;
  image.height_px = picture.rows;
  image.encoding = encoding;
  if (encoding == ImageEncoding::kJpeg) {
    cv::imencode(".jpg", picture, image.bytes, {cv::IMWRITE_JPEG_QUALITY, 100});
  } else {
    image.bytes.assign(picture.data, picture.data + picture.total() * picture.elemSize());
  }
  return image;
}

TEST(DecodePicture, RawPicturesComeOutAsTheyAre) {
  cv::Mat bgr(6, 10, CV_8UC3);
  cv::randu(bgr, 0, 255);
  EXPECT_EQ(cv::norm(*DecodePicture(Image(bgr, ImageEncoding::kBgr8)), bgr, cv::NORM_INF), 0.0);
  cv::Mat grey;
  cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  const auto decoded = DecodePicture(Image(grey, ImageEncoding::kMono8));
  ASSERT_TRUE(decoded);
  cv::Mat back;
  cv::extractChannel(*decoded, back, 2);
  EXPECT_EQ(cv::norm(back, grey, cv::NORM_INF), 0.0);
}

TEST(DecodePicture, JpegKeepsColoursInOrder) {
  const cv::Mat blue(16, 24, CV_8UC3, cv::Scalar(200, 40, 20));
  const auto decoded = DecodePicture(Image(blue, ImageEncoding::kJpeg));
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->size(), blue.size());
  EXPECT_LT(cv::norm(*decoded, blue, cv::NORM_INF), 6.0);
}

TEST(DecodePicture, SizesThatDisagreeAreRefused) {
  const cv::Mat picture(16, 24, CV_8UC3, cv::Scalar::all(90));
  for (const auto encoding : {ImageEncoding::kJpeg, ImageEncoding::kBgr8, ImageEncoding::kMono8}) {
    CameraImage image = Image(picture, encoding);
    image.width_px = 25;
    const auto decoded = DecodePicture(image);
    ASSERT_FALSE(decoded);
    EXPECT_EQ(decoded.reason(), Reason::kBadImage);
  }
  CameraImage nothing;
  EXPECT_FALSE(DecodePicture(nothing));
}

TEST(DecodePicture, FilesThatAreNoWholeJpegAreRefused) {
  CameraImage image = Image(cv::Mat(16, 24, CV_8UC3, cv::Scalar::all(90)), ImageEncoding::kJpeg);
  CameraImage cut = image;
  cut.bytes.resize(cut.bytes.size() / 2);
  EXPECT_FALSE(DecodePicture(cut));
  CameraImage png = image;
  cv::imencode(".png", cv::Mat(16, 24, CV_8UC3), png.bytes);
  EXPECT_FALSE(DecodePicture(png));
  CameraImage empty = image;
  empty.bytes.clear();
  EXPECT_FALSE(DecodePicture(empty));
}

double SpreadOf(const cv::Mat& bgr) {
  cv::Mat grey;
  cv::cvtColor(bgr, grey, cv::COLOR_BGR2GRAY);
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(grey, mean, deviation);
  return deviation[0];
}

TEST(Enhance, NothingAskedNothingDone) {
  cv::Mat bgr(32, 32, CV_8UC3);
  cv::randu(bgr, 0, 255);
  DetectorConfig config;
  config.clahe_clip = 0.0;
  EXPECT_EQ(cv::norm(Enhance(bgr, config), bgr, cv::NORM_INF), 0.0);
}

TEST(Enhance, EqualisationSpreadsAFlatPicture) {
  cv::Mat bgr(64, 64, CV_8UC3);
  cv::randu(bgr, 110, 130);
  DetectorConfig config;
  config.clahe_clip = 4.0;
  EXPECT_GT(SpreadOf(Enhance(bgr, config)), 1.5 * SpreadOf(bgr));
}

TEST(Enhance, EdgesGrowAndFlatPlacesStay) {
  cv::Mat bgr(40, 40, CV_8UC3, cv::Scalar::all(100));
  bgr.colRange(20, 40).setTo(cv::Scalar::all(150));
  DetectorConfig config;
  config.clahe_clip = 0.0;
  config.edge_gain = 1.0;
  const cv::Mat out = Enhance(bgr, config);
  EXPECT_NEAR(out.at<cv::Vec3b>(20, 2)[1], 100, 2);
  EXPECT_GT(out.at<cv::Vec3b>(20, 20)[1], 160);
  EXPECT_LT(out.at<cv::Vec3b>(20, 19)[1], 90);
}

}  // namespace
}  // namespace v2vouch
