// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>

#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/program/command_line.h"
#include "sim/bench/bench.h"
#include "sim/programs/bench_kitti.h"

namespace {

using namespace v2vouch::bench;

using v2vouch::kExitFailed;
using v2vouch::kExitGood;
using v2vouch::kExitUsage;

constexpr const char* kExamples =
    "Examples:\n"
    "  v2vouch-bench-tracker scen_rot_50.csv.gz --json      figures of a recording\n"
    "  v2vouch-bench-tracker --generate 100 --seeds 1-20    twenty recordings of our own traffic\n"
    "  v2vouch-bench-tracker --generate 50 --seeds 7 --rotate 0.6 --out traffic.csv\n"
    "  v2vouch-bench-tracker --kitti det_car label_02 seqmap.train --json  3-D CLEAR, sAMOTA\n"
    "\n"
    "FILE has the columns frame,t,kind,id,x,y,v,yaw,yaw_rate with kind T (truth) or D "
    "(detection);\n"
    "metres, seconds, radians. Times are of predict + associate + update, one thread.\n"
    "\n"
    "Exit codes: 0 good; 1 the recording cannot be read or written; 2 usage.";

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// "7" or "1-20".
bool ParseSeeds(const std::string& text, std::uint64_t& first, std::uint64_t& last) {
  char rest = 0;
  unsigned long long a = 0, b = 0;
  if (std::sscanf(text.c_str(), "%llu-%llu%c", &a, &b, &rest) == 2) {
    first = a, last = b;
  } else if (std::sscanf(text.c_str(), "%llu%c", &a, &rest) == 1) {
    first = last = a;
  } else {
    return false;
  }
  return first <= last && last - first < 100'000;
}

void PrintJson(const BenchFigures& f) {
  const nlohmann::ordered_json out = {{"gospa_mean", f.gospa_mean()},
                                      {"rmse_m", f.rmse_m()},
                                      {"false_tracks", f.false_tracks},
                                      {"switches", f.switches},
                                      {"ms_mean", f.ms_mean()},
                                      {"ms_p95", f.ms_quantile(0.95)},
                                      {"frames", f.frames},
                                      {"truths", f.truths},
                                      {"missed", f.missed},
                                      {"false_states", f.false_states},
                                      {"detections", f.detections}};
  std::printf("%s\n", out.dump().c_str());
}

std::string OrNone(const char* format, double value) {
  if (!std::isfinite(value)) return "none";
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

void PrintTable(const BenchFigures& f) {
  std::printf("frames scored        %d\n", f.frames);
  std::printf("vehicles per frame   %.1f\n",
              f.frames > 0 ? static_cast<double>(f.truths) / f.frames : 0.0);
  std::printf("detections           %lld\n", static_cast<long long>(f.detections));
  std::printf("GOSPA mean           %s\n", OrNone("%.3f", f.gospa_mean()).c_str());
  std::printf("RMSE                 %s\n", OrNone("%.3f m", f.rmse_m()).c_str());
  std::printf("missed               %lld of %lld\n", static_cast<long long>(f.missed),
              static_cast<long long>(f.truths));
  std::printf("false tracks         %d (%lld states)\n", f.false_tracks,
              static_cast<long long>(f.false_states));
  std::printf("switches             %d\n", f.switches);
  std::printf("step mean, p95       %s, %s\n", OrNone("%.3f ms", f.ms_mean()).c_str(),
              OrNone("%.3f ms", f.ms_quantile(0.95)).c_str());
}

/// What the command line asks for.
struct Request {
  std::string path, out_path, seeds = "1";
  std::uint64_t first_seed = 1, last_seed = 1;  // Of `seeds`.
  BenchSettings settings;
  TrafficSpec traffic;
  KittiRequest kitti;
  double rotate_rad = 0.0;
  bool has_file = false;
};

struct Options {
  CLI::Option* file;
  CLI::Option* generate;
};

Options AddTrafficOptions(CLI::App& app, Request& request) {
  TrafficSpec& traffic = request.traffic;
  BenchSettings& settings = request.settings;
  const auto share = CLI::Range(0.0, 1.0);
  const auto sigma = CLI::Range(1e-6, 1e3);
  auto* file = app.add_option("FILE", request.path, "Recording, CSV or CSV.gz");
  auto* generate =
      app.add_option("--generate", traffic.vehicles, "Make traffic of N vehicles instead")
          ->check(CLI::Range(1, 4000))
          ->excludes(file);
  app.add_option("--seeds", request.seeds, "Of --generate: one, or FIRST-LAST")
      ->capture_default_str();
  app.add_option("--frames", traffic.frames, "Of --generate")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--curvature", traffic.curvature_per_m, "Of the generated road [1/m]")
      ->check(CLI::Range(-0.02, 0.02));
  app.add_option("--rotate", request.rotate_rad, "Turn the whole scene by this [rad]")
      ->check(CLI::Range(-10.0, 10.0));
  app.add_option("--out", request.out_path, "Write the traffic as CSV instead of tracking it");
  app.add_option("--sigma-position", settings.noise.position_m,
                 "Noise of detections [m], each axis")
      ->check(sigma)
      ->capture_default_str();
  app.add_option("--sigma-speed", settings.noise.speed_mps, "[m/s]")
      ->check(sigma)
      ->capture_default_str();
  app.add_option("--sigma-yaw", settings.noise.yaw_rad, "[rad]")
      ->check(sigma)
      ->capture_default_str();
  app.add_option("--sigma-yaw-rate", settings.noise.yaw_rate_radps, "[rad/s]")
      ->check(sigma)
      ->capture_default_str();
  app.add_option("--clutter", settings.clutter_share, "Share of false detections")
      ->check(CLI::Range(1e-6, 1.0))
      ->capture_default_str();
  app.add_option("--detection-probability", settings.detection_probability, "")
      ->check(share)
      ->capture_default_str();
  app.add_option("--confirm-existence", settings.confirm_existence, "A track counts from here on")
      ->check(CLI::Range(0.01, 0.99999))
      ->capture_default_str();
  app.add_option("--cutoff", settings.cutoff_m, "GOSPA cutoff c [m]")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  app.add_option("--skip", settings.skipped_frames, "Frames not scored at the beginning")
      ->check(CLI::Range(0, 100000))
      ->capture_default_str();
  return {file, generate};
}

CLI::Option* AddKittiOptions(CLI::App& app, const Options& others, KittiRequest& kitti) {
  auto* kitti_option =
      app.add_option("--kitti", kitti.paths,
                     "DET LABEL SEQMAP: 3-D detections (AB3DMOT's columns), labels, sequences")
          ->expected(3)
          ->excludes(others.file)
          ->excludes(others.generate);
  app.add_option("--poses", kitti.poses,
                 "Of --kitti: folder of NNNN.txt with camera poses, 12 numbers a frame; without it "
                 "the motion is that of labels that stand still")
      ->needs(kitti_option);
  app.add_option("--iou", kitti.iou, "Of --kitti: least 3-D IoU of a hit")
      ->check(CLI::Range(0.01, 0.99))
      ->capture_default_str();
  app.add_option("--tracks", kitti.tracks, "Of --kitti: folder to write the tracks to")
      ->needs(kitti_option);
  return kitti_option;
}

int Fail(const std::string& error) {
  std::fprintf(stderr, "v2vouch-bench-tracker: %s\n", error.c_str());
  return kExitFailed;
}

// The recording that the request names or, for this seed, has generated.
std::optional<Recording> RecordingOf(Request& request, std::uint64_t seed, std::string& error) {
  std::optional<Recording> recording;
  if (request.has_file) {
    recording = ReadRecording(request.path, error);
  } else {
    request.traffic.seed = seed;
    request.traffic.noise = request.settings.noise;
    request.traffic.clutter_share = request.settings.clutter_share;
    request.traffic.detection_probability = request.settings.detection_probability;
    recording = GenerateTraffic(request.traffic);
  }
  if (recording && request.rotate_rad != 0.0) recording = Rotated(*recording, request.rotate_rad);
  return recording;
}

int RunSeeds(Request& request, bool as_json) {
  const std::uint64_t first = request.first_seed;
  const std::uint64_t last = request.has_file ? first : request.last_seed;
  std::string error;
  BenchFigures total;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const auto recording = RecordingOf(request, seed, error);
    if (!recording) return Fail(error);
    if (!request.out_path.empty()) {
      const bool is_written =
          WriteRecording(*recording, request.out_path, error, std::span(&request.path, 1));
      return is_written ? kExitGood : Fail(error);
    }
    total.Add(RunBench(*recording, request.settings, Now));
    if (last > first && isatty(STDERR_FILENO) != 0) {
      std::fprintf(stderr, "\rseed %llu of %llu-%llu%s", static_cast<unsigned long long>(seed),
                   static_cast<unsigned long long>(first), static_cast<unsigned long long>(last),
                   seed == last ? "\n" : "");
    }
  }
  as_json ? PrintJson(total) : PrintTable(total);
  if (total.frames > 0) return kExitGood;
  return Fail("no frame is scored: the recording has at most the " +
              std::to_string(request.settings.skipped_frames) + " that --skip leaves out");
}

}  // namespace

