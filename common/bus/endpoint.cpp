#include "common/bus/endpoint.hpp"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <fastdds/dds/core/condition/StatusCondition.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <idl/type_supports.hpp>
#include <optional>
#include <stdexcept>
#include <type_traits>

#include "common/bus/detail.hpp"
#include "common/bus/middleware/defaults.hpp"
#include "common/bus/middleware/liveliness.hpp"
#include "common/bus/middleware/sample_writer.hpp"
#include "common/bus/validate.hpp"

namespace aloft::bus {

namespace {

std::string not_created(const char* what, const TopicSettings& settings, const BusOptions& options) {
  return fmt::format("bus: cannot create a {} of {}{}", what, settings.name,
                     options.secure.empty() ? ""
                                            : fmt::format(": do the permissions of the role '{}' in {} allow it?",
                                                          to_text(options.role), options.secure.string()));
}

constexpr std::chrono::milliseconds max_blocking_time{1000};
constexpr int looked_at_samples = 256;  // per key, that arrive between two looks

/// The quality of service that writers and readers share: the middleware matches them only if it agrees.
template <class Qos>
void apply(const TopicSettings& settings, Qos& qos) {
  qos.reliability().kind = dds::RELIABLE_RELIABILITY_QOS;
  qos.reliability().max_blocking_time = duration(max_blocking_time);
  qos.durability().kind = settings.transient_local ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = settings.depth;
  make_room(settings.depth, settings.keys, qos.resource_limits());
  qos.endpoint().history_memory_policy = rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
  qos.data_sharing().off();
  if (settings.exclusive) {
    qos.ownership().kind = dds::EXCLUSIVE_OWNERSHIP_QOS;
    notice_dead_writers(qos.liveliness());
  }
}

template <class T>
struct TypeSupportOf;
#define ALOFT_TOPIC(type, ...)           \
  template <>                            \
  struct TypeSupportOf<wire::type> {     \
    using Type = wire::type##PubSubType; \
  };
#include "common/bus/topics.def"

template <class T>
constexpr bool belongs_to_experiment = requires(const T& sample) { sample.experiment_id(); };
/// A foreign agent need not know which experiment runs.
template <class T>
constexpr bool may_belong_to_any = std::is_same_v<T, wire::AgentStatus>;

}  // namespace

template <class T>
struct Writer<T>::State {
  std::shared_ptr<Participant::State> participant;
  const TopicSettings& settings = topic_settings<T>();
  std::optional<SampleWriter> writer;
};

template <class T>
Writer<T>::Writer(const Participant& participant, const WriterOptions& options) : state_(std::make_unique<State>()) {
  state_->participant = participant.state();
  auto& entry = state_->participant->template topic<typename TypeSupportOf<T>::Type>(state_->settings);
  dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
  apply(state_->settings, qos);
  qos.publish_mode().kind = dds::SYNCHRONOUS_PUBLISH_MODE;
  notice_loss(qos.reliable_writer_qos());
  if (state_->settings.exclusive) qos.ownership_strength().value = options.strength;
  state_->writer.emplace(state_->participant->publisher(state_->settings.scope), *entry.topic, qos);
  if (!state_->writer->created())
    throw std::runtime_error(not_created("writer", state_->settings, state_->participant->options));
}

template <class T>
Writer<T>::Writer(Writer&&) noexcept = default;
template <class T>
Writer<T>& Writer<T>::operator=(Writer&&) noexcept = default;
template <class T>
Writer<T>::~Writer() = default;

template <class T>
void Writer<T>::write(T& sample) {
  sample.protocol_version(wire::PROTOCOL_VERSION);
  if (const char* error = validate(sample))
    throw std::invalid_argument(fmt::format("bus: {}: refused to write: {}", state_->settings.name, error));
  if (!state_->writer->write(&sample))
    throw std::runtime_error(fmt::format("bus: {}: the middleware refused a sample (at most {} live keys)",
                                         state_->settings.name, state_->settings.keys));
}

template <class T>
std::size_t Writer<T>::matched() const {
  return state_->writer->matched();
}

template <class T>
void Writer<T>::assert_liveliness() {
  state_->writer->assert_liveliness();
}

template <class T>
void Writer<T>::set_strength(std::uint32_t strength) {
  const std::lock_guard lock(state_->participant->mutex);
  dds::DataWriterQos qos = state_->writer->qos();
  qos.ownership_strength().value = strength;
  if (!state_->writer->set_qos(qos))
    throw std::runtime_error(fmt::format("bus: {}: cannot change the strength", state_->settings.name));
}

template <class T>
bool Writer<T>::wait_acknowledged(std::chrono::milliseconds limit) {
  return state_->writer->wait_acknowledged(limit);
}

template <class T>
struct Reader<T>::State {
  std::shared_ptr<Participant::State> participant;
  const TopicSettings& settings = topic_settings<T>();
  dds::Subscriber* subscriber = nullptr;
  dds::DataReader* reader = nullptr;
  DropCounter* drops = nullptr;
  std::string experiment;
  rtps::GUID_t sender;
  T scratch;

