#include "common/bus/middleware/receiving_transport.hpp"

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include <utility>

namespace aloft::bus {
namespace {

namespace transport = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;

struct ReceivingDescriptor : transport::ChainingTransportDescriptor {
  ReceivingDescriptor(Receive function, Transport below)
      : ChainingTransportDescriptor(std::move(below)), receive(std::move(function)) {}
  [[nodiscard]] transport::TransportInterface* create_transport() const override;

  Receive receive;
};

class ReceivingTransport : public transport::ChainingTransport {
 public:
  explicit ReceivingTransport(const ReceivingDescriptor& descriptor)
      : ChainingTransport(descriptor), descriptor_(descriptor) {}

  transport::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  bool send(rtps::SenderResource* below, const rtps::octet* bytes, std::uint32_t size,
            transport::LocatorsIterator* begin, transport::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) override {
    return below->send(bytes, size, begin, end, timeout);
  }

  void receive(transport::TransportReceiverInterface* next, const rtps::octet* bytes, std::uint32_t size,
               const rtps::Locator_t& local, const rtps::Locator_t& remote) override {
    descriptor_.receive(bytes, size, remote, [&] { next->OnDataReceived(bytes, size, local, remote); });
  }

 private:
  ReceivingDescriptor descriptor_;
};

transport::TransportInterface* ReceivingDescriptor::create_transport() const {
  return new ReceivingTransport(*this);
}

}  // namespace

Transport receiving_through(Receive receive, Transport below) {
  return std::make_shared<ReceivingDescriptor>(std::move(receive), std::move(below));
}

}  // namespace aloft::bus
