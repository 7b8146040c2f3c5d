// The publishing thread's side of one source: its writers and what is due to be written.
//
// Everything it does is one short step that may block for `write_limit` at most, so that one source
// does not hold up the others: what could not be written stays and is tried again at the next step.
// A writer that waits for no reader is paced instead (WritePace). What was written is kept for who
// asks for it later. Used by the publishing thread alone.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "services/base/error.hpp"
#include "services/bus/bus.hpp"
#include "services/stream/messages.hpp"
#include "services/stream/retransmission_buffer.hpp"
#include "services/stream/source_publisher.hpp"
#include "services/stream/stream_writer.hpp"
#include "services/stream/write_pace.hpp"

namespace dyncal::inline stream {

struct SourceWriters {
  bus::Writer<dyncal::wire::SourceDescription> description;
  bus::Writer<dyncal::wire::SourceStatus> status;
  std::unique_ptr<StreamWriter> samples;
  std::optional<bus::Writer<dyncal::wire::AcsStep>> steps{}; // of a source that hands out steps
};

class SourcePublication {
public:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] static Expected<std::unique_ptr<SourcePublication>>
  create(bus::Participant& participant, std::shared_ptr<SourcePublisher> publisher,
         std::shared_ptr<RetransmissionBuffer> kept, std::string software);
  SourcePublication(std::shared_ptr<SourcePublisher> publisher,
                    std::shared_ptr<RetransmissionBuffer> kept, std::string software,
                    SourceWriters writers);

  [[nodiscard]] SourcePublisher& publisher() { return *publisher_; }
  [[nodiscard]] RetransmissionBuffer& kept() { return *kept_; }

  // With every status that is published, and how many messages with samples were written.
  using Report = std::function<void(const dyncal::wire::SourceStatus&, std::uint64_t)>;
  void report_to(Report report) { report_ = std::move(report); }

  // Somebody arms for this run: an empty message that names it is written as soon as the source has
  // a description.
  void answer(const std::string& run);

  // Writes a few of the things that wait. Returns true if there is more to do at once.
  bool step(std::chrono::nanoseconds write_limit);

  // Blocks are published even if the source never got a description: the service stops.
  void flush() { flushing_ = true; }
  [[nodiscard]] bool blocked() const {
    return pending_.has_value() || description_due_ || !steps_due_.empty();
  }
  [[nodiscard]] bool idle() const {
    return !pending_ && steps_due_.empty() && publisher_->ring().empty();
  }

  [[nodiscard]] std::uint64_t messages_written() const { return written_; }

  // Writes the status when its state has changed or `interval` has passed; returns when it is next
  // due.
  Clock::time_point step_status(std::chrono::nanoseconds interval,
                                std::chrono::nanoseconds write_limit);

  void wait_for_acknowledgments(std::chrono::nanoseconds limit) {
    writers_.samples->wait_for_acknowledgments(limit);
  }

private:
  bool write_description(std::chrono::nanoseconds limit);
  bool write_steps(std::chrono::nanoseconds limit);
  bool write_next(std::chrono::nanoseconds limit);
  bool next_message();
  void hold(RingEntry entry, const std::string& answers_run);
  void begin_session(std::uint64_t session);
  void write_status(Clock::time_point now, std::chrono::nanoseconds limit);
  void add_what_is_kept(dyncal::wire::SourceStatus& message);
  void say_what_can_be_kept();
  [[nodiscard]] bool may_write();
  [[nodiscard]] dyncal::wire::SourceState state(const SourcePublisher::Snapshot& snapshot,
                                                Clock::time_point now) const;
  void measure_rate(const SourcePublisher::Snapshot& snapshot, Clock::time_point now);

  const std::shared_ptr<SourcePublisher> publisher_;
  const std::shared_ptr<RetransmissionBuffer> kept_;
  const std::string software_;
  SourceWriters writers_;
  WritePace pace_;
  bool warned_of_kept_ = false;
  std::string said_of_kept_; // the newest sentence

  std::optional<drivers::SourceDescription> description_;
  bool description_due_ = false;
  bool flushing_ = false;
  std::uint64_t session_;
  bool ended_ = false; // the end of the session's stream has been written
  Report report_;
  std::uint64_t written_ = 0; // messages with samples
  std::uint64_t failed_writes_ = 0;
  std::uint64_t lost_in_writes_ = 0; // samples, or shots
  struct Pending {
    std::uint64_t size = 0; // samples, or one shot
    bool end_of_stream = false;
  };
  std::optional<Pending> pending_; // its message is the stream writer's
  std::deque<HandedOutStep> steps_due_;
  std::deque<std::string> runs_to_answer_;

  dyncal::wire::SourceState published_state_ = wire::SOURCE_STARTING;
  std::optional<Clock::time_point> status_written_;
  struct RatePoint {
    Clock::time_point time;
    std::uint64_t samples;
  };
  std::deque<RatePoint> rate_points_;
  double rate_hz_ = 0.0;
};

} // namespace dyncal::inline stream
