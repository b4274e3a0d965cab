// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/io/output_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

namespace v2vouch {
namespace {

using FileStatus = struct stat;

bool IsSame(const FileStatus& a, const FileStatus& b) {
  return a.st_dev == b.st_dev && a.st_ino == b.st_ino;
}

// /dev/stdout, /dev/fd/63, /proc/self/fd/1: somebody opened what is behind them for us.
bool IsOpenDescriptor(const std::string& path) {
  return path.starts_with("/dev/") || path.starts_with("/proc/");
}

}  // namespace

OutputPlace LookAtOutput(const std::string& path, std::span<const std::string> inputs,
                         std::string& error) {
  const auto refuse = [&](const std::string& why) {
    error = path + ": " + why;
    return OutputPlace::kRefused;
  };
  if (path.empty()) {
    error = "the name of the file to write is empty";
    return OutputPlace::kRefused;
  }
  FileStatus link{};
  if (lstat(path.c_str(), &link) != 0) {
    if (errno != ENOENT) return refuse(std::strerror(errno));
    const std::filesystem::path folder = std::filesystem::path(path).parent_path();
    std::error_code ignored;
    if (!folder.empty() && !std::filesystem::is_directory(folder, ignored)) {
      return refuse("cannot write in folder " + folder.string() + ": " + std::strerror(ENOENT));
    }
    return OutputPlace::kFile;
  }
  FileStatus status = link;
  if (S_ISLNK(link.st_mode)) {
    std::error_code ignored;
    const std::string target = std::filesystem::read_symlink(path, ignored).string();
    if (stat(path.c_str(), &status) != 0) {
      return refuse("is a symbolic link to " + target + ", which is not there");
    }
    if (S_ISREG(status.st_mode)) {
      if (IsOpenDescriptor(path)) return OutputPlace::kStream;
      return refuse("is a symbolic link to " + target + "; name that file to write it");
    }
  }
  for (const std::string& input : inputs) {
    FileStatus other{};
    if (S_ISREG(status.st_mode) && stat(input.c_str(), &other) == 0 && IsSame(status, other)) {
      return refuse("is the file that is being read");
    }
  }
  if (S_ISREG(status.st_mode)) return OutputPlace::kFile;
  if (S_ISCHR(status.st_mode) || S_ISFIFO(status.st_mode)) return OutputPlace::kStream;
  if (S_ISDIR(status.st_mode)) return refuse("is a folder");
  if (S_ISBLK(status.st_mode)) return refuse("is a disk; nothing is written onto it");
  return refuse("is no file");
}

std::FILE* OpenOutput(const std::string& path, std::span<const std::string> inputs,
                      std::string& error) {
  const OutputPlace place = LookAtOutput(path, inputs, error);
  if (place == OutputPlace::kRefused) return nullptr;
  // What was no link a moment ago must not have become one.
  const int flags = place == OutputPlace::kFile ? O_CREAT | O_TRUNC | O_NOFOLLOW : O_NONBLOCK;
  const int file = open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY | flags, 0644);
  if (file < 0) {
    error = path + ": " + (errno == ENXIO ? "is a pipe that nobody reads" : std::strerror(errno));
    return nullptr;
  }
  if (place == OutputPlace::kStream) fcntl(file, F_SETFL, fcntl(file, F_GETFL) & ~O_NONBLOCK);
  std::FILE* stream = fdopen(file, "wb");
  if (stream == nullptr) {
    error = path + ": " + std::strerror(errno);
    close(file);
  }
  return stream;
}

}  // namespace v2vouch
