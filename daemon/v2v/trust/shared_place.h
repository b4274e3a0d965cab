// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "daemon/common/base/time.h"
#include "daemon/common/base/visit.h"
#include "daemon/common/data/finding.h"

namespace v2vouch {

/// shared_place: several identities that claim one vehicle.
struct SharedPlaceConfig {
  double near_m = 1.2;      ///< Two claims so near each other are one place: no two cars can be ...
  double same_mps = 1.5;    ///< ... and this close in velocity.
  double alone_m = 4.0;     ///< The sensors see one vehicle within this of it, no second one.
  double withdraw_s = 2.0;  ///< For so long.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("near_m", near_m, {.above = 0.0, .at_most = 10.0});
    a.Field("same_mps", same_mps, {.above = 0.0, .at_most = 20.0});
    a.Field("alone_m", alone_m, {.above = 0.0, .at_most = 50.0});
    a.Field("withdraw_s", withdraw_s, {.above = 0.0, .at_most = 60.0});
  }
};

/// How long a sender's claims have been those of another sender, too, while the sensors see one
/// vehicle there: seconds shared less seconds apart, never below 0. Which of them belongs to the
/// vehicle is unknown, so none is believed; only a sender validated before is exempt. WITHDRAW
/// alone: two receivers with like errors may carry two honest cars to one place while one of them
/// is hidden. Copyable, fixed size.
class SharedPlace {
 public:
  void OnLook(Timestamp stamp, bool is_shared);
  /// Long enough that no further sender is validated there.
  [[nodiscard]] bool is_contested() const { return shared_s_ >= kContested_s; }
  [[nodiscard]] std::optional<Finding> Judge(const SharedPlaceConfig& config) const;

 private:
  static constexpr double kContested_s = 0.5;
  std::optional<Timestamp> last_look_;
  double shared_s_ = 0.0;
};

}  // namespace v2vouch
