// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/config/number_text.h"

#include <array>
#include <charconv>
#include <cmath>

#include "daemon/common/base/angle.h"

namespace v2vouch::config {

std::string NumberText(double number) {
  std::array<char, 40> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), number);
  return std::string(text.data(), end);
}

std::string DegreesText(double radians) {
  // Conversion rounds: several decimal texts may mean the same angle, and ToDegrees alone may give
  // 59.99999999999999 for 60.
  std::array<char, 40> text{};
  for (int digits = 1; digits <= 17; ++digits) {
    const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(),
                                            ToDegrees(radians), std::chars_format::general, digits);
    double degrees = 0.0;
    std::from_chars(text.data(), end, degrees);
    if (FromDegrees(degrees) == radians) return NumberText(degrees);
  }
  for (const double towards : {-1e9, 1e9}) {
    const double degrees = std::nextafter(ToDegrees(radians), towards);
    if (FromDegrees(degrees) == radians) return NumberText(degrees);
  }
  return NumberText(ToDegrees(radians));
}

}  // namespace v2vouch::config
