// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/io/durable_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "daemon/rim/io/output_file.h"

namespace v2vouch {
namespace {

bool WriteAll(int file, std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = write(file, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    content.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

bool SyncFolder(const std::string& folder) {
  const int handle = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (handle < 0) return false;
  const bool is_synced = fsync(handle) == 0;
  close(handle);
  return is_synced;
}

bool WriteStream(const std::string& path, std::string_view content, std::string& error) {
  std::FILE* stream = OpenOutput(path, {}, error);
  if (stream == nullptr) return false;
  bool is_good = std::fwrite(content.data(), 1, content.size(), stream) == content.size();
  is_good &= std::fflush(stream) == 0;
  if (!is_good) error = path + ": cannot write: " + std::strerror(errno);
  if (std::fclose(stream) != 0 && is_good) {
    error = path + ": cannot write: " + std::strerror(errno);
    return false;
  }
  return is_good;
}

}  // namespace

bool ReplaceFile(const std::string& path, std::string_view content, std::string& error,
                 std::span<const std::string> inputs) {
  const auto fail = [&](const std::string& what) {
    error = path + ": " + what + ": " + std::strerror(errno);
    return false;
  };
  const OutputPlace place = LookAtOutput(path, inputs, error);
  if (place == OutputPlace::kRefused) return false;
  if (place == OutputPlace::kStream) return WriteStream(path, content, error);
  std::string folder = std::filesystem::path(path).parent_path().string();
  if (folder.empty()) folder = ".";

  std::string temporary = path + ".XXXXXX";
  const int file = mkstemp(temporary.data());
  if (file < 0) return fail("cannot write in folder " + folder);
  bool is_good = fchmod(file, S_IRUSR | S_IWUSR | S_IRGRP | S_IROTH) == 0 &&
                 WriteAll(file, content) && fsync(file) == 0;
  if (!is_good) fail("cannot write");
  if (close(file) != 0 && is_good) is_good = fail("cannot write");
  if (is_good && std::rename(temporary.c_str(), path.c_str()) != 0)
    is_good = fail("cannot replace");
  if (!is_good) {
    unlink(temporary.c_str());
    return false;
  }
  return SyncFolder(folder) || fail("written, but folder " + folder + " cannot be synced");
}

}  // namespace v2vouch
