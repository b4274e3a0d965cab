// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "daemon/common/base/result.h"

namespace v2vouch::wire {

/// Decodes bytes that may be hostile into a generated LCM type. In this order: size cap of the
/// type, fingerprint, a walk over every length field and string (each within its cap and the bytes
/// left), whole buffer consumed, and only then lcm-gen's own decode, inside its own catch-all.
/// Content is not judged here. Instantiated for every type that travels on a channel.
/// Why: lcm-gen 1.3.1 trusts every length, see the cases in tests/daemon/rim/wire/codec_test.cc.
template <class T>
Result<T> Decode(std::span<const std::uint8_t> bytes);

/// Encodes into `bytes`, reusing its storage. Length fields must already equal the vectors' sizes;
/// lcm-gen would read past the end otherwise, so this is checked (V2VOUCH_CHECK).
template <class T>
void Encode(const T& message, std::vector<std::uint8_t>& bytes);

}  // namespace v2vouch::wire
