// SPDX-License-Identifier: Apache-2.0
// v2vouch-detect: the camera network on picture files, or on the pictures of a log.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>

#include "daemon/common/base/did_you_mean.h"
#include "daemon/detector/network_detector.h"
#include "daemon/programs/detect/detect_log.h"
#include "daemon/programs/detect/detect_report.h"
#include "daemon/programs/detect/picture_file.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/program/command_line.h"

namespace {

namespace fs = std::filesystem;
using namespace v2vouch;

constexpr char kExamples[] = R"(
Examples:
  v2vouch-detect street.jpg --model yolov4-tiny.weights --draw seen/
  v2vouch-detect *.png --config vehicle.yaml --json > boxes.json
  v2vouch-detect --truth labels.csv --config vehicle.yaml --degrade dark
      recall and precision on labelled pictures; columns image (beside the table), type, occluded,
      left, top, right, bottom
  v2vouch-detect --log drive.lcm --config vehicle.yaml --out detected.lcm
      what the network sees in a log's pictures, for v2vouch-replay

The network is that of `detector` in the configuration; --model, --network, --input and --min-score
come before it. Official YOLOv4 weights: scripts/fetch_yolov4.

Exit codes: 0 good; 1 a picture, log or table cannot be read, or a file not written; 2 usage or
configuration (a network that cannot be loaded included).)";

struct Options {
  std::vector<std::string> images;
  std::string config_path, model, network, input, draw_folder, truth_path, log, out;
  std::string degrade = "none";
  double min_score = 0.0;
  bool as_json = false;
};

int Complain(const std::string& what, int code) {
  std::cerr << "v2vouch-detect: " << what << '\n';
  return code;
}

bool ShowProgress(double share) {
  if (isatty(STDERR_FILENO) == 1) std::fprintf(stderr, "\rlooking %3.0f %%", 100.0 * share);
  return true;
}

// What the command line says goes before the file.
bool Configure(const Options& options, DaemonConfig& config, std::vector<std::string>& problems) {
  LoadDaemonConfig(options.config_path, config, problems);
  DetectorConfig& detector = config.detector;
  if (!options.model.empty()) {
    detector.model = options.model;
    detector.network.clear();
  }
  if (!options.network.empty()) detector.network = options.network;
  if (options.min_score > 0.0) detector.min_score = options.min_score;
  if (!options.input.empty()) {
    int used = 0;
    const int count = std::sscanf(options.input.c_str(), "%4dx%4d%n", &detector.input_width_px,
                                  &detector.input_height_px, &used);
    if (count != 2 || static_cast<std::size_t>(used) != options.input.size() ||
        detector.input_width_px < 32 || detector.input_height_px < 32) {
      problems.push_back("--input " + options.input + ": must be WIDTHxHEIGHT, 32 or more each");
    }
  }
  if (detector.model.empty()) {
    problems.push_back("no network: name one in detector.model of the configuration or by --model");
  }
  return problems.empty();
}

int LookAtFiles(const Options& options, NetworkDetector& detector) {
  TruthTable truth;
  std::string error;
  std::vector<std::string> images = options.images;
  const fs::path folder = fs::path(options.truth_path).parent_path();
  if (!options.truth_path.empty()) {
    if (!ReadTruth(options.truth_path, truth, error)) return Complain(error, kExitFailed);
    if (images.empty()) {
      for (const auto& [image, boxes] : truth) images.push_back((folder / image).string());
    }
  }
  std::vector<PictureReport> reports;
  std::optional<FindScore> score;
  for (const std::string& image : images) {
    ShowProgress(static_cast<double>(reports.size()) / static_cast<double>(images.size()));
    const cv::Mat picture = ReadPicture(image, error);
    if (picture.empty()) return Complain(error, kExitFailed);
    const cv::Mat bgr = Degraded(picture, options.degrade);
    const auto started = std::chrono::steady_clock::now();
    PictureReport report{image, 0.0, detector.Look(bgr)};
    report.ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - started)
            .count();
    if (!options.truth_path.empty()) {
      auto found = truth.find(fs::path(image).lexically_relative(folder).string());
      if (found == truth.end()) found = truth.find(image);
      if (found == truth.end()) {
        return Complain(image + ": has no row in " + options.truth_path, kExitFailed);
      }
      if (!score) score.emplace();
      AddScore(report.boxes, found->second, *score);
    }
    if (!options.draw_folder.empty()) {
      const fs::path file =
          fs::path(options.draw_folder) / fs::path(image).filename().replace_extension(".png");
      if (!WriteAnnotated(file.string(), bgr, report.boxes, images, error)) {
        return Complain(error, kExitFailed);
      }
    }
    reports.push_back(std::move(report));
  }
  if (isatty(STDERR_FILENO) == 1) std::fprintf(stderr, "\r\033[K");
  std::cout << (options.as_json ? JsonReport(reports, score) : TextReport(reports, score));
  return 0;
}

