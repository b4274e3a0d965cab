// SPDX-License-Identifier: Apache-2.0
#include "daemon/local/tracking/one_vehicle.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "daemon/common/models/extent.h"

namespace v2vouch {
namespace {

// Published tracks must share one place for so long before one of them goes, others for less.
constexpr double kDuplicateHold_s = 0.2;
constexpr double kTentativeHold_s = 0.1;
// So many clusters out of another vehicle's box, and a track is no vehicle.
constexpr int kMostBorrowed = 5;
constexpr double kBorrowedAside_m = 0.3;
// Vehicles that move faster than this keep more room between each other: what reflects so close to
// one, at its speed, is a part of it.
constexpr double kInMotion_mps = 5.0;
constexpr double kNoRoom_m = 1.5;
constexpr double kNoRoomAside_m = 0.6;
// Vehicles one behind the other overlap by less than this.
constexpr double kOverlap_m = 1.0;
// A centre counts as inside of a box this far behind its ends.
constexpr double kInside_m = 0.5;
constexpr double kMaxEndDoubt_m = 1.5;
// A part of a lorry lies on its axis and moves with it.
constexpr double kPartAside_m = 1.5;
constexpr double kPartSpeed_mps = 2.0;
constexpr double kPartHold_s = 0.5;
constexpr double kFreshReflection_s = 0.1;
constexpr double kPartSigma_m = 1.5;
// A length that is known so well was seen from end to end: what follows is an echo.
constexpr double kKnownLength_m = 0.5;
// Of two tracks in one lane at one speed, with a gap of less than so long, for so long.
constexpr double kConvoy_mps = 8.0;
constexpr double kConvoySpeed_mps = 1.5;
constexpr double kConvoyGap_s = 0.3;
constexpr double kConvoyHold_s = 1.0;
constexpr double kConvoyFresh_s = 0.3;
// Velocities of one vehicle differ by less than this; a point's is known that much worse.
constexpr double kSameSpeed_mps = 3.0;
constexpr double kPointDoubt_mps = 8.0;
// Tracks farther apart than half of this share no place.
constexpr double kLongest_m = 25.0;
// Far enough for the longest vehicle, and for one that has just been lengthened.
constexpr double kPartReach_m = 2.0 * kLongestVehicle_m;

// Of two tracks of one vehicle the one that stays: published before not, named by a camera before
// not, seen more often by cameras and in boxes (which see the vehicle as a whole), older before
// younger.
bool IsSenior(const LocalTrack& a, const LocalTrack& b) {
  if (a.is_confirmed != b.is_confirmed) return a.is_confirmed;
  const bool a_is_named = a.object_class != ObjectClass::kUnknown;
  const bool b_is_named = b.object_class != ObjectClass::kUnknown;
  if (a_is_named != b_is_named) return a_is_named;
  const int a_whole = a.camera_hits() + a.object_hits();
  const int b_whole = b.camera_hits() + b.object_hits();
  if (a_whole != b_whole) return a_whole > b_whole;
  return a.id < b.id;
}

// Whether a place lies in a vehicle's box, made longer by `beyond_m` at either end.
bool LiesIn(const LocalTrack& track, const Eigen::Vector2d& p_O, double beyond_m,
            double aside_m = kBorrowedAside_m) {
  const Eigen::Vector2d inside =
      Eigen::Rotation2D<double>(-track.state_O.mean[kYaw]) * (p_O - track.state_O.mean.head<2>());
  return std::abs(inside.x()) < 0.5 * track.extent.length_m + beyond_m &&
         std::abs(inside.y()) < 0.5 * track.extent.width_m + aside_m;
}

// One frame of a source of objects reported both: two boxes are two vehicles, however close they
// stand.
bool AreSeenAsTwo(const LocalTrack& a, const LocalTrack& b) {
  return a.support.SharesFrame(b.support, SensorKind::kObjects);
}

double VelocityDifference(const TrackEvidence& a, const TrackEvidence& b) {
  return (a.filter.velocity_O() - b.filter.velocity_O()).norm();
}

// Whether the older of two tracks stands behind the owner, fed by what lies inside of the nearer
// one, whose face it lost. Directions that no picture supports put ends anywhere.
bool StandsBehind(const TrackTable& table, std::size_t i, std::size_t j) {
  const auto [track, evidence] = table[i];
  const auto [owner, its_evidence] = table[j];
  if (track.camera_hits() == 0 || owner.camera_hits() == 0) return false;
  if (!evidence.filter.is_vehicle() || track.extent.length_sigma_m > kMaxEndDoubt_m ||
      owner.extent.length_sigma_m > kMaxEndDoubt_m) {
    return false;
  }
  const bool is_fresh = ToSeconds(table.now() - its_evidence.reflected) <= kFreshReflection_s;
  const double difference = VelocityDifference(evidence, its_evidence);
  const Eigen::Vector2d seen_from_O = evidence.filter.seen_from_O();
  const auto distance_m = [&](const LocalTrack& of) {
    return (of.state_O.mean.head<2>() - seen_from_O).norm();
  };
  const Eigen::Vector2d between = Eigen::Rotation2D<double>(-owner.state_O.mean[kYaw]) *
                                  (track.state_O.mean.head<2>() - owner.state_O.mean.head<2>());
  const double needed_m = 0.5 * (owner.extent.length_m + track.extent.length_m);
  if (std::abs(between.x()) > needed_m - kOverlap_m) return false;
  return is_fresh && difference < kPartSpeed_mps && distance_m(owner) < distance_m(track) &&
         !LiesIn(track, its_evidence.reflection_O, 0.0) &&
         !track.support.SharesFrame(owner.support, SensorKind::kCamera);
}

// Whether the last reflection of track i came out of the box of track j, its senior: it may live on
// what a lorry's flank reflects without ever being where the lorry is.
bool Borrows(const TrackTable& table, std::size_t i, std::size_t j) {
  const auto [track, evidence] = table[i];
  const auto [owner, its_evidence] = table[j];
  if (i == j || evidence.reflected != table.now()) return false;
  if (its_evidence.is_ended || !owner.is_confirmed) return false;
  if (!its_evidence.filter.is_vehicle() || AreSeenAsTwo(owner, track)) return false;
  const bool in_motion = track.object_class == ObjectClass::kUnknown &&
                         std::abs(owner.state_O.mean[kSpeed]) > kInMotion_mps &&
                         VelocityDifference(evidence, its_evidence) < kSameSpeed_mps;
  if (!LiesIn(owner, evidence.reflection_O, in_motion ? kNoRoom_m : 0.0,
              in_motion ? kNoRoomAside_m : kBorrowedAside_m)) {
    return false;
  }
  return IsSenior(owner, track) || StandsBehind(table, i, j);
}

// Whether track i stands in the place of track j, its senior, and moves with it.
bool IsWithin(const TrackTable& table, std::size_t i, std::size_t j) {
  const auto [young, evidence] = table[i];
  const auto [old, its_evidence] = table[j];
  if (i == j || its_evidence.is_ended || !IsSenior(old, young) || AreSeenAsTwo(old, young)) {
    return false;
  }
  const Eigen::Vector2d between = Eigen::Rotation2D<double>(-old.state_O.mean[kYaw]) *
                                  (young.state_O.mean.head<2>() - old.state_O.mean.head<2>());
  // A long vehicle's end is not known well: an unclassified track may be a part of it.
  const double beyond =
      young.object_class == ObjectClass::kUnknown
          ? std::min(old.extent.length_sigma_m, kMaxEndDoubt_m) + 0.25 * young.extent.length_m
          : 0.0;
  // Centres nearer than half of what two vehicles need, or one's centre in the other's box.
  const double half_length = std::max(0.25 * (old.extent.length_m + young.extent.length_m),
                                      0.5 * old.extent.length_m - kInside_m + beyond);
  const double half_width =
      std::max(0.45 * (old.extent.width_m + young.extent.width_m), 0.5 * old.extent.width_m);
  if (std::abs(between.x()) > half_length || std::abs(between.y()) > half_width) return false;
  const double doubt_mps = evidence.filter.is_vehicle() ? 0.0 : kPointDoubt_mps;
  return VelocityDifference(evidence, its_evidence) < kSameSpeed_mps + doubt_mps;
}

// How far behind the near face of vehicle j the last reflection of track i lies, on its axis, where
// it is not older than `fresh_s` and nothing shows both as two; nullopt otherwise. What is seen of
// a far end is its last reflection; its centre lies where a car's would.
std::optional<double> BehindFace(const TrackTable& table, std::size_t i, std::size_t j,
                                 double fresh_s) {
  const auto [part, evidence] = table[i];
  const auto [whole, its_evidence] = table[j];
  if (i == j || its_evidence.is_ended || !its_evidence.filter.is_vehicle()) return std::nullopt;
  if (!whole.is_confirmed || AreSeenAsTwo(part, whole)) return std::nullopt;
  if (part.support.SharesFrame(whole.support, SensorKind::kCamera)) return std::nullopt;
  if (ToSeconds(table.now() - evidence.reflected) > fresh_s) return std::nullopt;
  const Eigen::Rotation2D<double> into(-whole.state_O.mean[kYaw]);
  const Eigen::Vector2d between = into * (evidence.reflection_O - whole.state_O.mean.head<2>());
  if (std::abs(between.y()) > kPartAside_m) return std::nullopt;
  const Eigen::Vector2d sensor =
      into * (its_evidence.filter.seen_from_O() - whole.state_O.mean.head<2>());
  const double behind_m = sensor.x() > 0.0 ? -between.x() : between.x();
  return 0.5 * whole.extent.length_m + behind_m;
}

// How long lorry j is if track i is its far end; nullopt where it cannot be.
std::optional<double> LengthWithPart(const TrackTable& table, std::size_t i, std::size_t j) {
  const auto [part, evidence] = table[i];
  const auto [lorry, its_evidence] = table[j];
  if (!IsLong(lorry.object_class) || !IsSenior(lorry, part)) return std::nullopt;
  const double doubt_mps = evidence.filter.is_vehicle() ? 0.0 : kPointDoubt_mps;
  if (VelocityDifference(evidence, its_evidence) > kPartSpeed_mps + doubt_mps) return std::nullopt;
  const auto from_face_m = BehindFace(table, i, j, kFreshReflection_s);
  const double reach_m =
      std::min(kLongestVehicle_m, lorry.extent.length_m + 2.0 * lorry.extent.length_sigma_m);
  if (!from_face_m || *from_face_m < -kInside_m || *from_face_m > reach_m) return std::nullopt;
  return from_face_m;
}

// How long vehicle j is if track i is its far end, whatever both were called: so close behind each
// other, at one speed, nobody drives. nullopt where it cannot be.
std::optional<double> LengthAsConvoy(const TrackTable& table, std::size_t i, std::size_t j) {
  const auto [part, evidence] = table[i];
  const auto [near, its_evidence] = table[j];
  const double speed_mps = std::abs(near.state_O.mean[kSpeed]);
  if (speed_mps < kConvoy_mps || !evidence.filter.is_vehicle()) return std::nullopt;
  if (VelocityDifference(evidence, its_evidence) > kConvoySpeed_mps) return std::nullopt;
  const auto from_face_m = BehindFace(table, i, j, kConvoyFresh_s);
  const double length_m = near.extent.length_m;
  const double reach_m = std::min(kLongestVehicle_m, length_m + kConvoyGap_s * speed_mps);
  if (!from_face_m || *from_face_m < 0.5 * length_m || *from_face_m > reach_m) return std::nullopt;
  return from_face_m;
}

}  // namespace

bool IsInAnothersBox(const TrackTable& table, std::size_t i, const Eigen::Vector2d& p_O) {
  for (std::size_t j = 0; j < table.size(); ++j) {
    const auto [other, evidence] = table[j];
    if (j == i || !other.is_confirmed || !evidence.filter.is_vehicle()) continue;
    const double end_doubt_m = std::min(other.extent.length_sigma_m, kMaxEndDoubt_m);
    if (LiesIn(other, p_O, end_doubt_m + kInside_m)) return true;
  }
  return false;
}

void OneVehicle::Apply(double dt_s, TrackTable& table) {
  places_.Clear();
  for (std::size_t i = 0; i < table.size(); ++i) {
    places_.Add(table[i].track.state_O.mean.head<2>(), i);
  }
  places_.Sort();
  EndDuplicates(dt_s, table);
  JoinParts(dt_s, table);
}

void OneVehicle::EndDuplicates(double dt_s, TrackTable& table) const {
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto [track, evidence] = table[i];
    bool overlaps = false;
    bool borrows = false;
    places_.ForEachNear(track.state_O.mean.head<2>(), 0.5 * kLongest_m, [&](std::size_t j) {
      overlaps = overlaps || IsWithin(table, i, j);
      borrows = borrows || Borrows(table, i, j);
    });
    if (evidence.reflected == table.now()) {
      evidence.borrowed = borrows ? evidence.borrowed + 1 : std::max(evidence.borrowed - 2, 0);
      if (evidence.borrowed >= kMostBorrowed) evidence.is_ended = true;
    }
    evidence.overlap_s = overlaps ? evidence.overlap_s + dt_s : 0.0;
    const double hold_s = track.is_confirmed ? kDuplicateHold_s : kTentativeHold_s;
    if (overlaps && evidence.overlap_s > hold_s) evidence.is_ended = true;
  }
}

