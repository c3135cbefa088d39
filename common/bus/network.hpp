#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace aloft::bus {

/// An IPv4 address in dots, and a UDP port.
struct Endpoint {
  std::string address;
  std::uint16_t port = 0;
};

/// The address of this machine that "10.0.0.1" or "eth0" names. InputError, listing all addresses, if there is none.
[[nodiscard]] std::string local_address(const std::string& address_or_interface);

[[nodiscard]] bool is_local_address(const std::string& address);

/// Whether the interface with this address is up and has a link.
[[nodiscard]] bool is_running(const std::string& address);

/// "HOST:PORT" with an address or a name that can be resolved. InputError otherwise.
[[nodiscard]] Endpoint resolve_endpoint(const std::string& host_and_port);

/// InputError unless processes that use these interfaces (addresses) can reach the endpoint: loopback from loopback,
/// others from others.
void check_reachable(const Endpoint& endpoint, const std::vector<std::string>& interfaces);

/// InputError unless this process could listen there now.
void check_can_listen(const Endpoint& endpoint);

}  // namespace aloft::bus
