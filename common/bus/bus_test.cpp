// Writers and readers over the real transport, each in its own participant.
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <future>
#include <idl/type_supports.hpp>
#include <limits>
#include <map>
#include <thread>

#include "common/base/error.hpp"
#include "common/bus/detail.hpp"
#include "common/bus/endpoint.hpp"
#include "common/bus/testing/sample_limits.hpp"
#include "common/bus/waiter.hpp"
#include "tests/faults/rogue.hpp"
#include "tests/paths.hpp"

namespace aloft {
namespace {

namespace dds = bus::dds;
using namespace std::chrono_literals;
using Catch::Contains;

constexpr auto limit = 10s;

/// A place on the bus that no other test process shares.
bus::BusOptions place(const std::string& process, const std::string& worker = "w0") {
  bus::BusOptions options;
  options.run = "bus-test-" + std::to_string(getpid());
  options.worker = worker;
  options.process = process;
  options.domain = 10 + static_cast<int>(getpid() % 90);
  options.lease = 5s;  // the test machine may be busy
  return options;
}

template <class Condition>
bool eventually(Condition condition) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (std::chrono::steady_clock::now() < deadline) {
    if (condition()) return true;
    std::this_thread::sleep_for(2ms);
  }
  return condition();
}

wire::HeightCommand command(std::uint32_t stream, std::uint32_t step) {
  wire::HeightCommand message;
  message.stream(stream);
  message.episode_id(77);
  message.attempt(1);
  message.step(step);
  message.agent(wire::name("constant-120"));
  message.action(wire::ACTION_UP);
  message.has_introspection(true);
  message.epsilon(0.25);
  message.q_values({1.5, -2.5, 3.25});
  return message;
}

template <class T>
bool take_within(bus::Reader<T>& reader, T& sample) {
  bus::Waiter waiter;
  waiter.add(reader);
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!reader.take(sample)) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    waiter.wait(100ms);
  }
  return true;
}

}  // namespace

TEST_CASE("a sample arrives whole") {
  const bus::Participant here(place("here"));
  const bus::Participant there(place("there"));
  bus::Writer<wire::HeightCommand> writer(here);
  bus::Reader<wire::HeightCommand> reader(there);
  REQUIRE(eventually([&] { return writer.matched() == 1 && reader.matched() == 1; }));
  writer.write(command(5, 3));
  wire::HeightCommand sample;
  REQUIRE(take_within(reader, sample));
  CHECK(sample.protocol_version() == wire::PROTOCOL_VERSION);
  CHECK(sample.stream() == 5);
  CHECK(sample.episode_id() == 77);
  CHECK(sample.step() == 3);
  CHECK(wire::view(sample.agent()) == "constant-120");
  CHECK(sample.action() == wire::ACTION_UP);
  CHECK(sample.epsilon() == 0.25);
  CHECK(sample.q_values() == std::array{1.5, -2.5, 3.25});
  CHECK_FALSE(reader.take(sample));
  CHECK(there.drops() == 0);
}

TEST_CASE("a late joiner gets the state, and one sample of a megabyte arrives in fragments") {
  const bus::Participant here(place("here"));
  bus::Writer<wire::RunControl> writer(here);
  wire::RunControl control;
  control.experiment_id(wire::experiment_id("0123456789abcdef"));
  control.state(wire::RUN_RUNNING);
  std::string text(1048576, ' ');
  for (std::size_t i = 0; i < text.size(); ++i) text[i] = static_cast<char>('a' + i % 23);
  control.experiment_json(wire::bytes(text));
  writer.write(control);

  const bus::Participant there(place("there"));
  bus::Reader<wire::RunControl> reader(there);
  wire::RunControl sample;
  REQUIRE(take_within(reader, sample));
  CHECK(wire::view(sample.experiment_json()) == text);
  CHECK(wire::view(sample.experiment_id()) == "0123456789abcdef");
}

