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

using Schemas = std::map<std::string, std::string, std::less<>>;

/// What messages are made of.
struct Types {
  const std::string number = R"({"type":"number"})";
  const std::string whole = R"({"type":"integer"})";
  const std::string text = R"({"type":"string"})";
  const std::string yes_no = R"({"type":"boolean"})";
  const std::string bytes = R"({"type":"string","contentEncoding":"base64"})";
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
};

std::string EntityOf(const Types& t) {
  const std::string arrow = Object("foxglove.ArrowPrimitive", {{"pose", t.pose},
                                                               {"shaft_length", t.number},
                                                               {"shaft_diameter", t.number},
                                                               {"head_length", t.number},
                                                               {"head_diameter", t.number},
                                                               {"color", t.colour}});
  const std::string cube =
      Object("foxglove.CubePrimitive", {{"pose", t.pose}, {"size", t.vector}, {"color", t.colour}});
  const std::string line = Object("foxglove.LinePrimitive", {{"type", t.whole},
                                                             {"pose", t.pose},
                                                             {"thickness", t.number},
                                                             {"scale_invariant", t.yes_no},
                                                             {"points", List(t.point)},
                                                             {"color", t.colour},
                                                             {"colors", List(t.colour)},
                                                             {"indices", List(t.whole)}});
  const std::string label = Object("foxglove.TextPrimitive", {{"pose", t.pose},
                                                              {"billboard", t.yes_no},
                                                              {"font_size", t.number},
                                                              {"scale_invariant", t.yes_no},
                                                              {"color", t.colour},
                                                              {"text", t.text}});
  const std::string none = R"({"type":"object"})";
  const std::string pair = Object("foxglove.KeyValuePair", {{"key", t.text}, {"value", t.text}});
  return Object("foxglove.SceneEntity", {{"timestamp", t.time},
                                         {"frame_id", t.text},
                                         {"id", t.text},
                                         {"lifetime", t.duration},
                                         {"frame_locked", t.yes_no},
                                         {"metadata", List(pair)},
                                         {"arrows", List(arrow)},
                                         {"cubes", List(cube)},
                                         {"spheres", List(none)},
                                         {"cylinders", List(none)},
                                         {"lines", List(line)},
                                         {"triangles", List(none)},
                                         {"texts", List(label)},
                                         {"models", List(none)}});
}

void Add(const std::string& name, Fields fields, Schemas& schemas) {
  schemas[name] = Object(name, fields);
}

void AddScene(const Types& t, Schemas& schemas) {
  const std::string deletion = Object("foxglove.SceneEntityDeletion",
                                      {{"timestamp", t.time}, {"type", t.whole}, {"id", t.text}});
  Add("foxglove.SceneUpdate", {{"deletions", List(deletion)}, {"entities", List(EntityOf(t))}},
      schemas);
  Add("foxglove.FrameTransform",
      {{"timestamp", t.time},
       {"parent_frame_id", t.text},
       {"child_frame_id", t.text},
       {"translation", t.vector},
       {"rotation", t.rotation}},
      schemas);
}

void AddFixLogAndPictures(const Types& t, Schemas& schemas) {
  Add("foxglove.LocationFix",
      {{"timestamp", t.time},
       {"frame_id", t.text},
       {"latitude", t.number},
       {"longitude", t.number},
       {"altitude", t.number},
       {"position_covariance", List(t.number)},
       {"position_covariance_type", t.whole}},
      schemas);
  Add("foxglove.Log",
      {{"timestamp", t.time},
       {"level", t.whole},
       {"message", t.text},
       {"name", t.text},
       {"file", t.text},
       {"line", t.whole}},
      schemas);
  Add("foxglove.CompressedImage",
      {{"timestamp", t.time}, {"frame_id", t.text}, {"data", t.bytes}, {"format", t.text}},
      schemas);
  Add("foxglove.RawImage",
      {{"timestamp", t.time},
       {"frame_id", t.text},
       {"width", t.whole},
       {"height", t.whole},
       {"encoding", t.text},
       {"step", t.whole},
       {"data", t.bytes}},
      schemas);
}

void AddFlatTracks(const Types& t, Schemas& schemas) {
  Add("v2vouch.FlatTracks",
      {{"timestamp", t.time},
       {"count", t.whole},
       {"nearest_m", t.number},
       {"id", List(t.number)},
       {"x_m", List(t.number)},
       {"y_m", List(t.number)},
       {"speed_mps", List(t.number)},
       {"yaw_rad", List(t.number)},
       {"existence", List(t.number)},
       {"sigma_m", List(t.number)},
       {"own_age_s", List(t.number)},
       {"budget_s", List(t.number)},
       {"trust_state", List(t.number)}},
      schemas);
}

Schemas MakeSchemas() {
  const Types types;
  Schemas schemas;
  AddScene(types, schemas);
  AddFixLogAndPictures(types, schemas);
  AddFlatTracks(types, schemas);
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
