// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "daemon/common/base/visit.h"

namespace v2vouch::obu {

/// One UDP port on which units deliver.
struct InputConfig {
  std::string bind = "0.0.0.0";  ///< Own address; a multicast group is joined.
  int port = 5398;               ///< CARMA's; V2X-Hub 26789, Commsignia capture 7943, Cohda 4400.
  std::string framing = "auto";  ///< Take datagrams for this, whatever they look like.
  bool allow_text = false;       ///< Hex text and RSU 4.1 message files too.
  std::vector<std::string> allow{};  ///< Addresses of units; empty: anybody.

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("bind", bind);
    a.Field("port", port, {.at_least = 1, .at_most = 65535});
    a.Text("framing", framing);
    a.Field("allow_text", allow_text);
    a.Field("allow", allow);
  }
};

struct SecurityConfig {
  std::string roots;        ///< Folder of certificates that are trusted; "" = none.
  std::string issuers;      ///< Folder of certificates that the trusted ones vouch for.
  int checks_per_s = 2000;  ///< Signatures looked at; what exceeds it is published as unknown.
  int certificates = 4096;  ///< Remembered.

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("roots", roots);
    a.Text("issuers", issuers);
    a.Field("checks_per_s", checks_per_s, {.at_least = 0, .at_most = 1000000});
    a.Field("certificates", certificates, {.at_least = 1, .at_most = 1000000});
  }
};

struct GatewayConfig {
  std::vector<InputConfig> inputs = {InputConfig{}};
  SecurityConfig security;
  std::string lcm_url;  ///< "" = the environment's LCM_DEFAULT_URL, else LCM's own.
  std::string bsm_channel = "BSM";
  std::string status_channel = "OBU_STATUS";
  double duplicate_s = 0.5;           ///< The same message again within this is a copy.
  double merge_s = 0.005;             ///< Where signal strength is told: wait for a stronger copy.
  int most_per_source_per_s = 10000;  ///< Datagrams of one address; the rest is refused unread.
  double silent_s = 3.0;              ///< Without any datagram: obu_silent.
  double clock_suspect_s = 1.5;       ///< Reception minus generation time beyond this is told.

  template <class Archive>
  void Visit(Archive& a) {
    a.Field("inputs", inputs);
    a.Field("security", security);
    a.Text("lcm_url", lcm_url);
    a.Text("bsm_channel", bsm_channel);
    a.Text("status_channel", status_channel);
    a.Field("duplicate_s", duplicate_s, {.at_least = 0.0, .at_most = 10.0});
    a.Field("merge_s", merge_s, {.at_least = 0.0, .at_most = 0.05});
    a.Field("most_per_source_per_s", most_per_source_per_s, {.at_least = 1, .at_most = 1000000});
    a.Field("silent_s", silent_s, {.at_least = 0.1, .at_most = 3600.0});
    a.Field("clock_suspect_s", clock_suspect_s, {.at_least = 0.1, .at_most = 3600.0});
  }
};

}  // namespace v2vouch::obu