void OneVehicle::JoinParts(double dt_s, TrackTable& table) const {
  for (std::size_t i = 0; i < table.size(); ++i) {
    const auto [track, evidence] = table[i];
    if (evidence.is_ended) continue;
    std::size_t whole = table.size();
    double needed_m = 0.0;
    bool is_convoy = false;
    places_.ForEachNear(track.state_O.mean.head<2>(), kPartReach_m, [&](std::size_t j) {
      if (j >= whole) return;  // The oldest counts.
      const auto part = LengthWithPart(table, i, j);
      const auto length_m = part ? part : LengthAsConvoy(table, i, j);
      if (!length_m) return;
      whole = j;
      needed_m = *length_m;
      is_convoy = !part;
    });
    if (whole == table.size()) {
      evidence.part_s = 0.0;
      evidence.convoy_s = std::max(evidence.convoy_s - dt_s, 0.0);
      continue;
    }
    if (is_convoy) evidence.part_s = 0.0;
    double& held_s = is_convoy ? evidence.convoy_s : evidence.part_s;
    held_s += dt_s;
    const double hold_s = is_convoy            ? kConvoyHold_s
                          : track.is_confirmed ? kPartHold_s
                                               : kTentativeHold_s;
    if (held_s < hold_s) continue;
    evidence.is_ended = true;
    const auto [lorry, its_evidence] = table[whole];
    if (lorry.extent.length_sigma_m < kKnownLength_m) continue;
    its_evidence.filter.Lengthen(needed_m, kPartSigma_m);
    its_evidence.filter.Show(table.settings(), lorry);
  }
}

}  // namespace v2vouch
