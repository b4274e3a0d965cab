// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/rim/view/scene.h"

namespace v2vouch::view {

/// What Foxglove can subscribe: one topic, one schema, JSON.
struct FoxgloveTopic {
  enum class Content {
    kLocal,
    kPriority,
    kSenders,
    kRadar,
    kTruth,
    kTransform,
    kGnss,
    kLog,
    kStatus,
    kPicture,
    kFlatLocal,
    kFlatPriority
  };
  std::string topic;
  std::string schema;  ///< E.g. foxglove.SceneUpdate.
  Content content = Content::kLocal;
  std::size_t camera = 0;  ///< Of a picture.
};

/// All topics of this vehicle. The channel id of the protocol is the position + 1.
std::vector<FoxgloveTopic> FoxgloveTopics(const VehicleConfig& vehicle);

/// Which version of its content the scene has now; 0 = none yet. Of the log: unused.
std::int64_t FoxgloveRevision(const Scene& scene, const FoxgloveTopic& topic);

/// The message of a topic, made by daemon/rim/foxglove.
/// @param clears after a jump: what was shown before is deleted.
std::string FoxgloveMessage(const Scene& scene, const FoxgloveTopic& topic, bool clears);

/// One event as foxglove.Log.
std::string FoxgloveLog(const ViewEvent& event);

}  // namespace v2vouch::view
