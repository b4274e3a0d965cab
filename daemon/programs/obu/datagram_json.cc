// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstdio>
#include <ctime>
#include <nlohmann/json.hpp>

#include "daemon/common/base/hex_text.h"
#include "daemon/obu/ieee1609/dot2_time.h"
#include "daemon/programs/obu/datagram_report.h"

namespace v2vouch::obu {
namespace {

using Json = nlohmann::ordered_json;

// Under the names of bsm_t.lcm, raw.
Json JsonOf(const bsm_t& message) {
  Json json;
  json["rx_utime"] = message.rx_utime;
  json["generation_utime"] = message.generation_utime;
  json["seq"] = message.seq;
  json["msgCnt"] = message.msgCnt;
  json["id"] = message.id;
  json["secMark"] = message.secMark;
  json["lat"] = message.lat;
  json["long_"] = message.long_;
  json["elev"] = message.elev;
  json["semiMajor"] = message.semiMajor;
  json["semiMinor"] = message.semiMinor;
  json["orientation"] = message.orientation;
  json["transmission"] = message.transmission;
  json["speed"] = message.speed;
  json["heading"] = message.heading;
  json["angle"] = message.angle;
  json["accelSet_long"] = message.accelSet_long;
  json["accelSet_lat"] = message.accelSet_lat;
  json["accelSet_vert"] = message.accelSet_vert;
  json["accelSet_yaw"] = message.accelSet_yaw;
  json["wheelBrakes"] = message.wheelBrakes;
  json["traction"] = message.traction;
  json["abs"] = message.abs;
  json["scs"] = message.scs;
  json["brakeBoost"] = message.brakeBoost;
  json["auxBrakes"] = message.auxBrakes;
  json["width"] = message.width;
  json["length"] = message.length;
  json["signature_state"] = message.signature_state;
  json["certificate_digest"] = message.certificate_digest;
  json["rssi_dbm"] = std::isfinite(message.rssi_dbm) ? Json(message.rssi_dbm) : Json(nullptr);
  return json;
}

Json JsonOf(const Wsmp& wsmp) {
  Json json = {{"psid", wsmp.psid}};
  if (wsmp.channel) json["channel"] = *wsmp.channel;
  if (wsmp.rate_500kbps) json["rate_mbps"] = *wsmp.rate_500kbps * 0.5;
  if (wsmp.tx_power_raw) json["tx_power_raw"] = *wsmp.tx_power_raw;
  return json;
}

Json JsonOf(const Dot2Data& dot2, const Judgement& judgement) {
  Json json = {{"signed", dot2.content == Dot2Data::Content::kSigned}};
  if (dot2.content != Dot2Data::Content::kSigned) return json;
  json["psid"] = dot2.psid;
  if (dot2.generation_us) json["generation_utime"] = UtcOfDot2Micros(*dot2.generation_us);
  static constexpr const char* kSigners[] = {"none", "digest", "certificate", "self"};
  json["signer"] = kSigners[static_cast<std::size_t>(dot2.signer)];
  json["certificate"] = HexText(judgement.digest);
  json["signature"] = FindingName(judgement.finding);
  if (dot2.security_fault) json["unread"] = FaultText(dot2.security_fault);
  return json;
}

Json JsonOfPartTwo(const Bsm& bsm) {
  Json json = {{"items", Json::array()}, {"regional", Json::array()}};
  for (std::size_t i = 0; i < bsm.part_two_count; ++i) {
    json["items"].push_back(bsm.part_two[i].id);
  }
  for (std::size_t i = 0; i < bsm.regional_count; ++i) {
    json["regional"].push_back(bsm.regional[i].id);
  }
  if (bsm.safety) {
    if (bsm.safety->events) json["events"] = *bsm.safety->events;
    if (bsm.safety->path_points) json["path_points"] = *bsm.safety->path_points;
    if (bsm.safety->radius_of_curve) {
      json["radius_of_curve"] = *bsm.safety->radius_of_curve;
      json["prediction_confidence"] = bsm.safety->prediction_confidence;
    }
    if (bsm.safety->lights) json["lights"] = *bsm.safety->lights;
  }
  if (bsm.supplemental) {
    if (bsm.supplemental->vehicle_class) json["vehicle_class"] = *bsm.supplemental->vehicle_class;
    if (bsm.supplemental->role) json["role"] = *bsm.supplemental->role;
    if (bsm.supplemental->height) json["height"] = *bsm.supplemental->height;
  }
  if (bsm.unread_items > 0) json["unread_items"] = bsm.unread_items;
  if (bsm.tail_fault) json["fault"] = FaultText(bsm.tail_fault);
  return json;
}

Json JsonOf(const Cam& cam) {
  return {{"stationID", cam.station_id},
          {"stationType", cam.station_type},
          {"generationDeltaTime", cam.generation_delta_time},
          {"latitude", cam.latitude},
          {"longitude", cam.longitude},
          {"heading", cam.heading},
          {"speed", cam.speed},
          {"driveDirection", cam.direction},
          {"vehicleLength", cam.length},
          {"vehicleWidth", cam.width},
          {"yawRate", cam.yaw_rate}};
}

}  // namespace

std::optional<Layer> DatagramReport::framing() const {
  // What lies round the UDP datagram is the capture's, not the unit's.
  std::optional<Layer> first;
  bool is_inside_udp = false;
  for (const Layer layer : datagram.layers) {
    if (is_inside_udp || !first) first = layer;
    if (is_inside_udp) return first;
    is_inside_udp = layer == Layer::kUdp;
  }
  if (is_inside_udp || (first && *first == Layer::kIp)) return std::nullopt;
  return first;
}

std::string JsonOf(const DatagramReport& report) {
  const Datagram& datagram = report.datagram;
  Json json;
  if (report.captured.line > 0) {
    json["line"] = report.captured.line;
  } else {
    json["packet"] = report.number;
  }
  if (report.captured.utime != 0) json["utime"] = report.captured.utime;
  json["bytes"] = report.captured.bytes.size();
  if (datagram.udp) {
    json["source"] = SourceOf(datagram);
    json["port"] = datagram.udp->destination_port;
  }
  const auto framing = report.framing();
  json["framing"] = framing ? Json(LayerName(*framing)) : Json(nullptr);
  json["layers"] = Json::array();
  for (const Layer layer : datagram.layers) json["layers"].push_back(LayerName(layer));
  const bool is_used = report.message && !report.refused;
  json["bsm"] = is_used ? JsonOf(*report.message) : Json(nullptr);
  json["refused"] = report.refused ? Json(FaultName(report.refused.kind)) : Json(nullptr);
  if (report.refused) {
    json["detail"] = FaultText(report.refused);
    if (report.message) json["refused_bsm"] = JsonOf(*report.message);
    const std::size_t shown = std::min<std::size_t>(report.captured.bytes.size(), 16);
    json["first_bytes"] = HexText(report.captured.bytes.first(shown));
  }
  if (report.message) json["sender"] = HexText(std::span(report.message->id));
  if (datagram.frame && datagram.frame->message_id != kBsmMessageId) {
    json["message"] = MessageName(datagram.frame->message_id);
  }
  if (datagram.wsmp) json["wsmp"] = JsonOf(*datagram.wsmp);
  if (datagram.dot2) json["dot2"] = JsonOf(*datagram.dot2, report.judgement);
  if (datagram.bsm) json["part_two"] = JsonOfPartTwo(*datagram.bsm);
  if (datagram.cam) json["cam"] = JsonOf(*datagram.cam);
  if (datagram.trailing > 0) json["trailing"] = datagram.trailing;
  if (report.captured.is_cut) json["cut"] = true;
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string SourceOf(const Datagram& datagram) {
  if (!datagram.udp) return "";
  return datagram.udp->source_text() + ":" + std::to_string(datagram.udp->source_port);
}

std::string TimeText(std::int64_t utime) {
  const std::int64_t second = utime / 1000000 - (utime % 1000000 < 0 ? 1 : 0);
  const auto time = static_cast<std::time_t>(second);
  std::tm parts{};
  gmtime_r(&time, &parts);
  char date[32];
  std::strftime(date, sizeof date, "%Y-%m-%d %H:%M:%S", &parts);
  char text[64];
  std::snprintf(text, sizeof text, "%s.%06lld UTC", date,
                static_cast<long long>(utime - second * 1000000));
  return text;
}

}  // namespace v2vouch::obu
