// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "daemon/programs/v2vouchd/receiver.h"
#include "daemon/rim/wire/status.h"

namespace v2vouch {

/// What the receive paths threw away before there was a message, and how often they joined again.
class DroppedDatagramTable {
 public:
  /// Reads the receivers' counts and logs what is new. @param v2v_bus null: one bus serves all.
  void Take(const Receiver& own_bus, const Receiver* v2v_bus);
  /// Since start.
  [[nodiscard]] const std::vector<wire::DroppedDatagrams>& rows() const { return rows_; }

 private:
  void TakeBus(const Receiver& bus, const char* name, std::int64_t& rejoins);

  std::vector<wire::DroppedDatagrams> rows_;
  std::int64_t own_rejoins_ = 0;
  std::int64_t v2v_rejoins_ = 0;
};

}  // namespace v2vouch
