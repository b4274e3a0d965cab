// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/spy/field_tree.h"

#include <algorithm>
#include <ctime>

#include "daemon/programs/spy/printable.h"
#include "daemon/rim/message_schema/walk.h"

namespace v2vouch::spy {
namespace {

using message_schema::Field;
using message_schema::Primitive;

constexpr std::size_t kMostLines = 2000;

std::string TimeText(std::int64_t micros) {
  if (micros == 0) return "0";
  const std::time_t seconds = micros / 1'000'000;
  std::tm parts{};
  char text[32] = "?";
  if (gmtime_r(&seconds, &parts) != nullptr && parts.tm_year > 70 && parts.tm_year < 300) {
    std::strftime(text, sizeof(text), "%Y-%m-%d %H:%M:%S", &parts);
  }
  return Format("%lld  %s.%06lld", static_cast<long long>(micros), text,
                static_cast<long long>(micros % 1'000'000));
}

class TreeWriter : public message_schema::Visitor {
 public:
  explicit TreeWriter(std::size_t most_elements) : most_elements_(most_elements) {}

  void BeginStruct(const message_schema::Type& type) override {
    ++structs_;
    if (structs_ == 1) return Line(std::string(type.package) + '.' + std::string(type.name));
    if (!arrays_.empty() && arrays_.back().is_open) {
      if (IsShown()) Line(Format("[%zu]", arrays_.back().index));
      ++arrays_.back().index;
      arrays_.back().is_open = false;
      struct_in_array_.push_back(true);
    } else {
      Line(std::string(field_->name));
      struct_in_array_.push_back(false);
    }
  }
  void EndStruct() override {
    --structs_;
    if (structs_ == 0) return;
    if (struct_in_array_.back()) arrays_.back().is_open = true;
    struct_in_array_.pop_back();
  }
  void Name(const Field& field) override { field_ = &field; }
  void BeginArray(std::size_t count) override {
    const bool is_numbers = field_->primitive != Primitive::kStruct;
    if (IsShown()) Line(std::string(field_->name) + Format(" (%zu)", count) + Unit());
    arrays_.push_back({count, 0, true, is_numbers, {}});
  }
  void EndArray() override {
    Array array = std::move(arrays_.back());
    arrays_.pop_back();
    const bool is_cut = array.count > most_elements_;
    if (array.is_numbers) {
      if (!array.text.empty() && IsShown()) {
        Line("  " + array.text + (is_cut ? "..." : ""));
      }
    } else if (is_cut && IsShown()) {
      Line(Format("  ... %zu more", array.count - most_elements_));
    }
  }
  void Integer(std::int64_t value) override {
    if (field_->unit == "us UTC") return Value(TimeText(value), false);
    Value(std::to_string(value), true);
  }
  void Boolean(bool value) override { Value(value ? "true" : "false", true); }
  void Real(double value) override { Value(Format("%.6g", value), true); }
  void Text(std::string_view value) override { Value('"' + Printable(value) + '"', true); }
  void Bytes(std::span<const std::uint8_t> value, bool) override {
    std::string text;
    for (const std::uint8_t octet : value.first(std::min<std::size_t>(value.size(), 16))) {
      text += Format("%02x", octet);
    }
    if (value.size() > 16) text += Format("... (%zu bytes)", value.size());
    Value(text, true);
  }

  std::vector<std::string> lines;

 private:
  struct Array {
    std::size_t count = 0, index = 0;
    bool is_open = true;  // Its next element begins; false inside an element.
    bool is_numbers = false;
    std::string text;
  };

  [[nodiscard]] std::string Unit() const {
    return field_->unit.empty() ? "" : "  [" + std::string(field_->unit) + "]";
  }
  // Not within elements beyond those that are shown.
  [[nodiscard]] bool IsShown() const {
    return std::ranges::none_of(arrays_, [&](const Array& array) {
      // Inside an element the index counts it already.
      return array.index + (array.is_open ? 1 : 0) > most_elements_;
    });
  }
  void Value(const std::string& value, bool with_unit) {
    if (!arrays_.empty() && arrays_.back().is_open) {
      Array& array = arrays_.back();
      if (array.index < most_elements_) array.text += value + ' ';
      ++array.index;
      return;
    }
    if (!IsShown()) return;
    std::string line(field_->name);
    line.resize(std::max<std::size_t>(line.size() + 1, 24), ' ');
    line += value;
    if (with_unit && !field_->unit.empty()) line += ' ' + std::string(field_->unit);
    Line(line);
  }
  void Line(const std::string& text) {
    if (lines.size() >= kMostLines) return;
    const std::size_t depth = lines.empty() ? 0 : struct_in_array_.size() + arrays_.size() + 1;
    lines.push_back(std::string(2 * depth, ' ') + text);
  }

  std::size_t most_elements_;
  int structs_ = 0;
  const Field* field_ = nullptr;
  std::vector<Array> arrays_;
  std::vector<bool> struct_in_array_;
};

}  // namespace

std::vector<std::string> FieldTree(std::span<const std::uint8_t> message,
                                   std::size_t most_elements) {
  const message_schema::Type* type = message_schema::TypeOf(message);
  TreeWriter writer(most_elements);
  if (type != nullptr && message_schema::Walk(*type, message, writer)) {
    return std::move(writer.lines);
  }
  std::string bytes;
  for (const std::uint8_t octet : message.first(std::min<std::size_t>(message.size(), 16))) {
    bytes += Format("%02x ", octet);
  }
  return {type == nullptr ? "a type that is none of ours" : "broken " + std::string(type->name),
          Format("%zu bytes: ", message.size()) + bytes};
}

}  // namespace v2vouch::spy
