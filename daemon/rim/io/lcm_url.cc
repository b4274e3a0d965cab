// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/io/lcm_url.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string_view>
#include <utility>

#include "daemon/rim/net/source.h"

namespace v2vouch {
namespace {

constexpr int kDefaultPort = 7667;
constexpr char kReceiver[] = "receiver";  // Our own options.
constexpr char kFrom[] = "from";
constexpr char kLiblcm[] = "liblcm";

using Options = std::vector<std::pair<std::string, std::string>>;

struct Parts {
  std::string provider;
  std::string network;  // Between "://" and "?".
  Options options;
};

std::optional<std::int64_t> ToInteger(const std::string& text) {
  std::int64_t value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, fault] = std::from_chars(text.data(), end, value);
  if (text.empty() || fault != std::errc() || stop != end) return std::nullopt;
  return value;
}

std::optional<Parts> Split(const std::string& url) {
  const auto slashes = url.find("://");
  if (slashes == std::string::npos) return std::nullopt;
  Parts parts;
  parts.provider = url.substr(0, slashes);
  const auto question = url.find('?', slashes);
  parts.network = url.substr(
      slashes + 3, question == std::string::npos ? std::string::npos : question - slashes - 3);
  if (question == std::string::npos) return parts;
  std::string rest = url.substr(question + 1);
  while (!rest.empty()) {
    const auto end = std::min(rest.find('&'), rest.size());
    const std::string option = rest.substr(0, end);
    const auto equals = std::min(option.find('='), option.size());
    parts.options.emplace_back(option.substr(0, equals),
                               equals < option.size() ? option.substr(equals + 1) : "");
    rest.erase(0, end + 1);
  }
  return parts;
}

std::vector<std::string> AtCommas(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t from = 0; from <= text.size();) {
    const auto to = std::min(text.find(',', from), text.size());
    words.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  return words;
}

const std::string* Find(const Options& options, const std::string& wanted) {
  for (const auto& [key, value] : options) {
    if (key == wanted) return &value;
  }
  return nullptr;
}

class Checker {
 public:
  Checker(const std::string& url, std::vector<std::string>& problems)
      : url_(url), problems_(problems) {}

  void Problem(const std::string& what) {
    problems_.push_back("LCM URL \"" + url_.substr(0, 200) + "\": " + what);
  }

  void Integer(const std::string& key, const std::string& text, std::int64_t least,
               std::int64_t most) {
    const auto value = ToInteger(text);
    if (value && *value >= least && *value <= most) return;
    Problem(key + " = \"" + text + "\": must be an integer from " + std::to_string(least) + " to " +
            std::to_string(most));
  }

  // HOST:PORT; the host comes back, "" where there is none.
  std::string HostAndPort(const std::string& network, const std::string& example) {
    const auto colon = network.rfind(':');
    const std::string host = network.substr(0, colon);
    if (colon == std::string::npos) {
      Problem("has no port; give one, as in " + example);
    } else {
      Integer("port", network.substr(colon + 1), 1, 65535);
    }
    return host;
  }

  template <class IsGood>
  void EachOption(const Options& options, const std::string& known, IsGood take) {
    for (const auto& [key, value] : options) {
      if (!take(key, value)) {
        Problem("unknown option \"" + key + "\"" +
                (known.empty() ? std::string(": takes none") : "; known: " + known));
      }
    }
  }

 private:
  const std::string& url_;
  std::vector<std::string>& problems_;
};

void CheckSources(const Parts& parts, const std::string& value, Checker& check) {
  net::SourceFilter filter;
  std::string error;
  if (!net::SourceFilter::Parse(AtCommas(value), filter, error)) check.Problem("from: " + error);
  if (const std::string* receiver = Find(parts.options, kReceiver);
      receiver != nullptr && *receiver == kLiblcm) {
    check.Problem("from: liblcm takes everybody's messages; receiver=own can choose");
  }
}

void CheckUdp(const Parts& parts, Checker& check) {
  const std::string example = parts.provider + "://239.255.76.67:7667?ttl=0";
  if (!parts.network.empty()) {  // Else LCM's own group and port.
    const std::string group = check.HostAndPort(parts.network, example);
    in_addr address{};
    if (inet_pton(AF_INET, group.c_str(), &address) != 1 || !IN_MULTICAST(ntohl(address.s_addr))) {
      check.Problem("group \"" + group +
                    "\": must be a multicast address, 224.0.0.0 to 239.255.255.255");
    }
  }
  constexpr std::int64_t kMostBytes = 1 << 30;
  const bool has_ours = parts.provider == "udpm";
  check.EachOption(parts.options,
                   has_ours ? "ttl, recv_buf_size, receiver, from" : "ttl, recv_buf_size",
                   [&](const std::string& key, const std::string& value) {
                     if (key == "ttl") {
                       check.Integer(key, value, 0, 255);
                     } else if (key == "recv_buf_size") {
                       check.Integer(key, value, 1, kMostBytes);
                     } else if (has_ours && key == kReceiver) {
                       if (value != "own" && value != kLiblcm) {
                         check.Problem("receiver = \"" + value + "\": must be own or liblcm");
                       }
                     } else if (has_ours && key == kFrom) {
                       CheckSources(parts, value, check);
                     } else {
                       return false;
                     }
                     return true;
                   });
}

void CheckFile(const Parts& parts, Checker& check) {
  if (parts.network.empty()) check.Problem("names no file");
  std::string mode = "r";
  check.EachOption(
      parts.options, "mode, speed, start_timestamp",
      [&](const std::string& key, const std::string& value) {
        if (key == "mode") {
          mode = value;
          if (value != "r" && value != "w" && value != "a") {
            check.Problem("mode = \"" + value + "\": must be r, w or a");
          }
        } else if (key == "speed") {
          char* end = nullptr;
          const double speed = std::strtod(value.c_str(), &end);
          if (value.empty() || *end != '\0' || !std::isfinite(speed) || speed < 0.0) {
            check.Problem("speed = \"" + value + "\": must be 0 (no waiting) or above");
          }
        } else if (key == "start_timestamp") {
          check.Integer(key, value, 0, INT64_MAX);
        } else {
          return false;
        }
        return true;
      });
  std::error_code error;
  if (mode == "r" && !parts.network.empty() &&
      !std::filesystem::is_regular_file(parts.network, error)) {
    check.Problem("there is no file " + parts.network);
  }
}

}  // namespace

