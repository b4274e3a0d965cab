// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "daemon/rim/foxglove/flat_tracks.h"
#include "daemon/rim/foxglove/messages.h"
#include "daemon/rim/foxglove/scenes.h"
#include "tests/daemon/rim/view/view_messages.h"

namespace v2vouch::foxglove {
namespace {

using nlohmann::json;

TEST(FlatTracks, NearestVehicleComesFirstInEveryArray) {
  track_t hidden = view::Track(200'000'005, 10.0, 0.0);
  hidden.bridge_budget_s = 4.5;
  hidden.num_sources = 2;
  hidden.sources = {{track_source_t::RADAR, "FRONT", 4'000'000},
                    {track_source_t::V2V, "", 5'000'000}};
  const track_list_t list = view::List(5'000'000, {view::Track(7, 40.0, 0.0), hidden});
  const json plot = json::parse(FlatTracks(list));
  EXPECT_EQ(plot["count"], 2);
  EXPECT_EQ(plot["nearest_m"], 10.0);
  EXPECT_EQ(plot["id"].dump(), "[5,7]");
  EXPECT_EQ(plot["x_m"].dump(), "[10,40]");
  EXPECT_EQ(plot["own_age_s"].dump(), "[1,null]");  // V2V is no own sensor.
  EXPECT_EQ(plot["budget_s"][0], 4.5);
  EXPECT_TRUE(json::parse(FlatTracks(view::List(1, {})))["nearest_m"].is_null());
}

TEST(TruthScene, LiesInTheCarsOwnFrame) {
  truth_list_t truth{};
  truth.ego_x_m = 500.0;
  truth.ego_y_m = 200.0;
  truth.ego_yaw_rad = std::numbers::pi / 2;
  truth.num_objects = 2;
  truth.objects.resize(2);
  truth.objects[0].x_m = 500.0;
  truth.objects[0].y_m = 230.0;  // 30 m ahead of an ego that drives north.
  truth.objects[1].x_m = NAN;
  const json scene = json::parse(TruthScene(truth, true));
  ASSERT_EQ(scene["entities"].size(), 1u);
  EXPECT_EQ(scene["entities"][0]["frame_id"], "base_link");
  EXPECT_NEAR(scene["entities"][0]["cubes"][0]["pose"]["position"]["x"].get<double>(), 30.0, 1e-6);
  EXPECT_EQ(scene["deletions"].size(), 1u);
}

TEST(Picture, JpegIsCompressedAndAnythingElseRaw) {
  camera_image_t image{};
  image.sensor = "FRONT";
  image.encoding = "jpeg";
  image.data = {'f', 'o', 'o', 'b', 'a', 'r'};
  image.num_bytes = 6;
  EXPECT_EQ(PictureOf(image).schema, "foxglove.CompressedImage");
  const json compressed = json::parse(PictureOf(image).json);
  EXPECT_EQ(compressed["data"], "Zm9vYmFy");  // RFC 4648, section 10.
  EXPECT_EQ(compressed["format"], "jpeg");
  image.encoding = "bgr8";
  image.width_px = 2;
  image.height_px = 1;
  EXPECT_EQ(PictureOf(image).schema, "foxglove.RawImage");
  EXPECT_EQ(json::parse(PictureOf(image).json)["step"], 6);
}

TEST(Schema, OfEveryNameIsJson) {
  for (const char* name :
       {"foxglove.SceneUpdate", "foxglove.FrameTransform", "foxglove.LocationFix", "foxglove.Log",
        "foxglove.CompressedImage", "foxglove.RawImage", "v2vouch.FlatTracks"}) {
    EXPECT_EQ(json::parse(Schema(name))["title"], name);
  }
  EXPECT_TRUE(json::accept(Schema("of.others")));
}

}  // namespace
}  // namespace v2vouch::foxglove
