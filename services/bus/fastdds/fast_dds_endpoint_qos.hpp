// The QoS of writers and readers as Fast DDS takes it; the reasons stand at each setting.
//
// Writers of live samples publish synchronously: write() hands the packets to the network itself,
// so that a block is on its way when it returns. Where a thread of the implementation does it, 1500
// blocks may wait, and at full rate the last one comes 50 to 180 ms late
// (tests/benchmarks/bus_speed). What is repaired is sent by that thread in any case. Secured
// writers have it: packets are encrypted there, beside the program.
//
// Plain functions, any thread.
#pragma once

#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>

#include "services/bus/qos_profiles.hpp"

namespace dyncal::bus {

// `packet_bytes`: as packet_payload_bytes() has it.
[[nodiscard]] eprosima::fastdds::dds::DataWriterQos fast_dds_writer_qos(const EndpointQos& wanted,
                                                                        int packet_bytes);
[[nodiscard]] eprosima::fastdds::dds::DataWriterQos
fast_dds_secured_writer_qos(const EndpointQos& wanted);
[[nodiscard]] eprosima::fastdds::dds::DataReaderQos fast_dds_reader_qos(const EndpointQos& wanted);

} // namespace dyncal::bus
