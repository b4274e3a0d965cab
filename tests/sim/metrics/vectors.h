// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tests/support/data_folder.h"

namespace v2vouch::evaluation {

/// The reference vectors (gospa_vectors.json), or nothing where the data folder is absent.
inline std::optional<nlohmann::json> LoadVectors() {
  std::ifstream file(DataFolder() / "gospa_vectors.json");
  if (!file) return std::nullopt;
  return nlohmann::json::parse(file);
}

inline Eigen::Vector2d PointFrom(const nlohmann::json& xy) {
  return {xy.at(0).get<double>(), xy.at(1).get<double>()};
}

inline std::vector<Eigen::Vector2d> PointsFrom(const nlohmann::json& list) {
  std::vector<Eigen::Vector2d> points;
  for (const auto& xy : list) points.push_back(PointFrom(xy));
  return points;
}

/// |a - b| relative to the larger of |b| and 1.
inline double RelativeError(double a, double b) {
  return std::abs(a - b) / std::max(1.0, std::abs(b));
}

}  // namespace v2vouch::evaluation
