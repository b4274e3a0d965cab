// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/log/csv.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <span>
#include <string_view>

#include "daemon/common/base/did_you_mean.h"
#include "daemon/rim/io/event_log.h"
#include "daemon/rim/wire/type_table.h"

namespace v2vouch {
namespace {

using wire::Field;
using wire::Kind;
using wire::Layout;

// One value of a message: a figure or text, or a struct's fields, each with its elements.
struct Node {
  std::string text;
  std::vector<std::vector<Node>> fields;
};

std::uint64_t Take(std::span<const std::uint8_t>& bytes, std::size_t count) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < count; ++i) value = (value << 8) | bytes[i];
  bytes = bytes.subspan(count);
  return value;
}

std::string Exact(auto value) {
  char text[40];
  return {text, std::to_chars(text, text + sizeof(text), value).ptr};
}

std::string Quoted(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

Node ReadStruct(const Layout& layout, std::span<const std::uint8_t>& bytes);

// The bytes have been walked over: every length fits.
Node ReadValue(const Field& field, std::span<const std::uint8_t>& bytes) {
  switch (field.kind) {
    case Kind::kByte:
      return {Exact(static_cast<int>(Take(bytes, 1))), {}};
    case Kind::kInt8:
      return {Exact(static_cast<int>(static_cast<std::int8_t>(Take(bytes, 1)))), {}};
    case Kind::kInt16:
      return {Exact(static_cast<int>(static_cast<std::int16_t>(Take(bytes, 2)))), {}};
    case Kind::kInt32:
      return {Exact(static_cast<std::int32_t>(Take(bytes, 4))), {}};
    case Kind::kInt64:
      return {Exact(static_cast<std::int64_t>(Take(bytes, 8))), {}};
    case Kind::kFloat:
      return {Exact(std::bit_cast<float>(static_cast<std::uint32_t>(Take(bytes, 4)))), {}};
    case Kind::kDouble: {
      const double value = std::bit_cast<double>(Take(bytes, 8));
      return {std::isnan(value) ? "nan" : Exact(value), {}};
    }
    case Kind::kString: {
      const auto length = static_cast<std::size_t>(Take(bytes, 4));
      const std::string text(reinterpret_cast<const char*>(bytes.data()), length - 1);
      bytes = bytes.subspan(length);
      return {Quoted(text), {}};
    }
    case Kind::kStruct:
      return ReadStruct(*field.type, bytes);
  }
  return {};
}

Node ReadStruct(const Layout& layout, std::span<const std::uint8_t>& bytes) {
  Node node;
  std::int32_t count = 0;  // Of the int32 field right in front.
  for (const Field& field : layout.fields) {
    const int elements = field.max_count > 0 ? count : field.fixed;
    auto& values = node.fields.emplace_back();
    if (field.kind == Kind::kInt32) {
      auto ahead = bytes;
      count = static_cast<std::int32_t>(Take(ahead, 4));
    }
    for (int i = 0; i < elements; ++i) values.push_back(ReadValue(field, bytes));
  }
  return node;
}

// One step of a path: which field, and which of its elements; -1: of a list, each in its row.
struct Step {
  std::size_t field = 0;
  int element = 0;
};
using Path = std::vector<Step>;

std::vector<std::string> NamesOf(const Layout& layout) {
  std::vector<std::string> names;
  for (const Field& field : layout.fields) names.emplace_back(field.name);
  return names;
}

std::optional<Path> Resolve(const Layout& type, const std::string& name, std::string& error) {
  Path path;
  const Layout* layout = &type;
  std::size_t at = 0;
  while (at <= name.size()) {
    const std::size_t dot = std::min(name.find('.', at), name.size());
    std::string word = name.substr(at, dot - at);
    int element = -1;
    if (const auto open = word.find('['); open != std::string::npos && word.ends_with("]")) {
      const char* end = word.data() + word.size() - 1;
      const auto [stop, fault] = std::from_chars(word.data() + open + 1, end, element);
      if (fault != std::errc() || stop != end || element < 0) {
        error = name + ": no index in " + word;
        return std::nullopt;
      }
      word.resize(open);
    }
    if (layout == nullptr) {
      error = name + ": nothing is below " + name.substr(0, at - 1);
      return std::nullopt;
    }
    std::size_t i = 0;
    while (i < layout->fields.size() && layout->fields[i].name != word) ++i;
    if (i == layout->fields.size()) {
      error = name + ": " + std::string(layout->name) + " has no field " + word +
              DidYouMean(word, NamesOf(*layout));
      return std::nullopt;
    }
    const Field& field = layout->fields[i];
    const bool is_list = field.max_count > 0;
    if (element < 0 && !is_list && field.fixed > 1) {
      error = name + " has " + std::to_string(field.fixed) + " elements: name one, as in " + name +
              "[0]";
      return std::nullopt;
    }
    if (element < 0 && is_list && !path.empty()) {
      error = name + ": a list in a list: name one, as in " + word + "[0]";
      return std::nullopt;
    }
    path.push_back({i, element < 0 && !is_list ? 0 : element});
    layout = field.kind == Kind::kStruct ? field.type : nullptr;
    at = dot + 1;
  }
  if (layout != nullptr) {
    error = name + " is a " + std::string(layout->name) + ": name a field of it, as in " + name +
            "." + std::string(layout->fields[0].name);
    return std::nullopt;
  }
  return path;
}

// "" where the list is shorter than that.
const std::string& ValueAt(const Node& message, const Path& path, std::size_t row) {
  static const std::string kNothing;
  const Node* node = &message;
  for (const Step& step : path) {
    const auto& values = node->fields[step.field];
    const std::size_t element = step.element < 0 ? row : static_cast<std::size_t>(step.element);
    if (element >= values.size()) return kNothing;
    node = &values[element];
  }
  return node->text;
}

struct Columns {
  std::vector<Path> paths;
  std::optional<std::size_t> list;  // The field whose elements are rows.
};

std::optional<Columns> ResolveAll(const Layout& type, std::vector<std::string>& fields,
                                  std::string& error) {
  if (fields.empty()) {
    for (const Field& field : type.fields) {
      const bool is_plain = field.kind != Kind::kStruct && field.max_count == 0 && field.fixed == 1;
      if (is_plain) fields.emplace_back(field.name);
    }
  }
  Columns columns;
  for (const std::string& name : fields) {
    auto path = Resolve(type, name, error);
    if (!path) return std::nullopt;
    if (path->front().element < 0) {
      if (columns.list && *columns.list != path->front().field) {
        error = name + ": another list than the fields in front of it; one list makes the rows";
        return std::nullopt;
      }
      columns.list = path->front().field;
    }
    columns.paths.push_back(std::move(*path));
  }
  return columns;
}

}  // namespace

