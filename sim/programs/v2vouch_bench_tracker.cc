// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/program/command_line.h"
#include "sim/bench/bench.h"
#include "sim/programs/bench_kitti.h"

namespace {

using namespace v2vouch::bench;

constexpr int kGood = 0;
constexpr int kFailed = 1;
constexpr int kUsage = 2;

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

}  // namespace

int main(int argc, char** argv) {
  v2vouch::GuardStandardStreams("v2vouch-bench-tracker");
  CLI::App app("Runs the tracker core over recorded or generated detections: accuracy and time.");
  app.footer(kExamples);
  std::string path, out_path, seeds = "1", lcm_url;
  BenchSettings settings;
  TrafficSpec traffic;
  double rotate_rad = 0.0;
  bool as_json = false;
  const auto share = CLI::Range(0.0, 1.0);
  const auto sigma = CLI::Range(1e-6, 1e3);
  auto* file = app.add_option("FILE", path, "Recording, CSV or CSV.gz");
  auto* generate =
      app.add_option("--generate", traffic.vehicles, "Make traffic of N vehicles instead")
          ->check(CLI::Range(1, 4000))
          ->excludes(file);
  app.add_option("--seeds", seeds, "Of --generate: one, or FIRST-LAST")->capture_default_str();
  app.add_option("--frames", traffic.frames, "Of --generate")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--curvature", traffic.curvature_per_m, "Of the generated road [1/m]")
      ->check(CLI::Range(-0.02, 0.02));
  app.add_option("--rotate", rotate_rad, "Turn the whole scene by this [rad]")
      ->check(CLI::Range(-10.0, 10.0));
  app.add_option("--out", out_path, "Write the traffic as CSV instead of tracking it");
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
  KittiRequest kitti;
  auto* kitti_option =
      app.add_option("--kitti", kitti.paths,
                     "DET LABEL SEQMAP: 3-D detections (AB3DMOT's columns), labels, sequences")
          ->expected(3)
          ->excludes(file)
          ->excludes(generate);
  app.add_option("--poses", kitti.poses,
                 "Of --kitti: folder of NNNN.txt with camera poses, 12 numbers a frame; without it "
                 "the motion is that of labels that stand still")
      ->needs(kitti_option);
  app.add_option("--iou", kitti.iou, "Of --kitti: least 3-D IoU of a hit")
      ->check(CLI::Range(0.01, 0.99))
      ->capture_default_str();
  app.add_option("--tracks", kitti.tracks, "Of --kitti: folder to write the tracks to")
      ->needs(kitti_option);
  app.add_flag("--json", as_json, "Figures as JSON on standard output");
  app.add_option("-l,--lcm-url", lcm_url, "Accepted for uniformity; needs no network")
      ->check(v2vouch::CheckLcmUrl);
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-bench-tracker", argc, argv)) {
    return *code;
  }
  if (kitti_option->count() > 0) {
    kitti.as_json = as_json;
    return RunKitti(kitti);
  }
  if (file->count() + generate->count() != 1) {
    std::fprintf(stderr, "v2vouch-bench-tracker: give FILE, --generate N or --kitti\n");
    return kUsage;
  }
  std::uint64_t first = 1, last = 1;
  if (!ParseSeeds(seeds, first, last) || (!out_path.empty() && first != last)) {
    std::fprintf(stderr, "v2vouch-bench-tracker: --seeds = %s: a number or FIRST-LAST%s\n",
                 seeds.c_str(), out_path.empty() ? "" : "; with --out one number");
    return kUsage;
  }

  std::string error;
  BenchFigures total;
  if (file->count() > 0) last = first;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    Recording recording;
    if (file->count() > 0) {
      const auto read = ReadRecording(path, error);
      if (!read) {
        std::fprintf(stderr, "v2vouch-bench-tracker: %s\n", error.c_str());
        return kFailed;
      }
      recording = *read;
    } else {
      traffic.seed = seed;
      traffic.noise = settings.noise;
      traffic.clutter_share = settings.clutter_share;
      traffic.detection_probability = settings.detection_probability;
      recording = GenerateTraffic(traffic);
    }
    if (rotate_rad != 0.0) recording = Rotated(recording, rotate_rad);
    if (!out_path.empty()) {
      if (WriteRecording(recording, out_path, error, std::span(&path, 1))) return kGood;
      std::fprintf(stderr, "v2vouch-bench-tracker: %s\n", error.c_str());
      return kFailed;
    }
    total.Add(RunBench(recording, settings, Now));
    if (last > first && isatty(STDERR_FILENO) != 0) {
      std::fprintf(stderr, "\rseed %llu of %llu-%llu%s", static_cast<unsigned long long>(seed),
                   static_cast<unsigned long long>(first), static_cast<unsigned long long>(last),
                   seed == last ? "\n" : "");
    }
  }
  as_json ? PrintJson(total) : PrintTable(total);
  if (total.frames == 0) {
    std::fprintf(stderr,
                 "v2vouch-bench-tracker: no frame is scored: the recording has at most the %d that "
                 "--skip leaves out\n",
                 settings.skipped_frames);
    return kFailed;
  }
  return kGood;
}
