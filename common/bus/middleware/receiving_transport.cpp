#include "common/bus/middleware/receiving_transport.hpp"

#include <utility>

namespace aloft::bus {
namespace {

struct ReceivingDescriptor : rtps::ChainingTransportDescriptor {
  ReceivingDescriptor(Receive function, Transport below)
      : ChainingTransportDescriptor(std::move(below)), receive(std::move(function)) {}
  [[nodiscard]] rtps::TransportInterface* create_transport() const override;

  Receive receive;
};

class ReceivingTransport : public SendingTransport {
 public:
  explicit ReceivingTransport(const ReceivingDescriptor& descriptor)
      : SendingTransport(descriptor), descriptor_(descriptor) {}

  rtps::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

  void receive(rtps::TransportReceiverInterface* next, const rtps::octet* bytes, std::uint32_t size,
               const rtps::Locator_t& local, const rtps::Locator_t& remote) override {
    descriptor_.receive(bytes, size, remote, [&] { next->OnDataReceived(bytes, size, local, remote); });
  }

 private:
  ReceivingDescriptor descriptor_;
};

rtps::TransportInterface* ReceivingDescriptor::create_transport() const {
  return new ReceivingTransport(*this);
}

}  // namespace

Transport receiving_through(Receive receive, Transport below) {
  return std::make_shared<ReceivingDescriptor>(std::move(receive), std::move(below));
}

}  // namespace aloft::bus
