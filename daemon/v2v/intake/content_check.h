// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "daemon/common/data/finding.h"
#include "daemon/v2v/intake/message_check_config.h"

namespace v2vouch {

/// `late_messages`, WITHDRAW, where the median age of the last ten messages exceeds
/// late_s. (A message older than the intake's max_age_s is refused at once.)
class DelayCheck {
 public:
  std::optional<Finding> Judge(double age_s, const MessageCheckConfig& config);

 private:
  std::array<float, 10> age_s_{};
  std::size_t next_ = 0;
  std::size_t count_ = 0;
};

/// `size_change`, WITHDRAW, on the message in which length or width differs from the
/// last told by more than size_change_m, or by more than size_change_share of it. The new size is
/// the reference from then on, so that one correction is reported once.
class SizeCheck {
 public:
  std::optional<Finding> Judge(std::optional<double> length_m, std::optional<double> width_m,
                               const MessageCheckConfig& config);

 private:
  std::optional<double> length_m_;
  std::optional<double> width_m_;
};

/// `implausible`, WITHDRAW, where so many of the last ten messages were refused for a
/// speed or an acceleration that cannot be.
class ImplausibleCheck {
 public:
  void OnMessage(bool is_implausible);
  [[nodiscard]] std::optional<Finding> Judge(const MessageCheckConfig& config) const;

 private:
  std::uint32_t refused_ = 0;  // One bit per message, the newest lowest.
};

}  // namespace v2vouch
