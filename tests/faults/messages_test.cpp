// Invalid messages, which no process of Aloft sends, into a running system: they are dropped and counted, and the run
// ends with the same bytes as in one process.
#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <functional>
#include <idl/type_supports.hpp>
#include <optional>
#include <thread>

#include "common/base/random.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/testing/sample_limits.hpp"
#include "common/store/result_store.hpp"
#include "tests/faults/attacker.hpp"
#include "tests/faults/effort.hpp"
#include "tests/faults/fault_scene.hpp"
#include "tests/faults/rogue.hpp"

using namespace aloft;
using namespace aloft::test;
using namespace std::chrono_literals;

namespace {

// The unit test has larger samples.
constexpr std::size_t largest_sample_bytes = 5U << 20U;

/// A run with one worker and a stranger among its processes.
class Pestered {
 public:
  Pestered() {
    run_ = scene_.start("pestered", {"--workers", "1", "--run", name_});
    scene_.wait_for_flights("pestered", *run_, 1);
  }

  /// Sends every kind of bad sample, and checks that the readers in the table of topics have dropped them.
  template <class T, class Generated>
  void send() {
    Rogue<T, Generated> rogue(participant_);
    T sample = bus::testing::SampleLimits<T>::good();
    const std::string topic(bus::topic_settings<T>().name);
    const std::vector<std::string> readers = readers_of(bus::topic_settings<T>());
    INFO(topic);
    // Topics that no process of a run reads are read by the test, as an operator's command would.
    const bus::Participant here(place());
    std::optional<bus::Reader<T>> own;
    if (readers.empty()) own.emplace(here);
    REQUIRE(eventually(30s, [&] { return rogue.matched() >= std::max<std::size_t>(1, readers.size()); }));
    const auto counted = [&](const std::string& kind) {
      if (!own) return true;
      own->drain([](const T&) {});
      const bus::Drops drops = own->drops();
      return (kind == "a foreign" ? drops.foreign : kind == "an invalid" ? drops.invalid : drops.malformed) > 0;
    };
    const auto told = [&](const std::string& reader, const char* kind) {
      const std::string line = fmt::format("{}: dropped {} sample", topic, kind);
      return scene_.log("pestered", reader).find(line) != std::string::npos;
    };
    // Readers of some topics keep only the latest sample, so one kind is sent at a time, until it was counted.
    const auto send_until_told = [&](const char* kind, const std::function<void()>& write) {
      const bool all_told = eventually(30s, [&] {
        write();
        std::this_thread::sleep_for(50ms);
        return counted(kind) &&
               std::all_of(readers.begin(), readers.end(), [&](const auto& reader) { return told(reader, kind); });
      });
      INFO(kind);
      CHECK(all_told);
    };
    T newer = sample;
    newer.protocol_version(wire::PROTOCOL_VERSION + 1);
    sample.protocol_version(wire::PROTOCOL_VERSION);
    T other = newer;
    if constexpr (requires { sample.experiment_id(); }) {
      other = sample;
      other.experiment_id(wire::experiment_id("0123456789abcdef"));
      sample.experiment_id(wire::experiment_id(experiment_id_));
    }
    send_until_told("a foreign", [&] {
      rogue.write(newer);
      rogue.write(other);
    });
    send_until_told("an invalid", [&] {
      for (const auto& [what, spoil] : bus::testing::SampleLimits<T>::spoilers()) {
        T bad = sample;
        spoil(bad);
        if (rogue.bytes_of(bad).size() < largest_sample_bytes) rogue.write(bad);
      }
    });
    const std::vector<unsigned char> whole = Rogue<T, Generated>::bytes_of(newer);
    std::vector<unsigned char> longer = whole;
    longer.resize(whole.size() + 40);
    std::vector<unsigned char> noise(300, 0xFF);
    std::copy_n(whole.begin(), 4, noise.begin());  // its encapsulation: the guard refuses any other
    const std::vector<std::vector<unsigned char>> malformed{
        {0, 1, 0, 0}, {whole.begin(), whole.begin() + static_cast<long>(whole.size() / 2)}, noise, longer};
    send_until_told("a malformed", [&] {
      for (const auto& bytes : malformed) rogue.write_bytes(newer, bytes);
    });
  }

