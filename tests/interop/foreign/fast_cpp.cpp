// C++ and Fast DDS 2, with types that fastddsgen makes from dyncal.idl.
//
//   fast_cpp read DOMAIN PARTITION BENCH RESULTS FUNCTIONS
//   fast_cpp write DOMAIN PARTITION BENCH SECONDS
//
// What is printed and written is in README.md.
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
#include <string>
#include <thread>

#include "dyncalPubSubTypes.h"

namespace {

using namespace eprosima::fastdds::dds;
using std::chrono::milliseconds;
namespace rtps = eprosima::fastrtps::rtps;
namespace wire = dyncal::wire;

constexpr unsigned samples_a_block = 20;
constexpr milliseconds block_time{20};

template <class Thing>
Thing* checked(Thing* thing, const char* what) {
  if (thing == nullptr) {
    std::fprintf(stderr, "Fast DDS refuses the %s\n", what);
    std::exit(1);
  }
  return thing;
}

template <class Qos>
Qos make_qos(int kept) {
  Qos qos;
  qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
  qos.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
  qos.history().kind = KEEP_LAST_HISTORY_QOS;
  qos.history().depth = kept;
  qos.resource_limits().max_samples = 0;
  qos.resource_limits().max_instances = 0;
  qos.resource_limits().max_samples_per_instance = kept;
  qos.resource_limits().allocated_samples = 0;
  qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  qos.data_sharing().off();
  return qos;
}

template <class PubSubType>
Topic* make_topic(DomainParticipant* participant, const char* name) {
  auto* type = new PubSubType;
  type->auto_fill_type_information(false);
  type->auto_fill_type_object(false);
  TypeSupport support(type);
  support.register_type(participant);
  return checked(participant->create_topic(name, support.get_type_name(), TOPIC_QOS_DEFAULT),
                 "topic");
}

void print(const wire::CalibrationResult& one) {
  std::printf(
      "CalibrationResult\t%s\t%s\t%s\t%u\t%u\t%s\t%.17g\t%.17g\t%.17g\t%.17g\t%s\t%zu\t%s\n",
      one.bench().c_str(), one.run().c_str(), one.channel().c_str(), one.step(), one.repetition(),
      one.frequency_text_hz().c_str(), one.magnitude(), one.u_magnitude(), one.phase_rad(),
      one.u_phase_rad(), one.unit().c_str(), one.budget().size(), one.software().c_str());
}

void print(const wire::TransferFunction& one) {
  std::printf("TransferFunction\t%s\t%s\t%s\t%s\t%.17g\t%zu", one.bench().c_str(),
              one.run().c_str(), one.channel().c_str(), one.unit().c_str(), one.group_delay_s(),
              one.points().size());
  for (const wire::TransferPoint& point : one.points()) {
    std::printf("\t%.17g\t%.17g\t%.17g", point.magnitude(), point.phase_rad(), point.u_phase_rad());
  }
  std::printf("\n");
}

template <class Message, class PubSubType>
class PrintingReader {
public:
  PrintingReader(DomainParticipant* participant, Subscriber* subscriber, const char* topic)
      : reader_(checked(subscriber->create_datareader(make_topic<PubSubType>(participant, topic),
                                                      make_qos<DataReaderQos>(1)),
                        "reader")) {}
  // How many of the bench have come.
  int take(const std::string& bench) {
    int count = 0;
    SampleInfo info;
    Message message;
    while (reader_->take_next_sample(&message, &info) ==
           eprosima::fastrtps::types::ReturnCode_t::RETCODE_OK) {
      if (info.valid_data && message.bench().c_str() == bench) {
        print(message);
        ++count;
      }
    }
    std::fflush(stdout);
    return count;
  }

private:
  DataReader* reader_;
};

void read(DomainParticipant* participant, const char* partition, const std::string& bench,
          int results, int functions) {
  SubscriberQos qos;
  qos.partition().push_back(partition);
  Subscriber* subscriber = checked(participant->create_subscriber(qos), "subscriber");
  PrintingReader<wire::CalibrationResult, wire::CalibrationResultPubSubType> points(
      participant, subscriber, "CalibrationResult");
  PrintingReader<wire::TransferFunction, wire::TransferFunctionPubSubType> curves(
      participant, subscriber, "TransferFunction");
  while (results > 0 || functions > 0) {
    results -= points.take(bench);
    functions -= curves.take(bench);
    std::this_thread::sleep_for(block_time);
  }
}

wire::SourceDescription description(const std::string& bench, std::uint64_t session) {
  wire::SourceDescription source;
  source.bench(bench);
  source.source("acs");
  source.session(session);
  source.kind(wire::SOURCE_ACS);
  source.device("foreign source");
  source.channels().resize(2);
  source.channels()[0].name("reference");
  source.channels()[0].quantity("Acceleration");
  source.channels()[0].unit("\\metre\\second\\tothe{-2}");
  source.channels()[1].name("sync");
  source.channels()[1].quantity("Voltage");
  source.channels()[1].unit("\\volt");
  source.nominal_rate_hz(1000.0);
  source.contract_version(wire::CONTRACT_VERSION);
  return source;
}

DataWriter* make_writer(Publisher* publisher, Topic* topic, int kept) {
  auto qos = make_qos<DataWriterQos>(kept);
  qos.publish_mode().kind = ASYNCHRONOUS_PUBLISH_MODE;
  qos.reliable_writer_qos().times.heartbeatPeriod = {0, 10'000'000};
  qos.reliable_writer_qos().times.nackResponseDelay = {0, 0};
  qos.writer_data_lifecycle().autodispose_unregistered_instances = false;
  return checked(publisher->create_datawriter(topic, qos), "writer");
}

void write(DomainParticipant* participant, const char* partition, const std::string& bench,
           double seconds) {
  PublisherQos qos;
  qos.partition().push_back(partition);
  Publisher* publisher = checked(participant->create_publisher(qos), "publisher");
  DataWriter* descriptions = make_writer(
      publisher, make_topic<wire::SourceDescriptionPubSubType>(participant, "SourceDescription"),
      1);
  DataWriter* writer = make_writer(
      publisher, make_topic<wire::SampleBlockPubSubType>(participant, "AcsSamples"), 250);
  const auto begin = std::chrono::steady_clock::now();
  const auto session = static_cast<std::uint64_t>(begin.time_since_epoch().count());
  auto source = description(bench, session);
  descriptions->write(&source);
  wire::SampleBlock block;
  block.bench(bench);
  block.source("acs");
  block.session(session);
  block.origin_ns(250'000'000'000'000'000);
  block.interval_numerator_ns(1'000'000);
  block.interval_denominator(1);
  const auto blocks = static_cast<std::uint64_t>(seconds * 1000 / block_time.count());
  for (std::uint64_t number = 0; number <= blocks; ++number) {
    const unsigned count = number < blocks ? samples_a_block : 0;
    block.block(number);
    block.first_sample(number * samples_a_block);
    block.end_of_stream(count == 0);
    block.sample_count(count);
    block.channel_count(count == 0 ? 0 : 2);
    block.values().resize(std::size_t{2} * count);
    for (unsigned i = 0; i < count; ++i) {
      const auto sample = static_cast<double>(block.first_sample() + i);
      block.values()[i] = sample * 0.25;
      block.values()[count + i] = sample * -0.5;
    }
    writer->write(&block);
    std::this_thread::sleep_until(begin + number * block_time);
  }
  std::printf("written\t%llu\n", static_cast<unsigned long long>(blocks * samples_a_block));
  std::fflush(stdout);
  std::this_thread::sleep_for(std::chrono::seconds(3)); // repairs of the last blocks
}

} // namespace

int main(int argc, char** argv) {
  if (argc < 6) {
    std::fprintf(stderr, "usage: %s read|write DOMAIN PARTITION BENCH COUNT...\n", argv[0]);
    return 2;
  }
  auto* factory = DomainParticipantFactory::get_instance();
  factory->load_profiles();
  DomainParticipantQos qos;
  factory->get_default_participant_qos(qos);
  auto* participant =
      checked(factory->create_participant(static_cast<std::uint32_t>(std::atoi(argv[2])), qos),
              "participant");
  if (std::string(argv[1]) == "write") {
    write(participant, argv[3], argv[4], std::atof(argv[5]));
  } else {
    read(participant, argv[3], argv[4], std::atoi(argv[5]), std::atoi(argv[argc - 1]));
  }
}
