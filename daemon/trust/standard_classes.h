// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace v2vouch {

/// Where a finding stands in the standards on misbehaviour reports.
struct StandardClass {
  /// Class of the observation in ETSI TS 103 759 (of CAMs; a BSM's fields correspond): 0 beacon,
  /// 1 static, 2 security, 3 position, 4 speed, 5 longitudinal acceleration; -1 = it has none.
  std::int8_t etsi_class = -1;
  /// SAE J3287 lists the observation as reportable for BSMs: a longitudinal acceleration outside
  /// J2735's codes, and seven inconsistencies of the security header or the certificate.
  bool is_j3287 = false;
};

/// nullopt: no check of this name exists.
std::optional<StandardClass> StandardClassOf(std::string_view check);

}  // namespace v2vouch
