// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "daemon/common/base/time.h"
#include "daemon/common/base/visit.h"
#include "daemon/common/data/finding.h"
#include "daemon/common/data/missed_detection.h"

namespace v2vouch {

/// empty_place for senders that no sensor vouches for: is there anything where they say they are?
struct ClaimedPlaceConfig {
  double look_s = 0.3;        ///< At most one observation per this time: not independent.
  double bias_sigma_m = 1.5;  ///< GNSS bias that an honest sender may have, per axis.
  double false_detection = kFalseDetection;  ///< Chance that something is seen where nothing is.
  double clear_doubt = kClearDoubt;          ///< Chance that what is called clear is covered.
  double recovery_s = 5.0;           ///< Doubt fades with this time constant while out of view.
  double occupied_s = 0.6;           ///< ... with this one while something is there.
  double slack_m = 1.0;              ///< A track whose box comes so near explains a claim.
  double slack_mps = 3.0;            ///< So may their speeds differ.
  double withdraw_log_ratio = -4.6;  ///< At once ...
  double lasting_log_ratio = -3.3;   ///< ... or this for lasting_s: one corner may be hidden.
  double lasting_s = 1.5;
  double accuse_log_ratio = -7.0;  ///< And this must last accuse_hold_s.
  double max_distance_m = 100.0;   ///< Farther positions are not observed.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("look_s", look_s, {.above = 0.01, .at_most = 5.0});
    a.Field("bias_sigma_m", bias_sigma_m, {.above = 0.0, .at_most = 10.0});
    a.Field("false_detection", false_detection, {.at_least = 0.0, .below = 0.5});
    a.Field("clear_doubt", clear_doubt, {.above = 0.0, .below = 1.0});
    a.Field("recovery_s", recovery_s, {.above = 0.1, .at_most = 600.0});
    a.Field("occupied_s", occupied_s, {.above = 0.01, .at_most = 600.0});
    a.Field("slack_m", slack_m, {.at_least = 0.0, .at_most = 10.0});
    a.Field("slack_mps", slack_mps, {.at_least = 0.0, .at_most = 50.0});
    a.Field("withdraw_log_ratio", withdraw_log_ratio, {.at_least = -100.0, .below = 0.0});
    a.Field("lasting_log_ratio", lasting_log_ratio, {.at_least = -100.0, .below = 0.0});
    a.Field("lasting_s", lasting_s, {.at_least = 0.0, .at_most = 60.0});
    a.Field("accuse_log_ratio", accuse_log_ratio, {.at_least = -100.0, .below = 0.0});
    a.Field("max_distance_m", max_distance_m, {.above = 1.0, .at_most = 500.0});
  }
};

/// Whether a vehicle can be where a sender claims, though the sensors see none there. The claim has
/// an unknown bias b of a few metres, so the vehicle may be at any of nine places: the claimed one
/// and sqrt(3) sigma off along and across it (Gauss-Hermite points, weights w_i). Each observation
/// says for each position how likely the sensors would have shown a vehicle there,
///
///     l_i <- l_i (1 - (1 - clear_doubt) P_i) / (1 - false_detection),  l_i in [1e-5, 1]
///     log ratio = ln sum_i w_i l_i
///
/// P_i = 0 where the place is covered, out of view or not known to be clear: then l_i goes back to
/// 1 with the time constant recovery_s; with occupied_s where something is that may be the vehicle
/// (which may just drive past). So the ratio never falls below the weight of the positions that
/// cannot be seen, however long it is observed: a sender that may be hidden loses nothing.
///
/// Copyable, fixed size.
class ClaimedPlace {
 public:
  static constexpr std::size_t kPlaces = 9;
  /// Offsets in units of sigma along and across the claimed direction, and weights; the claimed
  /// place itself comes first.
  struct Place {
    double along;
    double across;
    double weight;
  };
  static const std::array<Place, kPlaces>& Places();

  enum class Seen : std::uint8_t { kUnknown, kOccupied, kEmpty };
  struct Look {
    Seen seen = Seen::kUnknown;
    double detection = 0.0;  ///< P_i, where kEmpty.
  };

  /// Whether the next observation is due.
  [[nodiscard]] bool IsDue(Timestamp stamp, const ClaimedPlaceConfig& config) const;
  void OnLook(Timestamp stamp, std::span<const Look, kPlaces> looks,
              const ClaimedPlaceConfig& config);
  /// The sensors vouch for the sender: no doubt is left.
  void OnVouched() {
    likelihood_.fill(1.0F);
    accusable_since_.reset();
    doubted_since_.reset();
  }
  /// There is doubt that a change of identity must not clear.
  [[nodiscard]] bool has_doubt() const { return log_ratio() < -0.5; }

  [[nodiscard]] double log_ratio() const;
  /// At the last observation. It accuses where the ratio has been low enough for `hold_s`.
  [[nodiscard]] std::optional<Finding> Judge(double hold_s, const ClaimedPlaceConfig& config) const;

 private:
  static constexpr std::array<float, kPlaces> kCertain = {1, 1, 1, 1, 1, 1, 1, 1, 1};
  std::array<float, kPlaces> likelihood_ = kCertain;
  std::optional<Timestamp> last_look_;
  std::optional<Timestamp> doubted_since_;    // Below lasting_log_ratio since ...
  std::optional<Timestamp> accusable_since_;  // ... below accuse_log_ratio since.
};

}  // namespace v2vouch
