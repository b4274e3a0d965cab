// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace v2vouch::spy {

/// A track list as a table, the nearest vehicle first. Empty where the bytes are no list.
std::vector<std::string> TrackTable(std::span<const std::uint8_t> message);

/// V2VOUCH_STATUS in sentences: what is wrong first, "All is well." where nothing is. Empty where
/// the bytes are no status.
std::vector<std::string> StatusWords(std::span<const std::uint8_t> message);

/// The form that suits the type: table, words, or the tree of fields.
std::vector<std::string> Describe(std::span<const std::uint8_t> message);

}  // namespace v2vouch::spy
