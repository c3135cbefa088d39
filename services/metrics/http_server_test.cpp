#include "services/metrics/http_server.hpp"

#include <httplib.h>

#include <catch2/catch.hpp>

#include "common/base/error.hpp"
#include "services/metrics/instruments.hpp"

using namespace aloft::metrics;

TEST_CASE("the server answers its routes on loopback", "[http]") {
  HttpServer server("127.0.0.1", 0,
                    {{"/healthz",
                      [] {
                        return HttpResponse{200, "text/plain", "ok\n"};
                      }},
                     {"/broken", [] {
                        return HttpResponse{503, "text/plain", "stalled\n"};
                      }}});
  REQUIRE(server.port() > 0);
  httplib::Client client("127.0.0.1", server.port());
  const auto health = client.Get("/healthz");
  REQUIRE(health);
  CHECK(health->status == 200);
  CHECK(health->body == "ok\n");
  CHECK(client.Get("/broken")->status == 503);
  CHECK(client.Get("/nothing")->status == 404);
}

TEST_CASE("a taken port is a clear error", "[http]") {
  const HttpServer first("127.0.0.1", 0, {});
  CHECK_THROWS_AS(HttpServer("127.0.0.1", first.port(), {}), aloft::InputError);
}

TEST_CASE("instruments read as Prometheus text", "[http]") {
  Instruments instruments;
  instruments.stored(100);
  instruments.stored(70);
  instruments.rejected(Rejection::bad_trace);
  instruments.committed(0.002);
  instruments.set_paused(true);
  instruments.set_progress(640, 4);
  const std::string text = instruments.prometheus_text();
  for (const char* line :
       {"aloft_flights_stored_total 2\n", "aloft_steps_stored_total 170\n",
        "aloft_records_rejected_total{reason=\"bad_trace\"} 1\n",
        "aloft_records_rejected_total{reason=\"unknown_flight\"} 0\n",
        "aloft_store_commit_seconds_bucket{le=\"0.001\"} 0\n", "aloft_store_commit_seconds_bucket{le=\"0.003\"} 1\n",
        "aloft_store_paused 1\n", "aloft_flights_total 640\n", "aloft_workers_alive 4\n"})
    CHECK_THAT(text, Catch::Contains(line));
}
