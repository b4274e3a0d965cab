// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/angle.h"
#include "daemon/common/base/visit.h"

/// What a sensor family's radars and cameras are like: section `family` of a scenario, drawn anew
/// for every run (draw_sensors.h) or written by hand with `sensors: {mode: custom}`.
namespace v2vouch::sim {

/// Strengths are signal-to-noise ratios at 20 m of a car; they fall with the fourth power of range.
struct RadarFamilySpec {
  double specular_db = 46.0;        ///< Point of a visible face that is square to the radar ...
  double specular_lobe_deg = 12.0;  ///< ... 12 dB less so far off the face's normal.
  double corner_db = 36.0;
  double wheel_db = 30.0;
  int face_points = 3;  ///< Number plate, lamps, mirrors: per face, and fixed to the vehicle.
  double face_db = 30.0;
  int inside_points = 5;  ///< Under and in the car, seen wherever the car is.
  double inside_db = 24.0;
  double inside_depth = 0.9;     ///< Share of the length over which they are spread.
  double point_spread_db = 5.0;  ///< Of each point about its kind, fixed to the vehicle.
  double fading_db = 4.0;        ///< Slow fading of each point ...
  double fading_s = 1.5;         ///< ... with this time constant.
  double fluctuation_db = 4.0;   ///< From scan to scan.
  double threshold_db = 11.0;    ///< Weaker returns are not reported.
  double cell_range_m = 0.4;     ///< Returns of one resolution cell merge, weighted by power.
  double cell_azimuth_deg = 2.0;
  double cell_rate_mps = 0.5;
  int most_returns = 8;         ///< Per vehicle, the strongest.
  bool snr_given = true;        ///< Else neither SNR nor cross-section is reported.
  double wheel_spin = 0.3;      ///< Share of wheel returns with the Doppler of a turning wheel.
  double under_body = 0.08;     ///< Share of scans with a return from under the car, behind it.
  double double_bounce = 0.03;  ///< ... with one there and back twice, below 25 m.
  double mirror = 0.06;         ///< Share of spells with an image over a wall, rail or lorry.
  double ground_per_scan = 1.0;
  double rain_per_scan = 0.0;       ///< Weak returns within 25 m.
  double interference_share = 0.0;  ///< Of scans with 10 to 30 returns of another radar.
  // Radars that report objects.
  double jump_every_s = 1.5;  ///< The reference point goes to another part of the vehicle.
  double confirm_s = 0.3;
  double coast_s = 0.5;
  double new_id_every_s = 10.0;
  double false_objects_per_s = 0.05;

