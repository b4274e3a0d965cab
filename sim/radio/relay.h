// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <tuple>
#include <vector>

#include "sim/radio/link.h"
#include "sim/world/geometry.h"
#include "v2vouch/truth_list_t.hpp"

namespace v2vouch::sim {

/// What the air did so far, all links together.
struct RadioFigures {
  std::int64_t sent = 0;   ///< Datagrams taken from cars.
  std::int64_t links = 0;  ///< Times a listening car could have heard one.
  std::int64_t heard = 0;
  std::int64_t too_far = 0;
  std::int64_t interference = 0;
  std::int64_t nowhere = 0;  ///< One of the two cars is not in TRUTH (yet).
  std::int64_t copies = 0;   ///< Handed over, duplicates included.
  std::int64_t blocked = 0;  ///< Of `links`: something stood between.
};

/// Joins several cars' units. Reads no clock and opens no socket: the same datagrams and truth at
/// the same times give the same deliveries.
class Relay {
 public:
  Relay(RadioConfig config, std::uint64_t seed);

  void OnTruth(const truth_list_t& truth);
  /// @param car index of the configuration's cars: the one that sends.
  void OnDatagram(std::size_t car, std::span<const std::uint8_t> bytes, std::int64_t utime);

  struct Delivery {
    std::int64_t utime = 0;
    std::size_t car = 0;  ///< Index of the one that hears.
    std::vector<std::uint8_t> bytes;
  };
  /// The earliest that is due by `utime`.
  std::optional<Delivery> Next(std::int64_t utime);
  [[nodiscard]] std::optional<std::int64_t> due() const;
  [[nodiscard]] const RadioFigures& figures() const { return figures_; }

 private:
  struct Waiting {
    Delivery delivery;
    std::uint64_t number = 0;  // Ties keep the order in which they were sent.
    bool operator<(const Waiting& other) const {
      return std::tie(delivery.utime, number) < std::tie(other.delivery.utime, other.number);
    }
  };
  struct Vehicle {
    Box box;
    bool is_tall = false;
  };
  [[nodiscard]] bool IsBlocked(std::int64_t from, std::int64_t to) const;

  RadioConfig config_;
  std::uint64_t seed_;
  std::map<std::int64_t, Vehicle> vehicles_;  // By id in TRUTH; 0 = the ego.
  std::map<std::pair<std::size_t, std::size_t>, Link> links_;
  std::set<Waiting> waiting_;
  std::uint64_t number_ = 0;
  RadioFigures figures_;
};

}  // namespace v2vouch::sim
