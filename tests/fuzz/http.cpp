// HTTP requests, each over a connection of its own to the collector's server.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>

#include "services/http/http_server.hpp"
#include "tests/fuzz/target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace aloft;
  static http::HttpServer server("127.0.0.1", 0,
                                 {{"/healthz",
                                   {[](const http::HttpRequest&) {
                                      return http::HttpResponse{200, "text/plain", "ok\n"};
                                    },
                                    true}},
                                  {"/metrics", {[](const http::HttpRequest&) {
                                     return http::HttpResponse{503, "text/plain", "slow\n"};
                                   }}}});
  const int connection = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(server.port()));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(connection, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) {
    (void)send(connection, data, size, MSG_NOSIGNAL);
    shutdown(connection, SHUT_WR);
    std::string answer;
    std::array<char, 4096> part;
    for (ssize_t got = 0; (got = recv(connection, part.data(), part.size(), 0)) > 0;)
      answer.append(part.data(), static_cast<std::size_t>(got));
    fuzz::require(answer.empty() || answer.starts_with("HTTP/1."), "the answer is no HTTP");
  }
  close(connection);
  return 0;
}
