#include "services/http/http_server.hpp"

#include <algorithm>
#include <array>
#include <boost/algorithm/string/replace.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <list>
#include <optional>
#include <thread>
#include <utility>

#include "common/base/error.hpp"
#include "services/http/request_check.hpp"

namespace aloft::http {
namespace {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace beast_http = beast::http;
using boost::system::error_code;
using net::ip::tcp;
using Clock = std::chrono::steady_clock;

constexpr std::uint32_t header_bytes = 8192;
constexpr std::uint64_t body_bytes = 1024;
constexpr std::size_t buffer_bytes = 16384;
constexpr int event_send_buffer_bytes = 65536;
constexpr std::chrono::milliseconds accept_again_time{100};  // no descriptor was left
constexpr std::chrono::milliseconds farewell_time{1000};

Response made_by(const HttpRoute& route, const HttpRequest& request) {
  Response response;
  try {
    HttpResponse answer = route.answer(request);
    response.result(static_cast<unsigned>(answer.status));
    response.set(beast_http::field::content_type, answer.content_type);
    response.body() = std::move(answer.body);
  } catch (const InputError& error) {
    response.result(beast_http::status::bad_request);
    response.body() = std::string(error.what()) + "\n";
  } catch (const std::exception& error) {
    response.result(beast_http::status::internal_server_error);
    response.body() = std::string(error.what()) + "\n";
  }
  return response;
}

/// Headers that all answers have. Pages load nothing from elsewhere, and run no script that is not a file of this
/// server.
template <class Message>
void protect(Message& response) {
  response.set(beast_http::field::cache_control, "no-store");
  response.set("Content-Security-Policy",
               "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data:; "
               "base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.set("Referrer-Policy", "no-referrer");
  response.set("X-Content-Type-Options", "nosniff");
}

void complete(Response& response, bool keep_alive, bool without_body) {
  if (response.count(beast_http::field::content_type) == 0) response.set(beast_http::field::content_type, "text/plain");
  protect(response);
  response.keep_alive(keep_alive);
  response.prepare_payload();
  if (without_body) response.body().clear();
}

/// An answer as a server-sent event; one that failed has the name "failure".
std::string event_of(const Response& response) {
  std::string text = response.body();
  while (text.ends_with('\n')) text.pop_back();
  boost::algorithm::replace_all(text, "\n", "\ndata: ");
  return (response.result() == beast_http::status::ok ? "data: " : "event: failure\ndata: ") + text + "\n\n";
}

/// The latest event of one target, and those who wait for the next one.
struct EventTopic {
  EventTopic(net::io_context& io, const HttpRoute& its_route, HttpRequest its_request)
      : route(its_route), request(std::move(its_request)), changed(io, Clock::time_point::max()) {}

  const HttpRoute& route;
  HttpRequest request;
  std::shared_ptr<const std::string> event;
  std::uint64_t events = 0;
  std::size_t viewers = 0;
  net::steady_timer changed;  // cancelled to wake the viewers
};

}  // namespace

struct HttpServer::State {
  using Connections = std::list<beast::tcp_stream>;
  using Topics = std::map<std::string, EventTopic>;

  State(std::map<std::string, HttpRoute> all_routes, HostNames host_names, const HttpLimits& all_limits)
      : routes(std::move(all_routes)), hosts(std::move(host_names)), limits(all_limits) {}

  net::awaitable<void> accept_all();
  net::awaitable<void> converse(Connections::iterator client);
  [[nodiscard]] std::optional<Response> refusal(const Request& request, const HttpRequest& asked) const;
  net::awaitable<Response> answer_of(const HttpRoute& route, const HttpRequest& asked);
  net::awaitable<void> send_events(Connections::iterator client, const HttpRoute& route, HttpRequest asked);
  net::awaitable<void> make_events(Topics::iterator topic);
  Topics::iterator topic_of(const HttpRoute& route, HttpRequest asked);

