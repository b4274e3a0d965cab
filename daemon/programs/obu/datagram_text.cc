// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "daemon/common/base/hex_text.h"
#include "daemon/obu/etsi/cam_to_bsm.h"
#include "daemon/obu/ieee1609/dot2_time.h"
#include "daemon/programs/obu/datagram_report.h"

namespace v2vouch::obu {
namespace {

std::string Line(const char* format, auto... values) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

std::string Named(std::string_view layer, const std::string& rest) {
  return Line("  %-9.*s ", static_cast<int>(layer.size()), layer.data()) + rest + "\n";
}

std::string EnumText(std::string_view field, std::int32_t raw) {
  static constexpr std::array<const char*, 8> kTransmission = {
      "neutral", "park", "forward", "reverse", "reserved", "reserved", "reserved", "unavailable"};
  static constexpr std::array<const char*, 4> kState = {"unavailable", "off", "on", "engaged"};
  if (raw < 0) return "";
  const auto index = static_cast<std::size_t>(raw);
  if (field == "transmission") return kTransmission.at(index);
  if (field == "traction" || field == "abs" || field == "scs") return kState.at(index);
  if (field == "brakeBoost") return kState.at(index);
  if (field == "auxBrakes") return index == 3 ? "reserved" : kState.at(index);
  if (field == "wheelBrakes") {
    if ((index & 16) != 0) return "unavailable";
    static constexpr std::array<const char*, 4> kWheels = {"LF", "LR", "RF", "RR"};
    std::string on;
    for (std::size_t i = 0; i < 4; ++i) {
      if ((index >> (3 - i) & 1) != 0) on += (on.empty() ? "" : " ") + std::string(kWheels.at(i));
    }
    return on.empty() ? "none applied" : on;
  }
  return "";
}

int Decimals(double unit) {
  int decimals = 0;
  for (; decimals < 7 && unit < 0.99; unit *= 10) ++decimals;
  return decimals;
}

std::string CoreText(const BsmCore& core) {
  std::string text;
  for (const CoreField& field : CoreFields()) {
    const std::int32_t raw = core.*field.member;
    std::string meaning = EnumText(field.name, raw);
    if (field.unavailable == raw) {
      meaning = "unavailable";
    } else if (!field.unit_name.empty()) {
      meaning =
          Line("%.*f %.*s", std::max(Decimals(field.unit), field.unit == 0.0125 ? 4 : 0),
               raw * field.unit, static_cast<int>(field.unit_name.size()), field.unit_name.data());
    }
    if (field.name == "semiMajor" || field.name == "semiMinor") {
      if (raw == 254) meaning = "12.70 m or more";
    }
    if (field.name == "secMark" && raw > 60999 && raw < 65535) meaning = "reserved";
    text += Line("    %-14.*s %11d  %s\n", static_cast<int>(field.name.size()), field.name.data(),
                 raw, meaning.c_str());
    if (field.name == "msgCnt") text += Line("    %-14s    %08x\n", "id", core.id);
  }
  return text;
}

std::string WsmpText(const Wsmp& wsmp) {
  std::string text = Line("PSID 0x%x", wsmp.psid);
  if (wsmp.channel) text += Line(", channel %d", *wsmp.channel);
  if (wsmp.rate_500kbps) text += Line(", %.1f Mbit/s", *wsmp.rate_500kbps * 0.5);
  if (wsmp.tx_power_raw) text += Line(", power (raw) %d", *wsmp.tx_power_raw);
  return text + Line(", %zu bytes inside", wsmp.payload.size());
}

std::string Dot2Text(const Dot2Data& dot2, const Judgement& judgement) {
  switch (dot2.content) {
    case Dot2Data::Content::kUnsecured:
      return "unsecured";
    case Dot2Data::Content::kEncrypted:
      return "encrypted";
    case Dot2Data::Content::kRequest:
      return "certificate request";
    case Dot2Data::Content::kSigned:
      break;
  }
  std::string text = Line("signed, PSID 0x%x", dot2.psid);
  if (dot2.generation_us) text += ", generated " + TimeText(UtcOfDot2Micros(*dot2.generation_us));
  if (dot2.signer == Dot2Data::Signer::kSelf) text += ", by itself";
  if (judgement.digest != HashedId8{}) text += ", certificate " + HexText(judgement.digest);
  if (dot2.certificate) {
    text += Line(" (enclosed, %zu bytes, %s)", dot2.certificate->whole.size(),
                 dot2.certificate->is_implicit ? "implicit" : "explicit");
  }
  static constexpr std::array<const char*, 3> kStates = {"unknown", "VALID", "INVALID"};
  const std::string_view finding = FindingName(judgement.finding);
  text += Line("; signature %s (%.*s)",
               kStates.at(static_cast<std::size_t>(judgement.signature_state())),
               static_cast<int>(finding.size()), finding.data());
  if (dot2.security_fault) text += "; " + FaultText(dot2.security_fault);
  return text;
}

std::string PartTwoText(const Bsm& bsm) {
  static constexpr std::array<const char*, 14> kEvents = {"hazard lights",
                                                          "stop line violation",
                                                          "ABS active",
                                                          "traction control loss",
                                                          "stability control",
                                                          "hazardous materials",
                                                          "reserved",
                                                          "hard braking",
                                                          "lights changed",
                                                          "wipers changed",
                                                          "flat tyre",
                                                          "disabled vehicle",
                                                          "airbag",
                                                          "jackknife"};
  std::string text;
  for (std::size_t i = 0; i < bsm.part_two_count; ++i) {
    text += Line("    item %d, %zu bytes\n", bsm.part_two[i].id, bsm.part_two[i].octets.bits / 8);
  }
  if (bsm.safety) {
    if (bsm.safety->events) {
      std::string events;
      for (std::size_t i = 0; i < kEvents.size(); ++i) {
        if ((*bsm.safety->events >> i & 1) != 0) {
          events += (events.empty() ? "" : ", ") + std::string(kEvents.at(i));
        }
      }
      text += "    events: " + (events.empty() ? "none" : events) + "\n";
    }
    if (bsm.safety->path_points) {
      text += Line("    path history: %d points\n", *bsm.safety->path_points);
    }
    if (bsm.safety->radius_of_curve) {
      const int radius = *bsm.safety->radius_of_curve;
      text += "    path prediction: " +
              (radius == 32767 ? std::string("straight") : Line("radius %.1f m", radius * 0.1)) +
              Line(", confidence %.1f %%\n", bsm.safety->prediction_confidence * 0.5);
    }
  }
  if (bsm.supplemental) {
    if (bsm.supplemental->vehicle_class) {
      text += Line("    vehicle class %d\n", *bsm.supplemental->vehicle_class);
    }
    if (bsm.supplemental->height) {
      text += Line("    height %.2f m\n", *bsm.supplemental->height * 0.05);
    }
  }
  for (std::size_t i = 0; i < bsm.regional_count; ++i) {
    text += Line("    regional extension of region %d, %zu bytes\n", bsm.regional[i].id,
                 bsm.regional[i].octets.bits / 8);
  }
  if (bsm.unread_items > 0) text += Line("    items only read in part: %d\n", bsm.unread_items);
  if (bsm.tail_fault) text += "    behind the core: " + FaultText(bsm.tail_fault) + "\n";
  return text;
}

std::string LayerText(Layer layer, const DatagramReport& report) {
  const Datagram& datagram = report.datagram;
  switch (layer) {
    case Layer::kUdp:
      if (!datagram.udp) return "";
      return SourceOf(datagram) + Line(" to port %d", datagram.udp->destination_port);
    case Layer::kRadiotap:
      if (!datagram.radiotap || !datagram.radiotap->signal_dbm) return "";
      return Line("signal %d dBm", *datagram.radiotap->signal_dbm);
    case Layer::kC2p: {
      if (!datagram.c2p) return "";
      std::string text = datagram.c2p->is_transmission ? "sent by the unit itself" : "received";
      if (datagram.c2p->rssi_dbm) text += Line(", signal %d dBm", *datagram.c2p->rssi_dbm);
      return text;
    }
    case Layer::kCohda:
      if (!datagram.cohda) return "";
      return Line("BTP port %d, ITS-AID %u, parse result %d, verify result %d, certificate ",
                  datagram.cohda->btp_port, datagram.cohda->its_aid, datagram.cohda->parse_result,
                  datagram.cohda->verify_result) +
             HexText(datagram.cohda->certificate_digest);
    case Layer::kWsmp:
      return datagram.wsmp ? WsmpText(*datagram.wsmp) : "";
    case Layer::kDot2:
      return datagram.dot2 ? Dot2Text(*datagram.dot2, report.judgement) : "";
    case Layer::kGeo:
      if (!datagram.geo) return "";
      return Line("header type 0x%02x%s", datagram.geo->header_type,
                  datagram.geo->is_secured ? ", secured" : "");
    case Layer::kBtp:
      return datagram.btp_port ? Line("port %d", *datagram.btp_port) : "";
    case Layer::kFrame: {
      if (!datagram.frame) return "";
      const std::string_view name = MessageName(datagram.frame->message_id);
      return Line("message %d %.*s, %zu bytes%s", datagram.frame->message_id,
                  static_cast<int>(name.size()), name.data(), datagram.frame->value.size(),
                  datagram.frame->has_extensions ? ", extension bit set" : "");
    }
    case Layer::kCam:
      if (!datagram.cam) return "";
      return Line("station %u of type %d, generationDeltaTime %d", datagram.cam->station_id,
                  datagram.cam->station_type, datagram.cam->generation_delta_time);
    default:
      return "";
  }
}

}  // namespace

std::string TextOf(const DatagramReport& report) {
  const Datagram& datagram = report.datagram;
  std::string text = report.captured.line > 0
                         ? Line("line %lld", static_cast<long long>(report.captured.line))
                         : Line("packet %lld", static_cast<long long>(report.number));
  if (report.captured.utime != 0) text += ", " + TimeText(report.captured.utime);
  text += Line(", %zu bytes%s\n", report.captured.bytes.size(),
               report.captured.is_cut ? ", cut off by the capture" : "");
  for (const Layer layer : datagram.layers) {
    text += Named(LayerName(layer), LayerText(layer, report));
  }
  if (datagram.bsm) text += CoreText(datagram.bsm->core) + PartTwoText(*datagram.bsm);
  if (datagram.cam) {
    std::optional<std::int64_t> time;
    if (report.captured.utime != 0) time = report.captured.utime;
    text += "    as a BSM:\n" + CoreText(CoreOfCam(*datagram.cam, time));
  }
  if (datagram.trailing > 0) text += Line("  %zu bytes behind it\n", datagram.trailing);
  if (report.refused) {
    const std::size_t shown = std::min<std::size_t>(report.captured.bytes.size(), 16);
    text += "  REFUSED: " + FaultText(report.refused) + "; first bytes " +
            HexText(report.captured.bytes.first(shown)) + "\n";
  }
  return text;
}

}  // namespace v2vouch::obu
