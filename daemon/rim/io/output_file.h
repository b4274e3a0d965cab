// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <span>
#include <string>

namespace v2vouch {

/// What stands at a path that a program was told to write to.
enum class OutputPlace {
  kFile,    ///< A file, or nothing yet: it may be replaced.
  kStream,  ///< A device or pipe: written into as it is, never replaced or removed.
  kRefused,
};

/// Looks before anything is written. Refused, with `error` set: a folder, a disk (block device), a
/// socket; a symbolic link to a file, or to nothing (whoever names a link may not know what would
/// be overwritten: the message tells the target); any of `inputs`, under whatever name. Links to
/// devices and pipes (/dev/stdout) are followed.
OutputPlace LookAtOutput(const std::string& path, std::span<const std::string> inputs,
                         std::string& error);

/// Opens for writing after that look; a file is made empty. A pipe that nobody reads is an error
/// instead of a wait. @return nullptr with `error` set.
std::FILE* OpenOutput(const std::string& path, std::span<const std::string> inputs,
                      std::string& error);

}  // namespace v2vouch
