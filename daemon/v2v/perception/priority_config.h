// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/common/base/visit.h"
#include "daemon/v2v/association/association_config.h"
#include "daemon/v2v/priority/bridge.h"
#include "daemon/v2v/priority/priority_filter.h"
#include "daemon/v2v/trust/trust_config.h"

namespace v2vouch {

enum class AssociationMode {
  kPaper,  ///< Algorithm 1 and nothing else; to compare with.
  kSafe,   ///< Evidence over time, one-to-one, trust, bounded bridges.
};

/// What the sensors must have seen of a vehicle before it may enter PRIORITY.
struct SensorSupportConfig {
  /// Where two kinds of sensors or more cover the place, two kinds must have measured it, each as
  /// often as this.
  int radar_hits = 3;
  int camera_hits = 2;
  int object_hits = 3;
  double single_s = 2.0;  ///< Where only one does: seen for so long ...
  int single_hits = 10;   ///< ... and so often.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("radar_hits", radar_hits, {.at_least = 1, .at_most = 100});
    a.Field("camera_hits", camera_hits, {.at_least = 1, .at_most = 100});
    a.Field("object_hits", object_hits, {.at_least = 1, .at_most = 100});
    a.Field("single_s", single_s, {.at_least = 0.0, .at_most = 60.0});
    a.Field("single_hits", single_hits, {.at_least = 1, .at_most = 1000});
  }
};

/// A sender that continues under a new id (pseudonym change).
struct IdentityChangeConfig {
  double least_silence_s = 0.25;  ///< The old id must have been silent so long ...
  double most_silence_s = 1.5;    ///< ... and no longer.
  double gate = 9.21;             ///< Chi-square, 2 dof, of the new id's claims on the old vehicle.
  int messages = 2;               ///< Claims inside the gate that hand the vehicle over.
  double contest_s = 5.0;         ///< The old id speaking again within this time takes it back.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("least_silence_s", least_silence_s, {.at_least = 0.0, .at_most = 5.0});
    a.Field("most_silence_s", most_silence_s, {.above = 0.0, .at_most = 10.0});
    a.Field("gate", gate, {.above = 0.0, .at_most = 100.0});
    a.Field("messages", messages, {.at_least = 1, .at_most = 20});
    a.Field("contest_s", contest_s, {.at_least = 0.0, .at_most = 60.0});
  }
};

/// Settings of the PRIORITY side.
struct PriorityConfig {
  AssociationMode association = AssociationMode::kSafe;
  PaperConfig paper;
  AssociationConfig safe;
  SensorSupportConfig sensor_support;
  TrustConfig trust;
  PriorityFilterConfig filter;
  BridgeConfig bridge;
  IdentityChangeConfig identity_change;
  double interest_m = 30.0;   ///< Senders are followed within this distance of a LOCAL track.
  double contact_s = 5.0;     ///< A sender silent for so long is forgotten.
  int max_senders = 128;      ///< Followed at a time.
  double turnover_hz = 40.0;  ///< Others that may take their places, once that many are followed.

  template <class Archive>
  void Visit(Archive& a) {
    a.Choice("association", association,
             {{"paper", AssociationMode::kPaper}, {"safe", AssociationMode::kSafe}});
    a.Field("paper", paper);
    a.Field("safe", safe);
    a.Field("sensor_support", sensor_support);
    a.Field("trust", trust);
    a.Field("filter", filter);
    a.Field("bridge", bridge);
    a.Field("identity_change", identity_change);
    a.Field("interest_m", interest_m, {.above = 1.0, .at_most = 500.0});
    a.Field("contact_s", contact_s, {.above = 0.5, .at_most = 60.0});
    a.Field("max_senders", max_senders, {.at_least = 4, .at_most = 1024});
    a.Field("turnover_hz", turnover_hz, {.above = 0.0, .at_most = 1e5});
  }
};

}  // namespace v2vouch
