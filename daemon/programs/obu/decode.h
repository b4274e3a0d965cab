// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "daemon/obu/framing/layer.h"
#include "daemon/obu/security/trust_anchors.h"

namespace v2vouch::obu {

struct DecodeOptions {
  std::string path;
  bool as_json = false;
  bool join_lines = false;  ///< Of hex text: the file is one datagram.
  std::optional<Layer> framing;
};

/// Prints what is in a file, packet by packet, on standard output.
/// @return exit code: 1 where the file cannot be read to its end or holds no packet.
int Decode(const DecodeOptions& options, TrustAnchors anchors);

/// Fills `anchors` with the certificates (COER or hex, one a file) of two folders; "" = none.
/// @return false with what is wrong on standard error.
bool LoadAnchors(const std::string& roots, const std::string& issuers, TrustAnchors& anchors);

}  // namespace v2vouch::obu
