#include "services/bus/fastdds/screened_transport.hpp"

#include "services/bus/fastdds/fast_dds_names.hpp"
// Its headers differ by version.
#include <fastdds/rtps/common/LocatorList.hpp>
#include <fastdds/rtps/common/LocatorsIterator.hpp>
#ifdef DYNCAL_FAST_DDS_3
#include <fastdds/rtps/transport/ChainingTransport.hpp>
#include <fastdds/rtps/transport/SenderResource.hpp>
#include <fastdds/rtps/transport/TransportReceiverInterface.hpp>
#else
#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/TransportReceiverInterface.h>
#endif
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "services/bus/fastdds/screen/discovery_heartbeats.hpp"
#include "services/bus/fastdds/screen/fragment_repairs.hpp"
#include "services/bus/fastdds/screen/message_check.hpp"
#include "services/bus/fastdds/screen/participant_announcements.hpp"
#include "services/bus/fastdds/screen/rtps_screen.hpp"
#include "services/bus/fastdds/screen/split_message.hpp"
#include "services/bus/qos_profiles.hpp"

namespace dyncal::bus {
namespace {

namespace vendor = eprosima::fastdds::rtps;
namespace rtps = fast_dds::rtps;

#ifndef DYNCAL_FAST_DDS_3
// The vendor's interface has a destructor that is not virtual; nobody destroys these through it.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wnon-virtual-dtor"
// Hands on the destinations of another, which can be visited only once, and notes them.
class NotedDestinations : public vendor::LocatorsIterator {
public:
  NotedDestinations(vendor::LocatorsIterator& destinations, std::vector<rtps::Locator_t>& noted)
      : destinations_(destinations), noted_(noted) {}

  LocatorsIterator& operator++() override {
    ++destinations_;
    return *this;
  }
  bool operator==(const LocatorsIterator& other) const override {
    return destinations_ == static_cast<const NotedDestinations&>(other).destinations_;
  }
  bool operator!=(const LocatorsIterator& other) const override { return !(*this == other); }
  const rtps::Locator_t& operator*() const override {
    const rtps::Locator_t& one = *destinations_;
    if (noted_.empty() || noted_.back() != one) {
      noted_.push_back(one);
    }
    return one;
  }

private:
  vendor::LocatorsIterator& destinations_;
  std::vector<rtps::Locator_t>& noted_;
};
#pragma GCC diagnostic pop

std::size_t hash_of(const rtps::SenderResource* below, const rtps::Locator_t& locator) {
  const std::string_view bytes(reinterpret_cast<const char*>(&locator), sizeof locator); // unpadded
  return std::hash<std::string_view>{}(bytes) ^ std::hash<const void*>{}(below);
}

// Those of discovery come alone or with a few of their kind. One that is missed costs a repeat.
constexpr std::uint32_t max_acknack_bytes = 256;
#endif

// Of UDP over IPv4.
constexpr std::uint32_t max_datagram_bytes = 65'507;

class ScreenedTransport : public vendor::ChainingTransport {
public:
  ScreenedTransport(const vendor::ChainingTransportDescriptor& descriptor,
                    std::shared_ptr<TransportState> state)
      : vendor::ChainingTransport(descriptor), state_(std::move(state)) {}

  vendor::TransportDescriptorInterface* get_configuration() override {
    return low_level_transport_->get_configuration();
  }
  void shutdown() override { low_level_transport_->shutdown(); }
  // What others send may be longer than what we send, which the transport below limits:
  // participants of Cyclone DDS without our profile announce themselves in longer datagrams, and
  // one that is cut off at its end is not as it should be.
  [[nodiscard]] std::uint32_t max_recv_buffer_size() const override { return max_datagram_bytes; }

#ifdef DYNCAL_FAST_DDS_3
  bool send(rtps::SenderResource* below, const std::vector<vendor::NetworkBuffer>& buffers,
            std::uint32_t count, vendor::LocatorsIterator* destinations_begin,
            vendor::LocatorsIterator* destinations_end,
            const std::chrono::steady_clock::time_point& timeout) override {
    note_acknacks(buffers, count);
    return below->send(buffers, count, destinations_begin, destinations_end, timeout);
  }
#else
  bool send(rtps::SenderResource* below, const rtps::octet* bytes, std::uint32_t count,
            vendor::LocatorsIterator* destinations_begin,
            vendor::LocatorsIterator* destinations_end,
            const std::chrono::steady_clock::time_point& timeout) override {
    if (!state_->listens || *destinations_begin == *destinations_end) {
      return true;
    }
    progress_.sent({bytes, count});
    if (count > static_cast<std::uint32_t>(state_->packet_bytes)) {
      return send_split({bytes, count}, *below, *destinations_begin, *destinations_end, timeout);
    }
    const auto now = std::chrono::steady_clock::now();
    const auto due = due_heartbeats(now);
    for (const auto& [way, datagram] : due) {
      send_to(way, datagram, timeout);
    }
    std::optional<DiscoveryHeartbeats::Datagram> counted;
    {
      const std::lock_guard lock(tables_);
      if (repairs_.went_lately({bytes, count}, hash_of(below, **destinations_begin), now)) {
        return true;
      }
      counted = heartbeats_.counted({bytes, count});
    }
    if (!counted) {
      return below->send(bytes, count, destinations_begin, destinations_end, timeout);
    }
    std::vector<rtps::Locator_t> noted;
    NotedDestinations begin(*destinations_begin, noted);
    NotedDestinations end(*destinations_end, noted);
    const bool sent = below->send(counted->data(), count, &begin, &end, timeout);
    note_sent(below, *counted, noted, now);
    return sent;
  }
#endif

