// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <thread>

namespace v2vouch {

/// Between everything in this process that writes to stderr (our log, liblcm, OpenCV) and whatever
/// stderr really is. While it lives, a write to stderr never waits: not for a pipe that nobody
/// empties, a stopped terminal or a full disk. What cannot be passed on is kept up to 256 kB, then
/// dropped by whole lines and counted; a line tells how many once stderr takes text again.
///
/// One at a time.
class StderrRelay {
 public:
  StderrRelay();
  /// Passes on what is left, for 0.2 s at most, and gives stderr back.
  ~StderrRelay();
  StderrRelay(const StderrRelay&) = delete;
  StderrRelay& operator=(const StderrRelay&) = delete;

 private:
  void Run();
  void Keep(const char* text, std::size_t size);
  void PassOn();

  int real_ = -1;                    // What stderr was.
  std::array<int, 2> pipe_{-1, -1};  // Into which stderr leads now.
  std::string waiting_;              // Whole lines, but for the last.
  std::int64_t lost_ = 0;            // Lines, since it was last told.
  bool is_dropping_ = false;         // The rest of this line too.
  std::atomic<bool> must_stop_ = false;
  std::thread thread_;
};

}  // namespace v2vouch
