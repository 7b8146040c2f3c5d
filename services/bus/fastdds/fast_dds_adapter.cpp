// The bus over Fast DDS. The settings differ from its defaults wherever those lose samples,
// wait for seconds or do not reach Cyclone DDS; a comment at each gives the reason.
#include <algorithm>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <iterator>
#include <map>
#include <mutex>
#include <set>

#include "services/bus/adapters.hpp"
#include "services/bus/default_partition.hpp"
#include "services/bus/fastdds/fast_dds_discovery.hpp"
#include "services/bus/fastdds/fast_dds_endpoint_qos.hpp"
#include "services/bus/fastdds/fast_dds_names.hpp"
#include "services/bus/fastdds/fast_dds_participant_qos.hpp"
#include "services/bus/fastdds/fast_dds_type.hpp"
#include "services/bus/host_network.hpp"
#include "services/bus/packet_size.hpp"
#include "services/bus/qos_profiles.hpp"
#include "services/bus/write_within.hpp"
#include "services/bus/writer_instance.hpp"

namespace dyncal::bus {
namespace {

namespace dds = eprosima::fastdds::dds;

// The lowest number that no participant of this process has. It gives the ports to listen at, and
// those of the first 32 are where peers without multicast look; by itself Fast DDS counts on for
// ever.
class ParticipantNumber {
public:
  ParticipantNumber() {
    const std::lock_guard lock(mutex());
    while (!taken().insert(value_).second) {
      ++value_;
    }
  }
  ParticipantNumber(const ParticipantNumber&) = delete;
  ParticipantNumber& operator=(const ParticipantNumber&) = delete;
  ~ParticipantNumber() {
    const std::lock_guard lock(mutex());
    taken().erase(value_);
  }
  [[nodiscard]] int value() const { return value_; }

private:
  static std::mutex& mutex() {
    static std::mutex mutex;
    return mutex;
  }
  static std::set<int>& taken() {
    static std::set<int> taken;
    return taken;
  }

  int value_ = 0;
};

// The vendor's participant; writers and readers share it, so that the last of them takes it down.
class FastDdsParticipantHandle {
public:
  FastDdsParticipantHandle(std::unique_ptr<ParticipantNumber> number,
                           std::unique_ptr<FastDdsDiscovery> discovery,
                           dds::DomainParticipant* participant,
                           std::shared_ptr<MalformedMessages> malformed,
                           std::shared_ptr<const RefusedPackets> refused)
      : number_(std::move(number)), discovery_(std::move(discovery)), participant_(participant),
        malformed_(std::move(malformed)), refused_(std::move(refused)) {}
  FastDdsParticipantHandle(const FastDdsParticipantHandle&) = delete;
  FastDdsParticipantHandle& operator=(const FastDdsParticipantHandle&) = delete;
  ~FastDdsParticipantHandle() {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }

  [[nodiscard]] dds::DomainParticipant* get() const { return participant_; }
  [[nodiscard]] std::uint64_t malformed_messages() const { return malformed_->count(); }
  [[nodiscard]] std::shared_ptr<const RefusedPackets> refused_packets() const { return refused_; }
  [[nodiscard]] Discovery discovered() const { return discovery_->discovered(); }

  // Topics are made once and live as long as the participant.
  dds::Topic* topic(const TypeSupport& type, const std::string& name) {
    const std::lock_guard lock(mutex_);
    if (auto known = topics_.find(name); known != topics_.end()) {
      return known->second->get_type_name() == type.name ? known->second : nullptr;
    }
    dds::TypeSupport(new FastDdsType(type, malformed_)).register_type(participant_);
    dds::Topic* topic = participant_->create_topic(name, type.name, dds::TOPIC_QOS_DEFAULT);
    if (topic != nullptr) {
      topics_.emplace(name, topic);
    }
    return topic;
  }

private:
  std::unique_ptr<ParticipantNumber> number_;   // given back after the participant is gone
  std::unique_ptr<FastDdsDiscovery> discovery_; // outlives the participant, which calls it
  dds::DomainParticipant* participant_;
  std::shared_ptr<MalformedMessages> malformed_;
  std::shared_ptr<const RefusedPackets> refused_;
  std::mutex mutex_;
  std::map<std::string, dds::Topic*> topics_;
};

class FastDdsWriter : public UntypedWriter {
public:
  FastDdsWriter(std::shared_ptr<FastDdsParticipantHandle> participant, const TypeSupport& type,
                dds::Publisher* publisher, dds::DataWriter* writer)
      : participant_(std::move(participant)), publisher_(publisher), writer_(writer),
        instance_(type.key, &fast_dds_key_hash) {}
  ~FastDdsWriter() override {
    // Emptied under its lock first. Left to itself, 2.9 gives back the samples of a writer that is
    // destroyed without its lock, and a heartbeat that goes through them meanwhile to a reader that
    // still lacks some never ends (Fast DDS pull request 4076, in 2.13).
    std::size_t removed = 0;
    writer_->clear_history(&removed);
    publisher_->delete_datawriter(writer_);
    participant_->get()->delete_publisher(publisher_);
  }

