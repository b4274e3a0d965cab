// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "daemon/common/models/extent.h"
#include "daemon/local/tracking/tracker.h"

namespace v2vouch {
namespace {

// Published tracks must share one place for so long before one of them goes, others for less.
constexpr double kDuplicateHold_s = 0.2;
constexpr double kTentativeHold_s = 0.1;
// So many clusters out of another vehicle's box, and a track is no vehicle.
constexpr int kMostBorrowed = 5;
constexpr double kBorrowedAside_m = 0.3;
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
bool LiesIn(const LocalTrack& track, const Eigen::Vector2d& p_O, double beyond_m) {
  const Eigen::Vector2d inside =
      Eigen::Rotation2D<double>(-track.state_O.mean[kYaw]) * (p_O - track.state_O.mean.head<2>());
  return std::abs(inside.x()) < 0.5 * track.extent.length_m + beyond_m &&
         std::abs(inside.y()) < 0.5 * track.extent.width_m + kBorrowedAside_m;
}

}  // namespace

// Two vehicles cannot stand in one place: of two tracks with overlapping footprints and one
// velocity the younger goes, at once while it is unpublished, after a while otherwise.
void Tracker::DropDuplicates(double dt_s) {
  constexpr double kLongest_m = 25.0;
  places_.Clear();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    places_.Add(tracks_[i].state_O.mean.head<2>(), i);
  }
  places_.Sort();
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    bool overlaps = false;
    bool borrows = false;
    places_.ForEachNear(tracks_[i].state_O.mean.head<2>(), 0.5 * kLongest_m, [&](std::size_t j) {
      overlaps = overlaps || IsWithin(i, j);
      borrows = borrows || Borrows(i, j);
    });
    if (hidden_[i].reflected == now_) {
      int& borrowed = hidden_[i].borrowed;
      borrowed = borrows ? borrowed + 1 : std::max(borrowed - 2, 0);
      if (borrowed >= kMostBorrowed) hidden_[i].is_dead = true;
    }
    hidden_[i].overlap_s = overlaps ? hidden_[i].overlap_s + dt_s : 0.0;
    const double hold_s = tracks_[i].is_confirmed ? kDuplicateHold_s : kTentativeHold_s;
    if (overlaps && hidden_[i].overlap_s > hold_s) hidden_[i].is_dead = true;
  }
}

// Whether a place lies in the box of a vehicle other than track i, or where its end may be.
bool Tracker::IsInAnothersBox(std::size_t i, const Eigen::Vector2d& p_O) const {
  for (std::size_t j = 0; j < tracks_.size(); ++j) {
    if (j == i || !tracks_[j].is_confirmed || !hidden_[j].filter.is_vehicle()) continue;
    const double end_doubt_m = std::min(tracks_[j].extent.length_sigma_m, kMaxEndDoubt_m);
    if (LiesIn(tracks_[j], p_O, end_doubt_m + kInside_m)) return true;
  }
  return false;
}

// Whether the last reflection of track i came out of the box of track j, its senior: it may live on
// what a lorry's flank reflects without ever being where the lorry is.
bool Tracker::Borrows(std::size_t i, std::size_t j) const {
  const LocalTrack& owner = tracks_[j];
  if (i == j || hidden_[i].reflected != now_ || hidden_[j].is_dead || !owner.is_confirmed) {
    return false;
  }
  if (!hidden_[j].filter.is_vehicle() || SeenAsTwo(j, i)) return false;
  if (!LiesIn(owner, hidden_[i].reflection_O, 0.0)) return false;
  if (IsSenior(owner, tracks_[i])) return true;
  // The elder may stand behind, fed by what lies inside of the nearer one, whose face it lost.
  // Directions that no picture supports put ends anywhere.
  if (tracks_[i].camera_hits() == 0 || owner.camera_hits() == 0) return false;
  if (!hidden_[i].filter.is_vehicle() || tracks_[i].extent.length_sigma_m > kMaxEndDoubt_m ||
      owner.extent.length_sigma_m > kMaxEndDoubt_m) {
    return false;
  }
  const bool is_fresh = ToSeconds(now_ - hidden_[j].reflected) <= kFreshReflection_s;
  const double difference =
      (hidden_[i].filter.velocity_O() - hidden_[j].filter.velocity_O()).norm();
  const Eigen::Vector2d seen_from_O = hidden_[i].filter.seen_from_O();
  const auto distance_m = [&](std::size_t k) {
    return (tracks_[k].state_O.mean.head<2>() - seen_from_O).norm();
  };
  const Eigen::Vector2d between =
      Eigen::Rotation2D<double>(-owner.state_O.mean[kYaw]) *
      (tracks_[i].state_O.mean.head<2>() - owner.state_O.mean.head<2>());
  const double needed_m = 0.5 * (owner.extent.length_m + tracks_[i].extent.length_m);
  if (std::abs(between.x()) > needed_m - kOverlap_m) return false;
  return is_fresh && difference < kPartSpeed_mps && distance_m(j) < distance_m(i) &&
         !LiesIn(tracks_[i], hidden_[j].reflection_O, 0.0) &&
         !tracks_[i].support.SharesFrame(owner.support, SensorKind::kCamera);
}

