// SPDX-License-Identifier: Apache-2.0
#include "sim/campaign/children.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

extern char** environ;

namespace v2vouch::campaign {
namespace {

std::string Content(const std::filesystem::path& path, std::size_t most) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  std::string content = text.str();
  if (content.size() > most) content.erase(0, content.size() - most);
  return content;
}

}  // namespace

ChildResult Children::Run(const std::vector<std::string>& command,
                          const std::filesystem::path& scratch) {
  constexpr std::size_t kMostOutput = 64u << 20;
  constexpr std::size_t kMostErrors = 4096;
  const std::string out = scratch.string() + ".out", err = scratch.string() + ".err";
  std::vector<char*> arguments;
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0644);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0644);
  // A group of its own: Ctrl-C reaches the campaign alone, which then ends its children in order.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  posix_spawnattr_setpgroup(&attributes, 0);

  ChildResult result;
  pid_t child = 0;
  int fault = 0;
  {
    // Started under the lock, so that Stop() misses none.
    const std::lock_guard lock(mutex_);
    if (!is_stopped_) {
      fault = posix_spawn(&child, arguments[0], &files, &attributes, arguments.data(), environ);
      result.has_started = fault == 0;
      if (result.has_started) running_.insert(child);
    }
  }
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  if (!result.has_started) {
    result.err = fault == 0 ? "stopped" : std::string("cannot start: ") + std::strerror(fault);
    return result;
  }
  int status = 0;
  // Waits without reaping first: as long as the child is in `running_`, its id is nobody else's.
  siginfo_t info{};
  while (waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOWAIT) != 0 && errno == EINTR) {
  }
  {
    const std::lock_guard lock(mutex_);
    running_.erase(child);
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
  }
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  result.out = Content(out, kMostOutput);
  result.err = Content(err, kMostErrors);
  std::error_code ignored;
  std::filesystem::remove(out, ignored);
  std::filesystem::remove(err, ignored);
  return result;
}

void Children::Stop() {
  const std::lock_guard lock(mutex_);
  is_stopped_ = true;
  for (const pid_t child : running_) kill(child, SIGTERM);
}

bool Children::is_stopped() const {
  const std::lock_guard lock(mutex_);
  return is_stopped_;
}

std::string ShellText(const std::vector<std::string>& command) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./=:,+@%";
  std::string text;
  for (const std::string& word : command) {
    if (!text.empty()) text += ' ';
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) {
      text += word;
      continue;
    }
    text += '\'';
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    text += '\'';
  }
  return text;
}

}  // namespace v2vouch::campaign