  WriteOutcome write(const EncodedMessage& message, std::chrono::nanoseconds limit) override {
    const auto instance = instance_.of(*message);
    if (!instance) {
      return WriteOutcome::failed;
    }
    FastDdsSample sample;
    sample.encoded = message.get();
    sample.instance = instance.get();
    return write_within(limit, [&] {
      const fast_dds::ReturnCode outcome = writer_->write(&sample, dds::InstanceHandle_t());
      return outcome == fast_dds::ok          ? WriteOutcome::written
             : outcome == fast_dds::timed_out ? WriteOutcome::timed_out
                                              : WriteOutcome::failed;
    });
  }

  [[nodiscard]] int matched_readers() const override {
    dds::PublicationMatchedStatus status;
    writer_->get_publication_matched_status(status);
    return status.current_count;
  }

  bool wait_for_acknowledgments(std::chrono::nanoseconds limit) override {
    return writer_->wait_for_acknowledgments(fast_dds::duration(limit)) == fast_dds::ok;
  }

private:
  std::shared_ptr<FastDdsParticipantHandle> participant_;
  dds::Publisher* publisher_;
  dds::DataWriter* writer_;
  WriterInstance instance_;
};

class RingOnData : public dds::DataReaderListener {
public:
  explicit RingOnData(std::shared_ptr<WakeUp> wake_up) : wake_up_(std::move(wake_up)) {}
  void on_data_available(dds::DataReader* /*reader*/) override { wake_up_->ring(); }

private:
  std::shared_ptr<WakeUp> wake_up_;
};

WriterId writer_of(const dds::SampleInfo& info) {
  const auto& guid = info.sample_identity.writer_guid();
  WriterId writer;
  const auto entity = std::copy(std::begin(guid.guidPrefix.value), std::end(guid.guidPrefix.value),
                                writer.guid.begin());
  std::copy(std::begin(guid.entityId.value), std::end(guid.entityId.value), entity);
  return writer;
}

class FastDdsReader : public UntypedReader {
public:
  FastDdsReader(std::shared_ptr<FastDdsParticipantHandle> participant, dds::Subscriber* subscriber,
                const TypeSupport& type, std::unique_ptr<RingOnData> listener)
      : participant_(std::move(participant)), subscriber_(subscriber),
        listener_(std::move(listener)), message_(type.create(), type.destroy) {
    sample_.message = message_.get();
  }
  ~FastDdsReader() override {
    if (reader_ != nullptr) {
      subscriber_->delete_datareader(reader_);
    }
    participant_->get()->delete_subscriber(subscriber_);
  }

  [[nodiscard]] bool open(dds::Topic* topic, const dds::DataReaderQos& qos) {
    reader_ = subscriber_->create_datareader(topic, qos, listener_.get(),
                                             listener_ ? dds::StatusMask::data_available()
                                                       : dds::StatusMask::none());
    return reader_ != nullptr;
  }

  std::size_t take(const Consume& consume) override {
    std::size_t taken = 0;
    dds::SampleInfo info;
    while (reader_->take_next_sample(&sample_, &info) == fast_dds::ok) {
      if (info.valid_data) {
        ++taken;
        consume(sample_.message, sample_.bytes, writer_of(info));
      }
    }
    return taken;
  }

  [[nodiscard]] int matched_writers() const override {
    dds::SubscriptionMatchedStatus status;
    reader_->get_subscription_matched_status(status);
    return status.current_count;
  }

private:
  std::shared_ptr<FastDdsParticipantHandle> participant_;
  dds::Subscriber* subscriber_;
  std::unique_ptr<RingOnData> listener_;
  dds::DataReader* reader_ = nullptr;
  std::unique_ptr<void, void (*)(void*)> message_;
  FastDdsSample sample_;
};

class FastDdsParticipant : public UntypedParticipant {
public:
  FastDdsParticipant(std::shared_ptr<FastDdsParticipantHandle> participant, bool secured,
                     int packet_bytes, std::vector<std::string> addresses)
      : participant_(std::move(participant)), secured_(secured), packet_bytes_(packet_bytes) {
    addresses_->set(std::move(addresses));
  }

