// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "daemon/rim/view/access.h"
#include "daemon/rim/view/session.h"

namespace v2vouch {

/// HTTP (the page and /health) and WebSocket (page and Foxglove) on one port, one thread.
/// Boost.Beast stays behind this header: its translation unit takes half a minute to compile.
///
/// Bounds: 32 connections, 8 of them WebSockets; requests of 8 kB without body, 10 s to come;
/// messages of clients up to 16 kB, 200 per 40 ms. What is sent is asked of the Session when the
/// message before has left; nothing queues.
class Server {
 public:
  Server(view::Hub& hub, view::AccessRules rules);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// @param port 0 = any free one. @return false with `error` set.
  bool Listen(const std::string& address, std::uint16_t port, std::string& error);
  [[nodiscard]] std::uint16_t port() const;

  /// Calls `work` again and again in the server's thread.
  void Every(std::chrono::milliseconds period, std::function<void()> work);
  /// Calls `work` once in the server's thread; from any thread.
  void Post(std::function<void()> work);
  /// Lets every client that has nothing under way ask its Session for the next message.
  void Wake();
  /// Seconds since the last WebSocket left; 0 while there is one.
  [[nodiscard]] double idle_s() const;

  void Run();   ///< Until Stop().
  void Stop();  ///< From the server's thread.

  struct Impl;  ///< Known to the connections.

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace v2vouch
