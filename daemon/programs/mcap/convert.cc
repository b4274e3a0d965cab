// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/mcap/convert.h"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "daemon/programs/mcap/raw_flavour.h"
#include "daemon/programs/mcap/view_flavour.h"
#include "daemon/rim/io/output_file.h"
#include "daemon/rim/mcap/reader.h"
#include "daemon/rim/mcap/writer.h"

namespace v2vouch::mcap_export {
namespace {

constexpr int kAskEvery = 256;  // Events.

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

}  // namespace

bool IsMcap(const std::string& path) {
  const File file(std::fopen(path.c_str(), "rb"));
  std::array<std::uint8_t, mcap::kMagic.size()> magic{};
  return file && std::fread(magic.data(), 1, magic.size(), file.get()) == magic.size() &&
         magic == mcap::kMagic;
}

bool LogToMcap(const std::string& in, const std::string& out, const ConvertOptions& options,
               const Progress& progress, ConvertResult& result, std::string& error) {
  result = {};
  const auto log = LogReader::Open(in, error);
  if (!log) return false;
  const std::array<std::string, 1> inputs{in};
  File file(OpenOutput(out, inputs, error));
  if (!file) return false;
  int write_error = 0;
  const auto sink = [&](std::span<const std::uint8_t> bytes) {
    const bool good =
        bytes.empty() || std::fwrite(bytes.data(), 1, bytes.size(), file.get()) == bytes.size();
    if (!good && write_error == 0) write_error = errno;
  };
  mcap::Writer writer(sink,
                      {.library = "v2vouch " V2VOUCH_VERSION, .compression = options.compression});
  RawWriter raw(writer);
  ViewWriter view(writer);
  const bool is_raw = options.flavour == Flavour::kRaw;
  result.made = is_raw ? "raw" : "view";
  LogEvent event;
  while (write_error == 0 && log->Next(event)) {
    if (is_raw) {
      raw.Write(event);
    } else {
      view.Write(event);
    }
    if (++result.events % kAskEvery == 0 && !progress(log->progress())) {
      error = "stopped; " + out + " holds what was done";
      writer.Close();
      return false;
    }
  }
  writer.Close();
  if (std::fflush(file.get()) != 0 && write_error == 0) write_error = errno;
  if (write_error != 0) {
    error = out + ": " + std::strerror(write_error);
    return false;
  }
  result.messages = static_cast<std::int64_t>(writer.messages());
  result.left_out = view.left_out();
  result.damaged = log->damaged();
  result.chunks = static_cast<std::int64_t>(writer.chunks());
  result.bytes = static_cast<std::int64_t>(writer.bytes_written());
  if (result.damaged > 0) {
    result.notes.push_back(in + " has " + std::to_string(result.damaged) +
                           " damaged stretches; what they held is not in " + out);
  }
  if (result.left_out > 0) {
    result.notes.push_back(std::to_string(result.left_out) +
                           " events are of types that are none of ours, or do not decode: they are "
                           "left out of the view flavour (--raw keeps them)");
  }
  return true;
}

bool McapToLog(const std::string& in, const std::string& out, const Progress& progress,
               ConvertResult& result, std::string& error) {
  result = {};
  const File file(std::fopen(in.c_str(), "rb"));
  if (!file) {
    error = in + ": " + std::strerror(errno);
    return false;
  }
  std::fseek(file.get(), 0, SEEK_END);
  const long size = std::ftell(file.get());
  std::fseek(file.get(), 0, SEEK_SET);
  const auto reader = mcap::Reader::Open(
      [&](std::span<std::uint8_t> into) {
        return std::fread(into.data(), 1, into.size(), file.get());
      },
      error);
  if (!reader) {
    error = in + ": " + error;
    return false;
  }
  const std::array<std::string, 1> inputs{in};
  const auto log = LogWriter::Create(out, error, inputs);
  if (!log) return false;
  RawReader raw;
  mcap::Message message;
  LogEvent event;
  result.made = "lcm";
  std::int64_t read = 0;
  while (log->is_good() && reader->Next(message)) {
    if (raw.Read(message, event)) {
      log->Write(event);
      ++result.messages;
      result.bytes += static_cast<std::int64_t>(28 + event.channel.size() + event.bytes.size());
    }
    const auto at = static_cast<double>(std::ftell(file.get()));
    if (++read % kAskEvery == 0 && !progress(size > 0 ? at / static_cast<double>(size) : 1.0)) {
      error = "stopped; " + out + " holds what was done";
      return false;
    }
  }
  if (!log->Close(error)) return false;
  result.events = read;
  result.left_out = raw.refused() + reader->stray_messages();
  result.damaged = reader->damaged_chunks();
  result.fault = reader->fault();
  if (!result.fault.empty()) result.notes.push_back(in + ": " + result.fault);
  if (result.damaged > 0) {
    result.notes.push_back(in + " has " + std::to_string(result.damaged) + " damaged chunks");
  }
  if (result.messages == 0) {
    error = in + " holds no LCM messages: only files made with --raw can be turned back";
    return false;
  }
  if (result.left_out > 0) {
    result.notes.push_back(std::to_string(result.left_out) + " messages are no LCM events");
  }
  return true;
}

}  // namespace v2vouch::mcap_export
