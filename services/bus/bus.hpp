// The bus: typed messages of idl/dyncal.idl over DDS, whichever vendor carries them.
//
// A process has one Participant, kept for as long as it runs; writers and readers keep it alive.
// They are made from it for one topic, one of the QoS profiles and one partition (the bench; "*"
// reads all benches), or two for what belongs to one run. T is a struct of the contract. No
// vendor's name or type appears here.
//
// QoS profiles (idl/README.md has the exact settings), all but the last reliable:
//   samples  keep all, transient local with bounded depth: a writer waits for its readers, and a
//            late joiner gets the newest blocks
//   live_samples, live_records
//            a writer keeps the newest few seconds and waits for no reader; a reader gets the
//            stream from now on, since blocks before it would hold up a run's beginning
//   paced_samples
//            as samples; when its readers have them, a writer keeps few: who needs them asks for
//            them
//   results  transient local, the newest of every key
//   state    transient local, the newest of every key
//   command  volatile, every one
//   catch_up every one: what a source sends again to one reader, by a writer of its own
//   probe    best effort, volatile: what is lost stays lost, so that losses can be counted
//
// Threads: a Participant may be used from any thread. Each Writer and each Reader belongs to one
// thread at a time, except Reader's wake-up, which comes from the vendor's threads and only
// notifies. write() may block (up to 1.5 s at 20 % packet loss; for the lease of a reader that was
// killed): the thread that listens to a device never calls it.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "services/base/error.hpp"
#include "services/bus/discovery.hpp"
#include "services/bus/names.hpp"
#include "services/bus/own_addresses.hpp"
#include "services/bus/refused_packets.hpp"
#include "services/bus/type_support.hpp"
#include "services/bus/wake_up.hpp"
#include "services/bus/writer_id.hpp"
#include "services/contract/topics.hpp"

namespace dyncal::bus {

// A DDS implementation, as parse_vendor() gives it.
enum class Vendor : std::uint8_t;

// Whose implementations the programs of the laboratory have (packet_size.hpp).
enum class LaboratoryVendors : bool { mixed, same };

struct ParticipantOptions {
  Vendor vendor{}; // the one that parse_vendor() knows first
  LaboratoryVendors laboratory = LaboratoryVendors::mixed;
  int domain = 0;
  std::string name;               // shown by discovery tools
  std::vector<std::string> peers; // addresses to find others at when multicast cannot be used
  bool multicast = true;          // false: discovery by `peers` alone
  std::string interface_name;     // network interface or its address; empty: the vendor's choice
  bool watch_discovery = false;   // for discovered()
  // False: packets reach the implementation as they come. To measure what a screen costs, only.
  bool screened = true;
  // One sentence for the user, e.g. that a host limit is too low; may be empty. Called from any
  // thread while the participant lives.
  std::function<void(const std::string&)> warn;
};

enum class WriteOutcome { written, timed_out, failed };

// What an adapter implements; use Writer<T> and Reader<T>.
class UntypedWriter {
public:
  virtual ~UntypedWriter() = default;
  // `message` is never null.
  virtual WriteOutcome write(const EncodedMessage& message, std::chrono::nanoseconds limit) = 0;
  [[nodiscard]] virtual int matched_readers() const = 0;
  virtual bool wait_for_acknowledgments(std::chrono::nanoseconds limit) = 0;
};

class UntypedReader {
public:
  // A sample, the bytes that it came as, and who wrote it; all until the call returns.
  using Consume =
      std::function<void(const void* sample, std::string_view bytes, const WriterId& writer)>;

