// SPDX-License-Identifier: Apache-2.0
// For server.cc alone, the one translation unit with Boost.Beast: the server's state and its
// WebSocket clients.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "daemon/programs/view/server.h"

namespace v2vouch {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using beast::error_code;
using Clock = std::chrono::steady_clock;

inline constexpr std::chrono::seconds kRequestTimeout{10};
inline constexpr int kMessagesPerTick = 200;
// What the kernel may hold of a slow client's.
inline constexpr std::size_t kSendBuffer = 1u << 18;

class Client;

struct Server::Impl {
  Impl(view::Hub& the_hub, view::AccessRules the_rules)
      : hub(the_hub), rules(std::move(the_rules)) {}

  void Accept();
  void Repeat(const std::shared_ptr<asio::steady_timer>& timer, std::chrono::milliseconds period,
              const std::shared_ptr<std::function<void()>>& work);

  view::Hub& hub;
  view::AccessRules rules;
  std::size_t connections = 0;
  std::set<Client*> clients;
  Clock::time_point last_client = Clock::now();
  // Behind what its handlers use: those of clients that are still there end with it.
  asio::io_context context{1};
  tcp::acceptor acceptor{context};
};

/// Counts a connection as long as it lives.
class Place {
 public:
  explicit Place(Server::Impl& server) : server_(&server) { ++server_->connections; }
  ~Place() {
    if (server_ != nullptr) --server_->connections;
  }
  Place(Place&& other) noexcept : server_(std::exchange(other.server_, nullptr)) {}
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;
  Place& operator=(Place&&) = delete;

 private:
  Server::Impl* server_;
};

/// One WebSocket.
class Client : public std::enable_shared_from_this<Client> {
 public:
  Client(Server::Impl& server, beast::tcp_stream&& stream, view::Session::Protocol protocol,
         Place&& place)
      : server_(server),
        place_(std::move(place)),
        socket_(std::move(stream)),
        session_(server.hub, protocol) {
    server_.clients.insert(this);
  }
  ~Client() {
    server_.clients.erase(this);
    server_.last_client = Clock::now();
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void Run(const http::request<http::empty_body>& request, const std::string& protocol) {
    beast::get_lowest_layer(socket_).expires_never();
    error_code ignored;
    beast::get_lowest_layer(socket_).socket().set_option(tcp::no_delay(true), ignored);
    beast::get_lowest_layer(socket_).socket().set_option(
        asio::socket_base::send_buffer_size(static_cast<int>(kSendBuffer)), ignored);
    auto timeout = websocket::stream_base::timeout::suggested(beast::role_type::server);
    timeout.handshake_timeout = kRequestTimeout;
    timeout.idle_timeout = std::chrono::seconds(60);  // A client that answers no ping is gone.
    socket_.set_option(timeout);
    socket_.set_option(websocket::stream_base::decorator([protocol](auto& response) {
      response.set(http::field::server, "v2vouch-view");
      response.set(http::field::sec_websocket_protocol, protocol);
    }));
    socket_.read_message_max(view::kMostClientBytes);
    socket_.async_accept(request, [self = shared_from_this()](error_code error) {
      if (error) return;
      self->is_open_ = true;
      self->Read();
      self->Pump();
    });
  }

  // Sends what is new, one message after the other.
  void Pump() {
    if (!is_open_ || is_writing_) return;
    auto next = session_.Next();
    if (!next) return;
    is_writing_ = true;
    socket_.binary(next->is_binary);
    const auto& bytes = *next->bytes;
    socket_.async_write(asio::buffer(bytes), [self = shared_from_this(), kept = next->bytes](
                                                 error_code error, std::size_t) {
      self->is_writing_ = false;
      if (error) return self->Close();
      self->Pump();
    });
  }

  void Close() {
    if (!is_open_) return;
    is_open_ = false;
    error_code ignored;
    beast::get_lowest_layer(socket_).socket().close(ignored);
  }

 private:
  void Read() {
    socket_.async_read(buffer_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->Close();
      self->Take();
    });
  }

  void Take() {
    if (tick_ != server_.hub.ticks()) {
      tick_ = server_.hub.ticks();
      messages_ = 0;
    }
    const auto data = buffer_.cdata();
    const auto* bytes = static_cast<const std::uint8_t*>(data.data());
    if (socket_.got_text()) {
      session_.TakeText({reinterpret_cast<const char*>(bytes), data.size()});
    } else {
      session_.TakeBinary({bytes, data.size()});
    }
    buffer_.consume(buffer_.size());
    if (++messages_ > kMessagesPerTick || session_.is_hopeless()) return Close();
    Pump();
    Read();
  }

  Server::Impl& server_;
  Place place_;
  websocket::stream<beast::tcp_stream> socket_;
  view::Session session_;
  beast::flat_buffer buffer_;
  bool is_open_ = false;
  bool is_writing_ = false;
  std::int64_t tick_ = 0;
  int messages_ = 0;
};

}  // namespace v2vouch
