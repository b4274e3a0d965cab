// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace v2vouch {

/// The known name that was probably meant by `name`: fewest letters changed, left out, added or
/// swapped with their neighbour (optimal string alignment), upper and lower case being the same
/// letter. At most two such slips, or one in three letters of a longer name, and never more than
/// half of the name. The first of equals. "" where no name is near enough, or where it is known.
std::string_view NearestName(std::string_view name, std::span<const std::string_view> known);

/// " (did you mean RADAR_FRONT?)" to put behind a message; "" where no name is near enough.
std::string DidYouMean(std::string_view name, std::span<const std::string_view> known);
std::string DidYouMean(std::string_view name, const std::vector<std::string>& known);

/// "a, b, c"; longer lists end in ", ... (12 in all)".
std::string Listed(const std::vector<std::string>& names, std::size_t at_most = 24);

}  // namespace v2vouch
