// SPDX-License-Identifier: Apache-2.0
// v2vouch-obu: from on-board units to channel BSM; prints what is in a capture.
#include <iostream>

#include "daemon/obu/framing/datagram.h"
#include "daemon/programs/obu/decode.h"
#include "daemon/programs/obu/gateway_check.h"
#include "daemon/programs/obu/live.h"
#include "daemon/rim/config/yaml_reader.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/program/command_line.h"

namespace {

constexpr char kExamples[] = R"(
Examples:
  v2vouch-obu --port 5398 -l 'udpm://239.255.76.68:7668?ttl=0'
      the unit forwards to UDP 5398 of this computer: publishes BSM and, once a second, OBU_STATUS
  v2vouch-obu --config obu.yaml
      several ports, allowed addresses, trusted certificates (docs/how-to/connect-an-on-board-unit.md)
  v2vouch-obu --interface wlan0
      captures whole radio packets from a card in monitor mode, or from Ethernet what passes by
  v2vouch-obu --send-to 192.168.88.40:1516 --unit-sends-none
      sends this car's BSMs, too, made of EGO_MOTION and EGO_GNSS. Off without these two options; the
      second one says that the BSMs which the unit makes by itself are turned off
  v2vouch-obu --decode drive.pcap
      what is in a capture: layer by layer, field by field with units, and why what was refused was
  v2vouch-obu --decode messages.hex --json | head -1
      one object a line; "bsm" has the raw integers under the names of bsm_t
  v2vouch-obu --decode drive.pcap --roots roots/ --issuers issuers/
      signatures checked up to the authorities' certificates in these folders (COER or hex)

Captures are pcap or pcapng files of Ethernet, 802.11, radiotap, Linux "any" or raw IP. A .hex file
holds one datagram a line; blanks round it, empty lines and comments (#) are passed over. Any other
file is one raw datagram. docs/reference/on-board-units.md lists the framings.

Exit codes: 0 good, refused messages included; 1 the file cannot be read to its end, or holds no
packet, or a socket cannot be opened; 2 usage or configuration (certificates that cannot be used
included).)";

std::vector<std::string> FramingNames() {
  std::vector<std::string> names = {"auto"};
  for (const v2vouch::obu::Layer layer : v2vouch::obu::Framings()) {
    names.emplace_back(v2vouch::obu::LayerName(layer));
  }
  return names;
}

}  // namespace

int main(int argc, char** argv) {
  v2vouch::GuardStandardStreams("v2vouch-obu");
  v2vouch::obu::DecodeOptions options;
  std::string framing = "auto", roots, issuers, lcm_url, config_path, send_to, own_form, interface;
  bool unit_sends_none = false;
  int port = 0;
  CLI::App app("Hands what on-board units receive to the daemon; prints what is in a capture.");
  app.footer(kExamples);
  CLI::Option* const decode =
      app.add_option("--decode", options.path, "Capture (pcap, pcapng), hex text or raw datagram");
  app.add_flag("--json", options.as_json, "One JSON object a line")->needs(decode);
  app.add_flag("--join", options.join_lines, "Hex text: all lines are one datagram")->needs(decode);
  app.add_option("--framing", framing, "Take datagrams for this, whatever they look like")
      ->check(v2vouch::OneOf(FramingNames()))
      ->capture_default_str();
  app.add_option("--config", config_path, "Ports, addresses and certificates of the gateway");
  app.add_option("--port", port, "Listen on this UDP port (default: 5398)")
      ->check(CLI::Range(1, 65535))
      ->excludes(decode);
  app.add_option("--interface", interface,
                 "Capture from this network interface instead of a socket (libpcap; as root)")
      ->excludes(decode);
  app.add_option("--roots", roots, "Folder of certificates that are trusted");
  app.add_option("--issuers", issuers, "Folder of certificates that the trusted ones vouch for");
  app.add_option("--send-to", send_to, "Send this car's BSMs to the unit: ADDRESS:PORT")
      ->excludes(decode);
  app.add_option("--send-form", own_form, "rsu_text (RSU 4.1, port 1516), frame (bare), dot2")
      ->check(v2vouch::OneOf({"rsu_text", "frame", "dot2"}));
  app.add_flag("--unit-sends-none", unit_sends_none,
               "The unit's own BSMs are turned off: needed for --send-to");
  app.add_option("-l,--lcm-url", lcm_url,
                 "Where BSM and OBU_STATUS are published; --decode opens no socket")
      ->check(v2vouch::CheckLcmUrl);
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-obu", argc, argv)) return *code;
  options.framing = v2vouch::obu::LayerOfName(framing);

  v2vouch::obu::GatewayConfig config;
  std::vector<std::string> problems;
  if (!config_path.empty()) v2vouch::config::Load(config_path, config, problems);
  v2vouch::obu::InputConfig one;
  if (!config.inputs.empty()) one = config.inputs.front();
  if (port != 0) one.port = port;
  if (framing != "auto") one.framing = framing;
  if (!interface.empty()) one.interface = interface;
  if (port != 0 || framing != "auto" || !interface.empty()) config.inputs = {one};
  if (!lcm_url.empty()) config.lcm_url = lcm_url;
  if (!roots.empty()) config.security.roots = roots;
  if (!issuers.empty()) config.security.issuers = issuers;
  if (!send_to.empty()) config.own_bsm.send_to = send_to;
  if (!own_form.empty()) config.own_bsm.form = own_form;
  config.own_bsm.unit_sends_none |= unit_sends_none;
  v2vouch::obu::CheckGatewayConfig(config, problems);
  for (const std::string& problem : problems) std::cerr << "v2vouch-obu: " << problem << '\n';
  v2vouch::obu::TrustAnchors anchors;
  const bool has_anchors =
      v2vouch::obu::LoadAnchors(config.security.roots, config.security.issuers, anchors);
  if (!has_anchors || !problems.empty()) return v2vouch::kExitUsage;
  if (!options.path.empty()) return v2vouch::obu::Decode(options, std::move(anchors));
  return v2vouch::obu::RunGateway(config, std::move(anchors));
}
