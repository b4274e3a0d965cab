// SPDX-License-Identifier: Apache-2.0
#include "sim/annotation/drawing.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "sim/annotation/projection.h"

namespace v2vouch::sim {
namespace {

const cv::Scalar kBoxColour(255, 255, 255);
const cv::Scalar kLocalColour(90, 230, 90);
const cv::Scalar kPriorityColour(255, 80, 255);
const cv::Scalar kShade(0, 0, 0);

void Label(cv::Mat& picture, const cv::Point& at, const std::string& text,
           const cv::Scalar& colour) {
  constexpr double kSize = 0.42;
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, kSize, kShade, 3, cv::LINE_AA);
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, kSize, colour, 1, cv::LINE_AA);
}

double UsualHeight_m(int object_class) {
  switch (object_class) {
    case track_t::CLASS_TRUCK:
    case track_t::CLASS_BUS:
      return 3.2;
    case track_t::CLASS_VAN:
      return 2.1;
    case track_t::CLASS_PEDESTRIAN:
    case track_t::CLASS_CYCLIST:
      return 1.75;
    default:
      return 1.5;
  }
}

// Corners in the picture: four of the footprint, then the four above them.
std::optional<std::array<cv::Point, 8>> Corners(const track_t& track, const CameraConfig& camera) {
  std::array<cv::Point, 8> corners;
  const double c = std::cos(track.yaw_body_rad);
  const double s = std::sin(track.yaw_body_rad);
  for (std::size_t i = 0; i < 8; ++i) {
    const double along = 0.5 * track.length_m * ((i % 4 == 0 || i % 4 == 3) ? 1.0 : -1.0);
    const double across = 0.5 * track.width_m * (i % 4 < 2 ? 1.0 : -1.0);
    const auto pixel = PixelOf(
        camera, {track.x_body_m + c * along - s * across, track.y_body_m + s * along + c * across,
                 i < 4 ? 0.0 : UsualHeight_m(track.object_class)});
    // Far outside, OpenCV's whole numbers end.
    if (!pixel || !(pixel->cwiseAbs().maxCoeff() < 1e5)) return std::nullopt;
    corners[i] = cv::Point(cvRound(pixel->x()), cvRound(pixel->y()));
  }
  return corners;
}

void DrawTrack(const track_t& track, const CameraConfig& camera, const cv::Scalar& colour,
               int thickness, const std::string& label, int line, cv::Mat& picture) {
  const auto corners = Corners(track, camera);
  if (!corners) return;
  const auto edge = [&](std::size_t a, std::size_t b) {
    cv::line(picture, (*corners)[a], (*corners)[b], colour, thickness, cv::LINE_AA);
  };
  for (std::size_t i = 0; i < 4; ++i) {
    edge(i, (i + 1) % 4);
    edge(4 + i, 4 + (i + 1) % 4);
    edge(i, 4 + i);
  }
  const cv::Rect frame = cv::boundingRect(std::vector<cv::Point>(corners->begin(), corners->end()));
  Label(picture, {frame.x, frame.y + frame.height + 13 + 13 * line}, label, colour);
}

// Ids are long; their last four hexadecimal digits tell them apart in one picture.
std::string Name(const char* list, const track_t& track) {
  char text[64];
  std::snprintf(text, sizeof(text), "%s %04x %.0f m", list,
                static_cast<unsigned>(track.id & 0xFFFF),
                std::hypot(track.x_body_m, track.y_body_m));
  return text;
}

}  // namespace

void DrawScene(const Scene& scene, const CameraConfig& camera, const std::string& title,
               cv::Mat& picture) {
  if (scene.boxes != nullptr) {
    for (const camera_box_t& box : scene.boxes->boxes) {
      const cv::Rect2d frame(box.left_px, box.top_px, box.width_px, box.height_px);
      cv::rectangle(picture, frame, kBoxColour, 1);
      char text[64];
      std::snprintf(text, sizeof(text), "%s %.2f", box.class_name.substr(0, 16).c_str(), box.score);
      Label(picture, {cvRound(frame.x), cvRound(frame.y) - 3}, text, kBoxColour);
    }
  }
  if (scene.local != nullptr) {
    for (const track_t& track : scene.local->tracks) {
      DrawTrack(track, camera, kLocalColour, 1, Name("L", track), 0, picture);
    }
  }
  if (scene.priority != nullptr) {
    for (const track_t& track : scene.priority->tracks) {
      const char* const sighting = track.visibility == track_t::HIDDEN        ? " hidden"
                                   : track.visibility == track_t::OUT_OF_VIEW ? " out of view"
                                                                              : "";
      DrawTrack(track, camera, kPriorityColour, 2, Name("P", track) + sighting, 1, picture);
    }
  }
  Label(picture, {6, 14}, title, kBoxColour);
}

cv::Mat EmptyRoad(const CameraConfig& camera) {
  constexpr double kHalfRoad_m = 5.0;
  cv::Mat picture(camera.image_height_px, camera.image_width_px, CV_8UC3, cv::Scalar(50, 45, 40));
  for (const double y_m : {-kHalfRoad_m, kHalfRoad_m}) {
    std::optional<Eigen::Vector2d> before;
    for (double x_m = camera.x_m + 2.0; x_m < 300.0; x_m *= 1.3) {
      const auto pixel = PixelOf(camera, {x_m, y_m, 0.0});
      if (before && pixel) {
        cv::line(picture, cv::Point2d(before->x(), before->y()),
                 cv::Point2d(pixel->x(), pixel->y()), cv::Scalar(110, 110, 110), 1, cv::LINE_AA);
      }
      before = pixel;
    }
  }
  return picture;
}

}  // namespace v2vouch::sim
