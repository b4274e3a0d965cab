// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>

#include "daemon/rim/wire/message_parts.h"
#include "daemon/rim/wire/sensor_conversion.h"

namespace v2vouch::wire {
namespace {

// Of an object: an oversize transport, and more than any road vehicle drives.
constexpr double kMaxLength_m = 40.0;
constexpr double kMaxWidth_m = 10.0;
constexpr double kMaxObjectSpeed_mps = 150.0;
// Variances: a position that is off by more than 100 m carries no information, and no position is
// known to a tenth of a millimetre. A correlation nearer to one than this leaves no ellipse.
constexpr double kMaxObjectVariance = 1e4;
constexpr double kLeastVariance = 1e-8;
constexpr double kMostCorrelation = 0.999;

// Axis and size. Length and width are used only where both are given.
void PutShape(const object_t& from, FieldJudge& judge, ObjectBox& object) {
  const auto yaw = judge.Optional(
      from.yaw_rad, -kTurn_rad, kTurn_rad,
      LooksLikeDegrees(from.yaw_rad) ? "objects.yaw_rad looks like degrees" : "objects.yaw_rad");
  object.has_yaw = yaw.has_value();
  object.yaw_rad = WrapAngle(yaw.value_or(0.0));
  if (from.has_front != 0 && from.has_front != 1) judge.Unused("objects.has_front");
  object.has_front = from.has_front == 1 && object.has_yaw;
  const auto size = [&judge](double value, double least, double most, std::string_view field) {
    return value == 0.0 ? std::nullopt : judge.Optional(value, least, most, field);
  };
  const auto length = size(from.length_m, 0.1, kMaxLength_m, "objects.length_m");
  const auto width = size(from.width_m, 0.1, kMaxWidth_m, "objects.width_m");
  object.has_size = length && width;
  if (!object.has_size) return;
  object.length_m = *length;
  object.width_m = *width;
}

void PutVelocity(const object_t& from, FieldJudge& judge, ObjectBox& object) {
  const auto x = judge.Optional(from.velocity_x_mps, -kMaxObjectSpeed_mps, kMaxObjectSpeed_mps,
                                "objects.velocity_x_mps");
  const auto y = judge.Optional(from.velocity_y_mps, -kMaxObjectSpeed_mps, kMaxObjectSpeed_mps,
                                "objects.velocity_y_mps");
  if (x && y) object.velocity_mps = Eigen::Vector2d(*x, *y);
}

// Variance i of an object's covariance; 0: unknown.
double Variance(const object_t& from, int i, FieldJudge& judge) {
  const double variance = from.covariance[6 * i];
  if (variance > 0.0 && variance <= kMaxObjectVariance) return std::max(variance, kLeastVariance);
  if (variance != 0.0 && !std::isnan(variance)) judge.Unused("objects.covariance");
  return 0.0;
}

// Of the i-th figure and the next. Where only one of the two is known it goes for both; a
// correlation that cannot be counts as none.
Eigen::Matrix2d Covariance(const object_t& from, int i, FieldJudge& judge) {
  Eigen::Matrix2d P = Eigen::Matrix2d::Zero();
  P(0, 0) = Variance(from, i, judge);
  P(1, 1) = Variance(from, i + 1, judge);
  if (P(0, 0) == 0.0) P(0, 0) = P(1, 1);
  if (P(1, 1) == 0.0) P(1, 1) = P(0, 0);
  const double upper = from.covariance[5 * i + i + 1];
  const double lower = from.covariance[5 * (i + 1) + i];
  if (std::isnan(upper) || std::isnan(lower)) return P;
  const double scale = std::sqrt(P(0, 0) * P(1, 1));
  const double mean = 0.5 * (upper + lower);
  const bool is_symmetric = std::abs(upper - lower) <= 1e-6 * (1.0 + scale);
  if (is_symmetric && std::abs(mean) <= kMostCorrelation * scale) {
    P(0, 1) = P(1, 0) = mean;
  } else if (scale > 0.0) {
    judge.Unused("objects.covariance");
  }
  return P;
}

void PutCovariances(const object_t& from, FieldJudge& judge, ObjectBox& object) {
  object.position_covariance = Covariance(from, 0, judge);
  object.yaw_sigma_rad = std::sqrt(Variance(from, 2, judge));
  object.velocity_covariance = Covariance(from, 3, judge);
}

}  // namespace

Result<ObjectList> FromWire(const object_list_t& message, const ObjectSensorConfig& source,
                            int index, Timestamp received, RefusalTally& dropped) {
  FieldJudge judge(dropped);
  JudgeSensor(message.sensor, source.name, judge);
  JudgeTime(message, received, judge);
  if (judge.refusal()) return *judge.refusal();

  ObjectList list;
  static_cast<MessageHeader&>(list) = Header(message, source.clock_offset_s, received);
  list.sensor = index;
  list.objects.reserve(message.objects.size());
  for (const object_t& from : message.objects) {
    FieldJudge each(dropped);
    each.Need(from.x_m, -kMaxRange_m, kMaxRange_m, "objects.x_m");
    each.Need(from.y_m, -kMaxRange_m, kMaxRange_m, "objects.y_m");
    if (each.refusal()) {
      dropped.Add(*each.refusal());
      continue;
    }
    const auto object_class = Class(from.class_name, "objects.class_name", dropped);
    if (!object_class) continue;
    ObjectBox& object = list.objects.emplace_back();
    object.x_m = from.x_m;
    object.y_m = from.y_m;
    object.object_class = *object_class;
    object.score = Score(from.score, "objects.score", "objects.score looks like percent", each);
    object.id = std::max<std::int64_t>(from.id, -1);
    PutShape(from, each, object);
    PutVelocity(from, each, object);
    PutCovariances(from, each, object);
  }
  return list;
}

}  // namespace v2vouch::wire