  template <class Archive>
  void Visit(Archive& a) {
    const auto strength = [&](const char* key, double& value) {
      a.Field(key, value, {.at_least = -50.0, .at_most = 100.0});
    };
    const auto share = [&](const char* key, double& value) {
      a.Field(key, value, {.at_least = 0.0, .at_most = 1.0});
    };
    strength("specular_db", specular_db);
    a.Field("specular_lobe_deg", specular_lobe_deg, {.above = 0.0, .at_most = 180.0});
    strength("corner_db", corner_db);
    strength("wheel_db", wheel_db);
    a.Field("face_points", face_points, {.at_least = 0, .at_most = 20});
    strength("face_db", face_db);
    a.Field("inside_points", inside_points, {.at_least = 0, .at_most = 50});
    strength("inside_db", inside_db);
    share("inside_depth", inside_depth);
    a.Field("point_spread_db", point_spread_db, {.at_least = 0.0, .at_most = 30.0});
    a.Field("fading_db", fading_db, {.at_least = 0.0, .at_most = 30.0});
    a.Field("fading_s", fading_s, {.above = 0.0, .at_most = 100.0});
    a.Field("fluctuation_db", fluctuation_db, {.at_least = 0.0, .at_most = 30.0});
    strength("threshold_db", threshold_db);
    a.Field("cell_range_m", cell_range_m, {.at_least = 0.0, .at_most = 10.0});
    a.Field("cell_azimuth_deg", cell_azimuth_deg, {.at_least = 0.0, .at_most = 30.0});
    a.Field("cell_rate_mps", cell_rate_mps, {.at_least = 0.0, .at_most = 10.0});
    a.Field("most_returns", most_returns, {.at_least = 1, .at_most = 100});
    a.Field("snr_given", snr_given);
    share("wheel_spin", wheel_spin);
    share("under_body", under_body);
    share("double_bounce", double_bounce);
    share("mirror", mirror);
    a.Field("ground_per_scan", ground_per_scan, {.at_least = 0.0, .at_most = 40.0});
    a.Field("rain_per_scan", rain_per_scan, {.at_least = 0.0, .at_most = 40.0});
    share("interference_share", interference_share);
    a.Field("jump_every_s", jump_every_s, {.above = 0.0, .at_most = 1e4});
    a.Field("confirm_s", confirm_s, {.at_least = 0.0, .at_most = 10.0});
    a.Field("coast_s", coast_s, {.at_least = 0.0, .at_most = 10.0});
    a.Field("new_id_every_s", new_id_every_s, {.above = 0.0, .at_most = 1e5});
    a.Field("false_objects_per_s", false_objects_per_s, {.at_least = 0.0, .at_most = 10.0});
  }
};

struct CameraFamilySpec {
  double edge_white_px = 1.0;        ///< Of each edge, from picture to picture.
  double edge_markov_px = 1.5;       ///< ... and with a time constant of edge_tau_s.
  double edge_markov_share = 0.015;  ///< ... more by this share of the box's size.
  double edge_tau_s = 0.5;
  double amodal_share = 0.3;  ///< Of vehicles: boxes of the whole car, hidden parts guessed.
  double split_per_s = 0.05;  ///< Vans, lorries and buses in two boxes, for split_s.
  double split_s = 0.8;
  double wrong_class_share = 0.1;  ///< Of the time, in spells of class_spell_s.
  double class_spell_s = 1.5;
  double misses_per_s = 0.15;  ///< Bursts of pictures without a vehicle, for miss_s.
  double miss_s = 0.5;
  double false_per_s = 0.1;  ///< Boxes of no vehicle, fixed to a place, for false_s.
  double false_s = 1.5;
  double duplicate_share = 0.01;         ///< Of boxes.
  double pitch_rad = FromDegrees(0.25);  ///< Of the body, with a time constant of pitch_tau_s.
  double pitch_tau_s = 0.7;
  double dive_rad = FromDegrees(0.25);  ///< Nod per m/s^2 of braking.

  template <class Archive>
  void Visit(Archive& a) {
    const auto share = [&](const char* key, double& value) {
      a.Field(key, value, {.at_least = 0.0, .at_most = 1.0});
    };
    const auto rate = [&](const char* key, double& value) {
      a.Field(key, value, {.at_least = 0.0, .at_most = 10.0});
    };
    const auto time = [&](const char* key, double& value) {
      a.Field(key, value, {.above = 0.0, .at_most = 100.0});
    };
    a.Field("edge_white_px", edge_white_px, {.at_least = 0.0, .at_most = 100.0});
    a.Field("edge_markov_px", edge_markov_px, {.at_least = 0.0, .at_most = 100.0});
    share("edge_markov_share", edge_markov_share);
    time("edge_tau_s", edge_tau_s);
    share("amodal_share", amodal_share);
    rate("split_per_s", split_per_s);
    time("split_s", split_s);
    share("wrong_class_share", wrong_class_share);
    time("class_spell_s", class_spell_s);
    rate("misses_per_s", misses_per_s);
    time("miss_s", miss_s);
    rate("false_per_s", false_per_s);
    time("false_s", false_s);
    share("duplicate_share", duplicate_share);
    a.Degrees("pitch_deg", pitch_rad, {.at_least = 0.0, .at_most = 5.0});
    time("pitch_tau_s", pitch_tau_s);
    a.Degrees("dive_deg", dive_rad, {.at_least = 0.0, .at_most = 2.0});
  }
};

struct FamilySpec {
  RadarFamilySpec radar;
  CameraFamilySpec camera;

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("radar", radar);
    a.Field("camera", camera);
  }
};

}  // namespace v2vouch::sim
