#include "services/http/http_server.hpp"

#include <fmt/format.h>
#include <httplib.h>

#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <catch2/catch.hpp>
#include <filesystem>
#include <future>
#include <list>
#include <thread>

#include "common/base/error.hpp"

using namespace aloft::http;
using namespace std::chrono_literals;
using Catch::Contains;
using Clock = std::chrono::steady_clock;

namespace {

HttpRoute fixed(int status, const std::string& body) {
  return {[=](const HttpRequest&) { return HttpResponse{status, "text/plain", body}; }, true};
}

const std::map<std::string, HttpRoute> health{{"/healthz", fixed(200, "ok\n")}};

/// A connection that sends arbitrary bytes.
class RawClient {
 public:
  explicit RawClient(const HttpServer& server) {
    namespace ip = boost::asio::ip;
    socket_.connect({ip::address_v4::loopback(), static_cast<std::uint16_t>(server.port())});
    timeval patience{20, 0};
    setsockopt(socket_.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }
  /// False if the server has closed the connection.
  bool send(std::string_view text) {
    boost::system::error_code error;
    boost::asio::write(socket_, boost::asio::buffer(text.data(), text.size()), error);
    return !error;
  }
  /// Everything up to and with `end`, and what came with it; all if the server closes the connection before.
  std::string until(const std::string& end) {
    std::string text;
    boost::system::error_code error;
    boost::asio::read_until(socket_, boost::asio::dynamic_buffer(text), end, error);
    return text;
  }
  /// Everything until the server closes the connection.
  std::string rest() {
    std::string text;
    boost::system::error_code end;
    boost::asio::read(socket_, boost::asio::dynamic_buffer(text), end);
    return text;
  }

 private:
  boost::asio::io_context io_;
  boost::asio::ip::tcp::socket socket_{io_};
};

std::string answer(const HttpServer& server, const std::string& request) {
  RawClient client(server);
  client.send(request);
  return client.rest();
}

/// The answer to a request that is addressed to `host`.
std::string answer_to(const HttpServer& server, const std::string& host) {
  return answer(server, "GET /healthz HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n\r\n");
}

bool is_healthy(const HttpServer& server) {
  httplib::Client client("127.0.0.1", server.port());
  client.set_read_timeout(20);
  const auto answer = client.Get("/healthz");
  return answer && answer->body == "ok\n";
}

}  // namespace

TEST_CASE("the server answers its routes on loopback", "[http]") {
  const HttpServer server("127.0.0.1", 0, {{"/healthz", fixed(200, "ok\n")}, {"/broken", fixed(503, "stalled\n")}});
  REQUIRE(server.port() > 0);
  httplib::Client client("127.0.0.1", server.port());
  client.set_keep_alive(true);
  const auto healthy = client.Get("/healthz?verbose=1");
  REQUIRE(healthy);
  CHECK(healthy->status == 200);
  CHECK(healthy->body == "ok\n");
  CHECK(healthy->get_header_value("Content-Type") == "text/plain");
  CHECK(client.Get("/broken")->status == 503);
  CHECK(client.Get("/nothing")->status == 404);
  CHECK(client.Post("/healthz")->status == 405);
  const auto head = client.Head("/healthz");
  REQUIRE(head);
  CHECK(head->status == 200);
  CHECK(head->body.empty());
}

TEST_CASE("a route that throws is answered, too", "[http]") {
  const HttpLimits limits{.waiting_answers = 2};
  const HttpServer server("127.0.0.1", 0,
                          {{"/status", {[](const HttpRequest&) -> HttpResponse { throw std::runtime_error("oh"); }}}},
                          {}, limits);
  httplib::Client client("127.0.0.1", server.port());
  for (int request = 0; request < 5; ++request) CHECK(client.Get("/status")->status == 500);
}

TEST_CASE("a taken port is a clear error", "[http]") {
  const HttpServer first("127.0.0.1", 0, {});
  CHECK_THROWS_AS(HttpServer("127.0.0.1", first.port(), {}), aloft::InputError);
  CHECK_THROWS_WITH(HttpServer("192.0.2.1", 0, {}), Contains("--http-port 0") && Contains("192.0.2.1"));
}

TEST_CASE("requests under a foreign name are refused", "[http]") {
  const HttpServer server("127.0.0.1", 0, health, {"aloft.example"});
  const std::string port = std::to_string(server.port());
  for (const std::string host : {"localhost", "LocalHost:1", "127.0.0.1", "127.0.0.1:9464", "[::1]", "[::1]:80",
                                 "aloft.example", "Aloft.Example:80"})
    CHECK_THAT(answer_to(server, host), Contains("HTTP/1.1 200 OK"));
  CHECK_THAT(answer_to(server, "127.0.0.1:" + port), Contains("HTTP/1.1 200 OK"));
  for (const std::string host : {"attacker.example", "localhost.attacker.example", "127.0.0.1.attacker.example:80",
                                 "192.0.2.1", "[2001:db8::1]", "[::1", "", ":80", "aloft", "xaloft.example"}) {
    INFO(host);
    const std::string refused = answer_to(server, host + ":" + port);
    CHECK_THAT(refused, Contains("HTTP/1.1 421 ") && Contains("--http-host"));
    CHECK_THAT(refused, !Contains("ok\n"));
  }
  CHECK_THAT(answer(server, "GET /healthz HTTP/1.1\r\nConnection: close\r\n\r\n"), Contains(" 400 "));
  CHECK_THAT(answer(server, "GET /healthz HTTP/1.0\r\nHost: localhost\r\nHost: attacker.example\r\n\r\n"),
             Contains(" 400 "));
  CHECK_THAT(answer(server, "GET /healthz HTTP/1.0\r\n\r\n"), Contains(" 200 "));  // an HTTP/1.0 health check
}

TEST_CASE("a server for other hosts answers under any address and this machine's name, not under others", "[http]") {
  const HttpServer server("0.0.0.0", 0, health);
  std::array<char, 65> machine{};
  REQUIRE(gethostname(machine.data(), machine.size() - 1) == 0);
  for (const std::string host : {"localhost", "127.0.0.1", "192.0.2.1", "[2001:db8::1]"})
    CHECK_THAT(answer_to(server, host), Contains(" 200 "));
  CHECK_THAT(answer_to(server, machine.data()), Contains(" 200 "));
  CHECK_THAT(answer_to(server, "attacker.example"), Contains(" 421 "));
}

TEST_CASE("requests that are too large or no HTTP are refused", "[http]") {
  const HttpServer server("127.0.0.1", 0, health);
  const std::string start = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n";
  CHECK_THAT(answer(server, start + "X: " + std::string(9000, 'x') + "\r\n\r\n"), Contains(" 431 "));
  CHECK_THAT(answer(server, start + "X: " + std::string(1U << 20U, 'x') + "\r\n\r\n"), Contains(" 431 "));
  CHECK_THAT(answer(server, start + "Content-Length: 5000\r\n\r\n" + std::string(5000, 'x')), Contains(" 413 "));
  CHECK_THAT(answer(server, "rubbish\r\n\r\n"), Contains(" 400 "));
  CHECK(is_healthy(server));
}

TEST_CASE("a client that sends or reads too slowly is dropped, and delays no other", "[http]") {
  HttpLimits limits;
  limits.time = 500ms;
  const std::string large(32U << 20U, 'x');
  const HttpServer server("127.0.0.1", 0, {{"/healthz", fixed(200, "ok\n")}, {"/large", fixed(200, large)}}, {},
                          limits);
  std::list<RawClient> slow;
  for (int i = 0; i < 20; ++i) CHECK(slow.emplace_back(server).send("GET /healthz HTTP/1.1\r\nHost: localhost\r\n"));
  RawClient never_reads(server);
  CHECK(never_reads.send("GET /large HTTP/1.1\r\nHost: localhost\r\n\r\n"));
  // A byte now and then must not keep a connection open without end.
  const auto started = Clock::now();
  while (slow.front().send("x") && Clock::now() - started < 30s) {
    for (RawClient& client : slow) (void)client.send("x");
    CHECK(is_healthy(server));
    std::this_thread::sleep_for(50ms);
  }
  CHECK(Clock::now() - started < 30s);
  for (RawClient& client : slow) CHECK(client.rest().empty());
  CHECK(never_reads.rest().size() < large.size());
}

TEST_CASE("one connection too many closes the least recently active one", "[http]") {
  HttpLimits limits;
  limits.connections = 4;
  limits.time = 1h;
  const HttpServer server("127.0.0.1", 0, health, {}, limits);
  httplib::Client busy("127.0.0.1", server.port());
  busy.set_keep_alive(true);
  REQUIRE(busy.Get("/healthz"));
  std::list<RawClient> idle;
  for (int i = 0; i < 20; ++i) {
    idle.emplace_back(server);
    REQUIRE(busy.Get("/healthz"));
  }
  for (int i = 0; i < 17; ++i) {
    CHECK(idle.front().rest().empty());  // closed by the server
    idle.pop_front();
  }
  for (RawClient& client : idle) {
    CHECK(client.send("GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"));
    CHECK_THAT(client.rest(), Contains(" 200 "));
  }
}

TEST_CASE("answers that take long do not delay the health, and do not pile up", "[http]") {
  std::promise<void> go_on;
  const std::shared_future<void> may_go_on = go_on.get_future().share();
  const HttpRoute slow{[may_go_on](const HttpRequest&) {
    may_go_on.wait();
    return HttpResponse{200, "text/plain", "at last\n"};
  }};
  HttpLimits limits;
  limits.waiting_answers = 3;
  const HttpServer server("127.0.0.1", 0, {{"/healthz", fixed(200, "ok\n")}, {"/status", slow}}, {}, limits);
  std::list<RawClient> clients;
  for (int i = 0; i < 5; ++i) {
    clients.emplace_back(server);
    CHECK(clients.back().send("GET /status HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"));
    CHECK(is_healthy(server));  // so the server has seen the one before
  }
  CHECK_THAT(clients.back().rest(), Contains(" 503 "));
  go_on.set_value();
  CHECK_THAT(clients.front().rest(), Contains(" 200 ") && Contains("at last"));
}

TEST_CASE("a server that ends leaves no client waiting", "[http]") {
  auto server = std::make_unique<HttpServer>("127.0.0.1", 0, health);
  RawClient idle(*server);
  RawClient half(*server);
  CHECK(half.send("GET /hea"));
  CHECK(is_healthy(*server));
  server.reset();
  CHECK(idle.rest().empty());
  CHECK(half.rest().empty());
}

namespace {

/// Counts up: a new event each time it is asked.
HttpRoute counter(std::atomic<int>& asked, std::chrono::milliseconds period = 10ms) {
  return {[&asked](const HttpRequest& request) {
            return HttpResponse{200, "application/json",
                                request.query.at("of") + std::to_string(++asked) + "\nsecond line\n"};
          },
          false, period};
}

const std::string ask_for_events = "GET /events?of=a HTTP/1.1\r\nHost: localhost\r\n\r\n";

}  // namespace

TEST_CASE("queries reach the route as they come", "[http]") {
  const HttpServer server("127.0.0.1", 0, {{"/flight", {[](const HttpRequest& request) {
                                              std::string body = request.path;
                                              for (const auto& [name, value] : request.query)
                                                body += "|" + name + "=" + value;
                                              return HttpResponse{200, "text/plain", body};
                                            }}}});
  httplib::Client client("127.0.0.1", server.port());
  CHECK(client.Get("/flight?trial=7&condition=2")->body == "/flight|condition=2|trial=7");
  CHECK(client.Get("/flight")->body == "/flight");
  CHECK(client.Get("/flight?")->body == "/flight");
  CHECK(client.Get("/flight?=&&a&b==1&a=2")->body == "/flight|=|a=|b==1");
}

TEST_CASE("what a route says of bad input is answered with 400", "[http]") {
  const HttpServer server(
      "127.0.0.1", 0, {{"/flight", {[](const HttpRequest&) -> HttpResponse { throw aloft::InputError("trial 9"); }}}});
  httplib::Client client("127.0.0.1", server.port());
  CHECK(client.Get("/flight")->status == 400);
  CHECK(client.Get("/flight")->body == "trial 9\n");
}

TEST_CASE("pages of other origins get nothing, and no answer can run foreign scripts", "[http]") {
  const HttpServer server("127.0.0.1", 0, health);
  const std::string host = "localhost:" + std::to_string(server.port());
  const auto from = [&](const std::string& origin) {
    return answer(server,
                  "GET /healthz HTTP/1.1\r\nHost: " + host + "\r\nOrigin: " + origin + "\r\nConnection: close\r\n\r\n");
  };
  CHECK_THAT(from("http://" + host), Contains(" 200 ") && Contains("Content-Security-Policy: default-src 'none'"));
  CHECK_THAT(from("http://" + host), !Contains("Access-Control-Allow-Origin"));
  for (const std::string& other :
       std::vector<std::string>{"http://attacker.example", "null", "http://localhost:1", "http://x" + host, ""}) {
    INFO(other);
    CHECK_THAT(from(other), Contains(" 403 ") && !Contains("ok\n"));
  }
}

TEST_CASE("viewers of the same events share them, and nothing is made without a viewer", "[http]") {
  std::atomic<int> asked = 0;
  const HttpServer server("127.0.0.1", 0, {{"/events", counter(asked)}, {"/healthz", fixed(200, "ok\n")}});
  std::this_thread::sleep_for(100ms);
  CHECK(asked == 0);
  {
    RawClient one(server);
    RawClient other(server);
    REQUIRE(one.send(ask_for_events));
    const std::string head = one.until("second line\n\n");
    CHECK_THAT(head, Contains(" 200 ") && Contains("text/event-stream") && Contains("\r\n\r\ndata: a1\ndata: second"));
    REQUIRE(other.send(ask_for_events));
    // The same events for both: no more were made than one of them has seen.
    const std::string seen = other.until("data: a50\n");
    CHECK_THAT(one.until("data: a50\n"), Contains("data: a49\n"));
    CHECK(is_healthy(server));
  }
  // Once both have left, which the server notices when it sends, no more are made.
  int before = -1;
  for (int wait = 0; wait < 200 && before != asked; ++wait) {
    before = asked;
    std::this_thread::sleep_for(100ms);
  }
  CHECK(before == asked);
}

TEST_CASE("a viewer that reads slowly misses events, and one that does not read is cut off", "[http]") {
  std::atomic<int> asked = 0;
  const std::string large(1U << 20U, 'x');
  const HttpRoute events{[&](const HttpRequest&) {
                           return HttpResponse{200, "text/plain", std::to_string(++asked) + " " + large};
                         },
                         false, 1ms};
  HttpLimits limits;
  limits.time = 500ms;
  const HttpServer server("127.0.0.1", 0, {{"/events", events}, {"/healthz", fixed(200, "ok\n")}}, {}, limits);
  RawClient never_reads(server);
  REQUIRE(never_reads.send("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n"));
  std::this_thread::sleep_for(1500ms);
  CHECK(is_healthy(server));
  CHECK(never_reads.rest().size() < 20 * large.size());  // what was under way when it was cut off
}

TEST_CASE("events that do not change are not sent again, but a comment shows that the server is there", "[http]") {
  const HttpRoute events{[](const HttpRequest&) -> HttpResponse { return {503, "text/plain", "no run\n"}; }, true, 5ms};
  HttpLimits limits;
  limits.silence = 50ms;
  limits.event_streams = 1;
  const HttpServer server("127.0.0.1", 0, {{"/events", events}}, {}, limits);
  RawClient client(server);
  REQUIRE(client.send("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n"));
  const std::string sent = client.until(":\n\n:\n\n");
  CHECK_THAT(sent, Contains("\r\n\r\nevent: failure\ndata: no run\n\n:\n\n"));
  CHECK_THAT(answer(server, "GET /events HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n"),
             Contains(" 503 ") && Contains("too many viewers"));
}

TEST_CASE("orders need the token, POST, and no foreign page", "[http]") {
  std::atomic<int> ordered = 0;
  HttpRoute order{[&ordered](const HttpRequest& request) {
    ++ordered;
    return HttpResponse{200, "text/plain", request.query.at("agent") + "\n"};
  }};
  order.token = "0123456789abcdef";
  const HttpServer server("127.0.0.1", 0, {{"/healthz", fixed(200, "ok\n")}, {"/swap", order}});
  const auto sent = [&](const std::string& method, const std::string& headers) {
    return answer(server, method + " /swap?agent=a HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n" +
                              "Content-Length: 0\r\n" + headers + "\r\n");
  };
  const std::string good = "Authorization: Bearer 0123456789abcdef\r\n";
  CHECK_THAT(sent("POST", ""), Contains(" 403 ") && Contains("token"));
  for (const std::string wrong : {"Bearer ", "Bearer 0123456789abcdeg", "Bearer 0123456789abcde",
                                  "Bearer 0123456789abcdef0", "0123456789abcdef", "Basic 0123456789abcdef", "bearer"}) {
    INFO(wrong);
    CHECK_THAT(sent("POST", "Authorization: " + wrong + "\r\n"), Contains(" 403 "));
  }
  CHECK_THAT(sent("POST", "Authorization: Bearer x\r\n" + good), Contains(" 403 "));
  CHECK_THAT(sent("GET", good), Contains(" 405 ") && Contains("Allow: POST"));
  CHECK_THAT(sent("HEAD", good), Contains(" 405 "));
  CHECK_THAT(sent("OPTIONS", good + "Origin: http://attacker.example\r\n"),
             Contains(" 403 ") && !Contains("Access-Control"));
  CHECK_THAT(sent("POST", good + "Origin: http://attacker.example\r\n"), Contains(" 403 "));
  CHECK(ordered == 0);
  CHECK_THAT(sent("POST", good + "Origin: http://localhost\r\n"), Contains(" 200 ") && Contains("\r\n\r\na\n"));
  CHECK(ordered == 1);
  httplib::Client client("127.0.0.1", server.port());
  CHECK(client.Post("/healthz")->status == 405);  // no other route takes orders
}

TEST_CASE("10,000 connections cost a bounded number of descriptors, and keep nobody out", "[http]") {
  const auto descriptors = [] {
    const std::filesystem::directory_iterator open("/proc/self/fd");
    return std::distance(begin(open), end(open));
  };
  HttpLimits limits;
  limits.connections = 16;
  const HttpServer server("127.0.0.1", 0, {{"/healthz", fixed(200, "ok\n")}}, {}, limits);
  const auto before = descriptors();
  std::list<RawClient> open;
  std::ptrdiff_t most = 0;
  for (int i = 0; i < 10'000; ++i) {
    open.emplace_back(server);
    if (i % 3 == 0) (void)open.back().send("GET /healthz HTTP/1.1\r\nX: ");
    if (open.size() > 100) open.pop_front();
    if (i % 1000 == 999) {
      CHECK(is_healthy(server));
      most = std::max(most, descriptors() - before);
    }
  }
  // A client has a socket, and an io_context with three descriptors of its own; the server has at most 17 sockets.
  CHECK(most <= 101 * 4 + 17 + 4);
  open.clear();
  CHECK(is_healthy(server));
}
