#include "services/bus/fastdds/fast_dds_discovery.hpp"

#include <limits>
#include <span>

#include "services/bus/participant_name.hpp"

namespace dyncal::bus {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = fast_dds::rtps;

std::string prefix_of(const rtps::GUID_t& guid) {
  return hexadecimal(guid.guidPrefix.value, rtps::GuidPrefix_t::size);
}

std::string key_of(const rtps::GUID_t& guid) {
  return prefix_of(guid) + hexadecimal(guid.entityId.value, rtps::EntityId_t::size);
}

double seconds(const fast_dds::Duration& duration) {
  return duration.seconds == fast_dds::infinite.seconds
             ? std::numeric_limits<double>::infinity()
             : duration.seconds + 1e-9 * duration.nanosec;
}

// The first of these that it announces.
template <class Properties>
std::string property_of(const Properties& properties, std::span<const char* const> names) {
  for (const char* name : names) {
    for (auto one = properties.begin(); one != properties.end(); ++one) {
      if (one->first() == name) {
        return one->second();
      }
    }
  }
  return "";
}

#ifdef DYNCAL_FAST_DDS_3
template <class Data>
const Data& policies_of(const Data& data) {
  return data;
}
#else
// Under the names of version 3.
struct Policies {
  const dds::PartitionQosPolicy& partition;
  const dds::ReliabilityQosPolicy& reliability;
  const dds::DurabilityQosPolicy& durability;
  const dds::OwnershipQosPolicy& ownership;
  const dds::DeadlineQosPolicy& deadline;
  const dds::LatencyBudgetQosPolicy& latency_budget;
  const dds::LivelinessQosPolicy& liveliness;
  const dds::PresentationQosPolicy& presentation;
  const dds::DestinationOrderQosPolicy& destination_order;
  const dds::DataRepresentationQosPolicy& representation;
  rtps::GUID_t guid;
  eprosima::fastrtps::string_255 topic_name;
  eprosima::fastrtps::string_255 type_name;
};

template <class Data>
Policies policies_of(const Data& data) {
  const auto& qos = data.m_qos;
  return {qos.m_partition,        qos.m_reliability,   qos.m_durability, qos.m_ownership,
          qos.m_deadline,         qos.m_latencyBudget, qos.m_liveliness, qos.m_presentation,
          qos.m_destinationOrder, qos.representation,  data.guid(),      data.topicName(),
          data.typeName()};
}
#endif

template <class Data>
DiscoveredEndpoint endpoint_of(const Data& data, EndpointKind kind) {
  const auto& qos = policies_of(data);
  DiscoveredEndpoint endpoint{
      .participant = prefix_of(qos.guid),
      .kind = kind,
      .topic = qos.topic_name.to_string(),
      .type = qos.type_name.to_string(),
      .partitions = qos.partition.getNames(),
      .reliable = qos.reliability.kind == dds::RELIABLE_RELIABILITY_QOS,
      .transient_local = qos.durability.kind >= dds::TRANSIENT_LOCAL_DURABILITY_QOS,
      .exclusive_ownership = qos.ownership.kind == dds::EXCLUSIVE_OWNERSHIP_QOS,
      .deadline_s = seconds(qos.deadline.period),
      .latency_budget_s = seconds(qos.latency_budget.duration),
      .liveliness = static_cast<Liveliness>(qos.liveliness.kind),
      .lease_s = seconds(qos.liveliness.lease_duration),
      .access_scope = static_cast<AccessScope>(qos.presentation.access_scope),
      .coherent_access = qos.presentation.coherent_access,
      .ordered_access = qos.presentation.ordered_access,
      .destination_order = static_cast<DestinationOrder>(qos.destination_order.kind)};
  endpoint.representations.assign(qos.representation.m_value.begin(),
                                  qos.representation.m_value.end());
  if (endpoint.partitions.empty()) {
    endpoint.partitions.emplace_back();
  }
  return endpoint;
}

} // namespace

Discovery FastDdsDiscovery::discovered() const {
  const std::lock_guard lock(mutex_);
  Discovery discovery;
  for (const auto& [id, participant] : participants_) {
    discovery.participants.push_back(participant);
  }
  for (const auto& [guid, endpoint] : endpoints_) {
    if (participants_.contains(endpoint.participant)) {
      discovery.endpoints.push_back(endpoint);
    }
  }
  return discovery;
}

