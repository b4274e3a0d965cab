// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/common/base/reason.h"
#include "daemon/common/data/finding.h"
#include "daemon/common/data/track.h"

namespace v2vouch {

/// Where a sender stands with us. Values are those of track_t.
enum class TrustState : std::int8_t {
  kNone = 0,
  kUnknown = 1,
  kCandidate = 2,
  kValidated = 3,
  kBridged = 4,
  kSuspect = 5,
  kRevoked = 6,
};

/// One line of a published list; V2V fields stay empty on LOCAL.
struct PublishedTrack {
  LocalTrack track;            ///< `track.id` is the list's own id.
  std::uint64_t local_id = 0;  ///< PRIORITY: the LOCAL track it rests on; 0 = none.
  std::optional<Timestamp> last_v2v{};
  SenderId sender = 0;
  TrustState trust = TrustState::kNone;
  double bridge_budget_s = kNaN;
  std::optional<Wgs84> position{};  ///< In geodetic terms, where an alignment exists.
  double bias_east_m = kNaN;
  double bias_north_m = kNaN;
  TrackEvents events = 0;  ///< PRIORITY only: what the sender says.
};

struct TrackList {
  Timestamp stamp{};  ///< Time of validity; never goes back within one list.
  std::int64_t seq = 0;
  int revision = 0;  ///< Corrections by late data in the last replay buffer's length.
  bool stale = false;
  bool ego_gnss_suspect = false;
  Pose<Odometry, Body> X_OB;
  std::vector<SectorHealth> sectors;
  std::vector<PublishedTrack> tracks;  ///< Ordered by id.
};

/// Which input a diagnostic is about.
enum class InputSource : std::uint8_t { kThis, kEgoMotion, kGnss, kRadar, kCamera, kObjects, kBsm };

/// A refused input or a dropped track.
struct Diagnostic {
  Reason reason = Reason::kCount;
  Timestamp stamp{};
  std::string_view field;  ///< As in Refusal; points at a literal.
  /// kThis: the input of this step. An earlier one where its refusal came out only now.
  InputSource source = InputSource::kThis;
  int sensor = 0;  ///< Index of the sensor of that kind, where `source` is one.
};

/// What became of one BSM when it was first heard.
struct BsmVerdict {
  Timestamp stamp{};  ///< Reception.
  std::int64_t seq = 0;
  SenderId sender = 0;
  TrustState trust = TrustState::kNone;  ///< Of the sender once it was used; kNone: refused.
  std::optional<Reason> refusal;
};

struct Evidence {
  std::string_view name;  ///< With its unit; points at a literal.
  double value = 0.0;
};

struct MisbehaviorReport {
  Timestamp stamp{};
  SenderId sender = 0;
  CertificateDigest certificate{};
  Check check{};
  Verdict verdict = Verdict::kWithdraw;
  std::vector<Evidence> evidence;
};

/// All that one step gave. Reused from step to step.
struct Outputs {
  bool has_lists = false;  ///< `local` and `priority` are new.
  /// `v2v` is new. It comes ten times a second, with a frame or, where it is long, soon after.
  bool has_v2v_list = false;
  TrackList local;
  TrackList priority;
  TrackList v2v;
  std::vector<Diagnostic> diagnostics;
  std::vector<MisbehaviorReport> reports;
  std::vector<BsmVerdict> bsm_verdicts;  ///< Only where they are asked for.

  void Clear() {
    has_lists = false;
    has_v2v_list = false;
    diagnostics.clear();
    reports.clear();
    bsm_verdicts.clear();
  }
  void Refuse(const Refusal& refusal, Timestamp stamp) {
    diagnostics.push_back({refusal.reason, stamp, refusal.field});
  }
};

}  // namespace v2vouch
