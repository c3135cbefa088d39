// Round trip of a report and its command, through common/bus and with the middleware alone: in one run, in turns, with
// the same types, quality of service and transport. The ratio is the cost of our layer.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fastdds/dds/core/condition/StatusCondition.hpp>
#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <idl/type_supports.hpp>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "common/bus/detail.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/middleware/sample_writer.hpp"
#include "common/bus/waiter.hpp"

namespace aloft {
namespace {

namespace dds = bus::dds;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr int pings_per_turn = 100;

bus::BusOptions place(const char* process, bool guarded = true) {
  return {.run = "bus-benchmark-" + std::to_string(getpid()),
          .worker = guarded ? "w0" : "w1",
          .process = process,
          .domain = 10 + static_cast<int>(getpid() % 90),
          .guarded = guarded};
}

wire::ChannelReport example_report() {
  wire::ChannelReport report;
  report.protocol_version(wire::PROTOCOL_VERSION);
  report.experiment_id(wire::experiment_id("0123456789abcdef"));
  report.agent(wire::name("one-step-ahead"));
  report.height_max_m(240);
  report.height_step_m(10);
  report.steps(100);
  report.neighbour_sinr_db({5, 4, 3, 2});
  return report;
}

wire::HeightCommand example_command() {
  wire::HeightCommand command;
  command.protocol_version(wire::PROTOCOL_VERSION);
  command.agent(wire::name("one-step-ahead"));
  command.step(1);
  command.action(wire::ACTION_UP);
  return command;
}

/// Ping and pong through common/bus, each in its own participant.
class BusPair {
 public:
  explicit BusPair(bool guarded = true) : guarded_(guarded), echo_([this] { echo(); }) {
    waiter_.add(commands_);
    while (commands_.matched() == 0 || reports_.matched() == 0) std::this_thread::sleep_for(1ms);
    std::this_thread::sleep_for(200ms);
  }
  ~BusPair() {
    stop_ = true;
    echo_.join();
  }
  BusPair(const BusPair&) = delete;
  BusPair& operator=(const BusPair&) = delete;

  void ping() {
    reports_.write(report_);
    while (!commands_.take(command_)) waiter_.wait(1000ms);
  }

 private:
  void echo() {
    const bus::Participant there(place("pong", guarded_));
    bus::Reader<wire::ChannelReport> reports(there);
    bus::Writer<wire::HeightCommand> commands(there);
    bus::Waiter waiter;
    waiter.add(reports);
    wire::ChannelReport report;
    wire::HeightCommand command = example_command();
    while (!stop_) {
      waiter.wait(100ms);
      while (reports.take(report)) commands.write(command);
    }
  }

  bool guarded_;
  std::atomic<bool> stop_{false};
  std::thread echo_;
  bus::Participant here_{place("ping", guarded_)};
  bus::Writer<wire::ChannelReport> reports_{here_};
  bus::Reader<wire::HeightCommand> commands_{here_};
  bus::Waiter waiter_;
  wire::ChannelReport report_ = example_report();
  wire::HeightCommand command_;
};

/// The middleware alone. The endpoints are copies of those that common/bus makes, so that only our code differs.
struct BareEndpoint {
  template <class Out, class In, class OutType, class InType>
  static void make(const bus::Participant& participant, OutType*, InType*, const char* out, const char* in,
                   std::optional<bus::SampleWriter>& writer, dds::DataReader*& reader) {
    dds::DomainParticipant& p = *participant.state()->participant;
    const dds::TypeSupport out_type(new bus::GeneratedType<OutType>);
    const dds::TypeSupport in_type(new bus::GeneratedType<InType>);
    for (const dds::TypeSupport* type : {&out_type, &in_type}) type->register_type(&p, type->get_type_name() + "Bare");
    dds::Topic* out_topic = p.create_topic(out, out_type.get_type_name() + "Bare", dds::TOPIC_QOS_DEFAULT);
    dds::Topic* in_topic = p.create_topic(in, in_type.get_type_name() + "Bare", dds::TOPIC_QOS_DEFAULT);
    const bus::Writer<Out> model_writer(participant);
    const bus::Reader<In> model_reader(participant);
    auto& publisher = participant.state()->publisher(bus::Scope::worker);
    auto& subscriber = participant.state()->subscriber(bus::Scope::worker);
    std::vector<dds::DataReader*> readers;
    subscriber.get_datareaders(readers);
    writer.emplace(publisher, *out_topic, bus::SampleWriter::qos_of_one(publisher));
    reader = subscriber.create_datareader(in_topic, readers.front()->get_qos());
    reader->get_statuscondition().set_enabled_statuses(dds::StatusMask::data_available());
  }
};

template <class T>
bool bare_take(dds::DataReader& reader, T& sample) {
  dds::SampleInfo info;
  return bus::succeeded(reader.take_next_sample(&sample, &info));
}

class BarePair {
 public:
  BarePair() : echo_([this] { echo(); }) {
    BareEndpoint::make<wire::ChannelReport, wire::HeightCommand>(
        here_, static_cast<wire::ChannelReportPubSubType*>(nullptr),
        static_cast<wire::HeightCommandPubSubType*>(nullptr), "BareReport", "BareCommand", writer_, reader_);
    waits_.attach_condition(reader_->get_statuscondition());
    while (writer_->matched() == 0) std::this_thread::sleep_for(1ms);
    std::this_thread::sleep_for(200ms);
  }
  ~BarePair() {
    stop_ = true;
    echo_.join();
  }
  BarePair(const BarePair&) = delete;
  BarePair& operator=(const BarePair&) = delete;

