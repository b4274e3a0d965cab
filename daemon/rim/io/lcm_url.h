// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace v2vouch {

/// What is wrong with an LCM URL; nothing where it is good ("" = LCM's default included). Stricter
/// than liblcm 1.3.1, which aborts at `tcpq://`, hears nothing without a port or on a group that is
/// none, and ignores options that it does not know.
///
///     udpm://GROUP:PORT?ttl=0&recv_buf_size=4194304&receiver=own&from=192.168.1.0/24,127.0.0.1
///     mpudpm://GROUP:PORT?ttl=0&recv_buf_size=4194304
///     memq://    file://PATH?mode=r&speed=1&start_timestamp=0    tcpq://HOST:PORT
std::vector<std::string> LcmUrlProblems(const std::string& url);

/// The first of them or "": the form in which command lines want it.
std::string CheckLcmUrl(const std::string& url);

/// What LCM will use where `url` is "": the environment's LCM_DEFAULT_URL, or "".
std::string EffectiveLcmUrl(const std::string& url);

/// The same without the options that are ours (`receiver`, `from`), which liblcm warns of.
std::string UrlForLiblcm(const std::string& url);

/// A good udpm:// URL, taken apart; LCM's defaults where it says nothing.
struct UdpmUrl {
  std::string group = "239.255.76.67";
  int port = 7667;
  int receive_buffer_bytes = 4 << 20;  ///< Asked of the kernel.
  std::vector<std::string> sources;    ///< `from`: who may send; empty: anybody.
};

/// For our own receive path. nullopt where liblcm receives: another provider, or receiver=liblcm.
std::optional<UdpmUrl> OwnReceiverUrl(const std::string& url);

/// UDP port of a good URL (after EffectiveLcmUrl); 0 where it has none.
int LcmUdpPort(const std::string& url);

}  // namespace v2vouch
