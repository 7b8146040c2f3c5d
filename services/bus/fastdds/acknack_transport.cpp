#include "services/bus/fastdds/acknack_transport.hpp"

#include <fastdds/rtps/transport/ChainingTransport.hpp>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.hpp>
#include <fastdds/rtps/transport/SenderResource.hpp>
#include <fastdds/rtps/transport/TransportReceiverInterface.hpp>
#include <mutex>
#include <utility>
#include <vector>

#include "services/bus/fastdds/screen/acknack_rewriter.hpp"

namespace dyncal::bus {
namespace {

namespace rtps = eprosima::fastdds::rtps;

// Of UDP over IPv4. What others send may be longer than what we send, which the transport below
// limits.
constexpr std::uint32_t max_datagram_bytes = 65'507;

class AcknackTransport : public rtps::ChainingTransport {
public:
  using rtps::ChainingTransport::ChainingTransport;

  rtps::TransportDescriptorInterface* get_configuration() override {
    return low_level_transport_->get_configuration();
  }
  void shutdown() override { low_level_transport_->shutdown(); }
  [[nodiscard]] std::uint32_t max_recv_buffer_size() const override { return max_datagram_bytes; }

  bool send(rtps::SenderResource* below, const std::vector<rtps::NetworkBuffer>& buffers,
            std::uint32_t count, rtps::LocatorsIterator* destinations_begin,
            rtps::LocatorsIterator* destinations_end,
            const std::chrono::steady_clock::time_point& timeout) override {
    return below->send(buffers, count, destinations_begin, destinations_end, timeout);
  }

  // Each socket has a thread, which ends with it.
  void receive(rtps::TransportReceiverInterface* above, const rtps::octet* bytes,
               std::uint32_t count, const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override {
    thread_local std::vector<unsigned char> datagram(max_datagram_bytes);
    datagram.assign(bytes, bytes + count);
    {
      const std::lock_guard lock(counts_);
      acknacks_.rewrite_all(datagram);
    }
    above->OnDataReceived(datagram.data(), count, local, remote);
  }

private:
  std::mutex counts_;
  AcknackRewriter acknacks_;
};

struct AcknackTransportDescriptor : rtps::ChainingTransportDescriptor {
  using rtps::ChainingTransportDescriptor::ChainingTransportDescriptor;

  [[nodiscard]] rtps::TransportInterface* create_transport() const override {
    return new AcknackTransport(*this);
  }
};

} // namespace

std::shared_ptr<rtps::TransportDescriptorInterface>
with_acknacks_rewritten(std::shared_ptr<rtps::TransportDescriptorInterface> transport) {
  return std::make_shared<AcknackTransportDescriptor>(std::move(transport));
}

} // namespace dyncal::bus
