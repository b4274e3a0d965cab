// SPDX-License-Identifier: Apache-2.0
#include "sim/bench/kitti_boxes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "daemon/common/base/angle.h"
#include "sim/import/kitti.h"

namespace v2vouch::bench {
namespace {

constexpr double kFramePeriod_s = 0.1;
constexpr double kCamera_x_m = 1.13;  // Ahead of the rear axle: KITTI's set-up page.
constexpr double kCarType = 2.0;      // AB3DMOT's numbers of classes.
constexpr int kMostFrames = 100'000;

// KITTI's camera frame: x right, y down, z forward; rotation 0 faces right.
Box3d FromCamera(double x, double y, double z, double rotation_y, double length, double width,
                 double height) {
  return {.x_m = z,
          .y_m = -x,
          .bottom_m = -y,
          .yaw_rad = WrapAngle(-rotation_y - 0.5 * kPi),
          .length_m = length,
          .width_m = width,
          .height_m = height};
}

// Numbers of each line, commas as blanks; `take` says what is wrong with them or "".
bool ForEachRow(const std::string& path, std::string& error,
                const std::function<std::string(const std::vector<double>&)>& take) {
  std::ifstream file(path);
  if (!file) {
    error = path + ": cannot be read";
    return false;
  }
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::ranges::replace(line, ',', ' ');
    std::istringstream words(line);
    std::vector<double> row;
    double value = 0.0;
    while (words >> value) row.push_back(value);
    std::string problem = words.eof() ? "" : "holds something that is no number";
    if (problem.empty() && !row.empty()) problem = take(row);
    if (problem.empty()) continue;
    error = path;
    error.append(":").append(std::to_string(number)).append(": ").append(problem);
    return false;
  }
  return true;
}

bool ReadDetections(const std::string& path, BoxSequence& sequence, std::string& error) {
  return ForEachRow(path, error, [&](const std::vector<double>& row) -> std::string {
    if (row.size() < 14) return "has fewer than 14 columns";
    if (!std::ranges::all_of(row, [](double v) { return std::isfinite(v); })) {
      return "holds a number that is not finite";
    }
    if (row[0] < 0.0 || row[0] >= static_cast<double>(sequence.frames.size())) {
      return "is of a frame that the sequence does not have";
    }
    if (row[1] != kCarType) return "";
    DetectedBox found;
    found.score = row[6];
    found.pixels = {row[2], row[3], row[4], row[5]};
    found.box = FromCamera(row[10], row[11], row[12], row[13], row[9], row[8], row[7]);
    sequence.frames[static_cast<std::size_t>(row[0])].detections.push_back(found);
    return "";
  });
}

void TakeLabels(const std::vector<sim::KittiLabel>& labels, BoxSequence& sequence) {
  constexpr int kUnknownOcclusion = 3;
  for (const sim::KittiLabel& label : labels) {
    BoxSequence::Frame& frame = sequence.frames[static_cast<std::size_t>(label.frame)];
    if (label.type == "DontCare") {
      frame.regions.push_back({label.left_px, label.top_px, label.right_px, label.bottom_px});
    }
    if (label.type != "Car" && label.type != "Van") continue;
    TruthBox truth;
    truth.id = label.track;
    truth.is_ignored =
        label.type == "Van" || label.truncated > 0.0 || label.occluded >= kUnknownOcclusion;
    truth.box = FromCamera(label.x_m, label.y_m, label.z_m, label.rotation_y_rad, label.length_m,
                           label.width_m, label.height_m);
    frame.truth.push_back(truth);
  }
}

bool ReadPoses(const std::string& path, BoxSequence& sequence, std::string& error) {
  std::size_t k = 0;
  const bool is_read = ForEachRow(path, error, [&](const std::vector<double>& row) -> std::string {
    if (row.size() != 12) return "has other than 12 numbers";
    if (k >= sequence.frames.size()) return "";
    // Rows of [R | t]; the optical axis is R's third column.
    Eigen::Isometry2d& X_OS = sequence.frames[k++].X_OS;
    X_OS = Eigen::Translation2d(row[11], -row[3]) *
           Eigen::Rotation2D<double>(std::atan2(-row[2], row[10]));
    return "";
  });
  if (!is_read || k == sequence.frames.size()) return is_read;
  error = path + ": has fewer poses than the sequence has frames";
  return false;
}

void TakeMotion(const std::vector<sim::KittiLabel>& labels, BoxSequence& sequence) {
  const auto motion = sim::KittiMotionFromLabels(labels, sim::KittiCamera{}, kCamera_x_m);
  Eigen::Isometry2d X_OB = Eigen::Isometry2d::Identity();
  for (std::size_t k = 0; k < sequence.frames.size(); ++k) {
    sequence.frames[k].X_OS = X_OB * Eigen::Translation2d(kCamera_x_m, 0.0);
    if (motion.empty()) continue;
    const sim::KittiMotion& from = motion[std::min(k, motion.size() - 1)];
    const sim::KittiMotion& to = motion[std::min(k + 1, motion.size() - 1)];
    const double way_m = 0.5 * (from.speed_mps + to.speed_mps) * kFramePeriod_s;
    const double turn_rad = 0.5 * (from.yaw_rate_radps + to.yaw_rate_radps) * kFramePeriod_s;
    X_OB = X_OB * Eigen::Rotation2D<double>(0.5 * turn_rad) * Eigen::Translation2d(way_m, 0.0) *
           Eigen::Rotation2D<double>(0.5 * turn_rad);
  }
}

}  // namespace

