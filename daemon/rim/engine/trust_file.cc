// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/engine/trust_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <span>

#include "daemon/common/base/sha256.h"

namespace v2vouch {
namespace {

constexpr std::string_view kMagic = "v2vouch-trust ";
constexpr std::string_view kHeader = "v2vouch-trust 1";
constexpr std::string_view kChecksum = "sha256 ";
constexpr std::int64_t kMostAge_ms = 1'000'000'000'000;  // Thirty years.
constexpr std::int64_t kMostCount = 1'000;
constexpr double kClockPlay_s = 60.0;  // A clock set back by less is no news.

std::string Digest(std::string_view text) {
  Sha256 digest;
  digest.Add({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
  return digest.Hex();
}

std::string_view NameOf(TrustState state) {
  return state == TrustState::kRevoked   ? "REVOKED"
         : state == TrustState::kSuspect ? "SUSPECT"
                                         : "KNOWN";
}

std::int64_t ToMillis(double seconds) {
  const double ms = std::round(1e3 * seconds);
  return ms >= 0.0 ? static_cast<std::int64_t>(std::min(ms, static_cast<double>(kMostAge_ms))) : 0;
}

// Words of one line, each taken exactly once; the first fault sticks.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}

  std::string_view Text() {
    const auto end = std::min(rest_.find(' '), rest_.size());
    const std::string_view word = rest_.substr(0, end);
    is_good_ &= !word.empty();
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    return word;
  }
  std::int64_t Integer(std::int64_t least, std::int64_t most) {
    std::int64_t value = 0;
    Take(Text(), value, 10);
    is_good_ &= value >= least && value <= most;
    return value;
  }
  std::uint64_t Hex(std::size_t digits) {
    const std::string_view word = Text();
    std::uint64_t value = 0;
    is_good_ &= word.size() == digits;
    Take(word, value, 16);
    return value;
  }
  [[nodiscard]] bool IsDone() const { return is_good_ && rest_.empty(); }

 private:
  template <class T>
  void Take(std::string_view word, T& value, int base) {
    const auto [stop, fault] = std::from_chars(word.data(), word.data() + word.size(), value, base);
    is_good_ &= fault == std::errc() && stop == word.data() + word.size();
  }

  std::string_view rest_;
  bool is_good_ = true;
};

std::optional<TrustMemory> ParseSender(std::string_view line) {
  Words words(line);
  TrustMemory memory;
  memory.sender = static_cast<SenderId>(words.Hex(8));
  const std::uint64_t certificate = words.Hex(16);
  for (std::size_t i = 0; i < 8; ++i) {
    memory.certificate[i] = static_cast<std::uint8_t>(certificate >> (56 - 8 * i));
  }
  const std::string_view state = words.Text();
  for (const auto each : {TrustState::kCandidate, TrustState::kSuspect, TrustState::kRevoked}) {
    if (state == NameOf(each)) memory.state = each;
  }
  memory.suspicions = static_cast<int>(words.Integer(0, kMostCount));
  memory.accusations = static_cast<int>(words.Integer(0, kMostCount));
  memory.since_s = 1e-3 * static_cast<double>(words.Integer(0, kMostAge_ms));
  memory.finding_s = 1e-3 * static_cast<double>(words.Integer(0, kMostAge_ms));
  if (!words.IsDone() || memory.state == TrustState::kNone) return std::nullopt;
  return memory;
}

}  // namespace

std::string PrintTrust(const TrustFile& file) {
  std::string text(kHeader);
  text += "\nvehicle " + file.vehicle + "\nsaved_us " + std::to_string(ToMicros(file.saved)) + "\n";
  for (const TrustMemory& memory : file.senders) {
    std::uint64_t certificate = 0;
    for (const std::uint8_t byte : memory.certificate) certificate = certificate << 8 | byte;
    std::array<char, 160> line{};
    std::snprintf(line.data(), line.size(), "%08x %016llx %s %d %d %lld %lld\n",
                  static_cast<unsigned>(memory.sender),
                  static_cast<unsigned long long>(certificate), NameOf(memory.state).data(),
                  memory.suspicions, memory.accusations,
                  static_cast<long long>(ToMillis(memory.since_s)),
                  static_cast<long long>(ToMillis(memory.finding_s)));
    text += line.data();
  }
  text += std::string(kChecksum) + Digest(text) + "\n";
  return text;
}

std::optional<TrustFile> ParseTrust(std::string_view text, std::string& problem) {
  const auto refuse = [&](const char* why) {
    problem = why;
    return std::nullopt;
  };
  if (!text.starts_with(kMagic)) return refuse("is no trust file");
  const auto checksum = text.rfind(kChecksum);
  if (text.size() > kMostTrustFileBytes || checksum == std::string_view::npos ||
      text.substr(checksum) != std::string(kChecksum) + Digest(text.substr(0, checksum)) + "\n") {
    return refuse("is damaged: its checksum does not fit");
  }
  text = text.substr(0, checksum);
  const auto next_line = [&text] {
    const auto end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return line;
  };
  if (next_line() != kHeader) return refuse("is of another version");
  TrustFile file;
  const std::string_view vehicle = next_line();
  if (!vehicle.starts_with("vehicle ")) return refuse("is damaged: names no vehicle");
  file.vehicle = vehicle.substr(8);
  Words saved(next_line());
  const bool has_key = saved.Text() == "saved_us";
  file.saved = FromMicros(saved.Integer(0, INT64_MAX / 4));
  if (!has_key || !saved.IsDone()) return refuse("is damaged: tells no time");
  while (!text.empty()) {
    const auto memory = ParseSender(next_line());
    if (!memory || file.senders.size() == kMostTrustMemories) {
      return refuse("is damaged: a sender's line cannot be read");
    }
    file.senders.push_back(*memory);
  }
  return file;
}

LoadedTrust LoadTrust(const std::string& path, const std::string& vehicle, Timestamp now,
                      double max_age_s) {
  LoadedTrust loaded;
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return loaded;
  const auto refuse = [&](const std::string& why) {
    loaded.problem = path + ": " + why;
    return loaded;
  };
  if (!std::filesystem::is_regular_file(path, ignored)) {  // Reading a pipe would wait.
    loaded.is_foreign = true;
    return refuse("is not a file");
  }
  std::ifstream stream(path, std::ios::binary);
  std::string text(kMostTrustFileBytes + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  std::string problem;
  const auto file = ParseTrust(text, problem);
  // A file that a full disk left empty has no owner.
  loaded.is_foreign = !text.empty() && !text.starts_with(kMagic);
  if (!file) return refuse(problem);
  if (file->vehicle != vehicle) {
    return refuse("is of vehicle \"" + file->vehicle.substr(0, 64) + "\", not \"" + vehicle + "\"");
  }
  const double since_s = ToSeconds(now - file->saved);
  if (since_s > max_age_s) {
    return refuse("is " + std::to_string(std::llround(since_s)) + " s old; at most " +
                  std::to_string(std::llround(max_age_s)) + " s are used");
  }
  const double age_s = std::max(0.0, since_s);
  for (TrustMemory memory : file->senders) {
    memory.since_s += age_s;
    memory.finding_s += age_s;
    const bool is_penalty = memory.state != TrustState::kCandidate;
    if (!is_penalty && since_s < -kClockPlay_s) continue;
    if ((is_penalty ? memory.finding_s : memory.since_s) > max_age_s) continue;
    loaded.senders.push_back(memory);
  }
  return loaded;
}

}  // namespace v2vouch
