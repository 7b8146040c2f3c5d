#include "services/bus/fastdds/screened_transport.hpp"

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/TransportReceiverInterface.h>

#include "services/bus/fastdds/rtps_screen.hpp"

namespace dyncal::bus {
namespace {

namespace vendor = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;

class ScreenedTransport : public vendor::ChainingTransport {
public:
  using vendor::ChainingTransport::ChainingTransport;

  vendor::TransportDescriptorInterface* get_configuration() override {
    return low_level_transport_->get_configuration();
  }
  void shutdown() override { low_level_transport_->shutdown(); }

  bool send(rtps::SenderResource* below, const rtps::octet* bytes, std::uint32_t count,
            vendor::LocatorsIterator* destinations_begin,
            vendor::LocatorsIterator* destinations_end,
            const std::chrono::steady_clock::time_point& timeout) override {
    return below->send(bytes, count, destinations_begin, destinations_end, timeout);
  }

  // Each socket has a thread.
  void receive(vendor::TransportReceiverInterface* above, const rtps::octet* bytes,
               std::uint32_t count, const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override {
    thread_local RtpsScreen screen;
    if (const auto passed = screen.pass({bytes, count}); !passed.empty()) {
      above->OnDataReceived(passed.data(), static_cast<std::uint32_t>(passed.size()), local,
                            remote);
    }
  }
};

struct ScreenedTransportDescriptor : vendor::ChainingTransportDescriptor {
  using vendor::ChainingTransportDescriptor::ChainingTransportDescriptor;

  [[nodiscard]] vendor::TransportInterface* create_transport() const override {
    return new ScreenedTransport(*this);
  }
};

} // namespace

std::shared_ptr<vendor::TransportDescriptorInterface>
screened(std::shared_ptr<vendor::TransportDescriptorInterface> transport) {
  return std::make_shared<ScreenedTransportDescriptor>(std::move(transport));
}

} // namespace dyncal::bus
