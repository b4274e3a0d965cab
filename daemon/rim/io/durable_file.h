// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace v2vouch {

/// Writes a file so that whoever opens `path`, at whatever moment the power fails, finds either
/// what was there before or all of `content`: into a new file in the same folder, to the disk, in
/// place of the old one, and the folder to the disk too. Readable by all, writable by the owner.
/// A device or pipe is written into instead; what LookAtOutput() refuses, `inputs` among it, is
/// left alone.
/// @return false with `error` set; the old file is then untouched and no new one is left.
bool ReplaceFile(const std::string& path, std::string_view content, std::string& error,
                 std::span<const std::string> inputs = {});

}  // namespace v2vouch
