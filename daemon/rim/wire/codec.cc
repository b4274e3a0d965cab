// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/wire/codec.h"

#include <algorithm>
#include <exception>

#include "daemon/common/base/check.h"
#include "daemon/rim/wire/layout.h"
#include "v2vouch/bsm_t.hpp"
#include "v2vouch/bsm_verdict_t.hpp"
#include "v2vouch/calibration_t.hpp"
#include "v2vouch/camera_detections_t.hpp"
#include "v2vouch/camera_image_t.hpp"
#include "v2vouch/daemon_status_t.hpp"
#include "v2vouch/ego_intent_t.hpp"
#include "v2vouch/ego_motion_t.hpp"
#include "v2vouch/gnss_fix_t.hpp"
#include "v2vouch/misbehavior_report_t.hpp"
#include "v2vouch/object_list_t.hpp"
#include "v2vouch/obu_status_t.hpp"
#include "v2vouch/radar_scan_t.hpp"
#include "v2vouch/text_t.hpp"
#include "v2vouch/track_list_t.hpp"
#include "v2vouch/truth_bsm_t.hpp"
#include "v2vouch/truth_list_t.hpp"
#include "v2vouch/warning_list_t.hpp"

namespace v2vouch::wire {
namespace {

constexpr std::size_t kFingerprintBytes = 8;

std::int64_t FingerprintIn(std::span<const std::uint8_t> bytes) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < kFingerprintBytes; ++i) bits = (bits << 8) | bytes[i];
  return static_cast<std::int64_t>(bits);
}

template <class Count, class Vector>
bool Fits(Count count, const Vector& vector) {
  return count >= 0 && static_cast<std::size_t>(count) == vector.size();
}

// Whether every length field says what its vector holds. Types without vectors always fit.
template <class T>
bool LengthsFit(const T&) {
  return true;
}
bool LengthsFit(const calibration_t& m) { return Fits(m.num_parameters, m.parameters); }
bool LengthsFit(const camera_detections_t& m) { return Fits(m.num_boxes, m.boxes); }
bool LengthsFit(const camera_image_t& m) { return Fits(m.num_bytes, m.data); }
bool LengthsFit(const misbehavior_report_t& m) { return Fits(m.num_evidence, m.evidence); }
bool LengthsFit(const object_list_t& m) { return Fits(m.num_objects, m.objects); }
bool LengthsFit(const radar_scan_t& m) { return Fits(m.num_detections, m.detections); }
bool LengthsFit(const daemon_status_t& m) {
  return Fits(m.num_inputs, m.inputs) && Fits(m.num_refusals, m.refusals) &&
         Fits(m.num_refusal_details, m.refusal_details) && Fits(m.num_latencies, m.latencies);
}
bool LengthsFit(const ego_intent_t& m) { return Fits(m.num_points, m.points); }
bool LengthsFit(const warning_list_t& m) { return Fits(m.num_warnings, m.warnings); }
bool LengthsFit(const track_list_t& m) {
  return Fits(m.num_sectors, m.sectors) && Fits(m.num_tracks, m.tracks) &&
         std::ranges::all_of(
             m.tracks, [](const track_t& track) { return Fits(track.num_sources, track.sources); });
}
bool LengthsFit(const truth_list_t& m) {
  if (!Fits(m.num_objects, m.objects)) return false;
  for (const truth_object_t& object : m.objects) {
    if (!Fits(object.num_sensors, object.sensors)) return false;
  }
  return true;
}

}  // namespace

template <class T>
Result<T> Decode(std::span<const std::uint8_t> bytes) {
  const Layout& layout = LayoutOf<T>();
  if (bytes.size() > layout.max_bytes) return Reason::kTooLarge;
  if (bytes.size() < kFingerprintBytes) return Reason::kTooShort;
  if (FingerprintIn(bytes) != T::getHash()) return Reason::kWrongType;
  if (const auto reason = Walk(layout, bytes.subspan(kFingerprintBytes))) return *reason;
  try {
    T message{};
    const int size = static_cast<int>(bytes.size());
    if (message.decode(bytes.data(), 0, size) != size) return Reason::kDecodeFailed;
    return message;
  } catch (const std::exception&) {  // Generated code: what it may throw is not ours to promise.
    return Reason::kDecodeFailed;
  }
}

template <class T>
void Encode(const T& message, std::vector<std::uint8_t>& bytes) {
  V2VOUCH_CHECK(LengthsFit(message));
  const int size = message.getEncodedSize();
  bytes.resize(static_cast<std::size_t>(size));
  const int written = message.encode(bytes.data(), 0, size);
  V2VOUCH_CHECK(written >= 0);
  bytes.resize(static_cast<std::size_t>(written));  // Shorter where a text held a NUL.
}

#define V2VOUCH_CODEC(Type)                                          \
  template Result<Type> Decode<Type>(std::span<const std::uint8_t>); \
  template void Encode<Type>(const Type&, std::vector<std::uint8_t>&);
V2VOUCH_CODEC(bsm_t)
V2VOUCH_CODEC(bsm_verdict_t)
V2VOUCH_CODEC(calibration_t)
V2VOUCH_CODEC(camera_detections_t)
V2VOUCH_CODEC(camera_image_t)
V2VOUCH_CODEC(daemon_status_t)
V2VOUCH_CODEC(ego_motion_t)
V2VOUCH_CODEC(gnss_fix_t)
V2VOUCH_CODEC(misbehavior_report_t)
V2VOUCH_CODEC(radar_scan_t)
V2VOUCH_CODEC(object_list_t)
V2VOUCH_CODEC(obu_status_t)
V2VOUCH_CODEC(text_t)
V2VOUCH_CODEC(track_list_t)
V2VOUCH_CODEC(truth_bsm_t)
V2VOUCH_CODEC(truth_list_t)
V2VOUCH_CODEC(ego_intent_t)
V2VOUCH_CODEC(warning_list_t)
#undef V2VOUCH_CODEC

}  // namespace v2vouch::wire
