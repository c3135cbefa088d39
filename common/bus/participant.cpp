#include "common/bus/participant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <stdexcept>

#include "common/base/error.hpp"
#include "common/base/plain_text.hpp"
#include "common/bus/detail.hpp"
#include "common/bus/middleware/clear_text_filter.hpp"
#include "common/bus/middleware/defaults.hpp"
#include "common/bus/middleware/late_interface.hpp"
#include "common/bus/middleware/lease.hpp"
#include "common/bus/middleware/one_message_at_a_time.hpp"
#include "common/bus/middleware/refusals.hpp"
#include "common/bus/network.hpp"
#include "common/security/keys.hpp"

namespace aloft::bus {

namespace {

constexpr int max_domain = 101;
constexpr std::uint32_t socket_buffer_bytes = 4U << 20U;
constexpr std::chrono::milliseconds server_ping_period{200};

/// Settings of the whole process, which must be made before the first participant.
void prepare_middleware() {
  static std::once_flag once;
  std::call_once(once, [] {
    ignore_working_directory();
    switch_off_intraprocess_delivery();
    take_over_log();
  });
}

/// A name can be empty: processes outside workers have no name of a worker.
void check_name(std::string_view what, const std::string& name) {
  const std::string objection = name.empty() ? "" : name_objection(name);
  if (!objection.empty()) throw InputError("{} name '{}': use {}", what, excerpt(name), objection);
}

void use_discovery_server(const BusOptions& options, dds::WireProtocolConfigQos& wire) {
  const Endpoint endpoint = resolve_endpoint(options.discovery_server);
  check_reachable(endpoint, options.interfaces);
  rtps::Locator_t locator;
  locator.kind = LOCATOR_KIND_UDPv4;
  rtps::IPLocator::setIPv4(locator, endpoint.address);
  rtps::IPLocator::setPhysicalPort(locator, endpoint.port);
  wire.builtin.discovery_config.discoveryServer_client_syncperiod = duration(server_ping_period);
  if (!options.serves_discovery) return ask_discovery_server(locator, server_prefix, wire);
  check_can_listen(endpoint);
  serve_discovery(locator, server_prefix, wire);
}

/// Authentication, access control and encryption, all with the files of our role. Nothing is left to a default.
void secure(const security::KeyFiles& files, dds::DomainParticipantQos& qos) {
  const auto uri = [](const std::filesystem::path& file) {
    return "file://" + std::filesystem::absolute(file).string();
  };
  auto& properties = qos.properties().properties();
  properties.emplace_back("dds.sec.auth.plugin", "builtin.PKI-DH");
  properties.emplace_back("dds.sec.auth.builtin.PKI-DH.identity_ca", uri(files.ca));
  properties.emplace_back("dds.sec.auth.builtin.PKI-DH.identity_certificate", uri(files.certificate));
  properties.emplace_back("dds.sec.auth.builtin.PKI-DH.private_key", uri(files.private_key));
  properties.emplace_back("dds.sec.access.plugin", "builtin.Access-Permissions");
  properties.emplace_back("dds.sec.access.builtin.Access-Permissions.permissions_ca", uri(files.ca));
  properties.emplace_back("dds.sec.access.builtin.Access-Permissions.governance", uri(files.governance));
  properties.emplace_back("dds.sec.access.builtin.Access-Permissions.permissions", uri(files.permissions));
  properties.emplace_back("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
}

dds::DomainParticipantQos participant_qos(const BusOptions& options, std::shared_ptr<guard::DatagramGuard> guard) {
  dds::DomainParticipantQos qos = dds::PARTICIPANT_QOS_DEFAULT;
  qos.name(options.worker.empty() ? options.process : options.process + "-" + options.worker);

  switch_off_type_lookup(qos);
  qos.user_data().setValue(Neighbourhood::naming(middleware()));

  // UDP only: a killed process leaves no shared memory behind, and a full /dev/shm cannot take others down.
  auto udp = std::make_shared<rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList = options.interfaces;
  udp->sendBufferSize = socket_buffer_bytes;
  udp->receiveBufferSize = socket_buffer_bytes;
  qos.transport().use_builtin_transports = false;
  const Transport checked = options.guarded ? guarded(std::move(guard), udp) : Transport(udp);
  qos.transport().user_transports.push_back(
      options.secure.empty() ? checked : one_message_at_a_time(without_clear_text(checked)));

  auto& discovery = qos.wire_protocol().builtin.discovery_config;
  discovery.leaseDuration = duration(longest_standstill(options).value_or(options.lease));
  // Every process announces itself to every other: n * n messages per period on a host, also while nothing is flown.
  discovery.leaseDuration_announcementperiod = duration(options.lease / 3);
  discovery.initial_announcements.count = 5;
  discovery.initial_announcements.period = duration(std::chrono::milliseconds(50));
  if (!options.discovery_server.empty()) use_discovery_server(options, qos.wire_protocol());
  qos.wire_protocol().builtin.mutation_tries = 200;
  qos.wire_protocol().builtin.readerHistoryMemoryPolicy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  return qos;
}

}  // namespace

std::string name_objection(std::string_view name) {
  constexpr std::size_t longest = 64;
  constexpr std::string_view allowed = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";
  const bool good = !name.empty() && name.size() <= longest && name.front() != '.' &&
                    name.find_first_not_of(allowed) == std::string_view::npos;
  return good ? "" : fmt::format("1 to {} letters, digits, '.', '_' or '-', the first no '.'", longest);
}

std::optional<std::chrono::milliseconds> longest_standstill(const BusOptions& options) noexcept {
  if (!options.secure.empty()) return secured_lease;
  if (!options.discovery_server.empty()) return served_lease;
  return std::nullopt;
}

std::string middleware() {
  return fmt::format("Fast DDS {}", middleware_version);
}

std::string secured_run_objection() {
  if constexpr (ALOFT_SECURED_RUNS == 1) return "";
  return fmt::format(
      "a run cannot be secured on {}: its secured processes may not find each other when they start together; use "
      "Debian 12 (Fast DDS 2.9) on all hosts of the run, or a network of the run's own without --secure",
      middleware());
}

Participant::Participant(const BusOptions& options) : state_(std::make_shared<State>(options)) {}

const BusOptions& Participant::options() const noexcept {
  return state_->options;
}

std::uint64_t Participant::drops() const {
  const std::lock_guard lock(state_->mutex);
  std::uint64_t total = 0;
  for (const auto& [name, entry] : state_->topics) total += entry.drops->drops().total();
  return total;
}

RefusalCounts Participant::refused() const {
  return state_->guard->refused();
}

std::vector<std::string> Participant::runs() const {
  return state_->neighbourhood.runs();
}

std::vector<std::string> Participant::middleware_of(const std::string& run) const {
  return state_->neighbourhood.middleware_of(run);
}

std::vector<std::string> Participant::absent(std::chrono::milliseconds patience) const {
  return state_->neighbourhood.rediscovery().absent(patience, Rediscovery::Clock::now());
}

Participant::State::State(const BusOptions& wanted)
    : options(wanted),
      guard(std::make_shared<guard::DatagramGuard>(!wanted.discovery_server.empty(), [this](const guard::Prefix& left) {
        rtps::GuidPrefix_t prefix;
        std::ranges::copy(left, prefix.value);
        neighbourhood.farewell(prefix);
      })) {
  if (options.domain < 0 || options.domain > max_domain)
    throw InputError("domain {} is out of range; allowed: 0 to {}", options.domain, max_domain);
  check_name("run", options.run);
  check_name("worker", options.worker);
  for (std::string& interface : options.interfaces) {
    interface = local_address(interface);
    wait_until_running(interface);
  }
  prepare_middleware();
  dds::DomainParticipantQos qos = participant_qos(options, guard);
  if (!options.secure.empty()) {
    if (const std::string objection = secured_run_objection(); !objection.empty())
      throw InputError("--secure: {}", objection);
    // The GUID prefix of a secured participant is derived from its certificate, that of a server is fixed.
    if (!options.discovery_server.empty())
      throw InputError(
          "--secure and --discovery-server cannot be combined: use multicast on a network of the run's own, or leave "
          "one of them out");
    const security::KeyFiles files = security::check_keys(options.secure, options.role);
    neighbourhood.expect_authority(files.authority);
    secure(files, qos);
  }
  neighbourhood.tell(rediscovery);
  participant = dds::DomainParticipantFactory::get_instance()->create_participant(
      static_cast<std::uint32_t>(options.domain), qos, &neighbourhood, dds::StatusMask::none());
  if (participant == nullptr)
    throw std::runtime_error(
        fmt::format("cannot join DDS domain {} on {}: is a UDP port free? ({} processes fit in a domain; try another "
                    "--domain)",
                    options.domain, fmt::join(options.interfaces, ", "), max_processes));
}

Participant::State::~State() {
  rediscovery.end();
  participant->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(participant);
}

void Participant::State::ask(const Rediscovery::Question& question) {
  const std::lock_guard lock(mutex);
  if (readers.empty()) return;
  dds::DataReaderQos qos = readers.front()->get_qos();
  qos.user_data().setValue(question);
  readers.front()->set_qos(qos);
}

/// Setting an unchanged quality of service makes the middleware announce every writer and reader again.
void Participant::State::announce() {
  const std::lock_guard lock(mutex);
  for (dds::Publisher* publisher : publishers)
    if (publisher != nullptr) publisher->set_qos(publisher->get_qos());
  for (dds::Subscriber* subscriber : subscribers)
    if (subscriber != nullptr) subscriber->set_qos(subscriber->get_qos());
}

void Participant::State::add(dds::DataReader& reader) {
  const std::lock_guard lock(mutex);
  readers.push_back(&reader);
}

void Participant::State::remove(dds::DataReader& reader) {
  const std::lock_guard lock(mutex);
  std::erase(readers, &reader);
}

std::string Participant::State::partition(Scope scope) const {
  std::string name = std::string(partition_root) + options.run;
  if (scope == Scope::run) return name;
  if (options.worker.empty())
    throw std::logic_error("bus: a process outside of a worker cannot use the topics inside a worker");
  name += "/" + options.worker;
  if (scope == Scope::worker) return name;
  return name + (scope == Scope::site_map ? "/site-map" : "/privileged");
}

dds::Publisher& Participant::State::publisher(Scope scope) {
  const std::lock_guard lock(mutex);
  dds::Publisher*& publisher = publishers.at(static_cast<std::size_t>(scope));
  if (publisher == nullptr) {
    dds::PublisherQos qos = dds::PUBLISHER_QOS_DEFAULT;
    qos.partition().push_back(partition(scope).c_str());
    publisher = participant->create_publisher(qos);
    if (publisher == nullptr) throw std::runtime_error("bus: cannot create a publisher in " + partition(scope));
  }
  return *publisher;
}

dds::Subscriber& Participant::State::subscriber(Scope scope) {
  const std::lock_guard lock(mutex);
  dds::Subscriber*& subscriber = subscribers.at(static_cast<std::size_t>(scope));
  if (subscriber == nullptr) {
    dds::SubscriberQos qos = dds::SUBSCRIBER_QOS_DEFAULT;
    qos.partition().push_back(partition(scope).c_str());
    subscriber = participant->create_subscriber(qos);
    if (subscriber == nullptr) throw std::runtime_error("bus: cannot create a subscriber in " + partition(scope));
  }
  return *subscriber;
}

void Participant::State::register_topic(TopicEntry& entry, const TopicSettings& settings,
                                        const dds::TypeSupport& type) {
  const std::string name(settings.name);
  if (!succeeded(participant->register_type(type)))
    throw std::runtime_error("bus: cannot register the type of topic " + name);
  entry.topic = participant->create_topic(name, type.get_type_name(), dds::TOPIC_QOS_DEFAULT);
  if (entry.topic == nullptr) throw std::runtime_error("bus: cannot create topic " + name);
}

}  // namespace aloft::bus
