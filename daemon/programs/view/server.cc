// SPDX-License-Identifier: Apache-2.0
// The one translation unit with Boost.Beast.
#include "daemon/programs/view/server.h"

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

#include "daemon/rim/page/page_files.h"

namespace v2vouch {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using beast::error_code;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostConnections = 32;
constexpr std::size_t kMostClients = 8;
constexpr std::uint32_t kHeaderLimit = 8192;
constexpr std::size_t kReadBuffer = 16384;
constexpr std::chrono::seconds kRequestTimeout{10};
constexpr int kMessagesPerTick = 200;
constexpr std::size_t kSendBuffer = 1u << 18;  // What the kernel may hold of a slow client's.

// No script, style or connection but from this server; nobody may frame the page.
constexpr std::string_view kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "img-src 'self' blob: data:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

std::string_view View(beast::string_view text) { return {text.data(), text.size()}; }

using Request = http::request<http::empty_body>;
using Response = http::response<http::string_body>;

Response Answer(const Request& request, http::status status, std::string_view type,
                std::string_view body) {
  Response response(status, request.version());
  const auto set = [&](const char* name, std::string_view value) {
    response.set(name, beast::string_view(value.data(), value.size()));
  };
  set("Server", "v2vouch-view");
  set("Content-Type", type);
  set("Content-Security-Policy", kPolicy);
  set("X-Content-Type-Options", "nosniff");
  set("Referrer-Policy", "no-referrer");
  set("Cross-Origin-Resource-Policy", "same-origin");
  set("Cross-Origin-Opener-Policy", "same-origin");
  set("Cache-Control", "no-store");
  response.keep_alive(request.keep_alive());
  if (request.method() != http::verb::head) response.body().assign(body);
  response.prepare_payload();
  return response;
}

class Client;

}  // namespace

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

namespace {

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

  void Run(const Request& request, const std::string& protocol) {
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

/// One connection that speaks HTTP so far.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Server::Impl& server, tcp::socket&& socket)
      : server_(server), place_(server), stream_(std::move(socket)) {}

  void Read() {
    parser_.emplace();
    parser_->header_limit(kHeaderLimit);
    parser_->body_limit(0);
    stream_.expires_after(kRequestTimeout);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](error_code error, std::size_t) {
                       if (!error) self->Judge();
                     });
  }

 private:
  void Judge() {
    const Request& request = parser_->get();
    const std::string_view host = View(request[http::field::host]);
    const std::string_view origin = View(request[http::field::origin]);
    if (!view::IsHostAllowed(server_.rules, host)) {
      return Refuse(http::status::misdirected_request, "This host name is not served here.\n");
    }
    if (!view::IsOriginAllowed(server_.rules, host, origin)) {
      return Refuse(http::status::forbidden, "This origin may not ask.\n");
    }
    if (websocket::is_upgrade(request)) return Upgrade(request);
    if (request.method() != http::verb::get && request.method() != http::verb::head) {
      return Refuse(http::status::method_not_allowed, "Read-only.\n");
    }
    std::string_view path = View(request.target());
    path = path.substr(0, path.find('?'));
    if (path == "/health") {
      return Send(Answer(request, http::status::ok, "application/json", "{\"status\":\"ok\"}\n"));
    }
    for (const PageFile& file : PageFiles()) {
      if (file.path != path) continue;
      return Send(Answer(request, http::status::ok, file.type, file.content));
    }
    Refuse(http::status::not_found, "Not found.\n");
  }

  void Upgrade(const Request& request) {
    std::string offered;
    for (const auto& field : request) {  // The header may stand there several times.
      if (field.name() != http::field::sec_websocket_protocol) continue;
      offered += (offered.empty() ? "" : ",") + std::string(View(field.value()));
    }
    const auto protocol = view::ChooseProtocol(offered);
    if (!view::HasToken(server_.rules, View(request.target()), offered)) {
      return Refuse(http::status::unauthorized,
                    "The token is missing or wrong; the program prints the whole address.\n");
    }
    if (!protocol) {
      return Refuse(http::status::bad_request,
                    "Sub-protocols: v2vouch.view.v1, foxglove.sdk.v1, foxglove.websocket.v1.\n");
    }
    if (server_.clients.size() >= kMostClients) {
      return Refuse(http::status::service_unavailable, "All places are taken.\n");
    }
    const auto kind = *protocol == view::kPageProtocol ? view::Session::Protocol::kPage
                                                       : view::Session::Protocol::kFoxglove;
    std::make_shared<Client>(server_, std::move(stream_), kind, std::move(place_))
        ->Run(request, *protocol);
  }

  void Refuse(http::status status, std::string_view why) {
    Response response = Answer(parser_->get(), status, "text/plain; charset=utf-8", why);
    response.keep_alive(false);
    Send(std::move(response));
  }

  void Send(Response response) {
    response_ = std::move(response);
    http::async_write(stream_, response_,
                      [self = shared_from_this()](error_code error, std::size_t) {
                        if (error) return;
                        if (self->response_.keep_alive()) return self->Read();
                        error_code ignored;
                        self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
                      });
  }

  Server::Impl& server_;
  Place place_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{kReadBuffer};
  std::optional<http::request_parser<http::empty_body>> parser_;
  Response response_;
};

}  // namespace

