// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/spy/screen.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "daemon/programs/spy/field_tree.h"
#include "daemon/programs/spy/plain_words.h"
#include "daemon/programs/spy/printable.h"

namespace v2vouch::spy {
namespace {

constexpr char kUp = 'k', kDown = 'j', kPageUp = 'u', kPageDown = 'd';
constexpr std::size_t kPage = 10;

// Rows and columns; 24 x 80 where the terminal does not say.
std::pair<std::size_t, std::size_t> SizeOfTerminal() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_row == 0) return {24, 80};
  return {size.ws_row, size.ws_col};
}

}  // namespace

Screen::Screen() {
  is_set_ = tcgetattr(STDIN_FILENO, &before_) == 0;
  if (is_set_) {
    termios raw = before_;
    raw.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    raw.c_cc[VMIN] = 0;
    raw.c_cc[VTIME] = 0;
    tcsetattr(STDIN_FILENO, TCSANOW, &raw);
  }
  std::fputs("\x1b[?1049h\x1b[?25l", stdout);  // Another screen, no cursor.
}

Screen::~Screen() {
  std::fputs("\x1b[?25h\x1b[?1049l", stdout);
  std::fflush(stdout);
  if (is_set_) tcsetattr(STDIN_FILENO, TCSANOW, &before_);
}

std::vector<std::string> Screen::Channels(const Moment& moment) const {
  std::vector<std::string> channels;
  for (const auto& [channel, row] : moment.table->rows()) {
    if (channel.find(filter_) != std::string::npos) channels.push_back(channel);
  }
  return channels;
}

void Screen::Key(char key, const Moment& moment) {
  if (is_filtering_) {
    if (key == '\n' || key == '\r' || key == '\x1b') {
      is_filtering_ = false;
    } else if (key == '\x7f' || key == '\b') {
      if (!filter_.empty()) filter_.pop_back();
    } else if (key >= ' ' && key <= '~') {
      filter_ += key;
    }
    selected_ = 0;
    return;
  }
  std::size_t& at = opened_.empty() ? selected_ : scroll_;
  if (key == 'q') is_over_ = true;
  if (key == kUp) at -= std::min<std::size_t>(at, 1);
  if (key == kDown) ++at;
  if (key == kPageUp) at -= std::min(at, kPage);
  if (key == kPageDown) at += kPage;
  if (key == 't') is_tree_ = !is_tree_;
  if (key == '/' && opened_.empty()) {
    is_filtering_ = true;
    filter_.clear();
  }
  if (key == '\x1b' || key == '\x7f') opened_.clear();
  if (key == '\n' || key == '\r') {
    const auto channels = Channels(moment);
    if (opened_.empty() && selected_ < channels.size()) opened_ = channels[selected_];
    scroll_ = 0;
  }
}

bool Screen::TakeKeys(const Moment& moment) {
  char keys[64];
  const ssize_t count = read(STDIN_FILENO, keys, sizeof(keys));
  for (ssize_t i = 0; i < count; ++i) {
    // Arrows and page keys come as ESC [ A, B, 5~, 6~.
    if (keys[i] == '\x1b' && i + 2 < count && keys[i + 1] == '[') {
      const char code = keys[i + 2];
      const char meant = code == 'A'   ? kUp
                         : code == 'B' ? kDown
                         : code == '5' ? kPageUp
                         : code == '6' ? kPageDown
                                       : '\0';
      i += code == '5' || code == '6' ? 3 : 2;
      if (meant != '\0' && !is_filtering_) Key(meant, moment);
    } else {
      Key(keys[i], moment);
    }
  }
  return !is_over_;
}

void Screen::Draw(const Moment& moment, const std::string& title) {
  const auto size = SizeOfTerminal();
  const std::size_t rows = size.first;
  const std::size_t columns = size.second;
  std::string frame = "\x1b[H";
  std::size_t used = 0;
  const auto put = [&](const std::string& line, bool is_marked = false) {
    if (used + 1 >= rows) return;
    ++used;
    if (is_marked) frame += "\x1b[7m";
    frame += line.substr(0, columns);
    frame += is_marked ? "\x1b[0m\x1b[K\r\n" : "\x1b[K\r\n";
  };
  const auto channels = Channels(moment);
  if (opened_.empty()) {
    selected_ = std::min(selected_, channels.empty() ? 0 : channels.size() - 1);
    constexpr std::size_t kWideTable = 111;
    const auto lines = TableLines(moment, filter_, columns < kWideTable);
    put(title + (filter_.empty() && !is_filtering_ ? "" : "  filter: " + filter_));
    put(lines.front());
    const auto refusals = RefusalLines(moment);
    const std::size_t below = std::min<std::size_t>(refusals.size(), 5);
    const std::size_t room = rows > below + 4 ? rows - below - 4 : 1;
    const std::size_t first = selected_ >= room ? selected_ - room + 1 : 0;
    for (std::size_t i = first; i + 1 < lines.size() && i < first + room; ++i) {
      put(lines[i + 1], i == selected_);
    }
    for (std::size_t i = 0; i < below; ++i) put(refusals[i]);
  } else {
    const ChannelRow* row = moment.table->Find(opened_);
    std::vector<std::string> lines;
    if (row != nullptr) lines = is_tree_ ? FieldTree(row->newest) : Describe(row->newest);
    scroll_ = std::min(scroll_, lines.empty() ? 0 : lines.size() - 1);
    put(Printable(opened_));
    for (std::size_t i = scroll_; i < lines.size(); ++i) put(lines[i]);
  }
  frame += "\x1b[J\x1b[" + std::to_string(rows) + ";1H";
  frame += opened_.empty() ? "arrows, Enter: open   / filter   q quit"
                           : "arrows: scroll   t fields/words   Esc back   q quit";
  std::fputs(frame.c_str(), stdout);
  std::fflush(stdout);
}

}  // namespace v2vouch::spy
