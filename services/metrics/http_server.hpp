#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>

namespace aloft::metrics {

struct HttpResponse {
  int status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  std::string body;
};

/// Answers GET requests until it is destroyed. Handlers run on the server's two threads.
class HttpServer {
 public:
  using Handler = std::function<HttpResponse()>;

  /// Listens on an IPv4 address of this machine. Port 0 takes a free one. InputError if the port cannot be had.
  HttpServer(const std::string& address, int port, const std::map<std::string, Handler>& routes);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  [[nodiscard]] int port() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace aloft::metrics