// Whether track i stands in the place of track j, its senior, and moves with it.
bool Tracker::IsWithin(std::size_t i, std::size_t j) const {
  const LocalTrack& young = tracks_[i];
  const LocalTrack& old = tracks_[j];
  if (i == j || hidden_[j].is_dead || !IsSenior(old, young) || SeenAsTwo(j, i)) return false;
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
  const double difference =
      (hidden_[i].filter.velocity_O() - hidden_[j].filter.velocity_O()).norm();
  const double doubt = hidden_[i].filter.is_vehicle() ? 0.0 : 8.0;
  return difference < 3.0 + doubt;
}

// A lorry's rear axle reflects ten metres behind its face and starts a track of its own. It moves
// with the lorry, on its axis, and no picture shows it beside it.
void Tracker::JoinParts(double dt_s) {
  // Far enough for the longest vehicle, and for one that has just been lengthened.
  constexpr double kReach_m = 2.0 * kLongestVehicle_m;
  bool has_lorry = false;
  for (const LocalTrack& track : tracks_) has_lorry = has_lorry || IsLong(track.object_class);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (hidden_[i].is_dead) continue;
    std::size_t whole = tracks_.size();
    double needed_m = 0.0;
    if (has_lorry) {
      places_.ForEachNear(tracks_[i].state_O.mean.head<2>(), kReach_m, [&](std::size_t j) {
        if (j >= whole) return;  // The oldest counts.
        const auto length_m = LengthWithPart(i, j);
        if (!length_m) return;
        whole = j;
        needed_m = *length_m;
      });
    }
    if (whole == tracks_.size()) {
      hidden_[i].part_s = 0.0;
      continue;
    }
    hidden_[i].part_s += dt_s;
    if (hidden_[i].part_s < (tracks_[i].is_confirmed ? kPartHold_s : kTentativeHold_s)) continue;
    hidden_[i].is_dead = true;
    hidden_[whole].filter.Lengthen(needed_m, kPartSigma_m);
    hidden_[whole].filter.Show(settings_, tracks_[whole]);
  }
}

// How long lorry j is if track i is its far end; nullopt where it cannot be.
std::optional<double> Tracker::LengthWithPart(std::size_t i, std::size_t j) const {
  const LocalTrack& part = tracks_[i];
  const LocalTrack& lorry = tracks_[j];
  if (i == j || hidden_[j].is_dead || !hidden_[j].filter.is_vehicle()) return std::nullopt;
  if (!IsLong(lorry.object_class) || !lorry.is_confirmed || !IsSenior(lorry, part))
    return std::nullopt;
  if (part.support.SharesFrame(lorry.support, SensorKind::kCamera)) return std::nullopt;
  if (SeenAsTwo(i, j)) return std::nullopt;
  const Eigen::Rotation2D<double> into(-lorry.state_O.mean[kYaw]);
  // What is seen of it is its last reflection; its centre lies where a car's would.
  if (ToSeconds(now_ - hidden_[i].reflected) > kFreshReflection_s) return std::nullopt;
  const Eigen::Vector2d between = into * (hidden_[i].reflection_O - lorry.state_O.mean.head<2>());
  if (std::abs(between.y()) > kPartAside_m) return std::nullopt;
  const Eigen::Vector2d sensor =
      into * (hidden_[j].filter.seen_from_O() - lorry.state_O.mean.head<2>());
  const double behind_m = sensor.x() > 0.0 ? -between.x() : between.x();
  const double reach_m =
      std::min(kLongestVehicle_m, lorry.extent.length_m + 2.0 * lorry.extent.length_sigma_m);
  const double from_face_m = 0.5 * lorry.extent.length_m + behind_m;
  if (from_face_m < -kInside_m || from_face_m > reach_m) return std::nullopt;
  const double speed = (hidden_[i].filter.velocity_O() - hidden_[j].filter.velocity_O()).norm();
  const double doubt = hidden_[i].filter.is_vehicle() ? 0.0 : 8.0;
  if (speed > kPartSpeed_mps + doubt) return std::nullopt;
  return from_face_m;
}

}  // namespace v2vouch
