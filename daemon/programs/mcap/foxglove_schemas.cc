// SPDX-License-Identifier: Apache-2.0
// The fields of Foxglove's schemas that we fill (github.com/foxglove/foxglove-sdk, schemas, MIT):
// viewers know a schema by its name and take from the text how to read it.
#include "daemon/programs/mcap/foxglove_messages.h"

namespace v2vouch::mcap_export {
namespace {

#define V2VOUCH_TIME \
  R"({"type":"object","properties":{"sec":{"type":"integer"},"nsec":{"type":"integer"}}})"
#define V2VOUCH_XYZ \
  R"({"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":{"type":"number"}}})"
#define V2VOUCH_ROTATION                                                               \
  R"({"type":"object","properties":{"x":{"type":"number"},"y":{"type":"number"},"z":)" \
  R"({"type":"number"},"w":{"type":"number"}}})"
#define V2VOUCH_COLOR                                                                  \
  R"({"type":"object","properties":{"r":{"type":"number"},"g":{"type":"number"},"b":)" \
  R"({"type":"number"},"a":{"type":"number"}}})"
#define V2VOUCH_POSE                                          \
  R"({"type":"object","properties":{"position":)" V2VOUCH_XYZ \
  R"(,"orientation":)" V2VOUCH_ROTATION "}}"

constexpr std::string_view kSceneUpdate =
    R"({"title":"foxglove.SceneUpdate","type":"object","properties":{)"
    R"("deletions":{"type":"array","items":{"type":"object","properties":{"timestamp":)" V2VOUCH_TIME
    R"(,"type":{"type":"integer"},"id":{"type":"string"}}}},)"
    R"("entities":{"type":"array","items":{"type":"object","properties":{"timestamp":)" V2VOUCH_TIME
    R"(,"frame_id":{"type":"string"},"id":{"type":"string"},"lifetime":)" V2VOUCH_TIME
    R"(,"frame_locked":{"type":"boolean"},"metadata":{"type":"array","items":{"type":"object",)"
    R"("properties":{"key":{"type":"string"},"value":{"type":"string"}}}},)"
    R"("arrows":{"type":"array","items":{"type":"object","properties":{"pose":)" V2VOUCH_POSE
    R"(,"shaft_length":{"type":"number"},"shaft_diameter":{"type":"number"},)"
    R"("head_length":{"type":"number"},"head_diameter":{"type":"number"},"color":)" V2VOUCH_COLOR
    R"(}}},"cubes":{"type":"array","items":{"type":"object","properties":{"pose":)" V2VOUCH_POSE
    R"(,"size":)" V2VOUCH_XYZ R"(,"color":)" V2VOUCH_COLOR
    R"(}}},"spheres":{"type":"array","items":{"type":"object"}},)"
    R"("cylinders":{"type":"array","items":{"type":"object"}},)"
    R"("lines":{"type":"array","items":{"type":"object"}},)"
    R"("triangles":{"type":"array","items":{"type":"object"}},)"
    R"("texts":{"type":"array","items":{"type":"object","properties":{"pose":)" V2VOUCH_POSE
    R"(,"billboard":{"type":"boolean"},"font_size":{"type":"number"},)"
    R"("scale_invariant":{"type":"boolean"},"color":)" V2VOUCH_COLOR
    R"(,"text":{"type":"string"}}}},"models":{"type":"array","items":{"type":"object"}}}}}}})";

constexpr std::string_view kFrameTransform =
    R"({"title":"foxglove.FrameTransform","type":"object","properties":{"timestamp":)" V2VOUCH_TIME
    R"(,"parent_frame_id":{"type":"string"},"child_frame_id":{"type":"string"},"translation":)" V2VOUCH_XYZ
    R"(,"rotation":)" V2VOUCH_ROTATION "}}";

constexpr std::string_view kLocationFix =
    R"({"title":"foxglove.LocationFix","type":"object","properties":{"timestamp":)" V2VOUCH_TIME
    R"(,"frame_id":{"type":"string"},"latitude":{"type":"number"},"longitude":{"type":"number"},)"
    R"("altitude":{"type":"number"},"position_covariance":{"type":"array","items":{"type":"number"}},)"
    R"("position_covariance_type":{"type":"integer"}}})";

constexpr std::string_view kLog =
    R"({"title":"foxglove.Log","type":"object","properties":{"timestamp":)" V2VOUCH_TIME
    R"(,"level":{"type":"integer"},"message":{"type":"string"},"name":{"type":"string"},)"
    R"("file":{"type":"string"},"line":{"type":"integer"}}})";

constexpr std::string_view kCompressedImage =
    R"({"title":"foxglove.CompressedImage","type":"object","properties":{"timestamp":)" V2VOUCH_TIME
    R"(,"frame_id":{"type":"string"},"data":{"type":"string","contentEncoding":"base64"},)"
    R"("format":{"type":"string"}}})";

constexpr std::string_view kRawImage =
    R"({"title":"foxglove.RawImage","type":"object","properties":{"timestamp":)" V2VOUCH_TIME
    R"(,"frame_id":{"type":"string"},"width":{"type":"integer"},"height":{"type":"integer"},)"
    R"("encoding":{"type":"string"},"step":{"type":"integer"},)"
    R"("data":{"type":"string","contentEncoding":"base64"}}})";

}  // namespace

std::string_view FoxgloveSchema(std::string_view name) {
  if (name == "foxglove.SceneUpdate") return kSceneUpdate;
  if (name == "foxglove.FrameTransform") return kFrameTransform;
  if (name == "foxglove.LocationFix") return kLocationFix;
  if (name == "foxglove.Log") return kLog;
  if (name == "foxglove.CompressedImage") return kCompressedImage;
  if (name == "foxglove.RawImage") return kRawImage;
  return {};
}

}  // namespace v2vouch::mcap_export
