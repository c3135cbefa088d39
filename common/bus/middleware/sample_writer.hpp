#pragma once

// The middleware's DataWriter, whose write() says by true that it worked in one generation and by 0 in the other. No
// other file names it (tests/project/layers_test.cpp), so nothing can misread what write() returns.
//
// Inside common/bus only.

#include <chrono>
#include <cstddef>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <vector>

#include "common/bus/middleware/duration.hpp"
#include "common/bus/middleware/generation.hpp"

namespace aloft::bus {

class SampleWriter {
 public:
  /// See created().
  SampleWriter(dds::Publisher& publisher, dds::Topic& topic, const dds::DataWriterQos& qos)
      : publisher_(publisher), writer_(publisher.create_datawriter(&topic, qos)) {}
  ~SampleWriter() {
    if (created()) publisher_.delete_datawriter(writer_);
  }
  SampleWriter(const SampleWriter&) = delete;
  SampleWriter& operator=(const SampleWriter&) = delete;

  /// False if the middleware refused to make it; nothing else may be called then.
  [[nodiscard]] bool created() const noexcept { return writer_ != nullptr; }
  /// False if the middleware refuses the sample.
  [[nodiscard]] bool write(void* sample) { return succeeded(writer_->write(sample)); }

  /// Readers known now.
  [[nodiscard]] std::size_t matched() const {
    dds::PublicationMatchedStatus status;
    static_cast<void>(writer_->get_publication_matched_status(status));
    return static_cast<std::size_t>(status.current_count);
  }
  void assert_liveliness() { static_cast<void>(writer_->assert_liveliness()); }
  [[nodiscard]] const dds::DataWriterQos& qos() const { return writer_->get_qos(); }
  [[nodiscard]] bool set_qos(const dds::DataWriterQos& qos) { return succeeded(writer_->set_qos(qos)); }
  /// True once every known reader has everything.
  [[nodiscard]] bool wait_acknowledged(std::chrono::milliseconds limit) {
    return succeeded(writer_->wait_for_acknowledgments(duration(limit)));
  }

  /// Of a writer that `publisher` has.
  [[nodiscard]] static dds::DataWriterQos qos_of_one(dds::Publisher& publisher) {
    std::vector<dds::DataWriter*> writers;
    static_cast<void>(publisher.get_datawriters(writers));
    return writers.at(0)->get_qos();
  }

 private:
  dds::Publisher& publisher_;
  dds::DataWriter* writer_;
};

}  // namespace aloft::bus