  base::Expected<std::unique_ptr<UntypedWriter>>
  writer(const TypeSupport& type, const std::string& topic, Profile profile,
         const std::vector<std::string>& partitions) override {
    dds::Topic* fast_topic = participant_->topic(type, topic);
    if (fast_topic == nullptr) {
      return fail(base::ErrorCode::network,
                  "Fast DDS refuses topic " + topic + " of type " + type.name);
    }
    dds::PublisherQos publisher_qos;
    for (const std::string& partition : partitions_of_writer(profile, secured_, partitions)) {
      publisher_qos.partition().push_back(partition.c_str());
    }
    dds::Publisher* publisher = participant_->get()->create_publisher(publisher_qos);
    if (publisher == nullptr) {
      return fail(base::ErrorCode::network,
                  "Fast DDS refuses to publish in partition " + partitions.front());
    }
    dds::DataWriter* fast_writer = publisher->create_datawriter(
        fast_topic, secured_ ? fast_dds_secured_writer_qos(qos_of_writer(profile, true))
                             : fast_dds_writer_qos(qos_of_writer(profile), packet_bytes_));
    if (fast_writer == nullptr) {
      participant_->get()->delete_publisher(publisher);
      return fail(base::ErrorCode::network, "Fast DDS refuses a writer of topic " + topic);
    }
    return std::make_unique<FastDdsWriter>(participant_, type, publisher, fast_writer);
  }

  base::Expected<std::unique_ptr<UntypedReader>> reader(const TypeSupport& type,
                                                        const std::string& topic, Profile profile,
                                                        const std::string& partition,
                                                        std::shared_ptr<WakeUp> wake_up) override {
    dds::Topic* fast_topic = participant_->topic(type, topic);
    if (fast_topic == nullptr) {
      return fail(base::ErrorCode::network,
                  "Fast DDS refuses topic " + topic + " of type " + type.name);
    }
    dds::SubscriberQos subscriber_qos;
    subscriber_qos.partition().push_back(partition.c_str());
    dds::Subscriber* subscriber = participant_->get()->create_subscriber(subscriber_qos);
    if (subscriber == nullptr) {
      return fail(base::ErrorCode::network,
                  "Fast DDS refuses to subscribe in partition " + partition);
    }
    auto listener = wake_up ? std::make_unique<RingOnData>(wake_up) : nullptr;
    auto fast_reader =
        std::make_unique<FastDdsReader>(participant_, subscriber, type, std::move(listener));
    if (!fast_reader->open(fast_topic, fast_dds_reader_qos(qos_of_reader(profile, secured_)))) {
      return fail(base::ErrorCode::network, "Fast DDS refuses a reader of topic " + topic);
    }
    if (wake_up) {
      wake_up->ring();
    }
    return fast_reader;
  }

  [[nodiscard]] std::uint64_t malformed_messages() const override {
    return participant_->malformed_messages();
  }

  [[nodiscard]] std::shared_ptr<const RefusedPackets> refused_packets() const override {
    return participant_->refused_packets();
  }

  [[nodiscard]] std::shared_ptr<const OwnAddresses> own_addresses() const override {
    return addresses_;
  }

  [[nodiscard]] Discovery discovered() const override { return participant_->discovered(); }

private:
  std::shared_ptr<FastDdsParticipantHandle> participant_;
  bool secured_;
  int packet_bytes_;
  std::shared_ptr<OwnAddresses> addresses_ = std::make_shared<OwnAddresses>();
};

// The one of its interface, else all but loopback, which it announces where there is nothing else.
std::vector<std::string> announced_addresses(const std::string& interface_name) {
  if (const auto one = interface_address(interface_name); !interface_name.empty() && one) {
    return {*one};
  }
  std::vector<std::string> addresses;
  for (const HostAddress& one : host_addresses().value_or(std::vector<HostAddress>())) {
    if (!one.loopback) {
      addresses.push_back(one.address);
    }
  }
  return addresses.empty() ? std::vector<std::string>{"127.0.0.1"} : addresses;
}

} // namespace

base::Expected<std::unique_ptr<UntypedParticipant>>
create_fast_dds_participant(const ParticipantOptions& options, const SecurityFiles* security) {
  auto transports = std::make_shared<TransportState>(
      std::make_shared<RefusedPackets>(options.warn),
      security == nullptr ? packet_payload_bytes(options) : max_udp_payload_bytes);
  DYNCAL_TRY(auto qos, fast_dds_participant_qos(options, security, transports));
  auto addresses = announced_addresses(options.interface_name);
  auto number = std::make_unique<ParticipantNumber>();
  qos.wire_protocol().participant_id = number->value();
  auto discovery = std::make_unique<FastDdsDiscovery>();
  dds::DomainParticipant* participant =
      dds::DomainParticipantFactory::get_instance()->create_participant(
          static_cast<std::uint32_t>(options.domain), qos,
          options.watch_discovery ? discovery.get() : nullptr, dds::StatusMask::none());
  if (participant == nullptr) {
    return fail(base::ErrorCode::network,
                "Fast DDS cannot join domain " + std::to_string(options.domain) +
                    ": see its messages above, and check the profiles file if you set one");
  }
  transports->listens = true;
  return std::make_unique<FastDdsParticipant>(
      std::make_shared<FastDdsParticipantHandle>(
          std::move(number), std::move(discovery), participant,
          std::make_shared<MalformedMessages>(options.warn), transports->refused),
      security != nullptr, transports->packet_bytes, std::move(addresses));
}

} // namespace dyncal::bus
