#include "services/bus/fastdds/fast_dds_endpoint_qos.hpp"

#include "services/bus/fastdds/fast_dds_names.hpp"

namespace dyncal::bus {
namespace {

namespace dds = eprosima::fastdds::dds;

template <class Qos>
void set_common(const EndpointQos& wanted, Qos& qos) {
  qos.reliability().kind =
      wanted.reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind =
      wanted.transient_local ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = wanted.keep_all ? dds::KEEP_ALL_HISTORY_QOS : dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = wanted.keep_all ? 1 : wanted.samples_per_key;
  // 0 is unlimited. With the defaults (5000, 10, 400) the eleventh key is never written, or is
  // received, acknowledged and dropped.
  qos.resource_limits().max_samples = 0;
  qos.resource_limits().max_instances = 0;
  qos.resource_limits().max_samples_per_instance = wanted.samples_per_key;
  qos.resource_limits().allocated_samples = 0;
  // The mode DYNAMIC_REUSABLE cannot deliver the end of an instance.
  qos.endpoint().history_memory_policy = fast_dds::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.data_sharing().off();
#ifdef DYNCAL_FAST_DDS_3
  qos.representation().m_value = {dds::XCDR_DATA_REPRESENTATION};
#endif
}

dds::DataWriterQos common_writer_qos(const EndpointQos& wanted,
                                     std::chrono::milliseconds heartbeat) {
  dds::DataWriterQos qos;
  set_common(wanted, qos);
  qos.reliability().max_blocking_time = fast_dds::duration(write_attempt);
  qos.writer_data_lifecycle().autodispose_unregistered_instances = false;
  auto& times = qos.reliable_writer_qos().times;
  // 3 s by default: so long a lost last packet would stay unnoticed.
  fast_dds::heartbeat_period(times) = fast_dds::duration(heartbeat);
  fast_dds::nack_response_delay(times) = fast_dds::duration(std::chrono::seconds(0));
  // With one in every packet, a Fast DDS reader asks hundreds of times a second for every sample
  // that is on the way: a link of 10 Mbit/s is then full of requests and of what they ask for.
  qos.reliable_writer_qos().disable_heartbeat_piggyback = true;
  return qos;
}

} // namespace

dds::DataWriterQos fast_dds_writer_qos(const EndpointQos& wanted, int packet_bytes) {
  dds::DataWriterQos qos = common_writer_qos(wanted, fast_dds_heartbeat);
  const bool has_long_packets = packet_bytes > max_udp_payload_bytes;
  qos.publish_mode().kind =
      wanted.sent_by_write ? dds::SYNCHRONOUS_PUBLISH_MODE : dds::ASYNCHRONOUS_PUBLISH_MODE;
  // A block that is one packet is there or lost, and on no narrow link: to ask at once shortens the
  // wait for what did not fit into the buffer of a socket.
  qos.reliable_writer_qos().disable_heartbeat_piggyback = !has_long_packets;
  if (has_long_packets && wanted.keep_all && wanted.sent_by_write) {
    qos.resource_limits().max_samples_per_instance = fast_dds_window_blocks;
  }
  return qos;
}

dds::DataWriterQos fast_dds_secured_writer_qos(const EndpointQos& wanted) {
  dds::DataWriterQos qos = common_writer_qos(wanted, fast_dds_secured_heartbeat);
  qos.publish_mode().kind = dds::ASYNCHRONOUS_PUBLISH_MODE;
  return qos;
}

dds::DataReaderQos fast_dds_reader_qos(const EndpointQos& wanted) {
  dds::DataReaderQos qos;
  set_common(wanted, qos);
  // The default of 5 ms divides the rate from a Cyclone DDS writer by twenty.
  auto& times = qos.reliable_reader_qos().times;
  fast_dds::heartbeat_response_delay(times) = fast_dds::duration(std::chrono::seconds(0));
  return qos;
}

} // namespace dyncal::bus
