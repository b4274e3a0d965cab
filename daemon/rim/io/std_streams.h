// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace v2vouch {

/// First call of every program's main():
///
/// - A standard stream that is closed is opened as one that takes nothing. Otherwise the next file
///   or socket would get its number, and messages for people would be written into that.
/// - A reader that goes away (SIGPIPE) is a failed write, not the end of the program.
/// - At exit: results that standard output did not take (full device, closed, reader gone) are told
///   on stderr, and exit code 0 becomes 1.
///
/// @param program its name, for that message; a string literal.
void GuardStandardStreams(const char* program);

}  // namespace v2vouch