TEST_CASE("samples of other writers do not displace the coordinator's, and the writer of each sample is known") {
  const bus::Participant coordinator(place("the-coordinator"));
  const bus::Participant stranger(place("a-stranger"));
  const bus::Participant there(place("there"));
  bus::Writer<wire::RunControl> ours(coordinator);
  bus::Writer<wire::RunControl> theirs(stranger);
  bus::Reader<wire::RunControl> reader(there);
  REQUIRE(eventually([&] { return ours.matched() == 1 && theirs.matched() == 1 && reader.matched() == 2; }));
  wire::RunControl control;
  control.experiment_id(wire::experiment_id("0123456789abcdef"));
  ours.write(control);
  REQUIRE(ours.wait_acknowledged(limit));
  control.experiment_id(wire::experiment_id("somebody's"));
  for (int i = 0; i < 10; ++i) {
    theirs.write(control);
    REQUIRE(theirs.wait_acknowledged(limit));
  }
  std::map<std::string, int> samples;
  std::string sender;
  reader.drain([&](const wire::RunControl& sample) {
    if (wire::view(sample.experiment_id()) == "0123456789abcdef") sender = reader.sender();
    ++samples[reader.sender()];
  });
  CHECK_THAT(sender, Contains("'the-coordinator-w0' at 127.0.0.1 ("));
  CHECK(samples.size() == 2);
  CHECK(samples[sender] == 1);
}

TEST_CASE("many keys: none is lost, whatever the middleware's default limit of ten") {
  const bus::Participant here(place("here"));
  const bus::Participant there(place("there"));
  bus::Writer<wire::HeightCommand> writer(here);
  bus::Reader<wire::HeightCommand> reader(there);
  REQUIRE(eventually([&] { return writer.matched() == 1 && reader.matched() == 1; }));
  const std::uint32_t keys = GENERATE(11U, 100U);
  for (std::uint32_t stream = 0; stream < keys; ++stream) writer.write(command(stream, stream + 1));
  std::map<std::uint32_t, std::uint32_t> seen;
  CHECK(eventually([&] {
    reader.drain([&](const wire::HeightCommand& sample) { seen[sample.stream()] = sample.step(); });
    return seen.size() == keys;
  }));
  for (const auto& [stream, step] : seen) CHECK(step == stream + 1);
}

TEST_CASE("who looks on finds all that came between two looks, and the writer waits for no acknowledgement") {
  const bus::Participant agent(place("agent"));
  const bus::Participant viewer(place("viewer"));
  bus::Writer<wire::HeightCommand> commands(agent);
  bus::Reader<wire::HeightCommand> looking_on(viewer, {.looks_on = true});
  bus::Reader<wire::HeightCommand> asked(viewer);
  REQUIRE(eventually([&] { return commands.matched() == 2 && looking_on.matched() == 1 && asked.matched() == 1; }));
  constexpr std::uint32_t steps = 200;
  for (std::uint32_t step = 1; step <= steps; ++step) commands.write(command(3, step));
  REQUIRE(commands.wait_acknowledged(limit));  // by the other reader: everything has been sent
  std::uint32_t last = 0;
  std::size_t seen = 0;
  CHECK(eventually([&] {
    looking_on.drain([&](const wire::HeightCommand& message) {
      last = message.step();
      ++seen;
    });
    return last == steps;
  }));
  CHECK(seen == steps);
  std::size_t kept = 0;
  asked.drain([&](const wire::HeightCommand&) { ++kept; });
  CHECK(kept <= 8);
}

TEST_CASE("more keys than the table of topics allows are refused, not lost silently") {
  const bus::Participant here(place("here"));
  bus::Writer<wire::HeightCommand> writer(here);
  const auto allowed = static_cast<std::uint32_t>(bus::topic_settings<wire::HeightCommand>().keys);
  for (std::uint32_t stream = 0; stream < allowed; ++stream) writer.write(command(stream, 1));
  CHECK_THROWS_WITH(writer.write(command(allowed, 1)), Contains("HeightCommand") && Contains("stream out of range"));

  bus::Writer<wire::WorkerStatus> statuses(here);
  wire::WorkerStatus status;
  for (int worker = 0; worker < bus::topic_settings<wire::WorkerStatus>().keys; ++worker) {
    status.worker(wire::name("w" + std::to_string(worker)));
    statuses.write(status);
  }
  status.worker(wire::name("one-too-many"));
  CHECK_THROWS_WITH(statuses.write(status), Contains("WorkerStatus") && Contains("1024"));
}

