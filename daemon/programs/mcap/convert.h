// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "daemon/rim/mcap/records.h"

namespace v2vouch::mcap_export {

enum class Flavour { kView, kRaw };

struct ConvertOptions {
  Flavour flavour = Flavour::kView;
  mcap::Compression compression = mcap::Compression::kZstd;
};

struct ConvertResult {
  std::string made;                ///< "view", "raw" or "lcm".
  std::int64_t events = 0;         ///< Read.
  std::int64_t messages = 0;       ///< Written.
  std::int64_t left_out = 0;       ///< Events that are not in the file.
  std::int64_t damaged = 0;        ///< Stretches or chunks of the input.
  std::int64_t chunks = 0;         ///< Of the MCAP file written.
  std::int64_t bytes = 0;          ///< Of the file written.
  std::string fault;               ///< Why the input ended early; empty = it is whole.
  std::vector<std::string> notes;  ///< Sentences for people.
};

/// Asked now and then with the share done; false stops.
using Progress = std::function<bool(double)>;

/// Whether the file begins as an MCAP file does.
bool IsMcap(const std::string& path);

bool LogToMcap(const std::string& in, const std::string& out, const ConvertOptions& options,
               const Progress& progress, ConvertResult& result, std::string& error);
/// From a raw MCAP file, whole or torn, back to an LCM log.
bool McapToLog(const std::string& in, const std::string& out, const Progress& progress,
               ConvertResult& result, std::string& error);

}  // namespace v2vouch::mcap_export
