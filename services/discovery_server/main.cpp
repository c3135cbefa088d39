// Introduces the processes of a run to each other where multicast does not reach.
#include <spdlog/spdlog.h>

#include <chrono>

#include "common/base/error.hpp"
#include "common/bus/middleware/lease.hpp"
#include "common/bus/waiter.hpp"
#include "services/runtime/service.hpp"

int main(int argc, char** argv) {
  using namespace aloft;
  const runtime::ServiceInfo info{
      .name = "aloft-discovery-server",
      .description = "Introduces the processes of one run to each other, across hosts. Listens on --discovery-server."};
  return runtime::run_service(argc, argv, info, {}, [](runtime::Service& service) {
    if (service.bus.discovery_server.empty())
      throw InputError("--discovery-server ADDRESS:PORT is missing: where to listen, an address of this machine");
    service.bus.serves_discovery = true;
    bus::Waiter waiter(service.stop);
    // If this server replaces one that has just died, its clients must notice that first: only then do they introduce
    // themselves again.
    waiter.wait(bus::served_lease + std::chrono::seconds(1));
    const bus::Participant participant(service.bus);
    spdlog::info("serves discovery on {}", service.bus.discovery_server);
    service.notifier.ready("serves discovery on " + service.bus.discovery_server);
    while (!service.stop.requested()) {
      waiter.wait(std::chrono::seconds(1));
      service.notifier.alive();
    }
  });
}
