// One source of a bench as its driver sees it: the sink of its samples, descriptions and counts.
// What is put here is published by the one publishing thread of SourceService.
//
// Life of a source: describe(), then take()... and end(). begin_session() begins the next play, or
// follows a device that has restarted its numbering. Blocks taken before the first describe() wait
// in the ring until the description is known, so that no reader meets a block whose channels it
// cannot name.
//
// When the ring is full (a network that does not take the samples), a live device loses its newest
// block, which is counted as dropped_in_service; a file waits: `WhenFull`. Long blocks are split
// (block_split.hpp).
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
#include <vector>

#include "drivers/sample_sink.hpp"
#include "services/contract/bench_file_origin.hpp"
#include "services/contract/device_identity.hpp"
#include "services/contract/reference_step.hpp"
#include "services/contract/source_kind.hpp"
#include "services/stream/block_ring.hpp"
#include "services/stream/block_split.hpp"

namespace dyncal::bus {
class WakeUp;
}

namespace dyncal::inline stream {

// `wait_briefly`: for a second, then as `drop` until there is room again. For streams that are held
// back by TCP: a simulated instrument that runs faster than real time is to be, a real one never.
enum class WhenFull { drop, wait, wait_briefly };

// Whether the source plays something that can wait. The writers of all others never wait for a
// reader.
[[nodiscard]] constexpr bool waits(WhenFull when_full) {
  return when_full == WhenFull::wait;
}

struct SourceOptions {
  std::string bench;
  std::string source;
  SourceKind kind = SourceKind::acs;
  DeviceIdentity identity = {};
  BenchFileOrigin origin = {}; // what the bench file says of this source
  // SILENT when no block came for this long, or for four times the usual interval of its blocks if
  // that is longer. 0: never (files, and devices that are asked for their records).
  std::chrono::nanoseconds silent_after = std::chrono::seconds(2);
  RingLimits ring = {};
  WhenFull when_full = WhenFull::drop;
  std::stop_token stop = {}; // once requested, take() waits no longer: its block is lost
  std::uint64_t session = 0; // the first one; 0: a random number
  std::size_t max_block_bytes = stream::max_block_bytes; // longer ones become several
  bool hands_out_steps = false; // evaluated ones, in place of samples (hand_out())
};

// The run of the bench that is under way, or was the last.
struct HeardRun {
  std::string run{};
  std::vector<PlannedReferenceStep> steps{};
  bool is_under_way = false; // PLANNED or RUNNING
  bool is_running = false;
  bool is_answered = false; // by this source, so that its begin was seen here
};

// A step that a source has evaluated itself.
struct HandedOutStep {
  std::string run;
  ReferenceStep step;
};

enum class SourceStage { starting, streaming, ended, failed };

class SourcePublisher : public drivers::SampleSink {
public:
  SourcePublisher(SourceOptions options, std::shared_ptr<bus::WakeUp> wake_up);

  [[nodiscard]] const SourceOptions& options() const { return options_; }

  // Published when it differs from the last one.
  void describe(const drivers::SourceDescription& description) override;

  // Blocks taken from now on belong to a new session (a new random number, blocks counted from 0),
  // unless the present one is still unused.
  void begin_session() override;

  // Never blocks, unless the options say so.
  void take(drivers::SampleBlock block) override;

  // Published with the next status.
  void count(const drivers::SampleCounts& counts) override;

  // To the log, under the name of the source.
  void warn(const std::string& sentence) override;

  // Of a triggered source: one shot with its values. Never blocks. Returns false if the ring is
  // full: the shot is lost and counted.
  [[nodiscard]] bool take_shot(Shot shot, drivers::SampleBlock values);

  // Of a source that evaluates itself. Never blocks: as many as a run has steps are few.
  void hand_out(HandedOutStep step);
  // Of such a source; nothing before a run was heard of.
  [[nodiscard]] std::optional<HeardRun> heard_run() const;

  // Of a device that is asked for its records: RUNNING while it can be reached, else SILENT.
  void set_reachable(bool reachable);

  // No more blocks in this session: behind the last one readers get an empty block with
  // end_of_stream, and the status is ENDED.
  void end();

  // The source cannot go on: end of the stream, and status FAILED with this sentence.
  void fail(std::string message);

  // The sentence of the status; "" when there is nothing to report.
  void set_message(std::string message);

  // Waits until a measurement of this bench is RUNNING whose run this function has not returned
  // before, and returns its run. Returns nothing if `stop` was requested. From then on until
  // begin_session() the source plays this run, and answers to no other.
  [[nodiscard]] std::optional<std::string> wait_for_run(const std::stop_token& stop);

  // Waits while the run that is played is RUNNING and nobody arms for another one.
  void wait_until_over(const std::stop_token& stop);
  // The rest of the play is not wanted any more: what has not been published never is.
  void discard() { ring_.discard(); }
  // Other runs are answered again, in the session that begins next.
  void end_play();

  // The publishing thread's side.
  struct Snapshot {
    SourceStage stage = SourceStage::starting;
    std::uint64_t session = 0;
    std::uint64_t offered_samples = 0;
    std::chrono::steady_clock::time_point last_offer{}; // of the session, or when it began
    std::chrono::nanoseconds silent_after{}; // longer for a source with rare blocks; 0: never
    std::optional<bool> reachable;           // of a device that is asked for its records
    drivers::SampleCounts counts;
    std::string message;
  };
  [[nodiscard]] Snapshot snapshot() const;
  [[nodiscard]] std::uint64_t session() const; // of the blocks that are taken from now on
  [[nodiscard]] std::optional<drivers::SourceDescription> take_changed_description();
  // Of the newest description; as unit_factors(), for the blocks of the ring, which are as taken.
  [[nodiscard]] std::vector<double> factors() const;
  [[nodiscard]] BlockRing& ring() { return ring_; }
  void note_running(const std::vector<std::string>& runs);
  void note_run(HeardRun run); // `is_answered` is known here
  [[nodiscard]] std::vector<HandedOutStep> take_handed_out();
  // Somebody arms for this run. Returns whether the source may answer now: not while it plays
  // another run, whose session that answer would belong to.
  [[nodiscard]] bool may_answer(const std::string& run);

private:
  RingEntry next_entry(drivers::SampleBlock block, std::optional<Shot> shot);
  [[nodiscard]] std::chrono::nanoseconds usual_gap() const;
  void close_stream(SourceStage stage);
  void offer(RingEntry entry);

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
  std::vector<double> factors_;
  std::condition_variable_any running_changed_;
  std::vector<std::string> running_;
  std::vector<std::string> returned_;
  std::optional<HeardRun> heard_run_;
  std::string answered_run_; // the last one
  std::vector<HandedOutStep> handed_out_;
  std::string playing_; // a run; empty: none
  bool superseded_ = false;
  bool play_ended_ = false;
};

} // namespace dyncal::inline stream