  ~State() {
    if (reader == nullptr) return;
    participant->remove(*reader);
    subscriber->delete_datareader(reader);
  }

  [[nodiscard]] bool good(const T& sample) const {
    if (sample.protocol_version() != wire::PROTOCOL_VERSION) {
      drops->foreign("another protocol version");
      return false;
    }
    if constexpr (belongs_to_experiment<T>) {
      const bool of_any = may_belong_to_any<T> && wire::view(sample.experiment_id()).empty();
      if (!experiment.empty() && sample.experiment_id() != experiment && !of_any) {
        drops->foreign("another experiment");
        return false;
      }
    }
    if (const char* error = validate(sample)) {
      drops->invalid(error);
      return false;
    }
    return true;
  }
};

template <class T>
Reader<T>::Reader(const Participant& participant, const ReaderOptions& options) : state_(std::make_unique<State>()) {
  state_->participant = participant.state();
  state_->subscriber = &state_->participant->subscriber(state_->settings.scope);
  auto& entry = state_->participant->template topic<typename TypeSupportOf<T>::Type>(state_->settings);
  state_->drops = entry.drops.get();
  dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
  TopicSettings settings = state_->settings;
  settings.depth += settings.spare;
  if (options.looks_on) settings.depth += looked_at_samples;
  apply(settings, qos);
  if (options.looks_on) qos.reliability().kind = dds::BEST_EFFORT_RELIABILITY_QOS;
  state_->reader = state_->subscriber->create_datareader(entry.topic, qos);
  if (state_->reader == nullptr)
    throw std::runtime_error(not_created("reader", state_->settings, state_->participant->options));
  state_->participant->add(*state_->reader);
  state_->reader->get_statuscondition().set_enabled_statuses(dds::StatusMask::data_available());
}

template <class T>
Reader<T>::Reader(Reader&&) noexcept = default;
template <class T>
Reader<T>& Reader<T>::operator=(Reader&&) noexcept = default;
template <class T>
Reader<T>::~Reader() = default;

template <class T>
bool Reader<T>::take(T& sample) {
  dds::SampleInfo info;
  while (succeeded(state_->reader->take_next_sample(&sample, &info)))
    if (info.valid_data && state_->good(sample)) {
      state_->sender = info.sample_identity.writer_guid();
      return true;
    }
  return false;
}

template <class T>
void Reader<T>::expect_experiment(const std::string& id) {
  state_->experiment = id;
}

template <class T>
std::size_t Reader<T>::matched() const {
  dds::SubscriptionMatchedStatus status;
  state_->reader->get_subscription_matched_status(status);
  return static_cast<std::size_t>(status.current_count);
}

template <class T>
Drops Reader<T>::drops() const {
  return state_->drops->drops();
}

template <class T>
std::string Reader<T>::sender() const {
  return fmt::format("{} ({})", Neighbourhood::name_of(state_->sender.guidPrefix), fmt::streamed(state_->sender));
}

template <class T>
void Reader<T>::drop(const char* why) {
  state_->drops->invalid(why);
}

template <class T>
void* Reader<T>::condition() {
  return static_cast<dds::Condition*>(&state_->reader->get_statuscondition());
}

template <class T>
T& Reader<T>::scratch() {
  return state_->scratch;
}

#define ALOFT_TOPIC(type, ...)       \
  template class Writer<wire::type>; \
  template class Reader<wire::type>;
#include "common/bus/topics.def"

}  // namespace aloft::bus
