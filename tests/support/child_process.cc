// SPDX-License-Identifier: Apache-2.0
#include "tests/support/child_process.h"

#include <sys/wait.h>

#include <array>
#include <cstdio>

namespace v2vouch {

Finished Execute(const std::string& command) {
  Finished finished;
  std::FILE* const pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return finished;
  std::array<char, 4096> chunk{};
  while (std::fgets(chunk.data(), static_cast<int>(chunk.size()), pipe) != nullptr) {
    finished.output += chunk.data();
  }
  const int status = pclose(pipe);
  if (WIFEXITED(status)) finished.code = WEXITSTATUS(status);
  return finished;
}

Finished Called(const std::string& program, const std::string& arguments) {
  return Execute("'" + program + "' " + arguments + " 2>&1");
}

}  // namespace v2vouch