std::optional<std::vector<BoxSequence>> ReadKittiBoxes(const std::string& detections,
                                                       const std::string& labels,
                                                       const std::string& seqmap,
                                                       const std::string& poses,
                                                       std::string& error) {
  std::ifstream file(seqmap);
  if (!file) {
    error = seqmap + ": cannot be read";
    return std::nullopt;
  }
  std::vector<BoxSequence> sequences;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::istringstream words(line);
    BoxSequence sequence;
    std::string empty;
    int first = 0, frames = 0;
    if (!(words >> sequence.name >> empty >> first >> frames) || frames < 1 ||
        frames > kMostFrames || sequence.name.find('/') != std::string::npos) {
      error = seqmap + ":" + std::to_string(number) + ": is no line of a sequence map";
      return std::nullopt;
    }
    const std::string name = "/" + sequence.name + ".txt";
    std::vector<sim::KittiLabel> labelled;
    if (!sim::ReadKittiLabels(labels + name, labelled, error, true)) return std::nullopt;
    for (const sim::KittiLabel& label : labelled) frames = std::max(frames, label.frame + 1);
    sequence.frames.resize(static_cast<std::size_t>(frames));
    TakeLabels(labelled, sequence);
    if (!ReadDetections(detections + name, sequence, error)) return std::nullopt;
    if (poses.empty()) {
      std::erase_if(labelled, [](const auto& label) { return label.track < 0; });
      TakeMotion(labelled, sequence);
    } else if (!ReadPoses(poses + name, sequence, error)) {
      return std::nullopt;
    }
    sequences.push_back(std::move(sequence));
  }
  if (sequences.empty()) {
    error = seqmap + ": names no sequence";
    return std::nullopt;
  }
  return sequences;
}

bool WriteKittiTracks(const std::vector<BoxSequence>& sequences,
                      const std::vector<EvaluatedSequence>& tracked, const std::string& directory,
                      std::string& error) {
  std::error_code failed;
  std::filesystem::create_directories(directory, failed);
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    const std::string path = directory + "/" + sequences[s].name + ".txt";
    std::ofstream file(path);
    for (std::size_t k = 0; k < tracked[s].size(); ++k) {
      for (const TrackedBox& row : tracked[s][k].tracked) {
        const Box3d& b = row.box;
        std::array<char, 512> text{};
        std::snprintf(text.data(), text.size(),
                      "%zu %llu Car -1 -1 -10 %.4f %.4f %.4f %.4f %.6f %.6f %.6f %.6f %.6f %.6f "
                      "%.6f %.9f\n",
                      k, static_cast<unsigned long long>(row.id), row.pixels.left, row.pixels.top,
                      row.pixels.right, row.pixels.bottom, b.height_m, b.width_m, b.length_m,
                      -b.y_m, -b.bottom_m, b.x_m, WrapAngle(-b.yaw_rad - 0.5 * kPi), row.score);
        file << text.data();
      }
    }
    if (!file.flush()) {
      error = path + ": cannot be written";
      return false;
    }
  }
  return true;
}

}  // namespace v2vouch::bench
