#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdint>

#include "common/bus/guard/testing/datagrams.hpp"

namespace aloft::test {

/// Sends datagrams to the ports of every process in a domain on the loopback interface, whose names it need not know.
class Attacker {
 public:
  explicit Attacker(int domain) : first_port_(7400 + 250 * domain) {
    sockaddr_in own{};
    own.sin_family = AF_INET;
    own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof own;
    (void)bind(socket_, reinterpret_cast<const sockaddr*>(&own), size);
    (void)getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size);
    port_ = ntohs(own.sin_port);
  }
  ~Attacker() { close(socket_); }
  Attacker(const Attacker&) = delete;
  Attacker& operator=(const Attacker&) = delete;

  void send(const bus::guard::testing::Bytes& datagram) const {
    constexpr int ports = 120;  // of both multicast sockets and of 54 participants; a process never uses one twice
    for (int port = 0; port < ports; ++port) send_to(port, datagram);
  }
  /// To one port, counted from the first one of the domain.
  void send_to(int port, const bus::guard::testing::Bytes& datagram) const {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(first_port_ + port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    (void)sendto(socket_, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }
  /// Announces a participant that receives at our port, with all endpoints that discovery needs: from then on the
  /// processes listen to its writers.
  void announce(const bus::guard::Prefix& participant, std::uint32_t lease_s) const {
    using namespace bus::guard::testing;
    send(datagram({announcement(true, participant, lease_s,
                                [this](Out& out) {
                                  constexpr std::uint32_t discovery_endpoints = 0x3f;
                                  parameter(out, 0x58, [](Out& value) { value.u32(discovery_endpoints); });
                                  for (const unsigned id : {0x31U, 0x32U})
                                    parameter(out, id, [this](Out& value) { locator(value, 1, port_, loopback); });
                                })},
                  participant));
  }

 private:
  int socket_ = socket(AF_INET, SOCK_DGRAM, 0);
  int first_port_;
  std::uint16_t port_ = 0;
};

}  // namespace aloft::test
