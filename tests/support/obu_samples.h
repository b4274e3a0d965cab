// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/common/base/hex_text.h"
#include "daemon/obu/j2735/bsm.h"

namespace v2vouch {

using Octets = std::vector<std::uint8_t>;

Octets FromHex(const std::string& hex);

/// A payload of data/j2735_bsm_vectors.json.
struct BsmVector {
  Octets bytes;
  obu::BsmCore core;
  bool has_frame_extensions = false;
};
/// A payload that must be refused, and why.
struct BsmReject {
  Octets bytes;
  std::string why;
};
std::vector<BsmVector> BsmVectors();
std::vector<BsmReject> BsmRejects();

/// A record of data/obu/wydot: what a unit sent or received, with the values that two decoders of
/// others agree on.
struct UnitRecord {
  Octets bytes;  ///< As the unit framed it: WSMP, or 1609.2.
  bool is_bsm = false;
  obu::BsmCore core;
  std::int64_t log_utime = 0;         ///< The unit's clock.
  std::int64_t generation_utime = 0;  ///< 0 = none.
  std::string digest;                 ///< HashedId8 in hex; "" = unsigned.
  std::string signer;                 ///< "none", "digest", "cert".
  std::string file;
};
/// All records: 803 BSMs in four files, and what else they hold.
std::vector<UnitRecord> UnitRecords();

/// A file below data/obu; empty where it is absent.
Octets ObuFile(const std::string& name);
std::string ObuPath(const std::string& name);

/// Whether the reference data are here. Tests skip without.
bool HasObuData();
#define V2VOUCH_NEEDS_OBU_DATA() \
  if (!::v2vouch::HasObuData()) GTEST_SKIP() << "SKIPPED: no obu samples under V2VOUCH_DATA"

}  // namespace v2vouch
