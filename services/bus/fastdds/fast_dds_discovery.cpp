#include "services/bus/fastdds/fast_dds_discovery.hpp"

#include <limits>

namespace dyncal::bus {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

std::string prefix_of(const rtps::GUID_t& guid) {
  return hexadecimal(guid.guidPrefix.value, rtps::GuidPrefix_t::size);
}

std::string key_of(const rtps::GUID_t& guid) {
  return prefix_of(guid) + hexadecimal(guid.entityId.value, rtps::EntityId_t::size);
}

double seconds(const eprosima::fastrtps::Duration_t& duration) {
  return duration.seconds == eprosima::fastrtps::c_TimeInfinite.seconds
             ? std::numeric_limits<double>::infinity()
             : duration.seconds + 1e-9 * duration.nanosec;
}

template <class Data>
DiscoveredEndpoint endpoint_of(const Data& data, EndpointKind kind) {
  DiscoveredEndpoint endpoint{
      .participant = prefix_of(data.guid()),
      .kind = kind,
      .topic = data.topicName().to_string(),
      .type = data.typeName().to_string(),
      .partitions = data.m_qos.m_partition.getNames(),
      .reliable = data.m_qos.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS,
      .transient_local = data.m_qos.m_durability.kind >= dds::TRANSIENT_LOCAL_DURABILITY_QOS,
      .exclusive_ownership = data.m_qos.m_ownership.kind == dds::EXCLUSIVE_OWNERSHIP_QOS,
      .deadline_s = seconds(data.m_qos.m_deadline.period),
      .latency_budget_s = seconds(data.m_qos.m_latencyBudget.duration),
      .liveliness = static_cast<Liveliness>(data.m_qos.m_liveliness.kind),
      .lease_s = seconds(data.m_qos.m_liveliness.lease_duration),
      .access_scope = static_cast<AccessScope>(data.m_qos.m_presentation.access_scope),
      .coherent_access = data.m_qos.m_presentation.coherent_access,
      .ordered_access = data.m_qos.m_presentation.ordered_access,
      .destination_order = static_cast<DestinationOrder>(data.m_qos.m_destinationOrder.kind)};
  endpoint.representations.assign(data.m_qos.representation.m_value.begin(),
                                  data.m_qos.representation.m_value.end());
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

void FastDdsDiscovery::on_participant_discovery(dds::DomainParticipant* /*participant*/,
                                                rtps::ParticipantDiscoveryInfo&& info) {
  const std::string id = prefix_of(info.info.m_guid);
  const std::lock_guard lock(mutex_);
  if (info.status == rtps::ParticipantDiscoveryInfo::REMOVED_PARTICIPANT ||
      info.status == rtps::ParticipantDiscoveryInfo::DROPPED_PARTICIPANT) {
    participants_.erase(id);
    std::erase_if(endpoints_, [&](const auto& one) { return one.second.participant == id; });
  } else {
    participants_[id] = {id, info.info.m_participantName.to_string(), vendor_of(id)};
  }
}

void FastDdsDiscovery::on_publisher_discovery(dds::DomainParticipant* /*participant*/,
                                              rtps::WriterDiscoveryInfo&& info) {
  const std::lock_guard lock(mutex_);
  if (info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER) {
    endpoints_.erase(key_of(info.info.guid()));
  } else {
    endpoints_[key_of(info.info.guid())] = endpoint_of(info.info, EndpointKind::writer);
  }
}

void FastDdsDiscovery::on_subscriber_discovery(dds::DomainParticipant* /*participant*/,
                                               rtps::ReaderDiscoveryInfo&& info) {
  const std::lock_guard lock(mutex_);
  if (info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER) {
    endpoints_.erase(key_of(info.info.guid()));
  } else {
    endpoints_[key_of(info.info.guid())] = endpoint_of(info.info, EndpointKind::reader);
  }
}

} // namespace dyncal::bus
