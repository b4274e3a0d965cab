// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/spy/printable.h"

#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace v2vouch::spy {

std::string Printable(std::string_view text, std::size_t most) {
  std::string out;
  for (const char c : text.substr(0, most)) out += c >= ' ' && c <= '~' ? c : '?';
  if (text.size() > most) out += "...";
  return out;
}

std::string Format(const char* format, ...) {
  char text[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof(text), format, arguments);
  va_end(arguments);
  return text;
}

std::string DurationText(double seconds) {
  if (!std::isfinite(seconds)) return "-";
  if (std::abs(seconds) < 1.0) return Format("%.0f ms", 1000.0 * seconds);
  if (std::abs(seconds) < 120.0) return Format("%.1f s", seconds);
  return Format("%.0f min", seconds / 60.0);
}

std::string BytesText(double bytes) {
  if (bytes < 1000.0) return Format("%.0f B", bytes);
  if (bytes < 1e6) return Format("%.1f kB", bytes / 1e3);
  return Format("%.1f MB", bytes / 1e6);
}

}  // namespace v2vouch::spy
