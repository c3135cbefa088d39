// Datagrams that were captured from a run, then mutated, at the ports of another run: the same bytes as in one process.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <thread>
#include <vector>

#include "common/base/random.hpp"
#include "tests/faults/attacker.hpp"
#include "tests/faults/effort.hpp"
#include "tests/faults/fault_scene.hpp"
#include "tests/paths.hpp"

using namespace aloft;
using namespace aloft::test;
using namespace std::chrono_literals;

namespace {

using Bytes = std::vector<unsigned char>;

/// The datagrams in a file of bad_network.cpp: each after its size in two bytes, low byte first.
std::vector<Bytes> read_record(const std::filesystem::path& file) {
  const std::string text = read_text(file);
  std::vector<Bytes> datagrams;
  for (std::size_t at = 0; at + 2 <= text.size();) {
    const std::size_t size = static_cast<unsigned char>(text[at]) + 256U * static_cast<unsigned char>(text[at + 1]);
    if (size > text.size() - at - 2) break;
    datagrams.emplace_back(text.begin() + static_cast<long>(at + 2), text.begin() + static_cast<long>(at + 2 + size));
    at += 2 + size;
  }
  return datagrams;
}

/// Changes captured datagrams in one to four places, and sends them to the ports of all processes of a domain.
class Mutations {
 public:
  Mutations(std::vector<Bytes> captured, int domain) : captured_(std::move(captured)), attacker_(domain) {}

  void send(int count) {
    constexpr int ports = 40;       // of both multicast sockets and of 14 processes
    constexpr int at_a_time = 100;  // more would overflow the receivers' buffers, and never be looked at
    for (int i = 0; i < count; ++i) {
      Bytes bytes = any();
      for (std::uint32_t left = 1 + random_.uniform_index(4); left > 0; --left) mutate(bytes);
      attacker_.send_to(i % ports, bytes);
      if (i % at_a_time == 0) std::this_thread::sleep_for(1ms);
    }
  }

 private:
  const Bytes& any() { return captured_[random_.uniform_index(static_cast<std::uint32_t>(captured_.size()))]; }
  std::size_t place(const Bytes& bytes) { return random_.uniform_index(static_cast<std::uint32_t>(bytes.size())); }

  void mutate(Bytes& bytes) {
    constexpr std::uint32_t words[] = {0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0x10000, 0x7FFF};
    constexpr std::size_t header_bytes = 20;
    const std::size_t at = place(bytes);
    switch (random_.uniform_index(6)) {
      case 0:
        bytes[at] = static_cast<unsigned char>(bytes[at] ^ 1U << random_.uniform_index(8));
        break;
      case 1:
        bytes[at] = static_cast<unsigned char>(random_.uniform_index(256));
        break;
      case 2: {
        const std::uint32_t word = words[random_.uniform_index(std::size(words))];
        std::memcpy(bytes.data() + at, &word, std::min(sizeof word, bytes.size() - at));
        break;
      }
      case 3:
        bytes.resize(std::max(at, header_bytes));
        break;
      case 4: {  // a part twice
        const Bytes part(bytes.begin() + static_cast<long>(at), bytes.end());
        bytes.insert(bytes.end(), part.begin(), part.end());
        break;
      }
      default: {  // the submessages of another one
        const Bytes& other = any();
        if (other.size() > header_bytes) bytes.insert(bytes.end(), other.begin() + header_bytes, other.end());
      }
    }
    constexpr std::size_t largest_datagram_bytes = 60'000;
    if (bytes.size() > largest_datagram_bytes) bytes.resize(largest_datagram_bytes);
  }

  std::vector<Bytes> captured_;
  Attacker attacker_;
  RandomStream random_{29, 0, "mutations"};
};

}  // namespace

TEST_CASE("mutated datagrams of another run change nothing", "[messages]") {
  const FaultScene scene(effort(120, 600));
  const std::string record = (scene.out("datagrams")).string();
  {
    const Variable preload("LD_PRELOAD", (bin_dir().parent_path() / "lib/libaloft_bad_network.so").string());
    const Variable into("ALOFT_TEST_RECORD", record);
    const auto run = scene.start("recorded", {"--workers", "2"});
    scene.check_finished("recorded", *run, 240s);
  }
  std::vector<Bytes> captured = read_record(record);
  REQUIRE(captured.size() > 10'000);
  Mutations mutations(std::move(captured), std::stoi(test_domain()));

  const std::string name = "mutated";
  const auto run = scene.start(name, {"--workers", "2"});
  scene.wait_for_flights(name, *run, scene.flights() / 8);
  const int datagrams = effort(20'000, 1'000'000);
  const int in_flight = datagrams / 20;
  mutations.send(in_flight);
  REQUIRE(run->running());
  HeldRun held(scene, name, *run);
  mutations.send(datagrams - in_flight);
  held.check_growth("mutated datagrams");
  held.go_on();
  scene.check_finished(name, *run, 240s);
  CHECK(run->error_so_far().find("starting it again") == std::string::npos);
}
