// SPDX-License-Identifier: Apache-2.0
#include "daemon/detector/darknet_cfg.h"

#include <charconv>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace v2vouch {
namespace {

constexpr std::int64_t kHeaderBytes = 20;
constexpr std::int64_t kMaxFilters = 1 << 20;
constexpr std::int64_t kMaxSize = 64;

struct Section {
  std::string name;
  std::map<std::string, std::string, std::less<>> values;
};

std::string WithoutSpaces(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c != ' ' && c != '\t' && c != '\r') out.push_back(c);
  }
  return out;
}

std::vector<Section> SectionsOf(std::string_view text) {
  std::vector<Section> sections;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string line = WithoutSpaces(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (line.empty() || line[0] == '#' || line[0] == ';') continue;
    if (line[0] == '[') {
      sections.push_back({line.substr(1, line.find(']') - 1), {}});
    } else if (const std::size_t equals = line.find('=');
               equals != std::string::npos && !sections.empty()) {
      sections.back().values[line.substr(0, equals)] = line.substr(equals + 1);
    }
  }
  return sections;
}

std::optional<std::int64_t> Whole(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// A key of a section within bounds; nullopt for anything else.
std::optional<std::int64_t> Value(const Section& section, std::string_view key,
                                  std::int64_t otherwise, std::int64_t least, std::int64_t most) {
  const auto found = section.values.find(key);
  const auto value = found == section.values.end() ? otherwise : Whole(found->second);
  return value && *value >= least && *value <= most ? value : std::nullopt;
}

class Count {
 public:
  explicit Count(std::int64_t input_channels) : input_(input_channels) {}

  bool Add(const Section& section) {
    const std::int64_t before = channels_.empty() ? input_ : channels_.back();
    std::optional<std::int64_t> after = before;
    if (section.name == "convolutional") {
      after = Convolution(section, before);
    } else if (section.name == "route") {
      after = Route(section);
    } else if (section.name != "maxpool" && section.name != "upsample" &&
               section.name != "shortcut" && section.name != "dropout" && section.name != "yolo") {
      return false;
    }
    if (!after) return false;
    channels_.push_back(*after);
    return true;
  }
  [[nodiscard]] std::int64_t parameters() const { return parameters_; }

 private:
  std::optional<std::int64_t> Convolution(const Section& section, std::int64_t before) {
    const auto filters = Value(section, "filters", 1, 1, kMaxFilters);
    const auto size = Value(section, "size", 1, 1, kMaxSize);
    const auto groups = Value(section, "groups", 1, 1, kMaxFilters);
    const auto normalised = Value(section, "batch_normalize", 0, 0, 1);
    if (!filters || !size || !groups || !normalised || before % *groups != 0) return std::nullopt;
    parameters_ += *filters * (before / *groups) * *size * *size;
    parameters_ += *filters * (*normalised == 1 ? 4 : 1);
    return filters;
  }

  // Channels of the layers named, joined; numbers below 0 count back from here.
  std::optional<std::int64_t> Route(const Section& section) {
    const auto found = section.values.find("layers");
    const auto groups = Value(section, "groups", 1, 1, kMaxFilters);
    if (found == section.values.end() || !groups) return std::nullopt;
    std::int64_t sum = 0;
    for (std::string_view rest = found->second; !rest.empty();) {
      const std::size_t comma = rest.find(',');
      auto layer = Whole(rest.substr(0, comma));
      rest.remove_prefix(comma == std::string_view::npos ? rest.size() : comma + 1);
      if (!layer) return std::nullopt;
      const auto count = static_cast<std::int64_t>(channels_.size());
      if (*layer < 0) *layer += count;
      if (*layer < 0 || *layer >= count) return std::nullopt;
      sum += channels_[static_cast<std::size_t>(*layer)];
    }
    return sum / *groups;
  }

  std::int64_t input_;
  std::vector<std::int64_t> channels_;
  std::int64_t parameters_ = 0;
};

}  // namespace

std::optional<std::int64_t> DarknetWeightBytes(std::string_view text) {
  const std::vector<Section> sections = SectionsOf(text);
  if (sections.empty() || (sections[0].name != "net" && sections[0].name != "network")) {
    return std::nullopt;
  }
  const auto input = Value(sections[0], "channels", 3, 1, kMaxFilters);
  if (!input) return std::nullopt;
  Count count(*input);
  for (std::size_t i = 1; i < sections.size(); ++i) {
    if (!count.Add(sections[i])) return std::nullopt;
  }
  return kHeaderBytes + 4 * count.parameters();
}

}  // namespace v2vouch
