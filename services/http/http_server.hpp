#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace aloft::http {

/// What is asked for: "/flight?condition=2&trial=7". Values are taken as they come, without decoding "%20" or "+".
struct HttpRequest {
  std::string path;
  std::map<std::string, std::string> query;
};

struct HttpResponse {
  int status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  std::string body;
};

struct HttpRoute {
  std::function<HttpResponse(const HttpRequest&)> answer;
  /// Never blocks: answered by the thread that keeps the connections, whatever the other routes are doing.
  bool quick = false;
  /// Above 0, the answers are server-sent events: the connection stays, and the answer is made again after each
  /// period, once for all who asked the same, and sent if it has changed. Nothing is made while nobody is connected.
  std::chrono::milliseconds event_period{0};
  /// If given, the route takes orders: POST requests, of those who know it ("Authorization: Bearer TOKEN").
  std::string token{};
};

/// Bounds on what clients can use up.
struct HttpLimits {
  std::size_t connections = 128;            ///< one more closes the least recently active one
  std::chrono::milliseconds time{5000};     ///< for a request to come in whole, and for its answer to be taken
  std::size_t waiting_answers = 32;         ///< of routes that are not quick; beyond: 503
  std::size_t event_streams = 64;           ///< connections that are sent events; beyond: 503
  std::chrono::milliseconds silence{5000};  ///< a stream without an event is sent a comment, to see whether it is there
};

/// Answers GET and HEAD requests, and POST requests of routes with a token, until it is destroyed. One thread keeps all
/// connections and never waits for any of them; another one makes the answers that are not quick. A viewer of events
/// that reads slowly misses some of them, and is cut off if it takes none for HttpLimits::time: nothing is kept for it
/// but the latest.
class HttpServer {
 public:
  /// Listens on an IPv4 address of this machine. Port 0 takes a free one. InputError if the port cannot be had.
  /// Against DNS rebinding, where a browser is led here under a foreign name, a request must be addressed to
  /// localhost, to a loopback address, to one of `names` or, if `address` is no loopback address, to any IP address or
  /// the name of this machine. A page of another origin gets nothing.
  HttpServer(const std::string& address, int port, std::map<std::string, HttpRoute> routes,
             std::vector<std::string> names = {}, const HttpLimits& limits = {});
  ~HttpServer();

  [[nodiscard]] int port() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace aloft::http
