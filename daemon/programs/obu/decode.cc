// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/obu/decode.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>
#include <map>
#include <set>

#include "daemon/common/base/big_endian.h"
#include "daemon/obu/capture/capture_file.h"
#include "daemon/obu/framing/datagram.h"
#include "daemon/obu/gateway/receptions.h"
#include "daemon/programs/obu/datagram_report.h"
#include "daemon/rim/io/std_streams.h"

namespace v2vouch::obu {
namespace {

void Complain(const std::string& what) { std::cerr << "v2vouch-obu: " << what << '\n'; }

struct Totals {
  std::int64_t packets = 0;
  std::int64_t messages = 0;
  std::map<std::string, std::int64_t> framings, refusals, signatures;
  std::set<std::uint32_t> senders;

  void Add(const DatagramReport& report) {
    ++packets;
    if (report.refused) {
      ++refusals[std::string(FaultName(report.refused.kind))];
      return;
    }
    ++messages;
    if (const auto framing = report.framing()) ++framings[std::string(LayerName(*framing))];
    ++signatures[std::string(FindingName(report.judgement.finding))];
    if (senders.size() < 100000) {
      senders.insert(BigEndian32(report.message->id));
    }
  }
};

std::string Listed(const std::map<std::string, std::int64_t>& counts) {
  std::string text;
  for (const auto& [name, count] : counts) {
    text += (text.empty() ? "" : ", ") + name + " " + std::to_string(count);
  }
  return text.empty() ? "none" : text;
}

std::string TextOf(const Totals& totals) {
  return "\n" + std::to_string(totals.packets) + " packets, " + std::to_string(totals.messages) +
         " messages of " + std::to_string(totals.senders.size()) + " senders\n" +
         "  framings:   " + Listed(totals.framings) + "\n" +
         "  signatures: " + Listed(totals.signatures) + "\n" +
         "  refused:    " + Listed(totals.refusals) + "\n";
}

// Reads a certificate file, COER or hex, and hands its bytes to `add`.
template <class Add>
bool LoadFolder(const std::string& folder, Add add) {
  if (folder.empty()) return true;
  std::error_code failed;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, failed)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  if (failed) {
    Complain(folder + ": " + failed.message());
    return false;
  }
  std::ranges::sort(files);
  bool is_good = true;
  if (files.empty()) {
    Complain(folder + ": holds no certificate");
    is_good = false;
  }
  for (const auto& path : files) {
    std::string error;
    const auto file = CaptureFile::Open(path.string(), true, error);
    const auto captured = file ? file->Next(error) : std::nullopt;
    if (captured && captured->fault) error = path.string() + ": " + FaultText(captured->fault);
    if (captured && !captured->fault) {
      if (const auto problem = add(captured->bytes)) error = path.string() + ": " + *problem;
    }
    if (!error.empty()) {
      Complain(error);
      is_good = false;
    }
  }
  return is_good;
}

}  // namespace

bool LoadAnchors(const std::string& roots, const std::string& issuers, TrustAnchors& anchors) {
  const bool has_roots = LoadFolder(roots, [&](Bytes bytes) { return anchors.AddAnchor(bytes); });
  const bool has_issuers =
      LoadFolder(issuers, [&](Bytes bytes) { return anchors.AddIntermediate(bytes); });
  return has_roots && has_issuers;
}

void Read(const Captured& captured, const DatagramOptions& options, std::span<std::uint8_t> scratch,
          DatagramReport& report) {
  if (captured.fault) {
    report.refused = captured.fault;
    return;
  }
  if (captured.link_type < 0) {
    ReadDatagram(captured.bytes, options, scratch, report.datagram);
  } else {
    ReadPacket(captured.link_type, captured.bytes, options, scratch, report.datagram);
  }
  report.refused = report.datagram.fault;
}

int Decode(const DecodeOptions& options, TrustAnchors anchors) {
  std::string error;
  const auto file = CaptureFile::Open(options.path, options.join_lines, error);
  if (!file) {
    Complain(error);
    return 1;
  }
  // All signatures of a file are looked at, however fast they came.
  Receptions receptions({.checks_per_s = 1 << 30}, std::move(anchors));
  Totals totals;
  std::array<std::uint8_t, kLongestDatagram> scratch{};
  DatagramOptions datagram_options{options.framing, true, 0};
  bool has_text_lines = false;
  while (const auto captured = file->Next(error)) {
    DatagramReport report;
    report.number = totals.packets + 1;
    report.captured = *captured;
    has_text_lines = has_text_lines || captured->line > 0;
    Read(*captured, datagram_options, scratch, report);
    const auto heard = receptions.Of(report.datagram, captured->utime, report.number);
    report.judgement = heard.judgement;
    if (report.datagram.bsm || report.datagram.cam) {
      report.message = BsmMessage(report.datagram, heard.reception);
    }
    totals.Add(report);
    std::cout << (options.as_json ? JsonOf(report) + "\n" : TextOf(report));
    if (!std::cout) return IsReaderGone() ? 0 : 1;
  }
  if (!options.as_json) std::cout << TextOf(totals);
  if (!error.empty()) {
    Complain(options.path + ": " + error);
    return 1;
  }
  if (totals.packets == 0) {
    Complain(options.path + ": holds no packet");
    return 1;
  }
  if (has_text_lines && totals.messages == 0 && totals.packets > 1) {
    Complain(options.path +
             ": no line holds a message; is it one datagram over several lines? "
             "Then --join");
  }
  return 0;
}

}  // namespace v2vouch::obu
