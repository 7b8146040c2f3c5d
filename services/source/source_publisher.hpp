// One source of a bench as its driver sees it: somewhere to put descriptions, blocks and counts,
// that never makes the driver wait (unless it asks to). What is put here is published by the one
// publishing thread of SourceService.
//
// Life of a source: describe(), then offer()... and end(). start_session() begins the next play, or
// follows a device that has restarted its numbering. Blocks offered before the first describe()
// wait in the ring until the description is known, so that no reader meets a block whose channels
// it cannot name.
//
// Threads: every function may be called from any thread; calls for one source keep their order only
// within one thread.
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
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
  // SILENT when no block came for this long, or for four times the usual interval of its blocks if
  // that is longer. 0: never (files).
  std::chrono::nanoseconds silent_after = std::chrono::seconds(2);
  RingLimits ring = {};
};

// Since the program started, as the driver accounts for it. Samples that the ring had to drop are
// counted by the publisher itself.
struct SourceCounts {
  std::uint64_t received = 0;
  std::uint64_t lost_in_device = 0;
  std::uint64_t lost_on_way = 0;
  std::uint64_t duplicates = 0;
  std::uint64_t rejected = 0;
  std::uint64_t stamps_not_trusted = 0;
  std::vector<std::pair<std::string, std::uint64_t>>
      causes; // the counts above taken apart, and what concerns no single sample
  double clock_uncertainty_s = 0.0; // of the device's clock now; 0: not known
};

enum class SourceStage { starting, streaming, ended, failed };

class SourcePublisher {
public:
  SourcePublisher(SourceOptions options, std::shared_ptr<bus::WakeUp> wake_up);

  [[nodiscard]] const SourceOptions& options() const { return options_; }

  // Known for the first time, or changed. Published when it differs from the last one.
  void describe(drivers::SourceDescription description);

  // Blocks offered from now on belong to a new session (a new random number, blocks counted from
  // 0), unless the present one is still unused.
  void start_session();

  // Never blocks. False when the block was dropped because the ring is full; its samples are
  // counted (dropped_in_service).
  bool offer(drivers::SampleBlock block);

  // For files: waits while the ring is full. False when `stop` was requested; the block is then
  // lost.
  bool offer_waiting(drivers::SampleBlock block, const std::stop_token& stop);

  // No more blocks in this session: behind the last one readers get an empty block with
  // end_of_stream, and the status says ENDED.
  void end();

  // The source cannot go on: end of the stream, and status FAILED with this sentence.
  void fail(std::string message);

  void report(SourceCounts counts); // published with the next status
  void say(std::string message);    // sentence of the status; "" when there is nothing to say

  // Waits until a measurement of this bench is RUNNING whose run this function has not returned
  // before, and returns its run. Nothing when `stop` was requested.
  [[nodiscard]] std::optional<std::string> wait_for_run(const std::stop_token& stop);

  // The publishing thread's side.
  struct Snapshot {
    SourceStage stage = SourceStage::starting;
    std::uint64_t session = 0;
    std::uint64_t offered_samples = 0;
    std::chrono::steady_clock::time_point last_offer{}; // of the session, or when it began
    std::chrono::nanoseconds silent_after{}; // longer for a source with rare blocks; 0: never
    SourceCounts counts;
    std::string message;
  };
  [[nodiscard]] Snapshot snapshot() const;
  [[nodiscard]] std::optional<drivers::SourceDescription> take_changed_description();
  [[nodiscard]] BlockRing& ring() { return ring_; }
  void note_running(const std::vector<std::string>& runs);

private:
  RingEntry next_entry(drivers::SampleBlock block);
  [[nodiscard]] std::chrono::nanoseconds usual_gap() const;
  void close_stream(SourceStage stage);

  const SourceOptions options_;
  const std::shared_ptr<bus::WakeUp> wake_up_;
  BlockRing ring_;

  mutable std::mutex mutex_;
  Snapshot state_;
  bool session_used_ = false;
  std::array<std::chrono::nanoseconds, 4> gaps_{}; // between the last blocks
  std::size_t gap_count_ = 0;
  std::optional<drivers::SourceDescription> description_;
  bool description_changed_ = false;
  std::condition_variable_any running_changed_;
  std::vector<std::string> running_;
  std::vector<std::string> returned_;
};

} // namespace dyncal::services
