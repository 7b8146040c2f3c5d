// Another tool on the bus: made from dyncal.idl by fastddsgen and from idl/README.md, with nothing
// of dyncal.
//
//   native_fast_peer DOMAIN FROM_PARTITION TO_PARTITION
//
// Reads three topics in one partition and writes what it reads into another, unchanged. A reader of
// a fourth topic asks for what dyncal offers to nobody. Runs until it is killed.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <thread>

#if __has_include(<fastdds/LibrarySettings.hpp>)
#define FAST_DDS_3
#include "dyncalPubSubTypes.hpp"
#else
#include "dyncalPubSubTypes.h"
#endif

namespace {

using namespace eprosima::fastdds::dds;
#ifdef FAST_DDS_3
namespace rtps = eprosima::fastdds::rtps;
constexpr ReturnCode_t ok = RETCODE_OK;
#else
namespace rtps = eprosima::fastrtps::rtps;
constexpr auto ok = eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK;
#endif

template <class Thing>
Thing* checked(Thing* thing, const char* what) {
  if (thing != nullptr) {
    return thing;
  }
  std::fprintf(stderr, "Fast DDS refuses the %s\n", what);
  std::exit(1);
}

enum class History { keep_all, keep_last }; // profile "samples"; "state" or "results"

template <class Qos>
Qos make_qos(History history) {
  Qos qos;
  qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
  qos.history().kind = history == History::keep_all ? KEEP_ALL_HISTORY_QOS : KEEP_LAST_HISTORY_QOS;
  qos.history().depth = 1;
  qos.resource_limits().max_samples = 0;
  qos.resource_limits().max_instances = 0;
  qos.resource_limits().max_samples_per_instance = history == History::keep_all ? 1500 : 1;
  qos.resource_limits().allocated_samples = 0;
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.data_sharing().off();
#ifdef FAST_DDS_3
  qos.representation().m_value = {XCDR_DATA_REPRESENTATION};
#endif
  return qos;
}

template <class PubSubType>
Topic* make_topic(DomainParticipant* participant, const char* topic_name) {
  auto* type = new PubSubType;
#ifndef FAST_DDS_3
  type->auto_fill_type_information(false);
  type->auto_fill_type_object(false);
#endif
  TypeSupport support(type);
  support.register_type(participant);
  return checked(participant->create_topic(topic_name, support.get_type_name(), TOPIC_QOS_DEFAULT),
                 "topic");
}

void ask_for_more(DomainParticipant* participant, const char* partition) {
  Topic* topic = make_topic<dyncal::wire::ExcitationPubSubType>(participant, "Excitation");
  SubscriberQos reading;
  reading.partition().push_back(partition);
  Subscriber* subscriber = checked(participant->create_subscriber(reading), "subscriber");
  auto qos = make_qos<DataReaderQos>(History::keep_last);
  qos.ownership().kind = EXCLUSIVE_OWNERSHIP_QOS;
  qos.deadline().period = {1, 0};
  qos.liveliness().kind = MANUAL_BY_TOPIC_LIVELINESS_QOS;
  qos.liveliness().lease_duration = {2, 0};
  qos.liveliness().announcement_period = {1, 0};
  checked(subscriber->create_datareader(topic, qos), "reader");
}

template <class Sample, class PubSubType>
class Echo {
public:
  Echo(DomainParticipant* participant, const char* topic_name, History history, const char* from,
       const char* to) {
    Topic* topic = make_topic<PubSubType>(participant, topic_name);

    SubscriberQos reading;
    reading.partition().push_back(from);
    Subscriber* subscriber = checked(participant->create_subscriber(reading), "subscriber");
    reader_ =
        checked(subscriber->create_datareader(topic, make_qos<DataReaderQos>(history)), "reader");

    PublisherQos writing;
    writing.partition().push_back(to);
    Publisher* publisher = checked(participant->create_publisher(writing), "publisher");
    auto qos = make_qos<DataWriterQos>(history);
    qos.publish_mode().kind = ASYNCHRONOUS_PUBLISH_MODE;
    auto& times = qos.reliable_writer_qos().times;
#ifdef FAST_DDS_3
    times.heartbeat_period = {0, 10'000'000};
    times.nack_response_delay = {0, 0};
#else
    times.heartbeatPeriod = {0, 10'000'000};
    times.nackResponseDelay = {0, 0};
#endif
    qos.writer_data_lifecycle().autodispose_unregistered_instances = false;
    writer_ = checked(publisher->create_datawriter(topic, qos), "writer");
  }

  void run() {
    SampleInfo info;
    while (reader_->take_next_sample(&sample_, &info) == ok) {
      if (!info.valid_data) {
        continue;
      }
      // It may give up before its time, so it is asked again.
      while (writer_->write(&sample_, HANDLE_NIL) != ok) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    }
  }

private:
  DataReader* reader_ = nullptr;
  DataWriter* writer_ = nullptr;
  Sample sample_;
};

} // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: %s DOMAIN FROM_PARTITION TO_PARTITION\n", argv[0]);
    return 2;
  }
  auto* factory = DomainParticipantFactory::get_instance();
  factory->load_profiles();
  DomainParticipantQos qos;
  factory->get_default_participant_qos(qos);
#ifdef FAST_DDS_3
  qos.properties().properties().emplace_back(parameter_policy_type_propagation, "disabled");
#endif
  auto* participant =
      checked(factory->create_participant(static_cast<std::uint32_t>(std::atoi(argv[1])), qos),
              "participant");
  Echo<dyncal::wire::SampleBlock, dyncal::wire::SampleBlockPubSubType> blocks(
      participant, "DauSamples", History::keep_all, argv[2], argv[3]);
  Echo<dyncal::wire::Measurement, dyncal::wire::MeasurementPubSubType> measurements(
      participant, "Measurement", History::keep_last, argv[2], argv[3]);
  Echo<dyncal::wire::CalibrationResult, dyncal::wire::CalibrationResultPubSubType> results(
      participant, "CalibrationResult", History::keep_last, argv[2], argv[3]);
  ask_for_more(participant, argv[2]);
  while (true) {
    blocks.run();
    measurements.run();
    results.run();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}
