// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/io/stop_signal.h"

#include <poll.h>
#include <signal.h>
#include <sys/time.h>
#include <unistd.h>

#include <cstring>

namespace v2vouch {
namespace {

constexpr suseconds_t kPatience_us = 800'000;

volatile sig_atomic_t stop_asked = 0;
volatile sig_atomic_t reload_asked = 0;

// Signal handlers: only what is safe at any moment.
void EndNow(int) {
  constexpr char kWords[] = "stopped in the middle of a step\n";
  pollfd out{STDERR_FILENO, POLLOUT, 0};
  if (poll(&out, 1, 0) == 1 && (out.revents & POLLOUT) != 0) {
    static_cast<void>(!write(STDERR_FILENO, kWords, sizeof(kWords) - 1));
  }
  _exit(1);
}

void AskToStop(int signal) {
  if (stop_asked != 0) EndNow(signal);
  stop_asked = 1;
  itimerval patience{};
  patience.it_value.tv_usec = kPatience_us;
  setitimer(ITIMER_REAL, &patience, nullptr);
}

void AskToReload(int) { reload_asked = 1; }

void Handle(int number, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(number, &action, nullptr);
}

}  // namespace

void HandleStopSignals() {
  Handle(SIGALRM, EndNow);
  Handle(SIGINT, AskToStop);
  Handle(SIGTERM, AskToStop);
}

bool IsStopAsked() { return stop_asked != 0; }

void HandleReloadSignal() { Handle(SIGHUP, AskToReload); }

bool TakeReloadAsked() {
  const bool was_asked = reload_asked != 0;
  reload_asked = 0;
  return was_asked;
}

}  // namespace v2vouch
