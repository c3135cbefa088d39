#include "services/metrics/http_server.hpp"

#include <algorithm>
#include <array>
#include <boost/algorithm/string/predicate.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <list>
#include <optional>
#include <thread>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/process_name.hpp"

namespace aloft::metrics {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using boost::system::error_code;
using net::ip::tcp;
using Request = http::request<http::string_body>;
using Response = http::response<http::string_body>;

constexpr std::uint32_t header_bytes = 8192;
constexpr std::uint64_t body_bytes = 1024;
constexpr std::size_t buffer_bytes = 16384;
constexpr std::chrono::milliseconds accept_again_time{100};  // no descriptor was left
constexpr std::chrono::milliseconds farewell_time{1000};

/// The name in "name:port" or "[::1]:port"; the port does not count, because a tunnel can change it.
std::string_view without_port(std::string_view host) {
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    return end == std::string_view::npos ? host : host.substr(1, end - 1);
  }
  return host.substr(0, host.find(':'));
}

/// The names under which this server answers.
class HostNames {
 public:
  HostNames(const net::ip::address& bound, std::vector<std::string> names)
      : any_address_(!bound.is_loopback()), names_(std::move(names)) {
    names_.emplace_back("localhost");
    if (any_address_) names_.push_back(this_process().host);
  }

  /// What is wrong with the Host of this request, or nothing. HTTP/1.0 clients need not send one; browsers do.
  [[nodiscard]] std::optional<Response> refusal(const Request& request) const {
    const auto count = request.count(http::field::host);
    if (count == 0 && request.version() < 11) return std::nullopt;
    Response response;
    if (count != 1) {
      response.result(http::status::bad_request);
      response.body() = "a request names one Host\n";
      return response;
    }
    const std::string_view host(request[http::field::host].data(), request[http::field::host].size());
    if (knows(without_port(host))) return std::nullopt;
    response.result(http::status::misdirected_request);
    response.body() =
        "this server does not answer under that name: use its address, or start it with --http-host NAME\n";
    return response;
  }

 private:
  [[nodiscard]] bool knows(std::string_view name) const {
    error_code no_address;
    const net::ip::address address = net::ip::make_address(std::string(name), no_address);
    if (!no_address) return any_address_ || address.is_loopback();
    return std::ranges::any_of(names_,
                               [&](const std::string& known) { return boost::algorithm::iequals(known, name); });
  }

  bool any_address_;
  std::vector<std::string> names_;
};

/// The answer to a request that cannot be read; none if its sender has left or is too slow.
std::optional<Response> refusal_of(const error_code& error) {
  Response response;
  if (error == http::error::header_limit || error == http::error::buffer_overflow) {
    response.result(http::status::request_header_fields_too_large);
  } else if (error == http::error::body_limit) {
    response.result(http::status::payload_too_large);
  } else if (error.category() == error_code(http::error::bad_method).category() &&
             error != http::error::end_of_stream && error != http::error::partial_message) {
    response.result(http::status::bad_request);
  } else {
    return std::nullopt;
  }
  response.body() = error.message() + "\n";
  return response;
}

Response made_by(const HttpRoute& route) {
  Response response;
  try {
    HttpResponse answer = route.answer();
    response.result(static_cast<unsigned>(answer.status));
    response.set(http::field::content_type, answer.content_type);
    response.body() = std::move(answer.body);
  } catch (const std::exception& error) {
    response.result(http::status::internal_server_error);
    response.body() = std::string(error.what()) + "\n";
  }
  return response;
}

/// Headers that all answers have.
void complete(Response& response, bool keep_alive, bool without_body) {
  if (response.count(http::field::content_type) == 0) response.set(http::field::content_type, "text/plain");
  response.set(http::field::cache_control, "no-store");
  response.keep_alive(keep_alive);
  response.prepare_payload();
  if (without_body) response.body().clear();
}

}  // namespace

struct HttpServer::State {
  using Connections = std::list<beast::tcp_stream>;

  State(std::map<std::string, HttpRoute> all_routes, HostNames host_names, const HttpLimits& all_limits)
      : routes(std::move(all_routes)), hosts(std::move(host_names)), limits(all_limits) {}

  net::awaitable<void> accept_all();
  net::awaitable<void> converse(Connections::iterator client);
  net::awaitable<Response> respond(const Request& request);
  net::awaitable<Response> answer_of(const HttpRoute& route);

  std::map<std::string, HttpRoute> routes;
  HostNames hosts;
  HttpLimits limits;
  net::io_context io{1};
  net::thread_pool workshop{1};  // makes the answers that are not quick
  tcp::acceptor acceptor{io};
  Connections connections;  // the least recently active one is at the front
  std::size_t waiting_answers = 0;
  std::thread thread;
};

