// One source of a bench as its driver sees it: somewhere to put descriptions, blocks and counts, that never makes the driver wait
// (unless it asks to). What is put here is published by the one publishing thread of SourceService.
//
// Life of a source:  add() -> describe() -> start_session() -> offer()... -> end(), and start_session() again for the next play or when
// the device has restarted its numbering. Blocks offered before the first describe() wait in the ring until the description is known,
// so that no reader meets a block it cannot name the channels of.
//
// Threads: every function may be called from any thread; calls for one source keep their order only within one thread.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "drivers/sample_block.hpp"
#include "services/source/block_ring.hpp"

namespace dyncal::bus {
class WakeUp;
}

namespace dyncal::services {

enum class SourceKind { dau, acs, can };

struct SourceOptions {
  std::string bench;
  std::string source;
  SourceKind kind = SourceKind::acs;
  // SILENT when no block came for this long, or for four times the usual interval of its blocks if that is longer. 0: never (files).
  std::chrono::nanoseconds silent_after = std::chrono::seconds(2);
  RingLimits ring;
};

// Since the program started; the driver's own accounting. Samples that the ring had to drop are counted here by the publisher.
struct SourceCounts {
  std::uint64_t received = 0;
  std::uint64_t lost_in_device = 0;
  std::uint64_t lost_on_way = 0;
  std::uint64_t duplicates = 0;
  std::uint64_t rejected = 0;
  std::uint64_t stamps_not_trusted = 0;
  std::vector<std::pair<std::string, std::uint64_t>> causes; // the counts above taken apart, and what concerns no sample
  double clock_uncertainty_s = 0.0;                          // of the device's clock now; 0: not known
};

class SourcePublisher {
public:
  SourcePublisher(SourceOptions options, std::shared_ptr<bus::WakeUp> wake_up);

  [[nodiscard]] const SourceOptions& options() const { return options_; }

  // Known for the first time or changed; published when it differs from the last one.
  void describe(drivers::SourceDescription description);

  // Blocks offered from now on belong to a new session: a new random number, blocks counted from 0.
  // Called implicitly by the first offer.
  void start_session();

  // Never blocks. False when the block was dropped because the ring is full; its samples are counted (dropped_in_service).
  bool offer(drivers::SampleBlock block);

  // For files: waits while the ring is full. False when `stop` was requested; the block is then lost.
  bool offer_waiting(drivers::SampleBlock block, const std::stop_token& stop);

  // No more blocks in this session: readers get an empty block with end_of_stream, the status becomes ENDED.
  void end();

  // The source cannot go on: status FAILED with this sentence, and the end of the stream.
  void fail(std::string message);

  void report(SourceCounts counts); // the newest counts, published with the next status
  void say(std::string message);    // sentence of the status, "" when there is nothing to say

  // Waits until a measurement of this bench is RUNNING whose run this function has not returned before; returns its run.
  // Nothing when `stop` was requested.
  [[nodiscard]] std::optional<std::string> wait_for_run(const std::stop_token& stop);

private:
  friend class SourceChannel; // the publishing thread's side

  enum class Stage { starting, streaming, ended, failed };

  struct Shared {
    std::optional<drivers::SourceDescription> description;
    bool description_changed = false;
    SourceCounts counts;
    std::string message;
    Stage stage = Stage::starting;
    std::uint64_t session = 0;
    std::uint64_t offered_samples = 0;
    std::uint64_t offered_blocks = 0;
    std::chrono::steady_clock::time_point last_offer{};
    std::vector<std::chrono::nanoseconds> recent_gaps; // between the last blocks, for slow sources
    std::vector<std::string> running;                  // runs of this bench that are RUNNING
    std::vector<std::string> returned;                 // by wait_for_run
  };

  RingEntry entry_for(drivers::SampleBlock block);
  void note_running(std::vector<std::string> runs); // from the publishing thread

  const SourceOptions options_;
  std::shared_ptr<bus::WakeUp> wake_up_;
  BlockRing ring_;
  mutable std::mutex mutex_;
  std::condition_variable_any running_changed_;
  Shared shared_;
};

} // namespace dyncal::services
