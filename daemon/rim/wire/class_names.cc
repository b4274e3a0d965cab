// SPDX-License-Identifier: Apache-2.0
#include "daemon/rim/wire/class_names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <optional>
#include <utility>

namespace v2vouch::wire {
namespace {

using Class = ObjectClass;

// Lower case, letters only: "Person_sitting" is "personsitting", then "person".
constexpr std::pair<std::string_view, Class> kClasses[] = {
    // Cars.
    {"car", Class::kCar},
    {"cars", Class::kCar},
    {"auto", Class::kCar},
    {"automobile", Class::kCar},
    {"pkw", Class::kCar},
    {"passenger", Class::kCar},
    {"passengercar", Class::kCar},
    {"private", Class::kCar},
    {"sedan", Class::kCar},
    {"hatchback", Class::kCar},
    {"wagon", Class::kCar},
    {"suv", Class::kCar},
    {"coupe", Class::kCar},
    {"taxi", Class::kCar},
    {"cab", Class::kCar},
    {"evehicle", Class::kCar},
    // Vans.
    {"van", Class::kVan},
    {"vans", Class::kVan},
    {"minivan", Class::kVan},
    {"minibus", Class::kVan},
    {"pickup", Class::kVan},
    {"pickuptruck", Class::kVan},
    {"transporter", Class::kVan},
    {"caravan", Class::kVan},
    {"ambulance", Class::kVan},
    {"delivery", Class::kVan},
    // Lorries.
    {"truck", Class::kTruck},
    {"trucks", Class::kTruck},
    {"lorry", Class::kTruck},
    {"lorries", Class::kTruck},
    {"lkw", Class::kTruck},
    {"trailer", Class::kTruck},
    {"semitrailer", Class::kTruck},
    {"semi", Class::kTruck},
    {"hgv", Class::kTruck},
    {"tractor", Class::kTruck},
    {"construction", Class::kTruck},
    {"firetruck", Class::kTruck},
    {"fireengine", Class::kTruck},
    // Buses, and what is as long.
    {"bus", Class::kBus},
    {"buses", Class::kBus},
    {"coach", Class::kBus},
    {"tram", Class::kBus},
    {"streetcar", Class::kBus},
    {"trolleybus", Class::kBus},
    {"train", Class::kBus},
    // Riders.
    {"motorcycle", Class::kMotorcycle},
    {"motorcycles", Class::kMotorcycle},
    {"motorbike", Class::kMotorcycle},
    {"motorcyclist", Class::kMotorcycle},
    {"motor", Class::kMotorcycle},
    {"motorrad", Class::kMotorcycle},
    {"moped", Class::kMotorcycle},
    {"scooter", Class::kMotorcycle},
    {"cyclist", Class::kCyclist},
    {"cyclists", Class::kCyclist},
    {"bicycle", Class::kCyclist},
    {"bicycles", Class::kCyclist},
    {"bicyclist", Class::kCyclist},
    {"bike", Class::kCyclist},
    {"cycle", Class::kCyclist},
    {"rider", Class::kCyclist},
    {"fahrrad", Class::kCyclist},
    // On foot.
    {"pedestrian", Class::kPedestrian},
    {"pedestrians", Class::kPedestrian},
    {"person", Class::kPedestrian},
    {"persons", Class::kPedestrian},
    {"people", Class::kPedestrian},
    {"human", Class::kPedestrian},
    {"adult", Class::kPedestrian},
    {"child", Class::kPedestrian},
    {"walker", Class::kPedestrian},
};

// The class is open.
constexpr std::string_view kOpen[] = {"",     "vehicle", "vehicles", "unknown", "other",
                                      "misc", "object",  "obstacle", "none",    "unlabeled"};
// Say nothing by themselves, whatever follows: "vehicle.car", "human.pedestrian.adult".
constexpr std::string_view kPrefixes[] = {"vehicle", "human",     "type",
                                          "object",  "emergency", "label"};
constexpr std::string_view kNoRoadUser[] = {
    "trafficlight", "trafficsign",  "trafficcone", "traffic",  "stopsign",   "sign",
    "light",        "cone",         "pole",        "barrier",  "movable",    "static",
    "firehydrant",  "parkingmeter", "busstop",     "bench",    "dontcare",   "background",
    "ignore",       "licenseplate", "animal",      "dog",      "cat",        "bird",
    "horse",        "sheep",        "cow",         "building", "vegetation", "tree"};
// Of COCO's eighty classes, from 0.
constexpr std::pair<int, Class> kCoco[] = {
    {0, Class::kPedestrian}, {1, Class::kCyclist}, {2, Class::kCar},  {3, Class::kMotorcycle},
    {5, Class::kBus},        {6, Class::kBus},     {7, Class::kTruck}};

template <class Table>
bool Contains(const Table& table, std::string_view word) {
  return std::ranges::find(table, word) != std::end(table);
}

std::optional<NamedClass> WordMeaning(std::string_view word) {
  for (const auto& [known, object_class] : kClasses) {
    if (known == word) return NamedClass{object_class, true, true};
  }
  if (Contains(kNoRoadUser, word)) return NamedClass{Class::kUnknown, true, false};
  return std::nullopt;
}

}  // namespace

NamedClass MeaningOf(std::string_view name) {
  constexpr std::size_t kLongest = 128;
  std::array<char, kLongest> letters{};  // Those of all words.
  std::array<std::string_view, 16> words;
  std::size_t count = 0;
  std::size_t used = 0;
  bool is_number = !name.empty();
  int number = 0;
  bool in_word = false;
  for (const char raw : name.substr(0, kLongest)) {
    const auto c = static_cast<unsigned char>(raw);
    const bool is_digit = std::isdigit(c) != 0;
    is_number = is_number && is_digit && number < 1000;
    if (is_digit && number < 1000) number = 10 * number + (c - '0');
    if (std::isalpha(c) == 0) {
      in_word = false;
      continue;
    }
    if (!in_word) {
      if (count == words.size()) break;
      words[count++] = {letters.data() + used, 0};
      in_word = true;
    }
    letters[used++] = static_cast<char>(std::tolower(c));
    words[count - 1] = {words[count - 1].data(), words[count - 1].size() + 1};
  }
  if (is_number) {
    for (const auto& [index, object_class] : kCoco) {
      if (index == number) return {object_class, true, true};
    }
    return {};
  }
  const std::string_view whole{letters.data(), used};
  if (used == 0 && !name.empty()) return {};
  if (Contains(kOpen, whole)) return {Class::kUnknown, true, true};
  if (const auto meaning = WordMeaning(whole)) return *meaning;
  bool is_open = false;
  for (std::size_t i = 0; i < count; ++i) {
    if (Contains(kPrefixes, words[i])) {
      is_open = true;
      continue;
    }
    if (i + 1 < count) {  // "traffic light", "fire truck", "motor cycle": words stand in a row.
      const std::string_view two{words[i].data(), words[i].size() + words[i + 1].size()};
      if (const auto meaning = WordMeaning(two)) return *meaning;
    }
    if (const auto meaning = WordMeaning(words[i])) return *meaning;
  }
  return {Class::kUnknown, is_open, true};
}

std::string Printable(std::string_view name) {
  std::string out(name.substr(0, 32));
  for (char& c : out) {
    const auto u = static_cast<unsigned char>(c);
    if (u < 0x20 || u > 0x7e || c == '\'' || c == '"' || c == '\\') c = '?';
  }
  return out;
}

}  // namespace v2vouch::wire
