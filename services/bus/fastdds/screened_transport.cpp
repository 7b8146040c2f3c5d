#include "services/bus/fastdds/screened_transport.hpp"

#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/TransportReceiverInterface.h>

#include "services/bus/fastdds/rtps_screen.hpp"
#include "services/bus/rtps/message_check.hpp"

namespace dyncal::bus {
namespace {

namespace vendor = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;

// Of IPv4, the first byte uppermost.
std::uint32_t address_of(const rtps::Locator_t& locator) {
  const rtps::octet* ipv4 = locator.address + 12;
  return std::uint32_t{ipv4[0]} << 24U | std::uint32_t{ipv4[1]} << 16U |
         std::uint32_t{ipv4[2]} << 8U | std::uint32_t{ipv4[3]};
}

class ScreenedTransport : public vendor::ChainingTransport {
public:
  ScreenedTransport(const vendor::ChainingTransportDescriptor& descriptor,
                    std::shared_ptr<RefusedPackets> refused)
      : vendor::ChainingTransport(descriptor), refused_(std::move(refused)) {}

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

  // Each socket has a thread, which ends with it.
  void receive(vendor::TransportReceiverInterface* above, const rtps::octet* bytes,
               std::uint32_t count, const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override {
    if (!check_.accepts({bytes, count})) {
      refused_->add_implausible(address_of(remote));
      return;
    }
    thread_local RtpsScreen screen(stamps_);
    if (const auto passed = screen.pass({bytes, count}); !passed.empty()) {
      above->OnDataReceived(passed.data(), static_cast<std::uint32_t>(passed.size()), local,
                            remote);
    } else if (screen.refused()) {
      refused_->add(address_of(remote));
    }
  }

private:
  std::shared_ptr<RefusedPackets> refused_;
  MessageCheck check_;
  SampleStamps stamps_;
};

struct ScreenedTransportDescriptor : vendor::ChainingTransportDescriptor {
  ScreenedTransportDescriptor(std::shared_ptr<vendor::TransportDescriptorInterface> below,
                              std::shared_ptr<RefusedPackets> counter)
      : vendor::ChainingTransportDescriptor(std::move(below)), refused(std::move(counter)) {}

  [[nodiscard]] vendor::TransportInterface* create_transport() const override {
    return new ScreenedTransport(*this, refused);
  }

  std::shared_ptr<RefusedPackets> refused;
};

} // namespace

std::shared_ptr<vendor::TransportDescriptorInterface>
screened(std::shared_ptr<vendor::TransportDescriptorInterface> transport,
         std::shared_ptr<RefusedPackets> refused) {
  return std::make_shared<ScreenedTransportDescriptor>(std::move(transport), std::move(refused));
}

} // namespace dyncal::bus
