// SPDX-License-Identifier: Apache-2.0
// v2vouch-obu: from on-board units to channel BSM; prints what is in a capture.
#include <iostream>

#include "daemon/programs/obu/decode.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/io/std_streams.h"
#include "daemon/rim/program/command_line.h"

namespace {

constexpr char kExamples[] = R"(
Examples:
  v2vouch-obu --decode drive.pcap
      what is in a capture: layer by layer, field by field with units, and why what was refused was
  v2vouch-obu --decode messages.hex --json | head -1
      one object a line; "bsm" has the raw integers under the names of bsm_t
  v2vouch-obu --decode drive.pcap --roots roots/ --issuers issuers/
      signatures checked up to the authorities' certificates in these folders (COER or hex)

Captures are pcap or pcapng files of Ethernet, 802.11, radiotap, Linux "any" or raw IP. A .hex file
holds one datagram a line; blanks round it, empty lines and comments (#) are passed over. Any other
file is one raw datagram. docs/obu.md lists the framings.

Exit codes: 0 good, refused messages included; 1 the file cannot be read to its end, or holds no
packet; 2 usage or configuration (certificates that cannot be used included).)";

const std::vector<std::string> kFramings = {"auto",  "frame",    "dot2",     "wsmp", "cv2x",
                                            "c2p",   "ethernet", "radiotap", "wlan", "llc",
                                            "cohda", "geo",      "btp",      "cam"};

}  // namespace

int main(int argc, char** argv) {
  v2vouch::GuardStandardStreams("v2vouch-obu");
  v2vouch::obu::DecodeOptions options;
  std::string framing = "auto", roots, issuers, lcm_url;
  CLI::App app("Takes V2X messages of on-board units apart and prints what is in a capture.");
  app.footer(kExamples);
  app.add_option("--decode", options.path, "Capture (pcap, pcapng), hex text or raw datagram");
  app.add_flag("--json", options.as_json, "One JSON object a line");
  app.add_flag("--join", options.join_lines, "Hex text: all lines are one datagram");
  app.add_option("--framing", framing, "Take datagrams for this, whatever they look like")
      ->check(v2vouch::OneOf(kFramings))
      ->capture_default_str();
  app.add_option("--roots", roots, "Folder of certificates that are trusted");
  app.add_option("--issuers", issuers, "Folder of certificates that the trusted ones vouch for");
  app.add_option("-l,--lcm-url", lcm_url, "Taken like every program's; --decode opens no socket")
      ->check(v2vouch::CheckLcmUrl);
  if (const auto code = v2vouch::ReadCommandLine(app, "v2vouch-obu", argc, argv)) return *code;
  if (options.path.empty()) {
    std::cerr << "v2vouch-obu: wants --decode FILE; see --help\n";
    return v2vouch::kExitUsage;
  }
  options.framing = v2vouch::obu::LayerOfName(framing);
  v2vouch::obu::TrustAnchors anchors;
  if (!v2vouch::obu::LoadAnchors(roots, issuers, anchors)) return v2vouch::kExitUsage;
  return v2vouch::obu::Decode(options, std::move(anchors));
}
