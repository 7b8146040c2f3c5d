// What every source program is made of: one publishing thread that carries all sources of a process
// to the bus, whatever benches they belong to (a bench is a partition).
//
// Per source it writes its samples (DauSamples, AcsSamples, CanSamples) or records (DsoRecord,
// TssRecord), SourceDescription when it is known or changes, and SourceStatus every 500 ms and at
// once when the state changes. It answers COMMAND_ARM for a described source in its stream with an
// empty message that names the run, behind everything written before: anyone who reads that answer
// reads what follows. A write that times out is tried again until it succeeds or the service stops.
// What was written is kept, and given again to who asks for it (catch_up_server.hpp), by a second
// thread.
//
//   auto service = SourceService::create(participant, {"dyncal-dau", software});
//   auto source = service->add({.bench = "acc-1", .source = "dau", .kind = SourceKind::dau});
//   service->start();  ... source->take(block) ...  service->stop();
//
// Threads: create, add, start and stop from one thread; the publishers from any.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "services/base/error.hpp"
#include "services/bus/bus.hpp"
#include "services/stream/catch_up_server.hpp"
#include "services/stream/source_publication.hpp"

namespace dyncal::inline stream {

struct SourceServiceOptions {
  std::string software; // name and version, as descriptions carry it
  std::chrono::nanoseconds status_interval = std::chrono::milliseconds(500);
  std::chrono::nanoseconds stop_limit =
      std::chrono::seconds(5); // for what is still in the rings when the service stops
  KeptLimits kept = {};        // of each source
  std::size_t max_block_bytes = stream::max_block_bytes;
  // Called by the publishing thread at every turn of its loop, at least every status_interval.
  std::function<void()> turned = {};
  // Called by it with every status that it has published, and how many messages with samples the
  // source has written.
  std::function<void(const wire::SourceStatus&, std::uint64_t)> reported = {};
};

class SourceService {
public:
  // `participant` outlives the service.
  [[nodiscard]] static std::unique_ptr<SourceService> create(bus::Participant& participant,
                                                             SourceServiceOptions options);
  ~SourceService(); // stops

  SourceService(const SourceService&) = delete;
  SourceService& operator=(const SourceService&) = delete;

  // Before start(). Fails (bad_argument) when the bench has a source of this name already or a name
  // is empty or longer than 64 characters, (network) when the bus refuses.
  [[nodiscard]] Expected<std::shared_ptr<SourcePublisher>> add(SourceOptions options);

  void start();

  // Ends every stream, publishes what the rings hold as far as stop_limit allows, reports ENDED and
  // waits for acknowledgments. Idempotent.
  void stop();

private:
  // What the bench asks of its sources.
  struct BenchReaders {
    bus::Reader<wire::Command> command;
    bus::Reader<wire::Measurement> measurement;
    std::vector<std::string> running{};
  };

  SourceService(bus::Participant& participant, SourceServiceOptions options)
      : participant_(participant), options_(std::move(options)), catch_up_(participant) {}
  Expected<void> join_bench(const std::string& bench);
  void run(const std::stop_token& stop);
  void give_again(const std::stop_token& stop);
  void finish();
  bool step_channels();
  [[nodiscard]] std::uint64_t messages_written() const;
  void keep_up();
  void listen();
  void take_commands(const std::string& bench, BenchReaders& readers);
  void take_measurements(const std::string& bench, BenchReaders& readers);

  bus::Participant& participant_;
  const SourceServiceOptions options_;
  const std::shared_ptr<bus::WakeUp> wake_up_ = std::make_shared<bus::WakeUp>();
  std::map<std::string, BenchReaders> benches_;
  std::vector<std::unique_ptr<SourcePublication>> channels_;
  CatchUpServer catch_up_; // of its thread, once that has started
  std::jthread thread_;
  std::jthread catch_up_thread_;
};

} // namespace dyncal::inline stream
