// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace v2vouch::spy {

/// A message as indented lines "name  value unit", types within types and arrays below their field.
/// Of an array the first `most_elements` are shown, of all lines at most 2000. Other people's types
/// and broken messages: size and first bytes.
std::vector<std::string> FieldTree(std::span<const std::uint8_t> message,
                                   std::size_t most_elements = 16);

}  // namespace v2vouch::spy