  void check_finished() { scene_.check_finished("pestered", *run_, 120s); }

  [[nodiscard]] bus::BusOptions place() const {
    return {.run = name_, .worker = "w0", .process = "rogue", .domain = std::stoi(test_domain())};
  }

 private:
  /// The processes by the names of their logs.
  static std::vector<std::string> readers_of(const bus::TopicSettings& topic) {
    using bus::Role;
    std::vector<std::string> readers;
    for (const Role role : {Role::coordinator, Role::metrics})
      if (topic.readers.contain(role)) readers.push_back(fmt::format("aloft-{}", to_text(role)));
    for (const Role role : {Role::environment, Role::channel, Role::learning_agent, Role::baseline_agent})
      if (topic.readers.contain(role)) readers.push_back(fmt::format("aloft-{}-w0", to_text(role)));
    // No agent that does not learn remembers earlier flights.
    if (topic.name == "StoredMemory") std::erase(readers, "aloft-baseline-agent-w0");
    return readers;
  }

  FaultScene scene_{200};  // trials: the run must last longer than the test
  std::string name_ = own_name("pestered");
  std::string experiment_id_ = store::ResultStore::open_for_reading(scene_.out("reference")).experiment().id;
  bus::Participant participant_{place()};
  std::unique_ptr<Command> run_;
};

/// Random bytes, and datagrams that begin like RTPS messages.
class Garbage {
 public:
  explicit Garbage(int domain) : attacker_(domain) {}

  void send(int datagrams) {
    constexpr int ports = 40;  // of both multicast sockets and of 14 processes
    for (int i = 0; i < datagrams; ++i) {
      std::vector<unsigned char> bytes(1 + random_.uniform_index(1400));
      for (std::size_t at = 0; at < bytes.size(); at += 4) {
        const std::uint32_t word = random_.next_u32();
        std::memcpy(bytes.data() + at, &word, std::min<std::size_t>(4, bytes.size() - at));
      }
      if (i % 2 == 1) look_like_rtps(bytes);
      attacker_.send_to(i % ports, bytes);
    }
  }

 private:
  /// A valid header, then submessages of known kinds with random content.
  void look_like_rtps(std::vector<unsigned char>& bytes) {
    constexpr std::array<unsigned char, 8> header{'R', 'T', 'P', 'S', 2, 2, 1, 15};
    constexpr std::array<unsigned char, 12> kinds{0x01, 0x06, 0x07, 0x08, 0x09, 0x0c,
                                                  0x0d, 0x0e, 0x0f, 0x12, 0x15, 0x16};
    std::copy_n(header.begin(), std::min(header.size(), bytes.size()), bytes.begin());
    for (std::size_t at = 20; at + 4 <= bytes.size();) {
      const std::uint32_t length = random_.uniform_index(200);
      bytes[at] = kinds.at(random_.uniform_index(kinds.size()));
      bytes[at + 1] |= 1U;  // little endian
      bytes[at + 2] = static_cast<unsigned char>(length);
      bytes[at + 3] = 0;
      at += 4 + length;
    }
  }

  Attacker attacker_;
  RandomStream random_{17, 0, "garbage"};
};

}  // namespace

TEST_CASE("bad samples on every topic are dropped and counted, and change nothing", "[messages]") {
  Pestered run;
#define ALOFT_TOPIC(type, ...) run.send<wire::type, wire::type##PubSubType>();
#include "common/bus/topics.def"
  run.check_finished();
}

TEST_CASE("100,000 garbage datagrams at the ports of every process", "[messages]") {
  const FaultScene scene(effort(120, 300));
  const std::string name = "garbage";
  const auto run = scene.start(name, {"--workers", "2"});
  scene.wait_for_flights(name, *run, scene.flights() / 8);
  HeldRun held(scene, name, *run);
  Garbage(std::stoi(test_domain())).send(100'000);
  held.check_growth("garbage");
  held.go_on();
  scene.check_finished(name, *run, 120s);
  CHECK(run->error_so_far().find("starting it again") == std::string::npos);
}