  virtual ~UntypedReader() = default;
  virtual std::size_t take(const Consume& consume) = 0;
  [[nodiscard]] virtual int matched_writers() const = 0;
};

class UntypedParticipant {
public:
  virtual ~UntypedParticipant() = default;
  virtual base::Expected<std::unique_ptr<UntypedWriter>>
  writer(const TypeSupport& type, const std::string& topic, Profile profile,
         const std::vector<std::string>& partitions) = 0;
  virtual base::Expected<std::unique_ptr<UntypedReader>>
  reader(const TypeSupport& type, const std::string& topic, Profile profile,
         const std::string& partition, std::shared_ptr<WakeUp> wake_up) = 0;
  [[nodiscard]] virtual std::uint64_t malformed_messages() const = 0;
  [[nodiscard]] virtual std::shared_ptr<const RefusedPackets> refused_packets() const {
    return std::make_shared<RefusedPackets>(nullptr); // none, where there are no packets
  }
  [[nodiscard]] virtual std::shared_ptr<const OwnAddresses> own_addresses() const {
    return std::make_shared<OwnAddresses>(); // none, where nothing leaves the process
  }
  // Nobody, where there is no discovery.
  [[nodiscard]] virtual Discovery discovered() const { return {}; }
};

template <class T>
class Writer {
public:
  using Message = T;

  explicit Writer(std::unique_ptr<UntypedWriter> untyped) : untyped_(std::move(untyped)) {}
  // Returns when the sample is in the writer's history, or when `limit` has passed without room for
  // it (it then may be tried again).
  WriteOutcome write(const T& sample, std::chrono::nanoseconds limit = std::chrono::seconds(10)) {
    return write_encoded(encode(sample), limit);
  }
  // The same for a T that is bytes already, by encode(), because somebody else keeps them too.
  WriteOutcome write_encoded(const EncodedMessage& message, std::chrono::nanoseconds limit) {
    return message ? untyped_->write(message, limit) : WriteOutcome::failed;
  }
  [[nodiscard]] int matched_readers() const { return untyped_->matched_readers(); }
  // Acknowledged by all readers that are there; true as well if there is none.
  bool wait_for_acknowledgments(std::chrono::nanoseconds limit) {
    return untyped_->wait_for_acknowledgments(limit);
  }

private:
  std::unique_ptr<UntypedWriter> untyped_;
};

template <class T>
class Reader {
public:
  // `bench`: whose messages are taken; empty: of all.
  Reader(std::unique_ptr<UntypedReader> untyped, std::string bench)
      : untyped_(std::move(untyped)), bench_(std::move(bench)) {}
  // Hands over everything that has come, in order, and returns how many that were. Passed over are
  // messages that name another bench than the partition they came in (by a writer of another tool
  // in partition "*", or of two benches), and that somebody has ended an instance: dyncal ends
  // none.
  template <class Consume>
  std::size_t take(Consume&& consume) {
    return take_whole(
        [&](const T& message, std::string_view, const WriterId&) { consume(message); });
  }
  // The same with the bytes that each message came as; they last until `consume` returns.
  template <class Consume>
  std::size_t take_with_bytes(Consume&& consume) {
    return take_whole([&](const T& message, std::string_view bytes, const WriterId&) {
      consume(message, bytes);
    });
  }
  // The same with the writer that each message came from.
  template <class Consume>
  std::size_t take_with_writer(Consume&& consume) {
    return take_whole([&](const T& message, std::string_view, const WriterId& writer) {
      consume(message, writer);
    });
  }
  [[nodiscard]] int matched_writers() const { return untyped_->matched_writers(); }

private:
  template <class Consume>
  std::size_t take_whole(Consume&& consume) {
    std::size_t taken = 0;
    untyped_->take([&](const void* sample, std::string_view bytes, const WriterId& writer) {
      const T& message = *static_cast<const T*>(sample);
      if (bench_.empty() || message.bench() == bench_ || message.bench() == "") {
        ++taken;
        consume(message, bytes, writer);
      }
    });
    return taken;
  }

  std::unique_ptr<UntypedReader> untyped_;
  std::string bench_;
};

class Participant {
public:
  // Fails (network) when the vendor is not in this build or cannot use the domain, interface or
  // peers.
  [[nodiscard]] static base::Expected<Participant> create(const ParticipantOptions& options);
  // Over any adapter; tests have one that does not leave the process (services/bus/memory).
  explicit Participant(std::unique_ptr<UntypedParticipant> untyped)
      : untyped_(std::move(untyped)) {}

