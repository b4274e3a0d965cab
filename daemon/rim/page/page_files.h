// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace v2vouch {

/// A file of the page, part of the program.
struct PageFile {
  std::string_view path;  ///< As asked for: "/" or "/scene.js".
  std::string_view type;  ///< Content-Type.
  std::string_view content;
};

/// All files of this folder, put in by scripts/cmake/V2vouchEmbed.cmake.
std::span<const PageFile> PageFiles();

}  // namespace v2vouch