  void ping() {
    dds::ConditionSeq active;
    if (!writer_->write(&report_)) throw std::runtime_error("the middleware refused a report");
    while (!bare_take(*reader_, command_)) waits_.wait(active, {1, 0});
  }

 private:
  void echo() {
    const bus::Participant there(place("bare-pong"));
    std::optional<bus::SampleWriter> writer;
    dds::DataReader* reader = nullptr;
    BareEndpoint::make<wire::HeightCommand, wire::ChannelReport>(
        there, static_cast<wire::HeightCommandPubSubType*>(nullptr),
        static_cast<wire::ChannelReportPubSubType*>(nullptr), "BareCommand", "BareReport", writer, reader);
    dds::WaitSet waits;
    waits.attach_condition(reader->get_statuscondition());
    dds::ConditionSeq active;
    wire::ChannelReport report;
    wire::HeightCommand command = example_command();
    while (!stop_) {
      waits.wait(active, {0, 100'000'000});
      while (bare_take(*reader, report))
        if (!writer->write(&command)) throw std::runtime_error("the middleware refused a command");
    }
  }

  std::atomic<bool> stop_{false};
  std::thread echo_;
  bus::Participant here_{place("bare-ping")};
  std::optional<bus::SampleWriter> writer_;
  dds::DataReader* reader_ = nullptr;
  dds::WaitSet waits_;
  wire::ChannelReport report_ = example_report();
  wire::HeightCommand command_;
};

template <class Pair>
void turn(Pair& pair, std::vector<double>& times_us) {
  for (int i = 0; i < pings_per_turn; ++i) {
    const auto start = Clock::now();
    pair.ping();
    times_us.push_back(std::chrono::duration<double, std::micro>(Clock::now() - start).count());
  }
}

double quantile(std::vector<double>& times, double p) {
  const auto at = times.begin() + static_cast<std::ptrdiff_t>(p * static_cast<double>(times.size() - 1));
  std::nth_element(times.begin(), at, times.end());
  return *at;
}

/// Round trips of two pairs, in turns.
template <class Ours, class Bare>
void compare(benchmark::State& state, Ours ours, Bare bare, const std::string& name) {
  std::vector<double> ours_us;
  std::vector<double> bare_us;
  for ([[maybe_unused]] auto _ : state) {
    turn(*ours, ours_us);
    turn(*bare, bare_us);
  }
  state.counters[name + "_p50_us"] = quantile(ours_us, 0.5);
  state.counters[name + "_p99_us"] = quantile(ours_us, 0.99);
  state.counters["bare_p50_us"] = quantile(bare_us, 0.5);
  state.counters["bare_p99_us"] = quantile(bare_us, 0.99);
  state.counters["ratio_p50"] = quantile(ours_us, 0.5) / quantile(bare_us, 0.5);
}

/// Our layer and the middleware alone; goal: a ratio of at most 1.3.
void bus_round_trip(benchmark::State& state) {
  compare(state, std::make_unique<BusPair>(), std::make_unique<BarePair>(), "bus");
}
BENCHMARK(bus_round_trip)->Iterations(50)->Unit(benchmark::kMillisecond);

/// With and without the guard before the middleware; goal: a ratio of at most 1.03.
void guard_round_trip(benchmark::State& state) {
  compare(state, std::make_unique<BusPair>(), std::make_unique<BusPair>(false), "guarded");
}
BENCHMARK(guard_round_trip)->Iterations(200)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace aloft
