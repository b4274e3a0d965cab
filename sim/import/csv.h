// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace v2vouch::sim {

/// Reads chosen columns of a CSV file with a header line, plain or gzip-compressed. No quoting: the
/// recordings read here have none. The first fault ends the reading; `error` names file and line.
///
///     auto csv = CsvReader::Open("speed.csv", {"t_s", "speed_mps"}, error);
///     while (csv->Next()) Use(csv->Number(0), csv->Number(1));
///     if (!csv->error().empty()) ...
class CsvReader {
 public:
  /// @return nullptr with `error` set when the file cannot be read or lacks one of `columns`.
  static std::unique_ptr<CsvReader> Open(const std::string& path,
                                         const std::vector<std::string>& columns,
                                         std::string& error);
  ~CsvReader();
  CsvReader(const CsvReader&) = delete;
  CsvReader& operator=(const CsvReader&) = delete;

  /// Goes to the next row that is not empty. False at the end, and after a fault.
  bool Next();
  /// Of the present row; `column` counts in the order given to Open.
  [[nodiscard]] std::string_view Text(std::size_t column) const { return fields_[column]; }
  /// A finite number; anything else is a fault, and 0.
  double Number(std::size_t column);
  /// Marks the present row as faulty for a reason of the caller's.
  void Fail(std::string_view why);

  [[nodiscard]] std::size_t line() const { return line_; }  ///< Counts from 1, header included.
  [[nodiscard]] const std::string& error() const { return error_; }  ///< Empty: none.

 private:
  struct Stream;
  CsvReader() = default;
  bool ReadLine();

  std::unique_ptr<Stream> stream_;
  std::string path_;
  std::vector<std::string> columns_;
  std::vector<std::size_t> positions_;  // Of each column in the file.
  std::size_t width_ = 0;               // Fields of the header.
  std::string text_;
  std::vector<std::string_view> fields_;
  std::size_t line_ = 0;
  std::string error_;
};

}  // namespace v2vouch::sim
