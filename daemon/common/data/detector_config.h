// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "daemon/common/base/visit.h"
#include "daemon/common/data/object_class.h"

namespace v2vouch {

/// How a picture is made as large as the network's input.
enum class PictureFit {
  kStretch,    ///< Each axis by itself, as darknet does.
  kLetterbox,  ///< Shape kept, rest filled with grey at the right and bottom, as YOLOX does.
};

/// One class of the network that we use.
struct NetworkClass {
  int id = 0;  ///< The network's own number, from 0.
  ObjectClass object_class = ObjectClass::kCar;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("id", id, {.at_least = 0, .at_most = 9999});
    VisitObjectClass(a, object_class);
  }
};

/// The camera network and what is done to a picture before and after it. One for all cameras with
/// `source: image`. Effects of the settings on real pictures: docs/results/camera.md.
struct DetectorConfig {
  std::string model;         ///< FILE.weights (darknet) or FILE.onnx (YOLOX); "" = no network.
  std::string network;       ///< Darknet's .cfg; "" = the model's name with .cfg.
  int input_width_px = 960;  ///< The network's input; multiples of 32 that suit the camera's shape.
  int input_height_px = 544;
  PictureFit fit = PictureFit::kStretch;
  int tiles = 1;              ///< Side by side, for wide pictures: each goes through the network.
  double tile_overlap = 0.2;  ///< Share of a tile that its neighbour sees too.
  double clahe_clip = 1.0;    ///< Contrast-limited histogram equalisation; 0: none.
  int clahe_grid = 8;         ///< Cells of it per axis.
  double edge_gain = 0.0;     ///< Edges added to the picture (unsharp mask); 0: none.
  bool refine_bottom = true;  ///< Move a box's bottom to the strongest horizontal edge near it.
  double min_score = 0.3;     ///< Objectness times class score.
  double nms_iou = 0.45;      ///< Of two boxes that overlap more, the weaker one goes.
  int threads = 1;            ///< For the network; leave a core to the fusion.
  /// Others the network knows are ignored. The default is COCO's numbering.
  std::vector<NetworkClass> classes = {{0, ObjectClass::kPedestrian}, {1, ObjectClass::kCyclist},
                                       {2, ObjectClass::kCar},        {3, ObjectClass::kMotorcycle},
                                       {5, ObjectClass::kBus},        {7, ObjectClass::kTruck}};

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("model", model);
    a.Text("network", network);
    a.Field("input_width_px", input_width_px, {.at_least = 32, .at_most = 4096});
    a.Field("input_height_px", input_height_px, {.at_least = 32, .at_most = 4096});
    a.Choice("fit", fit,
             {{"stretch", PictureFit::kStretch}, {"letterbox", PictureFit::kLetterbox}});
    a.Field("tiles", tiles, {.at_least = 1, .at_most = 8});
    a.Field("tile_overlap", tile_overlap, {.at_least = 0.0, .at_most = 0.8});
    a.Field("clahe_clip", clahe_clip, {.at_least = 0.0, .at_most = 100.0});
    a.Field("clahe_grid", clahe_grid, {.at_least = 1, .at_most = 64});
    a.Field("edge_gain", edge_gain, {.at_least = 0.0, .at_most = 10.0});
    a.Field("refine_bottom", refine_bottom);
    a.Field("min_score", min_score, {.above = 0.0, .at_most = 1.0});
    a.Field("nms_iou", nms_iou, {.above = 0.0, .at_most = 1.0});
    a.Field("threads", threads, {.at_least = 1, .at_most = 64});
    a.Field("classes", classes);
  }
};

}  // namespace v2vouch
