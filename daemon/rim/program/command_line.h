// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace v2vouch {

/// Exit codes of every program.
inline constexpr int kExitGood = 0;
inline constexpr int kExitFailed = 1;  ///< What was asked for failed.
inline constexpr int kExitUsage = 2;   ///< Usage or configuration.

/// Reads the command line of program `name`, whose options `app` has, and adds `--version`, which
/// prints "NAME 0.1.0" everywhere. What is wrong is told on standard error, for a mistyped option
/// or subcommand with the one that was probably meant. An empty value is refused: it is what an
/// unset shell variable leaves behind. So is a negative number where none can be.
/// @return the exit code where the program is to end now.
std::optional<int> ReadCommandLine(CLI::App& app, const std::string& name, int argc, char** argv);

/// Tells on standard error, as a note of program `name`, that a log has damaged stretches; nothing
/// where it has none.
void NoteDamage(const std::string& name, const std::string& path, std::int64_t damaged);

/// For `option->check(...)`: one of these words, with the nearest one named where it is not.
CLI::Validator OneOf(std::vector<std::string> words);

/// For `option->check(...)`: a number above 0.
CLI::Validator AboveZero();

}  // namespace v2vouch
