// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "daemon/common/base/visit.h"

namespace v2vouch::wire {

/// Channel names; a radar speaks on `radar_prefix` + NAME, a source of objects on `objects_prefix`
/// + NAME, a camera on `camera_prefix` + NAME with nothing, `image_suffix` or `detected_suffix`
/// behind, as its `source` says.
struct ChannelNames {
  std::string radar_prefix = "RADAR_";
  std::string camera_prefix = "CAMERA_";
  std::string objects_prefix = "OBJECTS_";
  std::string image_suffix = "_IMAGE";
  std::string detected_suffix = "_DETECTED";
  std::string ego_motion = "EGO_MOTION";
  std::string ego_gnss = "EGO_GNSS";
  std::string bsm = "BSM";
  std::string own_bsm = "OWN_BSM";
  std::string tracks_local = "TRACKS_LOCAL";
  std::string tracks_priority = "TRACKS_PRIORITY";
  std::string tracks_v2v = "TRACKS_V2V";
  std::string calibration = "CALIBRATION";
  std::string misbehavior = "MISBEHAVIOR";
  std::string bsm_verdict = "BSM_VERDICT";
  std::string status = "V2VOUCH_STATUS";
  std::string config = "V2VOUCH_CONFIG";

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("radar_prefix", radar_prefix);
    a.Text("camera_prefix", camera_prefix);
    a.Text("objects_prefix", objects_prefix);
    a.Text("image_suffix", image_suffix);
    a.Text("detected_suffix", detected_suffix);
    a.Text("ego_motion", ego_motion);
    a.Text("ego_gnss", ego_gnss);
    a.Text("bsm", bsm);
    a.Text("own_bsm", own_bsm);
    a.Text("tracks_local", tracks_local);
    a.Text("tracks_priority", tracks_priority);
    a.Text("tracks_v2v", tracks_v2v);
    a.Text("calibration", calibration);
    a.Text("misbehavior", misbehavior);
    a.Text("bsm_verdict", bsm_verdict);
    a.Text("status", status);
    a.Text("config", config);
  }
};

}  // namespace v2vouch::wire
