// SPDX-License-Identifier: Apache-2.0
#include "sim/campaign/record.h"

#include <unistd.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "sim/spoofing/spoof_json.h"

namespace v2vouch::campaign {
namespace {

using Json = nlohmann::ordered_json;

const char* KindName(Kind kind) {
  return kind == Kind::kPlain ? "plain" : kind == Kind::kAttack ? "attack" : "honest";
}

Json ToJson(const RunRecord& record) {
  const Job& job = record.job;
  Json json = {{"kind", KindName(job.overlay.kind)},
               {"id", job.overlay.id},
               {"variant", job.overlay.variant},
               {"scenario", job.scenario_name()},
               {"density", job.density},
               {"seed", job.seed},
               {"local_digest", record.local_digest},
               {"step_p99_us", record.step_p99_us},
               {"step_max_us", record.step_max_us},
               {"spoof", Json::parse(evaluation::SpoofJson(record.ours))}};
  if (record.warnings) json["warnings"] = Json::parse(record.warnings_json);
  if (record.paper) json["paper"] = Json::parse(evaluation::SpoofJson(*record.paper));
  return json;
}

std::optional<RunRecord> FromJson(const Json& json) {
  RunRecord record;
  Job& job = record.job;
  const std::string kind = json.at("kind").get<std::string>();
  job.overlay.kind = kind == "plain"    ? Kind::kPlain
                     : kind == "attack" ? Kind::kAttack
                                        : Kind::kHonest;
  job.overlay.id = json.at("id").get<std::string>();
  job.overlay.variant = json.at("variant").get<std::string>();
  job.scenario = json.at("scenario").get<std::string>();
  job.density = json.at("density").get<int>();
  job.seed = json.at("seed").get<std::uint64_t>();
  record.local_digest = json.at("local_digest").get<std::string>();
  record.step_p99_us = json.value("step_p99_us", 0.0);
  record.step_max_us = json.value("step_max_us", 0.0);
  if (!evaluation::ReadSpoofJson(json.at("spoof").dump(), record.ours)) return std::nullopt;
  if (json.contains("warnings")) {
    record.warnings_json = json["warnings"].dump();
    record.warnings.emplace();
    if (!evaluation::ReadWarnTally(record.warnings_json, *record.warnings)) return std::nullopt;
  }
  if (json.contains("paper")) {
    record.paper.emplace();
    if (!evaluation::ReadSpoofJson(json["paper"].dump(), *record.paper)) return std::nullopt;
  }
  return record;
}

}  // namespace

std::filesystem::path RecordPath(const std::filesystem::path& folder, const Job& job) {
  return folder / "runs" / (job.key() + ".json");
}

bool WriteRecord(const std::filesystem::path& folder, const RunRecord& record,
                 std::string& problem) {
  const std::filesystem::path path = RecordPath(folder, record.job);
  const std::filesystem::path temporary = path.string() + "." + std::to_string(getpid()) + ".part";
  std::error_code error;
  std::filesystem::create_directories(path.parent_path(), error);
  {
    std::ofstream file(temporary);
    file << ToJson(record).dump() << "\n";
    file.close();
    if (!file) {
      problem = "cannot write " + temporary.string();
      return false;
    }
  }
  std::filesystem::rename(temporary, path, error);
  if (error) problem = "cannot write " + path.string() + ": " + error.message();
  return !error;
}

std::optional<RunRecord> ReadRecord(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return std::nullopt;
  std::stringstream text;
  text << file.rdbuf();
  try {
    return FromJson(Json::parse(text.str()));
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

std::vector<RunRecord> ReadRecords(const std::vector<std::filesystem::path>& folders,
                                   std::vector<std::string>& problems) {
  std::map<std::string, RunRecord> records;
  for (const auto& folder : folders) {
    std::error_code error;
    std::filesystem::directory_iterator files(folder / "runs", error);
    if (error) {
      problems.push_back((folder / "runs").string() + ": " + error.message());
      continue;
    }
    for (const auto& file : files) {
      if (file.path().extension() != ".json") continue;
      auto record = ReadRecord(file.path());
      if (!record) {
        problems.push_back(file.path().string() + ": no record of a run");
        continue;
      }
      records.try_emplace(file.path().stem().string(), std::move(*record));
    }
  }
  std::vector<RunRecord> ordered;
  for (auto& [key, record] : records) ordered.push_back(std::move(record));
  return ordered;
}

}  // namespace v2vouch::campaign