std::optional<CsvTable> WriteCsv(const std::string& log, const std::string& channel,
                                 std::vector<std::string> fields, std::FILE* out,
                                 std::string& error) {
  const auto reader = LogReader::Open(log, error);
  if (!reader) return std::nullopt;
  const Layout* type = nullptr;
  std::optional<Columns> columns;
  std::vector<std::string> others;
  CsvTable table;
  LogEvent event;
  while (reader->Next(event)) {
    if (event.channel != channel) {
      if (std::ranges::find(others, event.channel) == others.end()) others.push_back(event.channel);
      continue;
    }
    const wire::WireType* found = wire::TypeOf(event.bytes);
    std::span<const std::uint8_t> bytes(event.bytes);
    if (found == nullptr || (type != nullptr && found->layout != type) ||
        wire::Walk(*found->layout, bytes.subspan(8))) {
      ++table.unreadable;
      continue;
    }
    bytes = bytes.subspan(8);  // The fingerprint.
    if (type == nullptr) {
      type = found->layout;
      columns = ResolveAll(*type, fields, error);
      if (!columns) return std::nullopt;
      std::fputs("recorded_utime", out);
      for (const std::string& name : fields) std::fprintf(out, ",%s", name.c_str());
      std::fputc('\n', out);
    }
    const Node message = ReadStruct(*type, bytes);
    const std::size_t count = columns->list ? message.fields[*columns->list].size() : 1;
    for (std::size_t row = 0; row < count; ++row, ++table.rows) {
      std::string line = Exact(ToMicros(event.received));
      for (const Path& path : columns->paths) {
        line += ',';
        line += ValueAt(message, path, row);
      }
      line += '\n';
      if (std::fputs(line.c_str(), out) < 0) return table;
    }
  }
  if (type == nullptr) {
    error = channel + ": no message of a known type in " + log + DidYouMean(channel, others);
    return std::nullopt;
  }
  table.damaged = reader->damaged();
  return table;
}

}  // namespace v2vouch
