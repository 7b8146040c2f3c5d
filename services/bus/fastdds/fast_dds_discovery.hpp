// What a participant in Fast DDS has discovered, kept from the calls of the vendor's threads.
#pragma once

#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <map>
#include <mutex>

#include "services/bus/discovery.hpp"
#include "services/bus/fastdds/fast_dds_names.hpp"

namespace dyncal::bus {

class FastDdsDiscovery : public eprosima::fastdds::dds::DomainParticipantListener {
public:
  using VendorParticipant = eprosima::fastdds::dds::DomainParticipant;

  // Any thread.
  [[nodiscard]] Discovery discovered() const;

#ifdef DYNCAL_FAST_DDS_3
  void on_participant_discovery(VendorParticipant* participant,
                                fast_dds::rtps::ParticipantDiscoveryStatus status,
                                const fast_dds::rtps::ParticipantBuiltinTopicData& data,
                                bool& ignore) override;
  void on_data_writer_discovery(VendorParticipant* participant,
                                fast_dds::rtps::WriterDiscoveryStatus status,
                                const fast_dds::rtps::PublicationBuiltinTopicData& data,
                                bool& ignore) override;
  void on_data_reader_discovery(VendorParticipant* participant,
                                fast_dds::rtps::ReaderDiscoveryStatus status,
                                const fast_dds::rtps::SubscriptionBuiltinTopicData& data,
                                bool& ignore) override;
#else
  void on_participant_discovery(VendorParticipant* participant,
                                fast_dds::rtps::ParticipantDiscoveryInfo&& info) override;
  void on_publisher_discovery(VendorParticipant* participant,
                              fast_dds::rtps::WriterDiscoveryInfo&& info) override;
  void on_subscriber_discovery(VendorParticipant* participant,
                               fast_dds::rtps::ReaderDiscoveryInfo&& info) override;
#endif

private:
  void set(DiscoveredParticipant participant);
  void remove_participant(const std::string& id);
  void set(const std::string& guid, DiscoveredEndpoint endpoint);
  void remove_endpoint(const std::string& guid);

  mutable std::mutex mutex_;
  std::map<std::string, DiscoveredParticipant> participants_; // by their ids
  std::map<std::string, DiscoveredEndpoint> endpoints_;       // by their GUIDs
};

} // namespace dyncal::bus
