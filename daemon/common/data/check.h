// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

namespace v2vouch {

/// Everything that can speak against a V2V sender, in alphabetical order of the names. The table
/// behind Describe() is the one place that says what each is; docs/reference/checks.md shows it.
enum class Check : std::uint8_t {
  kAccelerationResidual,
  kBridgeMisfit,
  kContestedCore,
  kContestedIdentity,
  kCourseAgainstPath,
  kEmptyPlace,
  kHeadingResidual,
  kImplausible,
  kImplausibleMotion,
  kLateMessages,
  kMessageRate,
  kOutOfReach,
  kOwnMotion,
  kPositionJump,
  kResidualDrift,
  kResidualJump,
  kResidualLevel,
  kSeenElsewhere,
  kSharedPlace,
  kSizeChange,
  kSpeedAgainstPath,
  kTwoPlaces,
  kVelocityResidual,
  kCount,
};

/// Class of an observation in ETSI TS 103 759 (of CAMs; a BSM's fields correspond). Values are
/// those of misbehavior_report_t.
enum class EtsiClass : std::int8_t {
  kNone = -1,  ///< What doubts an identity or a direction has no class there.
  kBeacon = 0,
  kStatic = 1,
  kSecurity = 2,
  kPosition = 3,
  kSpeed = 4,
  kAcceleration = 5,
};

struct CheckInfo {
  std::string_view name;  ///< As it leaves the car in MISBEHAVIOR.
  EtsiClass etsi_class = EtsiClass::kNone;
  /// The standard lists this very observation; else the class is our own assignment, by the field
  /// that is doubted.
  bool is_listed_by_etsi = false;
  std::string_view found_in;  ///< Source file without its ending, under daemon/.
  std::string_view finds;     ///< One clause.

  /// SAE J3287 lists the observation as reportable for BSMs. None of ours is: codes outside J2735's
  /// ranges and messages with an invalid signature are refused at reception and never become a
  /// claim, and its list has nothing kinematic.
  static constexpr bool kIsJ3287 = false;
};

const CheckInfo& Describe(Check check);
inline std::string_view NameOf(Check check) { return Describe(check).name; }

}  // namespace v2vouch