void FastDdsDiscovery::set(DiscoveredParticipant participant) {
  const std::lock_guard lock(mutex_);
  std::string id = participant.id;
  participants_[std::move(id)] = std::move(participant);
}

void FastDdsDiscovery::remove_participant(const std::string& id) {
  const std::lock_guard lock(mutex_);
  participants_.erase(id);
  std::erase_if(endpoints_, [&](const auto& one) { return one.second.participant == id; });
}

void FastDdsDiscovery::set(const std::string& guid, DiscoveredEndpoint endpoint) {
  const std::lock_guard lock(mutex_);
  endpoints_[guid] = std::move(endpoint);
}

void FastDdsDiscovery::remove_endpoint(const std::string& guid) {
  const std::lock_guard lock(mutex_);
  endpoints_.erase(guid);
}

#ifdef DYNCAL_FAST_DDS_3
void FastDdsDiscovery::on_participant_discovery(VendorParticipant* /*participant*/,
                                                rtps::ParticipantDiscoveryStatus status,
                                                const rtps::ParticipantBuiltinTopicData& data,
                                                bool& /*ignore*/) {
  const std::string id = prefix_of(data.guid);
  if (status == rtps::ParticipantDiscoveryStatus::REMOVED_PARTICIPANT ||
      status == rtps::ParticipantDiscoveryStatus::DROPPED_PARTICIPANT) {
    remove_participant(id);
  } else {
    set({id,
         participant_name(data.participant_name.to_string(),
                          property_of(data.properties, process_keys),
                          property_of(data.properties, host_keys)),
         vendor_of(id)});
  }
}

void FastDdsDiscovery::on_data_writer_discovery(VendorParticipant* /*participant*/,
                                                rtps::WriterDiscoveryStatus status,
                                                const rtps::PublicationBuiltinTopicData& data,
                                                bool& /*ignore*/) {
  if (status == rtps::WriterDiscoveryStatus::REMOVED_WRITER) {
    remove_endpoint(key_of(data.guid));
  } else {
    set(key_of(data.guid), endpoint_of(data, EndpointKind::writer));
  }
}

void FastDdsDiscovery::on_data_reader_discovery(VendorParticipant* /*participant*/,
                                                rtps::ReaderDiscoveryStatus status,
                                                const rtps::SubscriptionBuiltinTopicData& data,
                                                bool& /*ignore*/) {
  if (status == rtps::ReaderDiscoveryStatus::REMOVED_READER) {
    remove_endpoint(key_of(data.guid));
  } else {
    set(key_of(data.guid), endpoint_of(data, EndpointKind::reader));
  }
}
#else
void FastDdsDiscovery::on_participant_discovery(VendorParticipant* /*participant*/,
                                                rtps::ParticipantDiscoveryInfo&& info) {
  const std::string id = prefix_of(info.info.m_guid);
  if (info.status == rtps::ParticipantDiscoveryInfo::REMOVED_PARTICIPANT ||
      info.status == rtps::ParticipantDiscoveryInfo::DROPPED_PARTICIPANT) {
    remove_participant(id);
  } else {
    set({id,
         participant_name(info.info.m_participantName.to_string(),
                          property_of(info.info.m_properties, process_keys),
                          property_of(info.info.m_properties, host_keys)),
         vendor_of(id)});
  }
}

void FastDdsDiscovery::on_publisher_discovery(VendorParticipant* /*participant*/,
                                              rtps::WriterDiscoveryInfo&& info) {
  if (info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER) {
    remove_endpoint(key_of(info.info.guid()));
  } else {
    set(key_of(info.info.guid()), endpoint_of(info.info, EndpointKind::writer));
  }
}

void FastDdsDiscovery::on_subscriber_discovery(VendorParticipant* /*participant*/,
                                               rtps::ReaderDiscoveryInfo&& info) {
  if (info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER) {
    remove_endpoint(key_of(info.info.guid()));
  } else {
    set(key_of(info.info.guid()), endpoint_of(info.info, EndpointKind::reader));
  }
}
#endif

} // namespace dyncal::bus
