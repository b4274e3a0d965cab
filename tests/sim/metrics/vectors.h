// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace v2vouch::evaluation {

/// The reference vectors (gospa_vectors.json), or nothing where the data folder is absent.
inline std::optional<nlohmann::json> LoadVectors() {
  const char* folder = std::getenv("V2VOUCH_DATA");
  const auto path =
      std::filesystem::path(folder != nullptr ? folder : "../shared/data") / "gospa_vectors.json";
  std::ifstream file(path);
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
