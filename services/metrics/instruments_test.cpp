#include "services/metrics/instruments.hpp"

#include <catch2/catch.hpp>

#include "common/bus/answer_times.hpp"

using namespace aloft;
using namespace aloft::metrics;
using Catch::Contains;

TEST_CASE("answer times fall into the bucket that they do not exceed", "[metrics]") {
  CHECK(bus::answer_bucket(0.0) == 0);
  CHECK(bus::answer_bucket(20e-6) == 0);
  CHECK(bus::answer_bucket(21e-6) == 1);
  CHECK(bus::answer_bucket(1.0) == 14);
  CHECK(bus::answer_bucket(1.1) == 15);

  bus::AnswerCounts counts{};
  CHECK(std::isnan(bus::answered_within_s(counts, 0.5)));
  counts[1] = 98;  // up to 50 us
  counts[8] = 2;   // 10 ms
  CHECK(bus::answered_within_s(counts, 0.5) == 50e-6);
  CHECK(bus::answered_within_s(counts, 0.98) == 50e-6);
  CHECK(bus::answered_within_s(counts, 0.99) == 10e-3);
  counts[15] = 1000;
  CHECK(bus::answered_within_s(counts, 0.99) == INFINITY);
}

TEST_CASE("datagrams that the guard refuses are told by reason", "[metrics]") {
  metrics::Instruments instruments;
  bus::RefusalCounts counts{};
  counts.at(static_cast<std::size_t>(bus::Refusal::gap)) = 3;
  instruments.set_datagrams_refused(counts);
  const std::string text = instruments.prometheus_text();
  CHECK_THAT(text, Contains("aloft_datagrams_refused{reason=\"gap\"} 3\n"));
  CHECK_THAT(text, Contains("aloft_datagrams_refused{reason=\"header\"} 0\n"));
  CHECK(text.find("reason=\"none\"") == std::string::npos);
}

TEST_CASE("the histogram of answer times grows by what each worker has counted since its last status", "[metrics]") {
  metrics::Instruments instruments;
  bus::AnswerCounts counts{};
  counts[1] = 3;
  instruments.answered("w0", 1, counts, 0.1);
  instruments.answered("w0", 1, counts, 0.1);  // the same status again
  counts[8] = 1;
  instruments.answered("w0", 1, counts, 0.25);
  instruments.answered("w1", 7, counts, 0.25);
  CHECK_THAT(instruments.prometheus_text(), Contains("aloft_answer_seconds_bucket{le=\"5e-05\"} 6\n") &&
                                                Contains("aloft_answer_seconds_bucket{le=\"0.01\"} 8\n") &&
                                                Contains("aloft_answer_seconds_count 8\n") &&
                                                Contains("aloft_answer_seconds_sum 0.5\n"));

  bus::AnswerCounts anew{};
  anew[1] = 1;
  instruments.answered("w0", 2, anew, 0.0);                 // restarted: counts from zero
  instruments.answered("w0", 2, bus::AnswerCounts{}, 0.0);  // an older status
  CHECK_THAT(instruments.prometheus_text(), Contains("aloft_answer_seconds_count 9\n"));
}

TEST_CASE("instruments read as Prometheus text") {
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
    CHECK_THAT(text, Contains(line));
}
