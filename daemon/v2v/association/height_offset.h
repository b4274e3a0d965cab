// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "daemon/common/data/input.h"

namespace v2vouch {

/// One sender's height beside the ego's.
struct HeightWitness {
  SenderId sender = 0;
  double difference_m = 0.0;  ///< Its height less the ego's, as reported.
  double slack_m = 4.0;       ///< By which it may differ on one road, with distance and grade.
  /// A LOCAL track has its place and speed while it drives, well enough to be validated but for the
  /// height, over this way; 0: none has.
  double agreed_m = 0.0;
};

/// What all heights differ by from the ego's: sea level against ellipsoid, or an elevation that was
/// left at 0. Such a constant is no bridge. It is accepted as another zero only where the sensors
/// confirm that the senders that report it drive on our road:
///
/// - below 20 m, which is what bridges and stacked roads have: two senders that LOCAL tracks agree
///   with over 50 m of way report the same difference. One alone never opens it: on two decks cars
///   can keep pace for long.
/// - from 20 m up, where roads cross but do not run above one another at one pace: two senders over
///   10 m, or one, where no other difference is reported, over 10 m (25 m if no other sender is
///   heard at all).
///
/// It takes more such senders than report the offset in force. A liar gains nothing by it: the rule
/// about levels does not apply to a sender without elevation. No offset (0) wins every tie, and
/// returns as soon as as many senders that the sensors confirm report it: a liar cannot push
/// honest senders onto another level for as long as one of them is seen. A new offset holds until
/// evidence speaks against it. Copyable.
class HeightOffset {
 public:
  /// @param witnesses all senders heard lately that report a height, in any order.
  /// @return whether the offset changed.
  bool Judge(std::span<const HeightWitness> witnesses);

  /// In force [m]; 0: none.
  [[nodiscard]] double offset_m() const { return offset_m_; }
  /// What all senders differ by beyond the offset in force, without enough evidence to say why;
  /// nullopt: they do not, or there is none.
  [[nodiscard]] std::optional<double> unexplained_m() const { return unexplained_m_; }

  /// How far two reports of the same difference may be apart.
  static constexpr double kSame_m = 3.0;
  static constexpr double kBridge_m = 20.0;
  static constexpr double kLeastWay_m = 10.0;
  static constexpr double kAloneWay_m = 25.0;
  static constexpr double kBridgeWay_m = 50.0;

 private:
  struct Votes {
    int agreed = 0;
    double mean_m = 0.0;
    double longest_m = 0.0;
    double second_m = 0.0;
  };
  bool Decide(std::span<const HeightWitness> witnesses);
  [[nodiscard]] static Votes VotesFor(double offset_m, std::span<const HeightWitness> witnesses);
  [[nodiscard]] static bool IsShown(const Votes& votes, std::span<const HeightWitness> witnesses);
  [[nodiscard]] static bool IsCommonToAll(double offset_m,
                                          std::span<const HeightWitness> witnesses);

  double offset_m_ = 0.0;
  std::optional<double> unexplained_m_;
};

}  // namespace v2vouch
