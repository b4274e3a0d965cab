// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace v2vouch {

/// First call of every program's main():
///
/// - A standard stream that is closed is opened as one that takes nothing. Otherwise the next file
///   or socket would get its number, and messages for people would be written into that.
/// - A reader of a pipe that goes away (`| head`) has what it wanted: no SIGPIPE, no word, and the
///   program's own exit code. What prints much asks IsReaderGone() and ends early.
/// - At exit: results that standard output did not take otherwise (full device, closed) are told on
///   stderr, and exit code 0 becomes 1.
/// - An exception that nobody caught (no memory, no thread) is told on stderr: exit code 1, no
///   crash.
///
/// @param program its name, for that message; a string literal.
void GuardStandardStreams(const char* program);

/// Whether standard output is a pipe or socket that nobody reads any more.
bool IsReaderGone();

}  // namespace v2vouch