TEST_CASE("samples that break the limits of the wire are not written") {
  const bus::Participant here(place("here"));
  bus::Writer<wire::HeightProfile> profiles(here);
  wire::HeightProfile profile;
  profile.step(1);
  profile.height_min_m(40);
  profile.resolution_m(1);
  profile.qos().assign(4097, 1.0);
  CHECK_THROWS_WITH(profiles.write(profile), Contains("HeightProfile") && Contains("qos has a wrong length"));
  profile.qos().assign(201, std::numeric_limits<double>::quiet_NaN());
  CHECK_THROWS_AS(profiles.write(profile), std::invalid_argument);
  CHECK_THROWS_AS(wire::name(std::string(65, 'x')), std::length_error);
  CHECK(wire::view(wire::name(std::string(64, 'x'))) == std::string(64, 'x'));
}

TEST_CASE("samples of another experiment are dropped and counted") {
  const bus::Participant here(place("here"));
  const bus::Participant there(place("there"));
  bus::Writer<wire::EpisodeStored> writer(here);
  bus::Reader<wire::EpisodeStored> reader(there);
  reader.expect_experiment("mine");
  REQUIRE(eventually([&] { return writer.matched() == 1 && reader.matched() == 1; }));
  wire::EpisodeStored stored;
  stored.digest(std::string(64, 'a'));
  for (const char* id : {"other", "mine"}) {
    stored.experiment_id(wire::experiment_id(id));
    writer.write(stored);
  }
  wire::EpisodeStored sample;
  REQUIRE(take_within(reader, sample));
  CHECK(wire::view(sample.experiment_id()) == "mine");
  CHECK(reader.drops().foreign == 1);
  CHECK(there.drops() == 1);
}

namespace {

using Payload = bus::rtps::SerializedPayload_t;
using RogueCommands = test::Rogue<wire::HeightCommand, wire::HeightCommandPubSubType>;

std::vector<unsigned char> serialized(wire::HeightCommand sample) {
  sample.protocol_version(wire::PROTOCOL_VERSION);
  return RogueCommands::bytes_of(sample);
}

}  // namespace

TEST_CASE("the settings in deploy/dds make a program on this middleware a client of the discovery server") {
  const std::string generation = bus::middleware().substr(std::strlen("Fast DDS "), 1);
  const auto file = test::source_dir() / "deploy/dds" / ("fastdds" + generation + "-discovery-client.xml");
  auto& factory = *dds::DomainParticipantFactory::get_instance();
  REQUIRE(bus::succeeded(factory.load_XML_profiles_file(file.string())));
  dds::DomainParticipantQos qos;
  REQUIRE(bus::succeeded(factory.get_participant_qos_from_profile("aloft", qos)));

  dds::WireProtocolConfigQos wanted;
  bus::rtps::Locator_t server;
  server.kind = LOCATOR_KIND_UDPv4;
  bus::rtps::IPLocator::setIPv4(server, "10.0.0.1");
  bus::rtps::IPLocator::setPhysicalPort(server, 11811);
  bus::ask_discovery_server(server, bus::server_prefix, wanted);
  const auto& discovery = qos.wire_protocol().builtin.discovery_config;
  CHECK(discovery.discoveryProtocol == wanted.builtin.discovery_config.discoveryProtocol);
  CHECK(discovery.m_DiscoveryServers == wanted.builtin.discovery_config.m_DiscoveryServers);
  CHECK_FALSE(qos.transport().use_builtin_transports);
  CHECK(qos.transport().user_transports.size() == 1);
}

TEST_CASE("a process knows the middleware of the processes of a run") {
  const bus::Participant observer(place("observer"));
  const bus::Participant there(place("there"));
  const bus::Writer<wire::HeightCommand> writer(there);
  CHECK_THAT(bus::middleware(), Contains("Fast DDS "));
  CHECK(eventually(
      [&] { return observer.middleware_of(there.options().run) == std::vector<std::string>{bus::middleware()}; }));
  CHECK(observer.middleware_of("another").empty());
}

