// Turns the trials of a worker into worlds.
#include "services/environment/environment.hpp"
#include "services/runtime/service.hpp"

int main(int argc, char** argv) {
  using namespace aloft;
  const runtime::ServiceInfo info{
      .name = "aloft-environment", .description = "Makes the worlds that a worker's UAVs fly in.", .in_worker = true};
  return runtime::run_service(argc, argv, info, {},
                              [](runtime::Service& service) { environment::make_worlds(service.bus, service.stop); });
}
