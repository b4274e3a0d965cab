// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace v2vouch::spy {

/// Text from the bus for a terminal: what could steer it (control characters, odd bytes) is '?'.
/// Longer than `most` bytes: cut, with "..." at the end.
std::string Printable(std::string_view text, std::size_t most = 200);

/// printf into a string.
[[gnu::format(printf, 1, 2)]] std::string Format(const char* format, ...);

/// A duration for people: "12 ms", "3.4 s", "5 min".
std::string DurationText(double seconds);

/// "1.2 kB".
std::string BytesText(double bytes);

}  // namespace v2vouch::spy