void Server::Impl::Accept() {
  acceptor.async_accept([this](error_code error, tcp::socket socket) {
    if (!acceptor.is_open()) return;
    if (error) {  // No descriptor left, say: not in a tight loop.
      auto timer = std::make_shared<asio::steady_timer>(context, std::chrono::milliseconds(100));
      timer->async_wait([this, timer](error_code) { Accept(); });
      return;
    }
    if (connections < kMostConnections) {
      std::make_shared<Connection>(*this, std::move(socket))->Read();
    }
    Accept();
  });
}

void Server::Impl::Repeat(const std::shared_ptr<asio::steady_timer>& timer,
                          std::chrono::milliseconds period,
                          const std::shared_ptr<std::function<void()>>& work) {
  timer->expires_after(period);
  timer->async_wait([=, this](error_code error) {
    if (error) return;
    (*work)();
    Repeat(timer, period, work);
  });
}

Server::Server(view::Hub& hub, view::AccessRules rules)
    : impl_(std::make_unique<Impl>(hub, std::move(rules))) {}
Server::~Server() = default;

bool Server::Listen(const std::string& address, std::uint16_t port, std::string& error) {
  error_code code;
  const auto ip = asio::ip::make_address(address, code);
  const tcp::endpoint endpoint(ip, port);
  if (!code) impl_->acceptor.open(endpoint.protocol(), code);
  if (!code) impl_->acceptor.set_option(asio::socket_base::reuse_address(true), code);
  if (!code) impl_->acceptor.bind(endpoint, code);
  if (!code) impl_->acceptor.listen(asio::socket_base::max_listen_connections, code);
  if (code) {
    error = address + ":" + std::to_string(port) + ": " + code.message();
    return false;
  }
  impl_->rules.port = this->port();
  impl_->Accept();
  return true;
}

std::uint16_t Server::port() const {
  error_code ignored;
  return impl_->acceptor.local_endpoint(ignored).port();
}

void Server::Every(std::chrono::milliseconds period, std::function<void()> work) {
  impl_->Repeat(std::make_shared<asio::steady_timer>(impl_->context), period,
                std::make_shared<std::function<void()>>(std::move(work)));
}

void Server::Post(std::function<void()> work) { asio::post(impl_->context, std::move(work)); }

void Server::Wake() {
  const std::vector<Client*> clients(impl_->clients.begin(), impl_->clients.end());
  for (Client* client : clients) client->Pump();
}

double Server::idle_s() const {
  if (!impl_->clients.empty()) return 0.0;
  return std::chrono::duration<double>(Clock::now() - impl_->last_client).count();
}

void Server::Run() { impl_->context.run(); }
void Server::Stop() { impl_->context.stop(); }

}  // namespace v2vouch
