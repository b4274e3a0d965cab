// SPDX-License-Identifier: Apache-2.0
// JSON Schemas of Foxglove's message types, as far as we fill them. Names and units of the fields:
// github.com/foxglove/foxglove-sdk, schemas/jsonschema (MIT).
#include <map>

#include "daemon/rim/foxglove/messages.h"

namespace v2vouch::foxglove {
namespace {

using Fields = std::initializer_list<std::pair<const char*, std::string>>;

std::string Object(const std::string& title, Fields fields) {
  std::string properties, required;
  for (const auto& [name, schema] : fields) {
    properties += (properties.empty() ? "\"" : ",\"") + std::string(name) + "\":" + schema;
    required += (required.empty() ? "\"" : ",\"") + std::string(name) + "\"";
  }
  return R"({"title":")" + title + R"(","type":"object","properties":{)" + properties +
         R"(},"required":[)" + required + "]}";
}

std::string List(const std::string& items) { return R"({"type":"array","items":)" + items + "}"; }

std::map<std::string, std::string, std::less<>> MakeSchemas() {
  const std::string number = R"({"type":"number"})", whole = R"({"type":"integer"})",
                    text = R"({"type":"string"})", yes_no = R"({"type":"boolean"})";
  const std::string time = Object("time", {{"sec", whole}, {"nsec", whole}});
  const std::string duration = Object("duration", {{"sec", whole}, {"nsec", whole}});
  const std::string vector =
      Object("foxglove.Vector3", {{"x", number}, {"y", number}, {"z", number}});
  const std::string point =
      Object("foxglove.Point3", {{"x", number}, {"y", number}, {"z", number}});
  const std::string rotation =
      Object("foxglove.Quaternion", {{"x", number}, {"y", number}, {"z", number}, {"w", number}});
  const std::string pose =
      Object("foxglove.Pose", {{"position", vector}, {"orientation", rotation}});
  const std::string colour =
      Object("foxglove.Color", {{"r", number}, {"g", number}, {"b", number}, {"a", number}});
  const std::string none = R"({"type":"object"})";

  const std::string deletion =
      Object("foxglove.SceneEntityDeletion", {{"timestamp", time}, {"type", whole}, {"id", text}});
  const std::string arrow = Object("foxglove.ArrowPrimitive", {{"pose", pose},
                                                               {"shaft_length", number},
                                                               {"shaft_diameter", number},
                                                               {"head_length", number},
                                                               {"head_diameter", number},
                                                               {"color", colour}});
  const std::string cube =
      Object("foxglove.CubePrimitive", {{"pose", pose}, {"size", vector}, {"color", colour}});
  const std::string line = Object("foxglove.LinePrimitive", {{"type", whole},
                                                             {"pose", pose},
                                                             {"thickness", number},
                                                             {"scale_invariant", yes_no},
                                                             {"points", List(point)},
                                                             {"color", colour},
                                                             {"colors", List(colour)},
                                                             {"indices", List(whole)}});
  const std::string label = Object("foxglove.TextPrimitive", {{"pose", pose},
                                                              {"billboard", yes_no},
                                                              {"font_size", number},
                                                              {"scale_invariant", yes_no},
                                                              {"color", colour},
                                                              {"text", text}});
  const std::string pair = Object("foxglove.KeyValuePair", {{"key", text}, {"value", text}});
  const std::string entity = Object("foxglove.SceneEntity", {{"timestamp", time},
                                                             {"frame_id", text},
                                                             {"id", text},
                                                             {"lifetime", duration},
                                                             {"frame_locked", yes_no},
                                                             {"metadata", List(pair)},
                                                             {"arrows", List(arrow)},
                                                             {"cubes", List(cube)},
                                                             {"spheres", List(none)},
                                                             {"cylinders", List(none)},
                                                             {"lines", List(line)},
                                                             {"triangles", List(none)},
                                                             {"texts", List(label)},
                                                             {"models", List(none)}});
  std::map<std::string, std::string, std::less<>> schemas;
  const auto add = [&](const std::string& name, Fields fields) {
    schemas[name] = Object(name, fields);
  };
  add("foxglove.SceneUpdate", {{"deletions", List(deletion)}, {"entities", List(entity)}});
  add("foxglove.FrameTransform", {{"timestamp", time},
                                  {"parent_frame_id", text},
                                  {"child_frame_id", text},
                                  {"translation", vector},
                                  {"rotation", rotation}});
  add("foxglove.LocationFix", {{"timestamp", time},
                               {"frame_id", text},
                               {"latitude", number},
                               {"longitude", number},
                               {"altitude", number},
                               {"position_covariance", List(number)},
                               {"position_covariance_type", whole}});
  add("foxglove.Log", {{"timestamp", time},
                       {"level", whole},
                       {"message", text},
                       {"name", text},
                       {"file", text},
                       {"line", whole}});
  add("foxglove.CompressedImage", {{"timestamp", time},
                                   {"frame_id", text},
                                   {"data", R"({"type":"string","contentEncoding":"base64"})"},
                                   {"format", text}});
  add("foxglove.RawImage", {{"timestamp", time},
                            {"frame_id", text},
                            {"width", whole},
                            {"height", whole},
                            {"encoding", text},
                            {"step", whole},
                            {"data", R"({"type":"string","contentEncoding":"base64"})"}});
  add("v2vouch.FlatTracks", {{"timestamp", time},
                             {"count", whole},
                             {"nearest_m", number},
                             {"id", List(number)},
                             {"x_m", List(number)},
                             {"y_m", List(number)},
                             {"speed_mps", List(number)},
                             {"yaw_rad", List(number)},
                             {"existence", List(number)},
                             {"sigma_m", List(number)},
                             {"own_age_s", List(number)},
                             {"budget_s", List(number)},
                             {"trust_state", List(number)}});
  return schemas;
}

}  // namespace

std::string_view Schema(std::string_view name) {
  static const auto schemas = MakeSchemas();
  const auto found = schemas.find(name);
  return found == schemas.end() ? std::string_view(R"({"type":"object"})")
                                : std::string_view(found->second);
}

}  // namespace v2vouch::foxglove
