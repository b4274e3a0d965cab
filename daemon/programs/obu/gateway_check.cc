// SPDX-License-Identifier: Apache-2.0
#include "daemon/programs/obu/gateway_check.h"

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "daemon/obu/framing/layer.h"
#include "daemon/programs/obu/own_output.h"
#include "daemon/rim/io/event_log.h"
#include "daemon/rim/io/lcm_url.h"
#include "daemon/rim/net/source.h"

namespace v2vouch::obu {
namespace {

void CheckInput(const InputConfig& input, const std::string& name,
                std::vector<std::string>& problems) {
  if (input.framing != "auto" && !LayerOfName(input.framing)) {
    problems.push_back(name + ".framing = " + input.framing + ": is no framing; see --help");
  }
  if (input.interface.empty() && !net::ParseAddress(input.bind)) {
    problems.push_back(name + ".bind = " + input.bind + ": must be an address of this computer");
  }
  for (const std::string& address : input.allow) {
    const auto source = net::ParseAddress(address);
    if (source && source->Text() == address) continue;
    std::string problem = name;
    problem.append(".allow: ").append(address);
    if (!source) {
      problem.append(
          ": must be an address of a unit, e.g. 192.168.88.40; names and networks are not taken");
    } else {
      problem.append(": write it as ").append(source->Text());
    }
    problems.push_back(std::move(problem));
  }
}

// A channel that nobody can subscribe to would take all messages, without a word.
void CheckChannels(const GatewayConfig& config, std::vector<std::string>& problems) {
  std::map<std::string, std::string> keys;
  const auto check = [&](const std::string& key, const std::string& channel) {
    const bool is_plain = std::ranges::all_of(channel, [](char c) { return c > ' ' && c < 0x7f; });
    if (channel.empty() || channel.size() > kMaxChannelLength || !is_plain) {
      problems.push_back(key + ": channel \"" + channel.substr(0, 80) +
                         "\": must have 1 to 63 characters, no blanks");
    } else if (const auto [entry, is_new] = keys.emplace(channel, key); !is_new) {
      problems.push_back(key + ": channel " + channel + ": is that of " + entry->second +
                         " already");
    }
  };
  check("bsm_channel", config.bsm_channel);
  check("status_channel", config.status_channel);
  check("own_bsm.own_bsm_channel", config.own_bsm.own_bsm_channel);
  check("own_bsm.motion_channel", config.own_bsm.motion_channel);
  check("own_bsm.fix_channel", config.own_bsm.fix_channel);
}

}  // namespace

void CheckGatewayConfig(const GatewayConfig& config, std::vector<std::string>& problems) {
  if (config.inputs.empty()) problems.push_back("inputs: names no input");
  std::set<std::string> doors;
  for (std::size_t i = 0; i < config.inputs.size(); ++i) {
    const InputConfig& input = config.inputs[i];
    const std::string name = "inputs[" + std::to_string(i) + "]";
    CheckInput(input, name, problems);
    std::string door = input.interface.empty() ? input.bind : "interface ";
    if (input.interface.empty()) {
      door.append(" port ").append(std::to_string(input.port));
    } else {
      door.append(input.interface).append(" ").append(input.filter);
    }
    if (!doors.insert(door).second) {
      std::string problem = name;
      problem.append(": ").append(door).append(": stands here twice");
      problems.push_back(std::move(problem));
    }
  }
  if (const std::string problem = CheckLcmUrl(config.lcm_url); !problem.empty()) {
    problems.push_back("lcm_url: " + problem);
  }
  CheckChannels(config, problems);
  CheckOwnBsm(config.own_bsm, problems);
}

}  // namespace v2vouch::obu
