// SPDX-License-Identifier: Apache-2.0
#include "daemon/obu/message/own_bsm.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "daemon/common/base/angle.h"
#include "daemon/common/base/hex_text.h"
#include "daemon/common/geodesy/curvature.h"
#include "daemon/obu/octets/byte_reader.h"

namespace v2vouch::obu {
namespace {

constexpr double kCourseSpeed_mps = 3.0;  // Slower than this, GNSS velocity has no usable course.

// `value` in units of `unit`; what is no number stays unavailable, what is too large saturates.
std::int32_t Raw(double value, double unit, std::int32_t unavailable) {
  if (std::isnan(value)) return unavailable;
  const double raw = std::clamp(value / unit, -2.0e9, 2.0e9);
  const auto rounded = static_cast<std::int32_t>(std::lround(raw));
  return rounded == unavailable ? rounded - 1 : rounded;
}

double Wrapped(double angle_rad) {
  const double wrapped = std::fmod(angle_rad, 2.0 * kPi);
  return wrapped < 0.0 ? wrapped + 2.0 * kPi : wrapped;
}

std::int32_t Heading(double angle_rad) {
  return static_cast<std::int32_t>(std::lround(ToDegrees(Wrapped(angle_rad)) / 0.0125)) % 28800;
}

// Ellipse of the horizontal covariance (east, north), where both variances are known.
void SetAccuracy(const gnss_fix_t& fix, BsmCore& core) {
  const double ee = fix.covariance_enu_m2[0];
  const double nn = fix.covariance_enu_m2[4];
  double en = fix.covariance_enu_m2[1];
  if (!(ee > 0.0) || !(nn > 0.0) || !std::isfinite(ee) || !std::isfinite(nn)) return;
  if (!std::isfinite(en) || en * en > ee * nn) en = 0.0;
  const double mean = 0.5 * (ee + nn);
  const double radius = std::hypot(0.5 * (ee - nn), en);
  core.semi_major = std::min(Raw(std::sqrt(mean + radius), 0.05, 255), 254);
  core.semi_minor = std::min(Raw(std::sqrt(std::max(mean - radius, 0.0)), 0.05, 255), 254);
  // Long axis counter-clockwise from east is half of atan2(2 en, ee - nn).
  const double from_north = Wrapped(kPi / 2.0 - 0.5 * std::atan2(2.0 * en, ee - nn));
  core.orientation =
      static_cast<std::int32_t>(std::lround(ToDegrees(from_north) * 65535.0 / 360.0)) % 65535;
}

std::int32_t Transmission(int gear) { return gear >= 0 && gear <= 3 ? gear : 7; }

void SetMotion(const ego_motion_t& motion, BsmCore& core) {
  const double yaw_rate_radps = motion.yaw_rate_radps;
  core.transmission = Transmission(motion.gear);
  core.accel_long = Raw(motion.accel_long_mps2, 0.01, 2001);
  core.accel_lat = Raw(-motion.accel_lat_mps2, 0.01, 2001);
  core.accel_yaw = Raw(-ToDegrees(yaw_rate_radps), 0.01, 0);
  if (std::abs(ToDegrees(yaw_rate_radps)) < 0.005) core.accel_yaw = 0;
}

}  // namespace

OwnBsm::OwnBsm(OwnVehicle vehicle, std::uint64_t seed) : vehicle_(vehicle), rng_(seed) {}

bool OwnBsm::OnMotion(const ego_motion_t& motion) {
  if (!std::isfinite(motion.speed_mps)) return false;
  motion_ = motion;
  return true;
}

bool OwnBsm::OnFix(const gnss_fix_t& fix) {
  const bool has_place = std::isfinite(fix.latitude_rad) && std::isfinite(fix.longitude_rad) &&
                         std::abs(fix.latitude_rad) <= kPi / 2.0 &&
                         std::abs(fix.longitude_rad) <= 2.0 * kPi &&
                         (fix.latitude_rad != 0.0 || fix.longitude_rad != 0.0);
  if (!has_place || fix.fix_type == gnss_fix_t::FIX_NONE) return false;
  fix_ = fix;
  return true;
}

void OwnBsm::ChangeId(std::int64_t utime) {
  id_ = static_cast<std::uint32_t>(rng_());
  msg_count_ = static_cast<int>(rng_() % 128);
  id_since_ = utime;
}

std::optional<double> OwnBsm::BodyHeading(double speed_mps) const {
  const gnss_fix_t& fix = *fix_;
  // Exactly 0 without a sigma is what receivers send that have no heading.
  const bool has_heading =
      std::isfinite(fix.heading_rad) && (fix.heading_rad != 0.0 || fix.heading_sigma_rad > 0.0);
  if (has_heading) return Wrapped(fix.heading_rad);
  const double east = fix.velocity_east_mps;
  const double north = fix.velocity_north_mps;
  if (std::isfinite(east) && std::isfinite(north) && std::hypot(east, north) > kCourseSpeed_mps) {
    return Wrapped(std::atan2(east, north) + (speed_mps < 0.0 ? kPi : 0.0));
  }
  return course_rad_;
}

std::optional<Bsm> OwnBsm::Make(std::int64_t utime) {
  if (!fix_ || std::abs(utime - fix_->utime) > kOldestFix_us) return std::nullopt;
  const bool has_motion = motion_ && std::abs(utime - motion_->utime) <= kOldestMotion_us;
  const double nan = std::nan("");
  const double speed_mps = has_motion ? motion_->speed_mps : nan;
  const double yaw_rate_radps = has_motion ? motion_->yaw_rate_radps : nan;
  course_rad_ = BodyHeading(speed_mps);

  const double age_s = static_cast<double>(utime - fix_->utime) * 1e-6;
  const double turn_rad = std::isfinite(yaw_rate_radps) ? -yaw_rate_radps * age_s : 0.0;
  double north_m = 0.0;
  double east_m = 0.0;
  if (course_rad_) {
    const double begin = *course_rad_;
    const double end = begin + turn_rad;
    const double driven_m =
        std::isfinite(speed_mps) ? std::clamp(speed_mps, -120.0, 120.0) * age_s : 0.0;
    // Ahead and to the right of the antenna: the footprint's centre.
    const double ahead_m = vehicle_.centre_x_m - vehicle_.antenna_x_m;
    const double right_m = vehicle_.antenna_y_m;
    const double middle = 0.5 * (begin + end);
    north_m = driven_m * std::cos(middle) + ahead_m * std::cos(end) - right_m * std::sin(end);
    east_m = driven_m * std::sin(middle) + ahead_m * std::sin(end) + right_m * std::cos(end);
  }

  if (id_since_ == 0 || (vehicle_.id_change_us > 0 && utime - id_since_ >= vehicle_.id_change_us)) {
    ChangeId(utime);
  } else {
    msg_count_ = (msg_count_ + 1) % 128;
  }
  Bsm bsm;
  BsmCore& core = bsm.core;
  core.id = id_;
  core.msg_count = msg_count_;
  core.sec_mark = static_cast<std::int32_t>(utime / 1000 % 60000);
  const CurvatureRadii radii = RadiiAt(fix_->latitude_rad);
  const double latitude_rad = fix_->latitude_rad + north_m / radii.meridian_m;
  const double longitude_rad =
      std::remainder(fix_->longitude_rad + east_m / radii.parallel_m, 2.0 * kPi);
  core.lat = Raw(ToDegrees(latitude_rad), 1e-7, 900000001);
  core.lon = Raw(ToDegrees(longitude_rad), 1e-7, 1800000001);
  if (core.lon <= -1800000000) core.lon = 1800000000;  // The same meridian.
  if (fix_->fix_type >= gnss_fix_t::FIX_3D) core.elev = Raw(fix_->altitude_m, 0.1, -4096);
  SetAccuracy(*fix_, core);
  core.speed = Raw(std::abs(speed_mps), 0.02, 8191);
  if (course_rad_) {
    // Of motion: in reverse against the body's axis.
    core.heading = Heading(*course_rad_ + turn_rad + (speed_mps < 0.0 ? kPi : 0.0));
  }
  if (has_motion) {
    SetMotion(*motion_, core);
  }
  core.length = Raw(vehicle_.length_m > 0.0 ? vehicle_.length_m : nan, 0.01, 0);
  core.width = Raw(vehicle_.width_m > 0.0 ? vehicle_.width_m : nan, 0.01, 0);
  saturated_ += Saturate(core);
  return bsm;
}

std::vector<std::uint8_t> DatagramOf(const Bsm& bsm, OutputForm form,
                                     const RsuTextOptions& options) {
  std::array<std::uint8_t, kLongestDatagram> buffer{};
  std::size_t size = 0;
  if (WriteBsmFrame(bsm, buffer, size)) return {};
  const std::span<const std::uint8_t> frame = std::span(buffer).first(size);
  std::vector<std::uint8_t> out;
  switch (form) {
    case OutputForm::kFrame:
      out.assign(frame.begin(), frame.end());
      break;
    case OutputForm::kDot2:
      out = {0x03, 0x80};
      if (size >= 0x100) {
        out.push_back(0x82);
        out.push_back(static_cast<std::uint8_t>(size >> 8));
      } else if (size >= 0x80) {
        out.push_back(0x81);
      }
      out.push_back(static_cast<std::uint8_t>(size & 0xFF));
      out.insert(out.end(), frame.begin(), frame.end());
      break;
    case OutputForm::kRsuText: {
      std::string text =
          "Version=0.7\nType=BSM\nPSID=0x20\nPriority=" + std::to_string(options.priority) +
          "\nTxMode=ALT\nTxChannel=" + std::to_string(options.channel) +
          "\nTxInterval=0\nDeliveryStart=\nDeliveryStop=\nSignature=" +
          (options.signs ? "True" : "False") + "\nEncryption=False\nPayload=";
      text += UpperHexText(frame) + "\n";
      out.assign(text.begin(), text.end());
      break;
    }
  }
  return out;
}

}  // namespace v2vouch::obu
