#include "common/bus/serial_reception.hpp"

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include <mutex>

namespace aloft::bus {
namespace {

namespace transport = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;

struct SerialDescriptor : transport::ChainingTransportDescriptor {
  explicit SerialDescriptor(std::shared_ptr<TransportDescriptorInterface> below)
      : ChainingTransportDescriptor(std::move(below)) {}
  [[nodiscard]] transport::TransportInterface* create_transport() const override;
};

class SerialTransport : public transport::ChainingTransport {
 public:
  explicit SerialTransport(const SerialDescriptor& descriptor)
      : ChainingTransport(descriptor), descriptor_(descriptor) {}

  transport::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  bool send(rtps::SenderResource* below, const rtps::octet* bytes, std::uint32_t size,
            transport::LocatorsIterator* begin, transport::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    return below->send(bytes, size, begin, end, timeout);
  }

  void receive(transport::TransportReceiverInterface* next, const rtps::octet* bytes, std::uint32_t size,
               const rtps::Locator_t& local, const rtps::Locator_t& remote) override {
    // The calling thread has just read from its socket and holds no lock, so nobody can wait for it in a circle.
    const std::lock_guard lock(mutex_);
    next->OnDataReceived(bytes, size, local, remote);
  }

 private:
  SerialDescriptor descriptor_;
  std::mutex mutex_;
};

transport::TransportInterface* SerialDescriptor::create_transport() const {
  return new SerialTransport(*this);
}

}  // namespace

std::shared_ptr<transport::TransportDescriptorInterface> with_serial_reception(
    std::shared_ptr<transport::TransportDescriptorInterface> below) {
  return std::make_shared<SerialDescriptor>(std::move(below));
}

}  // namespace aloft::bus
