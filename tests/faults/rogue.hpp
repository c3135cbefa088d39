#pragma once

#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/bus/detail.hpp"
#include "common/bus/middleware/defaults.hpp"
#include "common/bus/middleware/sample_writer.hpp"
#include "common/bus/topics.hpp"

namespace aloft::test {

/// Writes a topic without the checks of bus::Writer, as a faulty or foreign program could.
template <class T, class Generated>
class Rogue {
 public:
  explicit Rogue(const bus::Participant& participant) {
    namespace dds = bus::dds;
    const bus::TopicSettings& settings = bus::topic_settings<T>();
    const std::string name(settings.name);
    type_ = new Type;
    const dds::TypeSupport support(type_);
    dds::DomainParticipant* domain = participant.state()->participant;
    support.register_type(domain);
    dds::Topic* topic = domain->create_topic(name, support.get_type_name(), dds::TOPIC_QOS_DEFAULT);
    dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
    if (settings.transient_local) qos.durability().kind = dds::TRANSIENT_LOCAL_DURABILITY_QOS;
    qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
    qos.history().depth = 100;
    qos.resource_limits().max_instances = 10;
    qos.resource_limits().max_samples_per_instance = 100;
    qos.resource_limits().max_samples = 1000;
    qos.endpoint().history_memory_policy = bus::rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
    qos.data_sharing().off();
    bus::notice_loss(qos.reliable_writer_qos());
    if (settings.exclusive) {
      qos.ownership().kind = dds::EXCLUSIVE_OWNERSHIP_QOS;
      qos.ownership_strength().value = 0;
      qos.liveliness().kind = dds::MANUAL_BY_TOPIC_LIVELINESS_QOS;
      qos.liveliness().lease_duration = {0, 500'000'000};
      qos.liveliness().announcement_period = {0, 100'000'000};
    }
    if (topic != nullptr) writer_.emplace(participant.state()->publisher(settings.scope), *topic, qos);
    if (!writer_ || !writer_->created()) throw std::runtime_error("no rogue writer of " + name);
  }

  void write(T sample) { static_cast<void>(writer_->write(&sample)); }
  /// Writes these bytes in place of the sample.
  void write_bytes(T key, std::vector<unsigned char> bytes) {
    type_->instead = std::move(bytes);
    write(std::move(key));
    type_->instead.clear();
  }
  [[nodiscard]] static std::vector<unsigned char> bytes_of(T sample) {
    bus::GeneratedType<Generated> type;
    bus::rtps::SerializedPayload_t payload(type.room_for(&sample) + 64);
    type.to_bytes(&sample, payload);
    return {payload.data, payload.data + payload.length};
  }
  [[nodiscard]] std::size_t matched() const { return writer_->matched(); }

 private:
  struct Type : bus::GeneratedType<Generated> {
    std::vector<unsigned char> instead;

    bool to_bytes(const void* sample, bus::rtps::SerializedPayload_t& payload) override {
      if (instead.empty()) return bus::GeneratedType<Generated>::to_bytes(sample, payload);
      std::memcpy(payload.data, instead.data(), instead.size());
      payload.length = static_cast<std::uint32_t>(instead.size());
      return true;
    }
    std::uint32_t room_for(const void* sample) override {
      if (instead.empty()) return bus::GeneratedType<Generated>::room_for(sample);
      return static_cast<std::uint32_t>(instead.size());
    }
  };

  Type* type_;  // owned by the middleware
  std::optional<bus::SampleWriter> writer_;
};

}  // namespace aloft::test