  // Fail (bad_argument) when the partition cannot be a bench's name, or that of who catches up
  // (services/bus/names.hpp), or (network) when the vendor refuses.
  template <class T>
  [[nodiscard]] base::Expected<Writer<T>> writer(const std::string& topic, Profile profile,
                                                 const std::string& partition) {
    DYNCAL_TRY(profile == Profile::catch_up ? check_asker_name(partition)
                                            : check_bench_name(partition));
    return open_writer<T>(topic, profile, {partition});
  }
  // `wake_up` rings whenever something may have come, and once at the beginning; it may be empty.
  template <class T>
  [[nodiscard]] base::Expected<Reader<T>> reader(const std::string& topic, Profile profile,
                                                 const std::string& partition,
                                                 const std::shared_ptr<WakeUp>& wake_up) {
    const bool is_bench = profile != Profile::catch_up && check_bench_name(partition).has_value();
    return untyped_->reader(type_support<T>(), topic, profile, partition, wake_up).map([&](auto r) {
      return Reader<T>(std::move(r), is_bench ? partition : "");
    });
  }

  // With the profile of the topic.
  template <class T>
  [[nodiscard]] base::Expected<Writer<T>> writer(const Topic<T>& topic,
                                                 const std::string& partition) {
    return writer<T>(topic.name, topic.profile, partition);
  }
  template <class T>
  [[nodiscard]] base::Expected<Reader<T>> reader(const Topic<T>& topic,
                                                 const std::string& partition,
                                                 const std::shared_ptr<WakeUp>& wake_up) {
    return reader<T>(topic.name, topic.profile, partition, wake_up);
  }

  // Of what belongs to one run: everybody who reads the bench gets it, and so does who reads only
  // this run, and nothing of those before it that are kept for late joiners.
  template <class T>
  [[nodiscard]] base::Expected<Writer<T>>
  writer_of_run(const Topic<T>& topic, const std::string& bench, const std::string& run) {
    DYNCAL_TRY(check_bench_name(bench));
    return open_writer<T>(topic.name, topic.profile, {bench, partition_of_run(bench, run)});
  }
  template <class T>
  [[nodiscard]] base::Expected<Reader<T>>
  reader_of_run(const Topic<T>& topic, const std::string& bench, const std::string& run,
                const std::shared_ptr<WakeUp>& wake_up) {
    return untyped_
        ->reader(type_support<T>(), topic.name, topic.profile, partition_of_run(bench, run),
                 wake_up)
        .map([&](auto r) { return Reader<T>(std::move(r), bench); });
  }

  // Messages dropped because they do not match the contract (idl/README.md). Not 0 if there was
  // one; some are counted twice.
  [[nodiscard]] std::uint64_t malformed_messages() const { return untyped_->malformed_messages(); }
  // Counts on, also when the participant is gone.
  [[nodiscard]] std::shared_ptr<const RefusedPackets> refused_packets() const {
    return untyped_->refused_packets();
  }
  // Also when the participant is gone.
  [[nodiscard]] std::shared_ptr<const OwnAddresses> own_addresses() const {
    return untyped_->own_addresses();
  }
  // The others of the domain and what they have, as far as it is known by now; nobody without
  // `watch_discovery`. Any thread.
  [[nodiscard]] Discovery discovered() const { return untyped_->discovered(); }

private:
  template <class T>
  base::Expected<Writer<T>> open_writer(const std::string& topic, Profile profile,
                                        const std::vector<std::string>& partitions) {
    return untyped_->writer(type_support<T>(), topic, profile, partitions).map([](auto w) {
      return Writer<T>(std::move(w));
    });
  }

  std::unique_ptr<UntypedParticipant> untyped_;
};

// From a name as --dds takes it. Fails (bad_argument) on any other name, with those of this build.
[[nodiscard]] base::Expected<Vendor> parse_vendor(const std::string& name);
[[nodiscard]] std::string to_string(Vendor vendor);
// The first is the default of --dds.
[[nodiscard]] std::vector<Vendor> vendors_in_this_build();

} // namespace dyncal::bus
