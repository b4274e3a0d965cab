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
  std::string interface;         ///< Capture from this one instead, by libpcap; "" = a UDP socket.
  /// What is captured (pcap-filter(7)); "" = UDP to `port`, WSMP and GeoNetworking of Ethernet,
  /// everything of 802.11.
  std::string filter;
  std::string framing = "auto";      ///< Take datagrams for this, whatever they look like.
  bool allow_text = false;           ///< Hex text and RSU 4.1 message files too.
  std::vector<std::string> allow{};  ///< Addresses of units; empty: anybody.

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("bind", bind);
    a.Field("port", port, {.at_least = 1, .at_most = 65535});
    a.Text("interface", interface);
    a.Text("filter", filter);
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

/// BSMs of this car, for the unit to send. Off unless `send_to` and `unit_sends_none` are set.
struct OwnBsmConfig {
  std::string send_to;            ///< Of the unit, "192.168.88.40:1516"; "" = nothing is sent.
  bool unit_sends_none = false;   ///< The unit's own BSMs are turned off: needed for sending.
  std::string form = "rsu_text";  ///< rsu_text (RSU 4.1), frame (bare), dot2 (1609.2 unsecured).
  bool unit_signs = false;        ///< rsu_text: the unit is asked to sign.
  int radio_channel = 183;        ///< rsu_text: 183 C-V2X; 172 or 180 DSRC.
  int priority = 6;               ///< rsu_text.
  double rate_hz = 10.0;
  double id_change_s = 300.0;  ///< A new TemporaryID after this; 0 = never.
  double antenna_x_m = 0.0;    ///< GNSS antenna, body frame.
  double antenna_y_m = 0.0;
  double centre_x_m = 1.35;  ///< Centre of the footprint ahead of the rear axle.
  double length_m = 0.0;     ///< 0 = not told.
  double width_m = 0.0;
  std::string lcm_url;  ///< Where EGO_MOTION and EGO_GNSS come from; "" = the gateway's lcm_url.
  std::string motion_channel = "EGO_MOTION";
  std::string fix_channel = "EGO_GNSS";
  std::string own_bsm_channel = "OWN_BSM";  ///< Tells the daemon what is sent.

  template <class Archive>
  void Visit(Archive& a) {
    a.Text("send_to", send_to);
    a.Field("unit_sends_none", unit_sends_none);
    a.Text("form", form);
    a.Field("unit_signs", unit_signs);
    a.Field("radio_channel", radio_channel, {.at_least = 0, .at_most = 255});
    a.Field("priority", priority, {.at_least = 0, .at_most = 7});
    a.Field("rate_hz", rate_hz, {.at_least = 1.0, .at_most = 10.0});
    a.Field("id_change_s", id_change_s, {.at_least = 0.0, .at_most = 86400.0});
    a.Field("antenna_x_m", antenna_x_m, {.at_least = -30.0, .at_most = 30.0});
    a.Field("antenna_y_m", antenna_y_m, {.at_least = -5.0, .at_most = 5.0});
    a.Field("centre_x_m", centre_x_m, {.at_least = -30.0, .at_most = 30.0});
    a.Field("length_m", length_m, {.at_least = 0.0, .at_most = 40.0});
    a.Field("width_m", width_m, {.at_least = 0.0, .at_most = 10.0});
    a.Text("lcm_url", lcm_url);
    a.Text("motion_channel", motion_channel);
    a.Text("fix_channel", fix_channel);
    a.Text("own_bsm_channel", own_bsm_channel);
  }
};

struct GatewayConfig {
  std::vector<InputConfig> inputs = {InputConfig{}};
  SecurityConfig security;
  OwnBsmConfig own_bsm;
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
    a.Field("own_bsm", own_bsm);
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
