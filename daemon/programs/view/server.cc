// SPDX-License-Identifier: Apache-2.0
// The one translation unit with Boost.Beast.
#include "daemon/programs/view/server.h"

#include <optional>
#include <utility>
#include <vector>

#include "daemon/programs/view/web_socket.h"
#include "daemon/rim/page/page_files.h"

namespace v2vouch {
namespace {

constexpr std::size_t kMostConnections = 32;
constexpr std::size_t kMostClients = 8;
constexpr std::uint32_t kHeaderLimit = 8192;
constexpr std::size_t kReadBuffer = 16384;

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
