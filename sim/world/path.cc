// SPDX-License-Identifier: Apache-2.0
#include "sim/world/path.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace v2vouch::sim {
namespace {

constexpr double kRampShare = 0.35;  // Of the curve's length, at either end.

// Curvature relative to its peak at share `u` (0..1) of the curve.
double CurvatureShape(double u) {
  const double from_end = std::min(u, 1.0 - u);
  if (from_end <= 0.0) return 0.0;
  if (from_end >= kRampShare) return 1.0;
  return 0.5 * (1.0 - std::cos(kPi * from_end / kRampShare));
}

// Length of a curve that turns by `angle_rad` with peak curvature 1 / radius: the two half-cosine
// ramps turn half as much as a full-curvature stretch of their length.
double CurveLength(double angle_rad, double radius_m) {
  return std::abs(angle_rad) * radius_m / (1.0 - kRampShare);
}

// How far before the corner the curve starts: the chord of a symmetric curve seen in its first
// tangent. Integrated, as the shape has no closed form.
double TangentLength(double angle_rad, double radius_m) {
  const double length = CurveLength(angle_rad, radius_m);
  constexpr int kSteps = 2000;
  double yaw = 0.0;
  Vec2 end = Vec2::Zero();
  for (int i = 0; i < kSteps; ++i) {
    const double step = length / kSteps;
    const double half = 0.5 * step * CurvatureShape((i + 0.5) / kSteps) / radius_m;
    end += step * Direction(yaw + half);
    yaw += 2.0 * half;
  }
  return end.x() - end.y() / std::tan(std::abs(angle_rad));
}

struct Piece {
  double length_m;
  double peak_curvature_per_m;  // 0 for a straight.
};

// The straights and curves between the waypoints. @return false with `problem` said when they do
// not fit.
bool MakePieces(const std::vector<Waypoint>& waypoints, std::vector<Piece>& pieces,
                double& first_yaw, std::string& problem) {
  if (waypoints.size() < 2) {
    problem = "a route needs two waypoints at least";
    return false;
  }
  double left_over = 0.0;  // Tangent length that the previous corner took from this straight.
  for (std::size_t i = 0; i + 1 < waypoints.size(); ++i) {
    const Vec2 leg = waypoints[i + 1].position - waypoints[i].position;
    if (leg.norm() < 0.1) {
      problem = "waypoints " + std::to_string(i) + " and " + std::to_string(i + 1) + " coincide";
      return false;
    }
    const double yaw = std::atan2(leg.y(), leg.x());
    if (i == 0) first_yaw = yaw;
    double tangent = 0.0;
    double angle = 0.0;
    if (i + 2 < waypoints.size()) {
      const Vec2 next = waypoints[i + 2].position - waypoints[i + 1].position;
      angle = AngleDifference(std::atan2(next.y(), next.x()), yaw);
      if (std::abs(angle) > FromDegrees(170.0)) {
        problem = "waypoint " + std::to_string(i + 1) + " turns back on itself";
        return false;
      }
      if (std::abs(angle) > 1e-9) tangent = TangentLength(angle, waypoints[i + 1].radius_m);
    }
    const double straight = leg.norm() - left_over - tangent;
    if (straight < -1e-6) {
      std::ostringstream text;
      text << "the curves at waypoints " << i << " and " << i + 1 << " need " << -straight
           << " m more than lies between them: smaller radius_m or waypoints farther apart";
      problem = text.str();
      return false;
    }
    pieces.push_back({std::max(0.0, straight), 0.0});
    if (tangent > 0.0) {
      const double radius = waypoints[i + 1].radius_m;
      pieces.push_back({CurveLength(angle, radius), std::copysign(1.0 / radius, angle)});
    }
    left_over = tangent;
  }
  return true;
}

}  // namespace

bool Path::Make(const std::vector<Waypoint>& waypoints, Path& path, std::string& problem) {
  std::vector<Piece> pieces;
  double first_yaw = 0.0;
  if (!MakePieces(waypoints, pieces, first_yaw, problem)) return false;
  path.points_.clear();
  path.length_m_ = 0.0;
  for (const Piece& piece : pieces) path.length_m_ += piece.length_m;
  PathPoint point{waypoints.front().position, first_yaw, 0.0};
  path.points_.push_back(point);
  std::size_t index = 0;
  double piece_start = 0.0;
  const auto steps = static_cast<std::size_t>(std::ceil(path.length_m_ / kStep_m));
  const auto curvature_at = [&](double s) {
    while (index + 1 < pieces.size() && s > piece_start + pieces[index].length_m) {
      piece_start += pieces[index].length_m;
      ++index;
    }
    const Piece& piece = pieces[index];
    if (piece.peak_curvature_per_m == 0.0) return 0.0;
    return piece.peak_curvature_per_m * CurvatureShape((s - piece_start) / piece.length_m);
  };
  for (std::size_t i = 0; i < steps; ++i) {
    const double s = static_cast<double>(i) * kStep_m;
    const double turn = curvature_at(s + 0.5 * kStep_m) * kStep_m;
    point.position += kStep_m * Direction(point.yaw_rad + 0.5 * turn);
    point.yaw_rad += turn;
    point.curvature_per_m = curvature_at(s + kStep_m);
    path.points_.push_back(point);
  }
  return true;
}

PathPoint Path::At(double s_m) const {
  if (s_m <= 0.0 || s_m >= length_m_) {
    PathPoint end = s_m <= 0.0 ? points_.front() : points_.back();
    const double over = s_m <= 0.0 ? s_m : s_m - kStep_m * static_cast<double>(points_.size() - 1);
    end.position += over * Direction(end.yaw_rad);
    end.curvature_per_m = 0.0;
    return end;
  }
  const double exact = s_m / kStep_m;
  const auto i = std::min(static_cast<std::size_t>(exact), points_.size() - 2);
  const double share = exact - static_cast<double>(i);
  const PathPoint& a = points_[i];
  const PathPoint& b = points_[i + 1];
  return {a.position + share * (b.position - a.position),
          a.yaw_rad + share * (b.yaw_rad - a.yaw_rad),
          a.curvature_per_m + share * (b.curvature_per_m - a.curvature_per_m)};
}

}  // namespace v2vouch::sim
