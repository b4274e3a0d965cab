// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace v2vouch {

struct Finished {
  int code = -1;  ///< Exit code; -1 when it could not be started or a signal ended it.
  std::string output;
};

/// Runs a line of shell to its end.
/// @return its standard output; with standard error where the line says `2>&1`.
Finished Execute(const std::string& command);

/// One of our programs as its users call it: `program` is a path, `arguments` as typed in a shell.
/// @return both of its streams.
Finished Called(const std::string& program, const std::string& arguments);

}  // namespace v2vouch
