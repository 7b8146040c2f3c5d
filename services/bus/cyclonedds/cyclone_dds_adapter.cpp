// The bus over Cyclone DDS 0.10.
#include <algorithm>
#include <dds/dds.h>
#include <iterator>
#include <map>
#include <mutex>

#include "services/bus/adapters.hpp"
#include "services/bus/cyclonedds/cyclone_dds_addresses.h"
#include "services/bus/cyclonedds/cyclone_dds_config.hpp"
#include "services/bus/cyclonedds/cyclone_dds_discovery.hpp"
#include "services/bus/cyclonedds/cyclone_dds_log.hpp"
#include "services/bus/cyclonedds/cyclone_dds_security.hpp"
#include "services/bus/cyclonedds/cyclone_dds_threads.hpp"
#include "services/bus/cyclonedds/cyclone_dds_type.hpp"
#include "services/bus/default_partition.hpp"
#include "services/bus/host_network.hpp"
#include "services/bus/qos_profiles.hpp"
#include "services/bus/write_within.hpp"
#include "services/bus/writer_instance.hpp"

namespace dyncal::bus {
namespace {

base::Error cyclone_error(const std::string& what, dds_return_t code) {
  return {base::ErrorCode::network, what + ": " + dds_strretcode(-code)};
}

// Owns one thing of Cyclone DDS; deleting it deletes what it contains.
class Entity {
public:
  explicit Entity(dds_entity_t handle) : handle_(handle) {}
  Entity(const Entity&) = delete;
  Entity& operator=(const Entity&) = delete;
  ~Entity() {
    if (handle_ > 0) {
      dds_delete(handle_);
    }
  }
  [[nodiscard]] dds_entity_t get() const { return handle_; }

private:
  dds_entity_t handle_;
};

// Cyclone DDS configures a domain once a process, so that all participants in it share the settings
// of the first.
struct Domain {
  Entity entity;
  std::string config;
};

base::Expected<std::shared_ptr<Domain>> open_domain(int number, const std::string& config) {
  static std::mutex mutex;
  static std::map<int, std::weak_ptr<Domain>> open;
  const std::lock_guard lock(mutex);
  if (auto domain = open[number].lock()) {
    if (domain->config == config) {
      return domain;
    }
    return fail(base::ErrorCode::network,
                "Cyclone DDS domain " + std::to_string(number) +
                    " is open in this process with other network settings");
  }
  DYNCAL_TRY(check_threads_for_cyclone_dds());
  const dds_entity_t handle =
      dds_create_domain(static_cast<dds_domainid_t>(number), config.c_str());
  if (handle < 0) {
    return fail(cyclone_error("Cyclone DDS cannot open domain " + std::to_string(number) +
                                  " (see its messages above; a machine holds " +
                                  std::to_string(participants_per_host - 1) +
                                  " programs of a domain, and CYCLONEDDS_URI may be the cause)",
                              handle));
  }
  auto domain = std::shared_ptr<Domain>(new Domain{Entity(handle), config});
  open[number] = domain;
  return domain;
}

// Writers and readers share it, so that the last of them takes it down. The domain is closed
// after the participant.
struct CycloneParticipantHandle {
  std::shared_ptr<Domain> domain;
  Entity entity;
  std::shared_ptr<MalformedMessages> malformed;
  std::shared_ptr<const RefusedPackets> refused;
};

std::vector<std::string> addresses_of(const ddsi_domaingv& domain) {
  const CycloneDdsAddresses own = cyclone_dds_addresses_of(&domain);
  std::vector<std::string> addresses;
  for (int i = 0; i < own.count; ++i) {
    const unsigned char* bytes = own.ipv4[i];
    addresses.push_back(std::to_string(bytes[0]) + "." + std::to_string(bytes[1]) + "." +
                        std::to_string(bytes[2]) + "." + std::to_string(bytes[3]));
  }
  return addresses;
}

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

Qos common_qos(const EndpointQos& wanted, const std::vector<std::string>& partitions) {
  Qos qos(dds_create_qos());
  dds_qset_reliability(qos.get(),
                       wanted.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT,
                       std::chrono::nanoseconds(write_attempt).count());
  dds_qset_durability(qos.get(), wanted.transient_local ? DDS_DURABILITY_TRANSIENT_LOCAL
                                                        : DDS_DURABILITY_VOLATILE);
  // A writer that keeps the last samples is never held back, by however many bytes it is ahead.
  dds_qset_history(qos.get(), wanted.keep_all ? DDS_HISTORY_KEEP_ALL : DDS_HISTORY_KEEP_LAST,
                   wanted.keep_all ? 1 : wanted.samples_per_key);
  std::vector<const char*> names;
  names.reserve(partitions.size());
  for (const std::string& partition : partitions) {
    names.push_back(partition.c_str());
  }
  dds_qset_partition(qos.get(), static_cast<std::uint32_t>(names.size()), names.data());
  return qos;
}

Qos writer_qos(const EndpointQos& wanted, const std::vector<std::string>& partitions) {
  Qos qos = common_qos(wanted, partitions);
  if (wanted.transient_local) {
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, wanted.for_late_joiners,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  // True by default: the end of a writer would read as the end of all its instances.
  dds_qset_writer_data_lifecycle(qos.get(), false);
  return qos;
}

Qos reader_qos(const EndpointQos& wanted, const std::string& partition) {
  Qos qos = common_qos(wanted, {partition});
  if (wanted.keep_all) {
    dds_qset_resource_limits(qos.get(), DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED,
                             wanted.samples_per_key);
  }
  return qos;
}

class CycloneWriter : public UntypedWriter {
public:
  CycloneWriter(std::shared_ptr<CycloneParticipantHandle> participant, const TypeSupport& type,
                dds_entity_t topic, dds_entity_t writer)
      : participant_(std::move(participant)), topic_(topic), writer_(writer),
        instance_(type.key, &cyclone_dds_key_hash) {}

  WriteOutcome write(const EncodedMessage& message, std::chrono::nanoseconds limit) override {
    const OutgoingMessage outgoing{message, instance_.of(*message)};
    if (!outgoing.instance) {
      return WriteOutcome::failed;
    }
    return write_within(limit, [&] {
      const dds_return_t outcome = dds_write(writer_.get(), &outgoing);
      return outcome == DDS_RETCODE_OK        ? WriteOutcome::written
             : outcome == DDS_RETCODE_TIMEOUT ? WriteOutcome::timed_out
                                              : WriteOutcome::failed;
    });
  }

  [[nodiscard]] int matched_readers() const override {
    dds_publication_matched_status_t status{};
    dds_get_publication_matched_status(writer_.get(), &status);
    return static_cast<int>(status.current_count);
  }

  bool wait_for_acknowledgments(std::chrono::nanoseconds limit) override {
    return dds_wait_for_acks(writer_.get(), limit.count()) == DDS_RETCODE_OK;
  }

private:
  std::shared_ptr<CycloneParticipantHandle> participant_;
  Entity topic_;
  Entity writer_;
  WriterInstance instance_;
};

struct SerdataDeleter {
  void operator()(ddsi_serdata* serdata) const { release_cyclone_serdata(serdata); }
};
using Serdata = std::unique_ptr<ddsi_serdata, SerdataDeleter>;

struct EndpointDeleter {
  void operator()(dds_builtintopic_endpoint_t* endpoint) const {
    dds_builtintopic_free_endpoint(endpoint);
  }
};

void ring(dds_entity_t /*reader*/, void* wake_up) {
  static_cast<WakeUp*>(wake_up)->ring();
}

class CycloneReader : public UntypedReader {
public:
  CycloneReader(std::shared_ptr<CycloneParticipantHandle> participant, dds_entity_t topic,
                dds_entity_t reader, const TypeSupport& type, std::shared_ptr<WakeUp> wake_up)
      : participant_(std::move(participant)), wake_up_(std::move(wake_up)), type_(type),
        sample_(type.create(), type.destroy), topic_(topic), reader_(reader) {}
  CycloneReader(const CycloneReader&) = delete;
  CycloneReader& operator=(const CycloneReader&) = delete;
  // Cyclone DDS 0.10 does not end a reader that is full while samples come for it: its receiving
  // thread waits for room, and the end of the reader for that thread.
  ~CycloneReader() override {
    ddsi_serdata* serdata = nullptr;
    dds_sample_info_t info;
    while (dds_takecdr(reader_.get(), &serdata, 1, &info, DDS_ANY_STATE) > 0) {
      release_cyclone_serdata(serdata);
    }
  }

  std::size_t take(const Consume& consume) override {
    std::size_t taken = 0;
    ddsi_serdata* serdata = nullptr;
    dds_sample_info_t info;
    while (dds_takecdr(reader_.get(), &serdata, 1, &info, DDS_ANY_STATE) > 0) {
      const Serdata owned(serdata);
      if (info.valid_data && read_cyclone_serdata(type_, serdata, sample_.get())) {
        ++taken;
        consume(sample_.get(), payload_of(serdata), writer_of(info.publication_handle));
      } else if (info.valid_data) { // otherwise it is the end of an instance
        participant_->malformed->add(type_.name);
      }
    }
    return taken;
  }

  [[nodiscard]] int matched_writers() const override {
    dds_subscription_matched_status_t status{};
    dds_get_subscription_matched_status(reader_.get(), &status);
    return static_cast<int>(status.current_count);
  }

private:
  // Asked for once; a handle is never given again.
  WriterId writer_of(dds_instance_handle_t handle) {
    if (handle == last_handle_) {
      return last_writer_;
    }
    if (const auto known = writers_.find(handle); known != writers_.end()) {
      last_handle_ = handle;
      last_writer_ = known->second;
      return last_writer_;
    }
    const std::unique_ptr<dds_builtintopic_endpoint_t, EndpointDeleter> endpoint(
        dds_get_matched_publication_data(reader_.get(), handle));
    if (!endpoint) {
      return {};
    }
    if (writers_.size() >= max_known_writers) {
      writers_.clear();
    }
    WriterId writer;
    std::copy(std::begin(endpoint->key.v), std::end(endpoint->key.v), writer.guid.begin());
    writers_.emplace(handle, writer);
    return writer;
  }

  static constexpr std::size_t max_known_writers = 1000; // asked for again beyond

  std::shared_ptr<CycloneParticipantHandle> participant_;
  std::shared_ptr<WakeUp> wake_up_; // the listener has its address: it must outlive the reader
  const TypeSupport& type_;
  std::unique_ptr<void, void (*)(void*)> sample_;
  Entity topic_;
  Entity reader_;
  std::map<dds_instance_handle_t, WriterId> writers_;
  dds_instance_handle_t last_handle_ = 0; // of no writer
  WriterId last_writer_;
};

class CycloneParticipant : public UntypedParticipant {
public:
  CycloneParticipant(std::shared_ptr<CycloneParticipantHandle> participant, bool secured)
      : participant_(std::move(participant)), secured_(secured) {}

  base::Expected<std::unique_ptr<UntypedWriter>>
  writer(const TypeSupport& type, const std::string& topic, Profile profile,
         const std::vector<std::string>& partitions) override {
    const dds_entity_t cyclone_topic = open_topic(type, topic);
    if (cyclone_topic < 0) {
      return fail(cyclone_error("Cyclone DDS refuses topic " + topic, cyclone_topic));
    }
    const Qos qos = writer_qos(qos_of_writer(profile, secured_),
                               partitions_of_writer(profile, secured_, partitions));
    const dds_entity_t cyclone_writer =
        dds_create_writer(participant_->entity.get(), cyclone_topic, qos.get(), nullptr);
    auto writer =
        std::make_unique<CycloneWriter>(participant_, type, cyclone_topic, cyclone_writer);
    if (cyclone_writer < 0) {
      return fail(cyclone_error("Cyclone DDS refuses a writer of topic " + topic, cyclone_writer));
    }
    return writer;
  }

  base::Expected<std::unique_ptr<UntypedReader>> reader(const TypeSupport& type,
                                                        const std::string& topic, Profile profile,
                                                        const std::string& partition,
                                                        std::shared_ptr<WakeUp> wake_up) override {
    const dds_entity_t cyclone_topic = open_topic(type, topic);
    if (cyclone_topic < 0) {
      return fail(cyclone_error("Cyclone DDS refuses topic " + topic, cyclone_topic));
    }
    const Qos qos = reader_qos(qos_of_reader(profile, secured_), partition);
    dds_listener_t* listener = dds_create_listener(wake_up.get());
    if (wake_up) {
      dds_lset_data_available(listener, &ring);
    }
    const dds_entity_t cyclone_reader =
        dds_create_reader(participant_->entity.get(), cyclone_topic, qos.get(), listener);
    dds_delete_listener(listener);
    auto reader =
        std::make_unique<CycloneReader>(participant_, cyclone_topic, cyclone_reader, type, wake_up);
    if (cyclone_reader < 0) {
      return fail(cyclone_error("Cyclone DDS refuses a reader of topic " + topic, cyclone_reader));
    }
    if (wake_up) {
      wake_up->ring();
    }
    return reader;
  }

  [[nodiscard]] std::uint64_t malformed_messages() const override {
    return participant_->malformed->count();
  }

  [[nodiscard]] std::shared_ptr<const RefusedPackets> refused_packets() const override {
    return participant_->refused;
  }

  [[nodiscard]] std::shared_ptr<const OwnAddresses> own_addresses() const override {
    return addresses_;
  }

  [[nodiscard]] Discovery discovered() const override {
    return discovered_by_cyclone_dds(participant_->entity.get());
  }

private:
  dds_entity_t open_topic(const TypeSupport& type, const std::string& name) {
    ddsi_sertype* sertype = make_cyclone_sertype(type, participant_->malformed);
    const dds_entity_t topic = dds_create_topic_sertype(participant_->entity.get(), name.c_str(),
                                                        &sertype, nullptr, nullptr, nullptr);
    if (topic < 0) {
      release_cyclone_sertype(sertype);
      return topic;
    }
    addresses_->set(addresses_of(domain_of(*sertype)));
    return topic;
  }

  std::shared_ptr<CycloneParticipantHandle> participant_;
  bool secured_;
  std::shared_ptr<OwnAddresses> addresses_ = std::make_shared<OwnAddresses>();
};

} // namespace

base::Expected<std::unique_ptr<UntypedParticipant>>
create_cyclone_dds_participant(const ParticipantOptions& options, const SecurityFiles* security) {
  DYNCAL_TRY(const auto config, cyclone_dds_config(options, security != nullptr));
  if (const auto warning = receive_buffer_warning(
          wanted_receive_buffer_bytes, granted_receive_buffer(wanted_receive_buffer_bytes));
      !warning.empty() && options.warn) {
    options.warn(warning);
  }

  auto refused = packets_refused_by_cyclone_dds(options.warn);
  DYNCAL_TRY(auto domain, open_domain(options.domain, config));
  const Qos qos(dds_create_qos());
  dds_qset_entity_name(qos.get(), options.name.c_str());
  if (security != nullptr) {
    set_cyclone_dds_security(*security, *qos);
  }
  const dds_entity_t participant =
      dds_create_participant(static_cast<dds_domainid_t>(options.domain), qos.get(), nullptr);
  if (participant < 0) {
    return fail(cyclone_error("Cyclone DDS cannot join domain " + std::to_string(options.domain),
                              participant));
  }
  return std::make_unique<CycloneParticipant>(
      std::shared_ptr<CycloneParticipantHandle>(new CycloneParticipantHandle{
          std::move(domain), Entity(participant), std::make_shared<MalformedMessages>(options.warn),
          std::move(refused)}),
      security != nullptr);
}

} // namespace dyncal::bus
