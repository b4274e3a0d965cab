// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/program.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
#include <thread>

namespace v2vouch::testing {

Program::Program(const std::vector<std::string>& arguments, const std::string& output_path)
    : output_path_(output_path) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  // Emptied before the child runs: what an earlier run wrote must not be taken for this one's.
  const int output = open(output_path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  pid_ = fork();
  if (pid_ != 0) {
    if (output >= 0) close(output);
    return;
  }
  dup2(output, STDOUT_FILENO);
  dup2(output, STDERR_FILENO);
  execvp(argv[0], argv.data());
  _exit(127);
}

Program::~Program() {
  if (!IsRunning()) return;
  Signal(SIGKILL);
  static_cast<void>(Wait(std::chrono::seconds(5)));
}

void Program::Signal(int signal) const {
  if (pid_ > 0) kill(pid_, signal);
}

bool Program::IsRunning() { return pid_ > 0 && !Wait(std::chrono::milliseconds(0)); }

std::optional<int> Program::Wait(std::chrono::milliseconds timeout) {
  static_cast<void>(Eventually(
      [this] {
        int status = 0;
        if (!exit_code_ && waitpid(pid_, &status, WNOHANG) == pid_) {
          exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
        }
        return exit_code_.has_value();
      },
      timeout));
  return exit_code_;
}

std::string Program::Output() const {
  std::ifstream file(output_path_, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), {});
}

bool Eventually(const std::function<bool()>& condition, std::chrono::milliseconds timeout) {
  const auto end = std::chrono::steady_clock::now() + timeout;
  while (!condition()) {
    if (std::chrono::steady_clock::now() >= end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

}  // namespace v2vouch::testing
