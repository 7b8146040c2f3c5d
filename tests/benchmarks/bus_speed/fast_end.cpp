// An end of bus_speed.py on Fast DDS alone: over UDP, with its defaults otherwise. Made from
// dyncal.idl by fastddsgen, and nothing of dyncal.
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <memory>
#include <thread>

#if __has_include(<fastdds/LibrarySettings.hpp>)
#define FAST_DDS_3
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>

#include "dyncalPubSubTypes.hpp"
#else
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

#include "dyncalPubSubTypes.h"
#endif

#include "speed_end.h"

namespace {

using namespace eprosima::fastdds::dds;
#ifdef FAST_DDS_3
namespace rtps = eprosima::fastdds::rtps;
constexpr ReturnCode_t ok = RETCODE_OK;
#else
namespace rtps = eprosima::fastrtps::rtps;
constexpr auto ok = eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
#endif
using Block = dyncal::wire::SampleBlock;

template <class Thing>
Thing* checked(Thing* thing, const char* what) {
  if (thing != nullptr) {
    return thing;
  }
  std::fprintf(stderr, "Fast DDS refuses the %s\n", what);
  std::exit(1);
}

DomainParticipant* join(int domain) {
  DomainParticipantQos qos;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(
      std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>());
#ifdef FAST_DDS_3
  qos.properties().properties().emplace_back(parameter_policy_type_propagation, "disabled");
#endif
  return checked(DomainParticipantFactory::get_instance()->create_participant(
                     static_cast<std::uint32_t>(domain), qos),
                 "participant");
}

Topic* topic_of(DomainParticipant* participant) {
  auto* type = new dyncal::wire::SampleBlockPubSubType;
#ifndef FAST_DDS_3
  type->auto_fill_type_information(false);
  type->auto_fill_type_object(false);
#endif
  TypeSupport support(type);
  support.register_type(participant);
  return checked(participant->create_topic(SPEED_TOPIC, support.get_type_name(), TOPIC_QOS_DEFAULT),
                 "topic");
}

template <class Qos>
Qos every_block() {
  Qos qos;
  qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = VOLATILE_DURABILITY_QOS;
  qos.history().kind = KEEP_ALL_HISTORY_QOS;
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.data_sharing().off();
  return qos;
}

int write_blocks(const SpeedOptions& options) {
  DomainParticipant* participant = join(options.domain);
  PublisherQos publishing;
  publishing.partition().push_back(SPEED_PARTITION);
  DataWriter* writer =
      checked(checked(participant->create_publisher(publishing), "publisher")
                  ->create_datawriter(topic_of(participant), every_block<DataWriterQos>()),
              "writer");
  PublicationMatchedStatus matched;
  while (matched.current_count == 0) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    writer->get_publication_matched_status(matched);
  }
  Block block;
  block.bench(SPEED_PARTITION);
  block.source("dau");
  block.values().resize(options.bytes / sizeof(double));
  for (std::size_t number = 1; number <= options.blocks; ++number) {
    block.block(number);
    block.origin_ns(monotonic_ns());
    while (writer->write(&block, HANDLE_NIL) != ok) {
    }
  }
  writer->wait_for_acknowledgments({LONGEST_SILENCE_S, 0});
  return report_writing();
}

int read_blocks(const SpeedOptions& options) {
  DomainParticipant* participant = join(options.domain);
  SubscriberQos subscribing;
  subscribing.partition().push_back(SPEED_PARTITION);
  DataReader* reader =
      checked(checked(participant->create_subscriber(subscribing), "subscriber")
                  ->create_datareader(topic_of(participant), every_block<DataReaderQos>()),
              "reader");
  Arrivals arrivals = await_arrivals(&options);
  Block block;
  SampleInfo info;
  while (is_awaited(&arrivals)) {
    reader->wait_for_unread_message({1, 0});
    while (reader->take_next_sample(&block, &info) == ok) {
      if (info.valid_data) {
        note_arrival(&arrivals, block.origin_ns());
      }
    }
  }
  return report_arrivals(&arrivals);
}

} // namespace

int main(int argc, char** argv) {
  const SpeedOptions options = speed_options_of(argc, argv);
  const int status = options.writes ? write_blocks(options) : read_blocks(options);
  std::_Exit(status); // what Fast DDS takes down is not measured
}