int main(int argc, char** argv) {
  v2vouch::GuardStandardStreams("v2vouch-bench-tracker");
  CLI::App app("Runs the tracker core over recorded or generated detections: accuracy and time.");
  app.footer(kExamples);
  Request request;
  std::string lcm_url;
  bool as_json = false;
  const Options options = AddTrafficOptions(app, request);
  const CLI::Option* const kitti = AddKittiOptions(app, options, request.kitti);
  app.add_flag("--json", as_json, "Figures as JSON on standard output");
  app.add_option("-l,--lcm-url", lcm_url, "Accepted for uniformity; needs no network")
      ->check(v2vouch::CheckLcmUrl);
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-bench-tracker", argc, argv)) {
    return *code;
  }
  if (kitti->count() > 0) {
    request.kitti.as_json = as_json;
    return RunKitti(request.kitti);
  }
  request.has_file = options.file->count() > 0;
  if (options.file->count() + options.generate->count() != 1) {
    std::fprintf(stderr, "v2vouch-bench-tracker: give FILE, --generate N or --kitti\n");
    return kExitUsage;
  }
  const bool writes = !request.out_path.empty();
  if (!ParseSeeds(request.seeds, request.first_seed, request.last_seed) ||
      (writes && request.first_seed != request.last_seed)) {
    std::fprintf(stderr, "v2vouch-bench-tracker: --seeds = %s: a number or FIRST-LAST%s\n",
                 request.seeds.c_str(), writes ? "; with --out one number" : "");
    return kExitUsage;
  }
  return RunSeeds(request, as_json);
}