std::vector<std::string> LcmUrlProblems(const std::string& url) {
  std::vector<std::string> problems;
  if (url.empty()) return problems;
  Checker check(url, problems);
  const auto parts = Split(url);
  if (!parts) {
    check.Problem("must begin with a provider, as in udpm://239.255.76.67:7667?ttl=0");
  } else if (parts->provider == "udpm" || parts->provider == "mpudpm") {
    CheckUdp(*parts, check);
  } else if (parts->provider == "tcpq") {
    if (check.HostAndPort(parts->network, "tcpq://localhost:7700").empty()) {
      check.Problem("names no host");
    }
    check.EachOption(parts->options, "", [](const auto&, const auto&) { return false; });
  } else if (parts->provider == "file") {
    CheckFile(*parts, check);
  } else if (parts->provider == "memq") {
    if (!parts->network.empty()) check.Problem("memq:// takes no address");
    check.EachOption(parts->options, "", [](const auto&, const auto&) { return false; });
  } else {
    check.Problem("unknown provider \"" + parts->provider +
                  "\"; known: udpm, mpudpm, memq, file, tcpq");
  }
  return problems;
}

std::string CheckLcmUrl(const std::string& url) {
  const auto problems = LcmUrlProblems(url);
  return problems.empty() ? "" : problems.front();
}

std::string EffectiveLcmUrl(const std::string& url) {
  if (!url.empty()) return url;
  const char* environment = std::getenv("LCM_DEFAULT_URL");
  return environment != nullptr ? environment : "";
}

std::string UrlForLiblcm(const std::string& url) {
  const auto parts = Split(url);
  if (!parts || parts->provider != "udpm") return url;
  std::string stripped = parts->provider + "://" + parts->network;
  char joint = '?';
  for (const auto& [key, value] : parts->options) {
    if (key == kReceiver || key == kFrom) continue;
    stripped += joint + key + "=" + value;
    joint = '&';
  }
  return stripped;
}

std::optional<UdpmUrl> OwnReceiverUrl(const std::string& url) {
  const auto parts = Split(url.empty() ? "udpm://" : url);
  if (!parts || parts->provider != "udpm") return std::nullopt;
  const std::string* receiver = Find(parts->options, kReceiver);
  if (receiver != nullptr && *receiver == kLiblcm) return std::nullopt;
  UdpmUrl own;
  if (!parts->network.empty()) own.group = parts->network.substr(0, parts->network.rfind(':'));
  own.port = LcmUdpPort(url);
  if (const std::string* bytes = Find(parts->options, "recv_buf_size")) {
    own.receive_buffer_bytes =
        static_cast<int>(ToInteger(*bytes).value_or(own.receive_buffer_bytes));
  }
  if (const std::string* from = Find(parts->options, kFrom)) own.sources = AtCommas(*from);
  return own;
}

int LcmUdpPort(const std::string& url) {
  const std::string effective = url.empty() ? "udpm://" : url;
  const auto parts = Split(effective);
  if (!parts || (parts->provider != "udpm" && parts->provider != "mpudpm")) return 0;
  if (parts->network.empty()) return kDefaultPort;
  const auto colon = parts->network.rfind(':');
  if (colon == std::string::npos) return 0;
  const auto port = ToInteger(parts->network.substr(colon + 1));
  return port && *port >= 1 && *port <= 65535 ? static_cast<int>(*port) : 0;
}

}  // namespace v2vouch
