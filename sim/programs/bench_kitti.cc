// SPDX-License-Identifier: Apache-2.0
#include "sim/programs/bench_kitti.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "sim/bench/box_bench.h"

namespace v2vouch::bench {
namespace {

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Shares as per cent, as the published tables have them.
double PerCent(double share) { return 100.0 * share; }

void PrintJson(double iou, const Clear3dFigures& f, const BoxRun& run) {
  const ClearCounts& best = f.best;
  const nlohmann::ordered_json out = {{"iou", iou},
                                      {"samota", PerCent(f.samota)},
                                      {"amota", PerCent(f.amota)},
                                      {"mota", PerCent(best.mota())},
                                      {"motp", PerCent(best.motp())},
                                      {"ids", best.switches},
                                      {"frag", best.fragments},
                                      {"fp", best.false_boxes},
                                      {"fn", best.misses},
                                      {"gt", best.truths},
                                      {"anees", best.anees()},
                                      {"ms_mean", run.ms_mean()},
                                      {"frames", run.step_ms.size()}};
  std::printf("%s\n", out.dump().c_str());
}

void PrintTable(double iou, const Clear3dFigures& f, const BoxRun& run) {
  const ClearCounts& best = f.best;
  std::printf("3-D IoU              %.2f\n", iou);
  std::printf("sAMOTA, AMOTA        %.2f, %.2f %%\n", PerCent(f.samota), PerCent(f.amota));
  std::printf("MOTA, MOTP           %.2f, %.2f %%\n", PerCent(best.mota()), PerCent(best.motp()));
  std::printf("switches, fragments  %d, %d\n", best.switches, best.fragments);
  std::printf("false, missed        %d, %d of %d\n", best.false_boxes, best.misses, best.truths);
  std::printf("ANEES of position    %.2f\n", best.anees());
  std::printf("step mean            %.3f ms, %zu frames\n", run.ms_mean(), run.step_ms.size());
}

}  // namespace

int RunKitti(const KittiRequest& request) {
  std::string error;
  const auto sequences =
      ReadKittiBoxes(request.paths[0], request.paths[1], request.paths[2], request.poses, error);
  if (!sequences) {
    std::fprintf(stderr, "v2vouch-bench-tracker: %s\n", error.c_str());
    return 1;
  }
  const BoxRun run = TrackBoxes(*sequences, BoxSettings{}, Now);
  if (!request.tracks.empty() &&
      !WriteKittiTracks(*sequences, run.sequences, request.tracks, error)) {
    std::fprintf(stderr, "v2vouch-bench-tracker: %s\n", error.c_str());
    return 1;
  }
  const Clear3dFigures figures = EvaluateClear3d(run.sequences, request.iou);
  request.as_json ? PrintJson(request.iou, figures, run) : PrintTable(request.iou, figures, run);
  if (figures.best.truths > 0) return 0;
  std::fprintf(stderr, "v2vouch-bench-tracker: the labels hold no car to be found\n");
  return 1;
}

}  // namespace v2vouch::bench
