#include "services/metrics/http_server.hpp"

#include <fmt/format.h>
#include <httplib.h>

#include <thread>

#include "common/base/error.hpp"

namespace aloft::metrics {

struct HttpServer::State {
  httplib::Server server;
  int port = 0;
  std::thread thread;
};

HttpServer::HttpServer(const std::string& host, int port, const std::map<std::string, Handler>& routes)
    : state_(std::make_unique<State>()) {
  httplib::Server& server = state_->server;
  server.new_task_queue = [] { return new httplib::ThreadPool(2); };  // NOLINT: the library takes ownership
  // The library's default shares a port with whoever else listens there.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  server.set_payload_max_length(1024);
  server.set_keep_alive_timeout(1);  // also bounds how long stopping waits
  for (const auto& [path, handler] : routes) {
    server.Get(path, [handler](const httplib::Request&, httplib::Response& response) {
      const HttpResponse answer = handler();
      response.status = answer.status;
      response.set_content(answer.body, answer.content_type);
    });
  }
  state_->port = port == 0 ? server.bind_to_any_port(host) : server.bind_to_port(host, port) ? port : -1;
  if (state_->port < 0)
    throw InputError(fmt::format(
        "--http-port {}: the port cannot be opened on {} (taken?); choose another, or 0 for any", port, host));
  state_->thread = std::thread([this] { state_->server.listen_after_bind(); });
  while (!server.is_running()) std::this_thread::yield();  // stop() is lost before that
}

HttpServer::~HttpServer() {
  state_->server.stop();
  state_->thread.join();
}

int HttpServer::port() const noexcept {
  return state_->port;
}

}  // namespace aloft::metrics
