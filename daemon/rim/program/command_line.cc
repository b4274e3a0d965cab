// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/program/command_line.h"

#include <cstdio>
#include <iostream>
#include <sstream>

#include "daemon/common/base/did_you_mean.h"

namespace v2vouch {
namespace {

// Options and subcommands as they are typed.
void Collect(const CLI::App& app, std::vector<std::string>& options,
             std::vector<std::string>& commands) {
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) options.push_back("--" + name);
  }
  for (const CLI::App* command : app.get_subcommands(nullptr)) {
    commands.push_back(command->get_name());
    Collect(*command, options, commands);
  }
}

std::string Hints(const CLI::App& app) {
  std::vector<std::string> options, commands;
  Collect(app, options, commands);
  std::string hints;
  for (const std::string& extra : app.remaining(true)) {
    const std::string word = extra.substr(0, extra.find('='));
    const std::string hint = DidYouMean(word, word.starts_with("-") ? options : commands);
    if (!hint.empty()) hints.append("\n").append(word).append(hint);
  }
  return hints;
}

// What CLI11 lets pass: "" for a name or a number, -1 as 18446744073709551615.
std::string Faults(const CLI::App& app) {
  std::string faults;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& given : option->results()) {
      const std::string line = (faults.empty() ? "" : "\n") + option->get_name() + ": ";
      if (given.empty()) {
        faults += line + "is empty; is a shell variable not set?";
      } else if (given.front() == '-' && option->get_type_name().starts_with("UINT")) {
        faults += line + given + ": must not be negative";
      }
    }
  }
  for (const CLI::App* command : app.get_subcommands()) {
    const std::string more = Faults(*command);
    if (!more.empty()) faults += (faults.empty() ? "" : "\n") + more;
  }
  return faults;
}

}  // namespace

std::optional<int> ReadCommandLine(CLI::App& app, const std::string& name, int argc, char** argv) {
  app.name(name);
  app.set_version_flag("--version", name + " " V2VOUCH_VERSION);
  try {
    app.parse(argc, argv);
    const std::string faults = Faults(app);
    if (!faults.empty()) throw CLI::ValidationError(faults);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {
      // --help and --version print and end. Not through std::cout, which CLI11 flushes: why it
      // could not be written must still be known at the end.
      std::ostringstream text;
      app.exit(error, text, text);
      std::fputs(text.str().c_str(), stdout);
      return kExitGood;
    }
    const std::string hints = Hints(app);
    std::fprintf(stderr, "%s: %s%s\nRun %s --help for options and examples.\n", name.c_str(),
                 error.what(), hints.c_str(), name.c_str());
    return kExitUsage;
  }
}

void NoteDamage(const std::string& name, const std::string& path, std::int64_t damaged) {
  if (damaged == 0) return;
  std::cerr << name << ": note: " << path << ": " << damaged
            << " damaged stretches, cut off or overwritten; what they held is missing\n";
}

CLI::Validator OneOf(std::vector<std::string> words) {
  const std::string all = Listed(words);
  return {[words = std::move(words), all](std::string& given) {
            for (const std::string& word : words) {
              if (word == given) return std::string();
            }
            return given + ": must be one of " + all + DidYouMean(given, words);
          },
          "{" + all + "}"};
}

CLI::Validator AboveZero() {
  return {[](std::string& given) {
            double value = 0.0;
            if (CLI::detail::lexical_cast(given, value) && value > 0.0) return std::string();
            return given + ": must be a number above 0";
          },
          "above 0"};
}

}  // namespace v2vouch