net::awaitable<void> HttpServer::State::accept_all() {
  net::steady_timer pause(io);
  while (acceptor.is_open()) {
    error_code error;
    tcp::socket socket = co_await acceptor.async_accept(net::redirect_error(net::use_awaitable, error));
    if (error) {
      pause.expires_after(accept_again_time);
      co_await pause.async_wait(net::redirect_error(net::use_awaitable, error));
      continue;
    }
    // Connections that are closed already still wait for their answer from the workshop.
    const auto oldest =
        std::ranges::find_if(connections, [](beast::tcp_stream& stream) { return stream.socket().is_open(); });
    if (connections.size() >= limits.connections && oldest != connections.end()) oldest->close();
    connections.emplace_back(std::move(socket));
    net::co_spawn(io, converse(std::prev(connections.end())), net::detached);
  }
}

net::awaitable<void> HttpServer::State::converse(Connections::iterator client) {
  beast::flat_buffer buffer(buffer_bytes);
  error_code error;
  for (bool goes_on = true; goes_on && !error;) {
    http::request_parser<http::string_body> parser;
    parser.header_limit(header_bytes);
    parser.body_limit(body_bytes);
    client->expires_after(limits.time);
    co_await http::async_read(*client, buffer, parser, net::redirect_error(net::use_awaitable, error));
    std::optional<Response> response = error ? refusal_of(error) : std::nullopt;
    if (error && !response) break;
    connections.splice(connections.end(), connections, client);
    goes_on = !error && parser.get().keep_alive();
    if (!response) response = co_await respond(parser.get());
    complete(*response, goes_on, parser.get().method() == http::verb::head);
    client->expires_after(limits.time);
    co_await http::async_write(*client, *response, net::redirect_error(net::use_awaitable, error));
  }
  // Unread input would reset the connection before the client has read the answer.
  client->expires_after(std::min(limits.time, farewell_time));
  error_code ended;
  client->socket().shutdown(tcp::socket::shutdown_send, ended);
  for (std::array<char, 4096> rest; !ended;)
    co_await client->async_read_some(net::buffer(rest), net::redirect_error(net::use_awaitable, ended));
  connections.erase(client);
}

net::awaitable<Response> HttpServer::State::respond(const Request& request) {
  if (std::optional<Response> refusal = hosts.refusal(request)) co_return std::move(*refusal);
  Response response;
  if (request.method() != http::verb::get && request.method() != http::verb::head) {
    response.result(http::status::method_not_allowed);
    response.set(http::field::allow, "GET, HEAD");
    co_return response;
  }
  const std::string path(request.target().substr(0, request.target().find('?')));
  const auto route = routes.find(path);
  if (route == routes.end()) {
    response.result(http::status::not_found);
    for (const auto& [known, unused] : routes) response.body() += known + "\n";
    co_return response;
  }
  co_return co_await answer_of(route->second);
}

net::awaitable<Response> HttpServer::State::answer_of(const HttpRoute& route) {
  if (route.quick) co_return made_by(route);
  Response response;
  if (waiting_answers >= limits.waiting_answers) {
    response.result(http::status::service_unavailable);
    response.body() = "too many requests wait already\n";
    co_return response;
  }
  ++waiting_answers;
  auto made = net::co_spawn(
      workshop, [&route]() -> net::awaitable<Response> { co_return made_by(route); }, net::use_awaitable);
  response = co_await std::move(made);
  --waiting_answers;
  co_return response;
}

HttpServer::HttpServer(const std::string& address, int port, std::map<std::string, HttpRoute> routes,
                       std::vector<std::string> names, const HttpLimits& limits) {
  const net::ip::address bound = net::ip::make_address(address);
  state_ = std::make_unique<State>(std::move(routes), HostNames(bound, std::move(names)), limits);
  try {
    tcp::acceptor& acceptor = state_->acceptor;
    acceptor.open(tcp::v4());
    acceptor.set_option(tcp::acceptor::reuse_address(true));
    acceptor.bind(tcp::endpoint(bound, static_cast<std::uint16_t>(port)));
    acceptor.listen();
  } catch (const boost::system::system_error& error) {
    throw InputError("--http-port {}: the port cannot be opened on {}: {}; choose another, or 0 for any", port, address,
                     error.code().message());
  }
  net::co_spawn(state_->io, state_->accept_all(), net::detached);
  state_->thread = std::thread([this] { state_->io.run(); });
}

HttpServer::~HttpServer() {
  state_->io.stop();
  state_->thread.join();
  state_->workshop.stop();
  state_->workshop.join();
}

int HttpServer::port() const noexcept {
  error_code ignored;
  return state_->acceptor.local_endpoint(ignored).port();
}

}  // namespace aloft::metrics