  std::map<std::string, HttpRoute> routes;
  HostNames hosts;
  HttpLimits limits;
  net::io_context io{1};
  net::thread_pool workshop{1};  // makes the answers that are not quick
  tcp::acceptor acceptor{io};
  Connections connections;  // the least recently active one is at the front
  Topics topics;            // that somebody views
  std::size_t event_streams = 0;
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
    beast_http::request_parser<beast_http::string_body> parser;
    parser.header_limit(header_bytes);
    parser.body_limit(body_bytes);
    client->expires_after(limits.time);
    co_await beast_http::async_read(*client, buffer, parser, net::redirect_error(net::use_awaitable, error));
    std::optional<Response> response = error ? refusal_of(error) : std::nullopt;
    if (error && !response) break;
    connections.splice(connections.end(), connections, client);
    goes_on = !error && parser.get().keep_alive();
    const bool head = parser.get().method() == beast_http::verb::head;
    if (!response) {
      const HttpRequest asked = parsed({parser.get().target().data(), parser.get().target().size()});
      response = refusal(parser.get(), asked);
      if (!response && !head && routes.at(asked.path).event_period.count() > 0) {
        co_await send_events(client, routes.at(asked.path), asked);
        break;
      }
      if (!response) response = co_await answer_of(routes.at(asked.path), asked);
    }
    complete(*response, goes_on, head);
    client->expires_after(limits.time);
    co_await beast_http::async_write(*client, *response, net::redirect_error(net::use_awaitable, error));
  }
  // Unread input would reset the connection before the client has read the answer.
  client->expires_after(std::min(limits.time, farewell_time));
  error_code ended;
  client->socket().shutdown(tcp::socket::shutdown_send, ended);
  for (std::array<char, 4096> rest; !ended;)
    co_await client->async_read_some(net::buffer(rest), net::redirect_error(net::use_awaitable, ended));
  connections.erase(client);
}

std::optional<Response> HttpServer::State::refusal(const Request& request, const HttpRequest& asked) const {
  if (std::optional<Response> refused = hosts.refusal(request)) return refused;
  Response response;
  const auto route = routes.find(asked.path);
  const bool takes_orders = route != routes.end() && !route->second.token.empty();
  const bool is_order = request.method() == beast_http::verb::post;
  const bool is_question = request.method() == beast_http::verb::get || request.method() == beast_http::verb::head;
  if (takes_orders ? !is_order : !is_question) {
    response.result(beast_http::status::method_not_allowed);
    response.set(beast_http::field::allow, takes_orders ? "POST" : "GET, HEAD");
    return response;
  }
  if (takes_orders && !shows_token(request, route->second.token)) {
    response.result(beast_http::status::forbidden);
    response.body() = "this takes the token of the address that was printed\n";
    return response;
  }
  if (route == routes.end()) {
    response.result(beast_http::status::not_found);
    for (const auto& [known, unused] : routes) response.body() += known + "\n";
    return response;
  }
  if (route->second.event_period.count() > 0 && event_streams >= limits.event_streams) {
    response.result(beast_http::status::service_unavailable);
    response.body() = "too many viewers already\n";
    return response;
  }
  return std::nullopt;
}

net::awaitable<Response> HttpServer::State::answer_of(const HttpRoute& route, const HttpRequest& asked) {
  if (route.quick) co_return made_by(route, asked);
  Response response;
  if (waiting_answers >= limits.waiting_answers) {
    response.result(beast_http::status::service_unavailable);
    response.body() = "too many requests wait already\n";
    co_return response;
  }
  ++waiting_answers;
  auto made = net::co_spawn(
      workshop, [&route, asked]() -> net::awaitable<Response> { co_return made_by(route, asked); }, net::use_awaitable);
  response = co_await std::move(made);
  --waiting_answers;
  co_return response;
}

net::awaitable<void> HttpServer::State::send_events(Connections::iterator client, const HttpRoute& route,
                                                    HttpRequest asked) {
  static const std::string comment = ":\n\n";
  beast_http::response<beast_http::empty_body> head;
  head.set(beast_http::field::content_type, "text/event-stream");
  protect(head);
  head.keep_alive(false);
  beast_http::response_serializer<beast_http::empty_body> header(head);
  error_code error;
  client->socket().set_option(net::socket_base::send_buffer_size(event_send_buffer_bytes), error);
  const Topics::iterator topic = topic_of(route, std::move(asked));
  EventTopic& viewed = topic->second;
  ++viewed.viewers;
  ++event_streams;
  client->expires_after(limits.time);
  co_await beast_http::async_write_header(*client, header, net::redirect_error(net::use_awaitable, error));
  for (std::uint64_t seen = 0; !error;) {
    client->expires_never();
    error_code woken;
    if (viewed.events == seen) co_await viewed.changed.async_wait(net::redirect_error(net::use_awaitable, woken));
    const std::shared_ptr<const std::string> event = viewed.events == seen ? nullptr : viewed.event;
    seen = viewed.events;
    connections.splice(connections.end(), connections, client);
    client->expires_after(limits.time);
    co_await net::async_write(*client, net::buffer(event ? *event : comment),
                              net::redirect_error(net::use_awaitable, error));
  }
  --event_streams;
  --viewed.viewers;
}

HttpServer::State::Topics::iterator HttpServer::State::topic_of(const HttpRoute& route, HttpRequest asked) {
  std::string target = asked.path;
  for (const auto& [name, value] : asked.query) target += '&' + name + '=' + value;
  const auto [topic, is_new] = topics.try_emplace(target, io, route, std::move(asked));
  if (is_new) net::co_spawn(io, make_events(topic), net::detached);
  return topic;
}

net::awaitable<void> HttpServer::State::make_events(Topics::iterator topic) {
  EventTopic& viewed = topic->second;
  net::steady_timer pause(io);
  Clock::time_point woke = Clock::now();
  do {
    std::string event = event_of(co_await answer_of(viewed.route, viewed.request));
    const bool changed = !viewed.event || event != *viewed.event;
    if (changed) {
      viewed.event = std::make_shared<const std::string>(std::move(event));
      ++viewed.events;
    }
    if (changed || Clock::now() - woke >= limits.silence) {
      woke = Clock::now();
      viewed.changed.cancel();
    }
    error_code ignored;
    pause.expires_after(viewed.route.event_period);
    co_await pause.async_wait(net::redirect_error(net::use_awaitable, ignored));
  } while (viewed.viewers > 0);
  topics.erase(topic);
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

}  // namespace aloft::http
