// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/io/std_streams.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>

namespace v2vouch {
namespace {

void OpenIfClosed(int stream, int mode) {
  if (fcntl(stream, F_GETFD) >= 0) return;
  // The lowest free number is given, and those below are open by now.
  const int opened = open("/dev/null", mode);
  if (opened >= 0 && opened != stream) close(opened);
}

// As of GNU's close_stdout, which every tool of theirs has at its exit. std::cout goes through
// stdout's buffer.
void CheckStandardOutput(int status, void* program) {
  errno = 0;
  bool is_good = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  // A network file system may complain at close only. Others still flush at exit: a copy is closed.
  if (is_good) {
    const int copy = dup(STDOUT_FILENO);
    is_good = copy < 0 || close(copy) == 0;
  }
  if (is_good || IsReaderGone()) return;
  std::fprintf(stderr, "%s: standard output: %s\n", static_cast<const char*>(program),
               errno != 0 ? std::strerror(errno) : "could not be written");
  if (status == 0) _exit(1);
}

const char* program_name = "";

// Mostly: the system gives no memory, or no thread. abort() would be a crash without a word.
void TellAndEnd() {
  if (const auto thrown = std::current_exception()) {
    try {
      std::rethrow_exception(thrown);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "%s: cannot go on: %s\n", program_name, error.what());
    } catch (...) {
      std::fprintf(stderr, "%s: cannot go on: an exception of unknown kind\n", program_name);
    }
  } else {
    std::abort();  // A mistake of our own, such as a thread that was not joined.
  }
  poll(nullptr, 0, 150);  // Where a thread passes stderr on, it gets the time to.
  _exit(1);
}

}  // namespace

bool IsReaderGone() {
  // Of a pipe whose other end is closed the kernel says POLLERR; of a socket POLLHUP.
  pollfd output{STDOUT_FILENO, POLLOUT, 0};
  return poll(&output, 1, 0) == 1 && (output.revents & (POLLERR | POLLHUP)) != 0;
}

void GuardStandardStreams(const char* program) {
  // The wrong way round on purpose: writing fails with EBADF and is noticed.
  OpenIfClosed(STDIN_FILENO, O_WRONLY);
  OpenIfClosed(STDOUT_FILENO, O_RDONLY);
  OpenIfClosed(STDERR_FILENO, O_RDONLY);
  signal(SIGPIPE, SIG_IGN);
  program_name = program;
  std::set_terminate(TellAndEnd);
  on_exit(CheckStandardOutput, const_cast<char*>(program));
}

}  // namespace v2vouch
