// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace v2vouch::bench {

/// `v2vouch-bench-tracker --kitti DET LABEL SEQMAP`.
struct KittiRequest {
  std::vector<std::string> paths;  ///< DET, LABEL, SEQMAP.
  std::string poses;               ///< Folder of NNNN.txt; empty: motion from standing labels.
  std::string tracks;              ///< Folder to write the tracks to; empty: none.
  double iou = 0.25;
  bool as_json = false;
};

/// Tracks, evaluates and prints. @return the program's exit code.
int RunKitti(const KittiRequest& request);

}  // namespace v2vouch::bench
