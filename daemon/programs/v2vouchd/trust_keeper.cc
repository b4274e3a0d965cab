// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/v2vouchd/trust_keeper.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdlib>
#include <tuple>
#include <utility>

#include "daemon/rim/io/durable_file.h"

namespace v2vouch {
namespace {

using Clock = std::chrono::steady_clock;

// The ages in the file count from when it was written; only "validated until now" has to be
// renewed.
constexpr std::chrono::seconds kRenew{30};

bool IsUnchanged(const std::vector<TrustMemory>& a, const std::vector<TrustMemory>& b) {
  return std::ranges::equal(a, b, [](const TrustMemory& x, const TrustMemory& y) {
    return std::tie(x.sender, x.certificate, x.state, x.suspicions, x.accusations) ==
           std::tie(y.sender, y.certificate, y.state, y.suspicions, y.accusations);
  });
}

Timestamp WallClock() {
  return FromMicros(std::chrono::duration_cast<std::chrono::microseconds>(
                        std::chrono::system_clock::now().time_since_epoch())
                        .count());
}

}  // namespace

TrustKeeper::TrustKeeper(const StateConfig& config, const std::string& vehicle)
    : config_(config), vehicle_(vehicle), is_active_(config.enabled && !config.file.empty()) {
  if (is_active_) thread_ = std::thread([this] { Run(); });
}

TrustKeeper::~TrustKeeper() { StopThread(); }

void TrustKeeper::StopThread() {
  {
    const std::lock_guard lock(mutex_);
    must_stop_ = true;
  }
  has_some_.notify_one();
  if (thread_.joinable()) thread_.join();
}

std::vector<TrustMemory> TrustKeeper::Load() {
  if (!is_active_) {
    spdlog::info("event=state_off hint=\"penalties of senders do not outlive this run\"");
    return {};
  }
  LoadedTrust loaded = LoadTrust(config_.file, vehicle_, WallClock(), config_.max_age_s);
  if (loaded.is_foreign) {
    is_active_ = false;
    spdlog::error("event=state_refused what=\"{}\" hint=\"it is left as it is; nothing is kept\"",
                  loaded.problem);
  } else if (!loaded.problem.empty()) {
    spdlog::warn("event=state_refused what=\"{}\" hint=\"starting without it\"", loaded.problem);
  } else {
    const auto penalties = std::ranges::count_if(loaded.senders, [](const TrustMemory& memory) {
      return memory.state != TrustState::kCandidate;
    });
    spdlog::info("event=state_loaded file=\"{}\" senders={} penalties={}", config_.file,
                 loaded.senders.size(), penalties);
  }
  return std::move(loaded.senders);
}

bool TrustKeeper::IsDue(Clock::time_point now) const {
  return is_active_ && now - looked_ >= std::chrono::duration<double>(config_.period_s);
}

void TrustKeeper::Keep(const std::vector<TrustMemory>& senders, Clock::time_point now) {
  looked_ = now;
  const bool renew = !senders.empty() && now - written_ >= kRenew;
  if (IsUnchanged(senders, kept_) && !renew) return;
  kept_ = senders;
  written_ = now;
  {
    const std::lock_guard lock(mutex_);
    waiting_ = Print(senders);
  }
  has_some_.notify_one();
}

void TrustKeeper::Finish(const std::vector<TrustMemory>& senders) {
  if (!is_active_ || (senders.empty() && kept_.empty())) return;
  StopThread();
  Write(Print(senders));
}

void TrustKeeper::Run() {
  std::unique_lock lock(mutex_);
  while (true) {
    has_some_.wait(lock, [this] { return must_stop_ || waiting_; });
    if (must_stop_) return;
    const std::string content = *std::exchange(waiting_, std::nullopt);
    lock.unlock();
    Write(content);
    lock.lock();
  }
}

// One line when it begins to fail, one when it works again.
void TrustKeeper::Write(const std::string& content) {
  std::string error;
  const bool is_good = ReplaceFile(config_.file, content, error);
  if (!is_good && !has_failed_) spdlog::error("event=state_not_saved what=\"{}\"", error);
  if (is_good && has_failed_) spdlog::info("event=state_saved_again file=\"{}\"", config_.file);
  has_failed_ = !is_good;
}

std::string TrustKeeper::Print(const std::vector<TrustMemory>& senders) const {
  return PrintTrust({vehicle_, WallClock(), senders});
}

}  // namespace v2vouch
