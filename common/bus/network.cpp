#include "common/bus/network.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <system_error>

#include "common/base/error.hpp"

namespace aloft::bus {
namespace {

std::string text(const in_addr& address) {
  std::array<char, INET_ADDRSTRLEN> buffer{};
  return inet_ntop(AF_INET, &address, buffer.data(), buffer.size());
}

/// Copied out of the socket API's untyped address.
sockaddr_in ipv4(const sockaddr* address) {
  sockaddr_in result{};
  std::memcpy(&result, address, sizeof result);
  return result;
}

bool is_loopback(const std::string& address) {
  return address.starts_with("127.");
}

struct Interface {
  std::string name;
  std::string address;
  bool running = false;
};

std::vector<Interface> interfaces_of_this_machine() {
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0)
    throw std::system_error(errno, std::generic_category(), "cannot list the network interfaces");
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, &freeifaddrs);
  std::vector<Interface> all;
  for (const ifaddrs* at = list; at != nullptr; at = at->ifa_next)
    if (at->ifa_addr != nullptr && at->ifa_addr->sa_family == AF_INET)
      all.push_back({at->ifa_name, text(ipv4(at->ifa_addr).sin_addr), (at->ifa_flags & IFF_RUNNING) != 0});
  return all;
}

}  // namespace

std::string local_address(const std::string& address_or_interface) {
  std::string known;
  for (const Interface& one : interfaces_of_this_machine()) {
    if (one.name == address_or_interface || one.address == address_or_interface) return one.address;
    known += fmt::format("{}{} ({})", known.empty() ? "" : ", ", one.name, one.address);
  }
  throw InputError("--interface {}: this machine has no such IPv4 interface or address; it has: {}",
                   address_or_interface, known);
}

bool is_running(const std::string& address) {
  const std::vector<Interface> all = interfaces_of_this_machine();
  return std::any_of(all.begin(), all.end(),
                     [&](const Interface& one) { return one.address == address && one.running; });
}

bool is_local_address(const std::string& address) {
  const std::vector<Interface> all = interfaces_of_this_machine();
  return std::any_of(all.begin(), all.end(), [&](const Interface& one) { return one.address == address; });
}

Endpoint resolve_endpoint(const std::string& host_and_port) {
  const std::size_t colon = host_and_port.rfind(':');
  Endpoint endpoint;
  const char* const end = host_and_port.data() + host_and_port.size();
  const bool has_port =
      colon != std::string::npos && colon > 0 &&
      std::from_chars(host_and_port.data() + colon + 1, end, endpoint.port) == std::from_chars_result{end, std::errc()};
  if (!has_port || endpoint.port == 0)
    throw InputError("--discovery-server {}: write ADDRESS:PORT, e.g. 10.0.0.1:11811", host_and_port);
  const std::string host = host_and_port.substr(0, colon);
  addrinfo hints{};
  hints.ai_family = AF_INET;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(host.c_str(), nullptr, &hints, &found); error != 0)
    throw InputError(
        fmt::format("--discovery-server {}: cannot find the host '{}': {}", host_and_port, host, gai_strerror(error)));
  endpoint.address = text(ipv4(found->ai_addr).sin_addr);
  freeaddrinfo(found);
  return endpoint;
}

void check_reachable(const Endpoint& endpoint, const std::vector<std::string>& interfaces) {
  const bool wanted = is_loopback(endpoint.address);
  if (std::any_of(interfaces.begin(), interfaces.end(),
                  [&](const std::string& address) { return is_loopback(address) == wanted; }))
    return;
  throw InputError(
      wanted ? fmt::format("--discovery-server {}:{} is on the loopback interface, which is not used here; give the "
                           "server's address on the network, or add --interface 127.0.0.1",
                           endpoint.address, endpoint.port)
             : fmt::format("--discovery-server {}:{} is not on the loopback interface, and nothing else is used unless "
                           "you say so; add --interface with the address or name of the interface that leads there",
                           endpoint.address, endpoint.port));
}

void check_can_listen(const Endpoint& endpoint) {
  const int socket_fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(endpoint.port);
  inet_pton(AF_INET, endpoint.address.c_str(), &address.sin_addr);
  sockaddr generic{};
  std::memcpy(&generic, &address, sizeof generic);
  const int error = bind(socket_fd, &generic, sizeof generic) == 0 ? 0 : errno;
  close(socket_fd);
  if (error != 0)
    throw InputError(
        fmt::format("cannot listen on {}:{}: {}; every run needs a port of its own, on an address of this machine",
                    endpoint.address, endpoint.port, std::generic_category().message(error)));
}

}  // namespace aloft::bus
