// What a participant in Fast DDS has discovered, kept from the calls of the vendor's threads.
#pragma once

#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <map>
#include <mutex>

#include "services/bus/discovery.hpp"

namespace dyncal::bus {

class FastDdsDiscovery : public eprosima::fastdds::dds::DomainParticipantListener {
public:
  // Any thread.
  [[nodiscard]] Discovery discovered() const;

  void on_participant_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;
  void on_publisher_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;
  void on_subscriber_discovery(eprosima::fastdds::dds::DomainParticipant* participant,
                               eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override;

private:
  mutable std::mutex mutex_;
  std::map<std::string, DiscoveredParticipant> participants_; // by their ids
  std::map<std::string, DiscoveredEndpoint> endpoints_;       // by their GUIDs
};

} // namespace dyncal::bus
