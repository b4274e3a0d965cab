// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "daemon/common/base/time.h"

namespace v2vouch::evaluation {

/// The drive from above, to be played: ten frames a second (fewer of a long or crowded drive, so
/// that all of them stay within 16 MB before compression) as the live page would show them, with
/// that page's own drawing code. HTML with scripts, for one page; "" where the log holds no list.
///
/// @param first which moment is shown at first, in message time; the begin where there is none.
std::string SceneClip(const std::string& log, std::optional<Timestamp> first);

}  // namespace v2vouch::evaluation