// What is wrong with a log of which no picture was looked at; "" where one was.
std::string WhyNothingSeen(const DetectLogResult& result, const DaemonConfig& config) {
  std::vector<std::string> cameras;
  for (const CameraConfig& camera : config.perception.vehicle.cameras) {
    if (camera.source != CameraSource::kImage) continue;
    cameras.push_back(config.lcm.channels.camera_prefix + camera.name +
                      config.lcm.channels.image_suffix);
  }
  if (result.pictures == 0) {
    std::string why = "holds no picture on " + Listed(cameras);
    for (const std::string& channel : result.unknown_pictures) {
      why += "; pictures on " + channel + " belong to no camera with source: image" +
             DidYouMean(channel, cameras);
    }
    return why;
  }
  std::uint64_t refused = 0;
  std::vector<std::string> reasons;
  for (std::size_t i = 0; i < kReasonCount; ++i) {
    refused += result.refused[i];
    if (result.refused[i] == 0) continue;
    reasons.push_back(std::string(ReasonName(static_cast<Reason>(i))) + " " +
                      std::to_string(result.refused[i]));
  }
  if (refused < static_cast<std::uint64_t>(result.pictures)) return "";
  return "none of its " + std::to_string(result.pictures) +
         " pictures could be looked at: " + Listed(reasons) +
         " (are image_width_px and image_height_px those of the camera?)";
}

int LookAtLog(const Options& options, const DaemonConfig& config, NetworkDetector& detector) {
  DetectLogResult result;
  std::string error;
  if (!DetectLog(options.log, options.out, config, detector, ShowProgress, result, error)) {
    return Complain(error, kExitFailed);
  }
  if (isatty(STDERR_FILENO) == 1) std::fprintf(stderr, "\r\033[K");
  NoteDamage("v2vouch-detect", options.log, result.damaged);
  std::cout << LogReport(result, options.as_json);
  const std::string why = WhyNothingSeen(result, config);
  return why.empty() ? 0 : Complain(options.log + ": " + why, kExitFailed);
}

int Run(const Options& options) {
  const bool has_pictures = !options.images.empty() || !options.truth_path.empty();
  if (has_pictures == !options.log.empty()) {
    return Complain("wants pictures, --truth or --log; see --help", kExitUsage);
  }
  if (options.log.empty() != options.out.empty()) {
    return Complain("--log and --out go together", kExitUsage);
  }
  DaemonConfig config;
  std::vector<std::string> problems;
  std::unique_ptr<NetworkDetector> detector;
  if (Configure(options, config, problems)) {
    detector = NetworkDetector::Load(config.detector, problems);
  }
  const auto& cameras = config.perception.vehicle.cameras;
  if (!options.log.empty() && std::ranges::none_of(cameras, [](const CameraConfig& camera) {
        return camera.source == CameraSource::kImage;
      })) {
    std::string names;
    for (const CameraConfig& camera : cameras) names += (names.empty() ? "" : ", ") + camera.name;
    problems.push_back("--log: no camera of the vehicle has source: image" +
                       (names.empty() ? " (it has no camera)" : " (it has " + names + ")") +
                       ", so no picture would be looked at");
    detector.reset();
  }
  for (const std::string& problem : problems) Complain(problem, kExitUsage);
  if (!detector) return kExitUsage;
  if (!options.draw_folder.empty()) {
    std::error_code failed;
    fs::create_directories(options.draw_folder, failed);
    if (failed) return Complain(options.draw_folder + ": " + failed.message(), kExitFailed);
  }
  return options.log.empty() ? LookAtFiles(options, *detector)
                             : LookAtLog(options, config, *detector);
}

}  // namespace

int main(int argc, char** argv) {
  GuardStandardStreams("v2vouch-detect");
  Options options;
  std::string lcm_url;
  CLI::App app("Runs the camera network on picture files, or on the pictures of a log.");
  app.footer(kExamples);
  app.add_option("IMAGE", options.images, "Picture files");
  app.add_option("--config", options.config_path, "Vehicle description with its detector");
  app.add_option("--model", options.model, "Network: FILE.weights or FILE.onnx");
  app.add_option("--network", options.network, "Darknet .cfg (default: the model's name)");
  app.add_option("--input", options.input, "Input of the network, e.g. 960x320");
  app.add_option("--min-score", options.min_score, "Weakest box told")
      ->check(CLI::Range(0.01, 1.0));
  app.add_option("--draw", options.draw_folder, "Folder for the pictures with boxes drawn in");
  app.add_option("--truth", options.truth_path, "Table of labelled boxes to score against");
  app.add_option("--degrade", options.degrade, "Look at worse copies of the pictures")
      ->check(OneOf({"none", "dark", "flat", "noisy"}))
      ->capture_default_str();
  app.add_option("--log", options.log, "LCM log whose pictures are looked at");
  app.add_option("--out", options.out, "With --log: the log to write");
  app.add_flag("--json", options.as_json, "Print as JSON");
  app.add_option("-l,--lcm-url", lcm_url, "Taken like every program's; no socket is opened")
      ->check(CheckLcmUrl);
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-detect", argc, argv)) return *code;
  try {
    return Run(options);
  } catch (const std::exception& error) {
    return Complain(error.what(), kExitFailed);
  }
}