  // Each socket has a thread, which ends with it.
  void receive(vendor::TransportReceiverInterface* above, const rtps::octet* bytes,
               std::uint32_t count, const rtps::Locator_t& local,
               const rtps::Locator_t& remote) override {
    if (!check_.accepts({bytes, count})) {
      state_->refused->add_implausible(RefusedPackets::sender_in(remote.address));
      return;
    }
#ifndef DYNCAL_FAST_DDS_3
    if (count <= max_acknack_bytes) {
      const std::lock_guard lock(tables_);
      heartbeats_.received({bytes, count});
    }
#endif
    thread_local RtpsScreen screen(stamps_, progress_);
    if (const auto passed = screen.pass({bytes, count}); !passed.empty()) {
      // Participants announce themselves by multicast and unicast at once. While Fast DDS 2.9 takes
      // in a new one, the other copy empties the addresses that are being read: the participant is
      // then known without any, and a secured one is never authenticated.
      std::unique_lock one_at_a_time(announcement_, std::defer_lock);
      if (announces_participant(passed)) {
        one_at_a_time.lock();
      }
      above->OnDataReceived(passed.data(), static_cast<std::uint32_t>(passed.size()), local,
                            remote);
    } else if (screen.refused()) {
      state_->refused->add(RefusedPackets::sender_in(remote.address));
    }
  }

private:
  std::shared_ptr<TransportState> state_;
  MessageCheck check_;
  SampleStamps stamps_;
  ReaderProgress progress_;
  std::mutex announcement_; // held while one is taken in

#ifdef DYNCAL_FAST_DDS_3
  // In pieces; those of ACKNACKs are short.
  void note_acknacks(const std::vector<vendor::NetworkBuffer>& pieces, std::uint32_t bytes) {
    if (bytes > max_udp_payload_bytes) {
      return;
    }
    std::vector<unsigned char> message;
    for (const vendor::NetworkBuffer& piece : pieces) {
      const auto* begin = static_cast<const unsigned char*>(piece.buffer);
      message.insert(message.end(), begin, begin + piece.size);
    }
    progress_.sent(message);
  }
#else
  struct Way {
    rtps::SenderResource* below;
    rtps::Locator_t destination;
  };

  using Instant = std::chrono::steady_clock::time_point;

  std::vector<std::pair<Way, DiscoveryHeartbeats::Datagram>> due_heartbeats(Instant now) {
    std::vector<std::pair<Way, DiscoveryHeartbeats::Datagram>> due;
    const std::lock_guard lock(tables_);
    for (auto& [destination, datagram] : heartbeats_.due(now)) {
      due.emplace_back(ways_.at(destination), std::move(datagram));
    }
    return due;
  }

  void note_sent(rtps::SenderResource* below, const DiscoveryHeartbeats::Datagram& datagram,
                 const std::vector<rtps::Locator_t>& destinations, Instant now) {
    const std::lock_guard lock(tables_);
    for (const rtps::Locator_t& destination : destinations) {
      const std::size_t way = hash_of(below, destination);
      if (ways_.size() < DiscoveryHeartbeats::max_destinations) {
        ways_.try_emplace(way, Way{below, destination});
      }
      if (ways_.contains(way)) {
        heartbeats_.sent(datagram, way, now);
      }
    }
  }

  // Of a secured participant, whose messages may be longer than a packet.
  bool send_split(std::span<const unsigned char> message, rtps::SenderResource& below,
                  vendor::LocatorsIterator& begin, vendor::LocatorsIterator& end,
                  const std::chrono::steady_clock::time_point& timeout) const {
    rtps::LocatorList_t destinations;
    for (; begin != end; ++begin) {
      destinations.push_back(*begin);
    }
    bool sent = true;
    for (const auto& part :
         split_message(message, static_cast<std::size_t>(state_->packet_bytes))) {
      vendor::Locators first(destinations.begin());
      vendor::Locators last(destinations.end());
      sent = below.send(part.data(), static_cast<std::uint32_t>(part.size()), &first, &last,
                        timeout) &&
             sent;
    }
    return sent;
  }

  static void send_to(const Way& way, const DiscoveryHeartbeats::Datagram& datagram,
                      const std::chrono::steady_clock::time_point& timeout) {
    rtps::LocatorList_t destination;
    destination.push_back(way.destination);
    vendor::Locators begin(destination.begin());
    vendor::Locators end(destination.end());
    way.below->send(datagram.data(), static_cast<std::uint32_t>(datagram.size()), &begin, &end,
                    timeout); // lost like any other where it cannot be sent
  }

  std::mutex tables_; // what follows; not held while anything is sent, which may take time
  FragmentRepairs repairs_;
  DiscoveryHeartbeats heartbeats_;
  std::map<std::size_t, Way> ways_; // of heartbeats
#endif
};

struct ScreenedTransportDescriptor : vendor::ChainingTransportDescriptor {
  ScreenedTransportDescriptor(std::shared_ptr<vendor::TransportDescriptorInterface> below,
                              std::shared_ptr<TransportState> of_participant)
      : vendor::ChainingTransportDescriptor(std::move(below)), state(std::move(of_participant)) {}

  [[nodiscard]] vendor::TransportInterface* create_transport() const override {
    return new ScreenedTransport(*this, state);
  }

  std::shared_ptr<TransportState> state;
};

} // namespace

std::shared_ptr<vendor::TransportDescriptorInterface>
screened(std::shared_ptr<vendor::TransportDescriptorInterface> transport,
         std::shared_ptr<TransportState> state) {
  return std::make_shared<ScreenedTransportDescriptor>(std::move(transport), std::move(state));
}

} // namespace dyncal::bus