TEST_CASE("malformed and out-of-range payloads are dropped and counted; good ones still arrive") {
  const bus::Participant there(place("there"));
  bus::Reader<wire::HeightCommand> reader(there);

  const bus::Participant raw(place("raw"));
  RogueCommands writer(raw);
  // Both sides must know each other: a volatile sample goes only to readers that its writer knows.
  REQUIRE(eventually([&] { return reader.matched() == 1 && writer.matched() == 1; }));

  const std::vector<unsigned char> good = serialized(command(9, 1));
  std::vector<std::vector<unsigned char>> bad;
  bad.push_back({0, 1, 0, 0});                        // a header alone
  bad.emplace_back(good.begin(), good.begin() + 20);  // cut off
  bad.emplace_back(300, 0xFF);                        // noise
  std::copy_n(good.begin(), 4, bad.back().begin());   // that is said to be CDR
  bad.push_back(good);                                // trailing bytes
  bad.back().resize(good.size() + 40, 0);
  wire::HeightCommand nan = command(9, 2);
  nan.action(wire::ACTION_ABSOLUTE);
  nan.height_m(std::numeric_limits<double>::quiet_NaN());
  wire::HeightCommand action = command(9, 2);
  action.action(static_cast<wire::Action>(99));
  for (const auto& sample : {nan, action}) bad.push_back(serialized(sample));
  for (const auto& bytes : bad) writer.write_bytes(command(9, 2), bytes);
  writer.write_bytes(command(9, 2), good);

  wire::HeightCommand sample;
  REQUIRE(take_within(reader, sample));
  CHECK(sample.stream() == 9);
  CHECK(sample.step() == 1);
  CHECK_FALSE(reader.take(sample));
  CHECK(reader.drops().malformed >= 4);  // the middleware looks at a sample more than once
  CHECK(reader.drops().invalid == 2);
}

TEST_CASE("samples in another representation than CDR stop at the guard; those of other writers arrive") {
  const bus::Participant there(place("there"));
  bus::Reader<wire::EpisodeStored> reader(there);
  const bus::Participant stranger(place("stranger"));
  const bus::Participant here(place("here"));
  test::Rogue<wire::EpisodeStored, wire::EpisodeStoredPubSubType> rogue(stranger);
  bus::Writer<wire::EpisodeStored> writer(here);
  REQUIRE(eventually([&] { return rogue.matched() == 1 && writer.matched() == 1 && reader.matched() == 2; }));
  wire::EpisodeStored stored;
  stored.digest(std::string(64, 'a'));
  std::vector<unsigned char> xcdr2 = rogue.bytes_of(stored);
  xcdr2[1] = 7;
  rogue.write_bytes(stored, xcdr2);
  const auto counted = [&] { return there.refused().at(static_cast<std::size_t>(bus::Refusal::encapsulation)); };
  CHECK(eventually([&] { return counted() > 0; }));
  stored.episode_id(5);
  writer.write(stored);
  wire::EpisodeStored sample;
  REQUIRE(take_within(reader, sample));
  CHECK(sample.episode_id() == 5);
  CHECK(there.drops() == 0);
}

namespace {

/// Exchanges a good sample of a topic between two participants, there and back.
template <class T>
void exchange(const bus::Participant& here, const bus::Participant& there, T good) {
  for (const auto& [from, to] : {std::pair(&here, &there), std::pair(&there, &here)}) {
    bus::Writer<T> writer(*from);
    bus::Reader<T> reader(*to);
    INFO(bus::topic_settings<T>().name);
    REQUIRE(eventually([&] { return writer.matched() == 1 && reader.matched() == 1; }));
    writer.write(good);
    T sample;
    REQUIRE(take_within(reader, sample));
  }
}

}  // namespace

TEST_CASE("the guard lets everything pass that two participants exchange on all topics, in fragments too") {
  const bus::Participant here(place("here"));
  const bus::Participant there(place("there"));
#define ALOFT_TOPIC(type, ...) exchange(here, there, bus::testing::SampleLimits<wire::type>::good());
#include "common/bus/topics.def"
  wire::EpisodeRecord record = bus::testing::SampleLimits<wire::EpisodeRecord>::good();
  record.trace().resize(300'000);
  for (int bytes = 0; bytes < 4; ++bytes) {
    record.trace().push_back(7);
    exchange(here, there, record);
  }
  record.agent_memory().resize(limits::memory_bytes);
  exchange(here, there, record);
  for (const bus::Participant* participant : {&here, &there})
    for (std::size_t reason = 0; reason < bus::refusal_names.size(); ++reason) {
      INFO(bus::refusal_names.at(reason));
      CHECK(participant->refused().at(reason) == 0);
    }
}

TEST_CASE("the largest valid samples are no larger than the guard lets pass in fragments") {
  const auto size = []<class Type>(Type type, const typename Type::Sample& sample) { return type.room_for(&sample); };
  wire::EpisodeRecord record;
  record.trace().resize(limits::trace_bytes);
  record.agent_memory().resize(limits::memory_bytes);
  CHECK(size(bus::GeneratedType<wire::EpisodeRecordPubSubType>(), record) <= bus::guard::largest_sample_bytes);
  wire::World measured;
  measured.agents().resize(limits::agents);
  measured.measured().throughput_kbps().resize(limits::cells);
  measured.measured().sinr_db().resize(limits::cells);
  measured.measured().serving_cell().resize(limits::cells);
  measured.measured().sites().resize(limits::base_stations);
  measured.measured().route().resize(limits::steps);
  CHECK(size(bus::GeneratedType<wire::WorldPubSubType>(), measured) <= bus::guard::largest_sample_bytes);
  wire::World city;
  city.agents().resize(limits::agents);
  city.city().base_stations().resize(limits::base_stations);
  city.city().building_height_m().resize(limits::cells);
  CHECK(size(bus::GeneratedType<wire::WorldPubSubType>(), city) <= bus::guard::largest_sample_bytes);
  wire::RunControl control;
  control.experiment_json().resize(limits::experiment_bytes);
  CHECK(size(bus::GeneratedType<wire::RunControlPubSubType>(), control) <= bus::guard::largest_sample_bytes);
}

// The guard refuses their datagrams before (common/bus/guard); in a secured run it cannot see what is encrypted.
TEST_CASE("samples that are not XCDR1 are refused before they are read") {
  bus::DropCounter drops("HeightCommand");
  bus::CheckedType<wire::HeightCommandPubSubType> checked(drops);
  const std::vector<unsigned char> good = serialized(command(9, 1));
  const auto accepted = [&](unsigned char first, unsigned char second) {
    Payload payload(static_cast<std::uint32_t>(good.size()));
    std::copy(good.begin(), good.end(), payload.data);
    payload.length = static_cast<std::uint32_t>(good.size());
    payload.data[0] = first;
    payload.data[1] = second;
    wire::HeightCommand sample;
    return checked.from_bytes(payload, &sample);
  };
  CHECK(accepted(0, 1));
  CHECK_FALSE(accepted(1, 1));
  // DDS-XTypes 1.3, 7.6.3.1.2: parameter lists, and the representations of XCDR2.
  for (const int other : {2, 3, 6, 7, 8, 9, 10, 11}) CHECK_FALSE(accepted(0, static_cast<unsigned char>(other)));
  CHECK(drops.drops().malformed == 9);
}

TEST_CASE("samples are padded to four bytes") {
  bus::DropCounter drops("EpisodeRecord");
  bus::CheckedType<wire::EpisodeRecordPubSubType> checked(drops);
  wire::EpisodeRecord record = bus::testing::SampleLimits<wire::EpisodeRecord>::good();
  for (std::size_t bytes = 1; bytes <= 8; ++bytes) {
    record.agent_memory().resize(bytes);
    const std::uint32_t size = checked.room_for(&record);
    CHECK(size % 4 == 0);
    Payload payload(size);
    REQUIRE(checked.to_bytes(&record, payload));
    CHECK(payload.length == size);
    wire::EpisodeRecord back;
    REQUIRE(checked.from_bytes(payload, &back));
    CHECK(back.agent_memory().size() == bytes);
  }
}

TEST_CASE("a malformed sample that claims to be huge gets no memory") {
  wire::World world;
  world.agents(wire::names({"dqn"}));
  world.city().base_stations().resize(3);
  bus::GeneratedType<wire::WorldPubSubType> plain;
  Payload good(plain.room_for(&world) + 64);
  REQUIRE(plain.to_bytes(&world, good));
  bus::DropCounter drops("World");
  bus::CheckedType<wire::WorldPubSubType> checked(drops);
  wire::World sample;
  REQUIRE(checked.from_bytes(good, &sample));
  std::uint64_t refused = 0;
  for (std::uint32_t at = 4; at + 4 <= good.length; at += 4)
    for (const std::uint32_t length : {0xFFFFFFFFU, 0x10000000U, 0x01000000U}) {
      Payload bad(good.length);
      bad.copy(&good);
      std::memcpy(bad.data + at, &length, sizeof length);
      wire::World spoilt;
      refused += checked.from_bytes(bad, &spoilt) ? 0U : 1U;
      CHECK(spoilt.agents().capacity() < 1000);
      CHECK(spoilt.city().base_stations().capacity() < 1000);
    }
  CHECK(refused >= 9);  // the lengths of the three sequences that are not empty or not of numbers
  CHECK(drops.drops().malformed == refused);
}

TEST_CASE("a sample that is longer than its type can be gets no memory") {
  wire::WorkerStatus status;
  bus::GeneratedType<wire::WorkerStatusPubSubType> plain;
  const auto serialized_status = [&] {
    Payload payload(plain.room_for(&status));
    plain.to_bytes(&status, payload);
    return std::vector<unsigned char>(payload.data, payload.data + payload.length);
  };
  std::vector<unsigned char> bytes = serialized_status();
  status.failures().resize(1);
  const std::vector<unsigned char> with_failure = serialized_status();
  const auto length_at = std::mismatch(bytes.begin(), bytes.end(), with_failure.begin()).first - bytes.begin();
  bytes.resize(1U << 20U);
  const std::uint32_t failures = 900'000;  // fewer than there are bytes: enough for Fast CDR
  std::memcpy(bytes.data() + length_at, &failures, sizeof failures);

  Payload payload(static_cast<std::uint32_t>(bytes.size()));
  std::copy(bytes.begin(), bytes.end(), payload.data);
  payload.length = static_cast<std::uint32_t>(bytes.size());
  bus::DropCounter drops("WorkerStatus");
  bus::CheckedType<wire::WorkerStatusPubSubType> checked(drops);
  wire::WorkerStatus spoilt;
  CHECK_FALSE(checked.from_bytes(payload, &spoilt));
  CHECK(spoilt.failures().capacity() < 1000);
}

TEST_CASE("a sequence of AgentName has the bytes of a sequence of strings on the wire") {
  wire::World world;
  world.agents(wire::names({"dqn", "x"}));
  bus::GeneratedType<wire::WorldPubSubType> type;
  Payload payload(type.room_for(&world));
  REQUIRE(type.to_bytes(&world, payload));
  const std::vector<unsigned char> sequence{2, 0, 0, 0, 4, 0, 0, 0, 'd', 'q', 'n', 0, 2, 0, 0, 0, 'x', 0};
  const unsigned char* const end = payload.data + payload.length;
  CHECK(std::search(payload.data, payload.data + payload.length, sequence.begin(), sequence.end()) != end);
}

/// The writer is in the partition of its topic; `elsewhere` is where a process of the same worker looks for the topic
/// that has not joined this partition.
template <class Sample, class PubSubType>
void check_stays_in_its_partition(const Sample& good, const std::vector<bus::Scope>& elsewhere) {
  const bus::Participant channel(place("channel", "w0"));
  const bus::Participant allowed(place("allowed", "w0"));
  const bus::Participant other_worker(place("other", "w1"));
  bus::Writer<Sample> writer(channel);
  bus::Reader<Sample> reader(allowed);
  bus::Reader<Sample> stranger(other_worker);
  const bus::Participant ordinary(place("ordinary", "w0"));
  auto& entry = ordinary.state()->topic<PubSubType>(bus::topic_settings<Sample>());
  std::vector<dds::DataReader*> blind;
  for (const bus::Scope scope : elsewhere) {
    blind.push_back(ordinary.state()->subscriber(scope).create_datareader(entry.topic, dds::DATAREADER_QOS_DEFAULT));
    REQUIRE(blind.back() != nullptr);
  }

  REQUIRE(eventually([&] { return writer.matched() == 1 && reader.matched() == 1; }));
  Sample sent = good;
  writer.write(sent);
  Sample sample;
  REQUIRE(take_within(reader, sample));
  CHECK(writer.matched() == 1);
  CHECK(stranger.matched() == 0);
  CHECK_FALSE(stranger.take(sample));
  for (dds::DataReader* one : blind) CHECK(one->get_unread_count() == 0);
}

TEST_CASE("the future stays in the privileged partition, and workers do not receive each other's samples") {
  wire::HeightProfile profile;
  profile.step(1);
  profile.height_min_m(40);
  profile.resolution_m(1);
  profile.qos().assign(201, 2.5);
  check_stays_in_its_partition<wire::HeightProfile, wire::HeightProfilePubSubType>(
      profile, {bus::Scope::worker, bus::Scope::site_map});
}

TEST_CASE("the site map stays in the partition of those who may have it") {
  wire::SiteMap map;
  map.route().resize(100);
  map.sites().resize(45);
  map.radio_json() = {'{', '}'};
  check_stays_in_its_partition<wire::SiteMap, wire::SiteMapPubSubType>(map,
                                                                       {bus::Scope::worker, bus::Scope::privileged});
}

TEST_CASE("readers get the strongest live writer; the next one takes over when it dies") {
  const bus::Participant channel(place("channel"));
  bus::Reader<wire::HeightCommand> reader(channel);
  const bus::Participant weak(place("weak"));
  bus::Writer<wire::HeightCommand> standby(weak, {.strength = 1});
  auto strong = std::make_unique<bus::Participant>(place("strong"));
  auto owner = std::make_unique<bus::Writer<wire::HeightCommand>>(*strong, bus::WriterOptions{.strength = 5});
  REQUIRE(eventually([&] { return reader.matched() == 2 && owner->matched() == 1 && standby.matched() == 1; }));

  owner->write(command(0, 1));
  wire::HeightCommand sample;
  REQUIRE(take_within(reader, sample));
  standby.write(command(0, 2));
  owner->write(command(0, 3));
  REQUIRE(take_within(reader, sample));
  CHECK(sample.step() == 3);

  // The owner falls silent without a message: its liveliness expires after half a second.
  CHECK(eventually([&] {
    standby.assert_liveliness();
    standby.write(command(0, 4));
    return reader.take(sample) && sample.step() == 4;
  }));
}

TEST_CASE("a waiter ends by data, by wake, by a stop, or by its limit") {
  StopSignal stop;
  bus::Waiter waiter(stop);
  CHECK_FALSE(waiter.wait(10ms));
  waiter.wake();
  CHECK(waiter.wait(10s));
  CHECK_FALSE(waiter.wait(10ms));
  const auto later = std::async(std::launch::async, [] {
    std::this_thread::sleep_for(20ms);
    kill(getpid(), SIGTERM);
  });
  CHECK(waiter.wait(10s));
  CHECK(stop.requested());
  CHECK(stop.interrupted());
}

TEST_CASE("names that would be patterns, and domains without ports, are refused") {
  bus::BusOptions options = place("x");
  options.run = "*";
  CHECK_THROWS_AS(bus::Participant(options), InputError);
  options = place("x");
  options.domain = 102;
  CHECK_THROWS_WITH(bus::Participant(options), Contains("0 to 101"));
}

}  // namespace aloft
