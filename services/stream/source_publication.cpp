#include "services/stream/source_publication.hpp"

#include <algorithm>
#include <utility>

#include <spdlog/spdlog.h>

#include "drivers/utc_clock.hpp"
#include "services/contract/topics.hpp"
#include "services/stream/kept_span.hpp"

namespace dyncal::inline stream {

namespace {

constexpr int blocks_per_step = 16;                   // so that one source cannot starve the others
constexpr auto rate_window = std::chrono::seconds(3); // over which the rate of the status is taken
constexpr std::size_t runs_to_answer = 16; // a run asks again, so a forgotten one is not lost
constexpr auto patience = std::chrono::seconds(2); // with a reader that acknowledges nothing

void add_cause(dyncal::wire::SourceStatus& message, const std::string& name, std::uint64_t value) {
  if (value > 0) {
    dyncal::wire::NamedCount count;
    count.name(name);
    count.value(value);
    message.causes().push_back(std::move(count));
  }
}

} // namespace

Expected<std::unique_ptr<SourcePublication>>
SourcePublication::create(bus::Participant& participant, std::shared_ptr<SourcePublisher> publisher,
                          std::shared_ptr<RetransmissionBuffer> kept, std::string software) {
  const SourceOptions& options = publisher->options();
  DYNCAL_TRY(auto description,
             participant.writer<dyncal::wire::SourceDescription>(
                 bus::topics::source_description, bus::Profile::state, options.bench));
  DYNCAL_TRY(auto status, participant.writer<dyncal::wire::SourceStatus>(
                              bus::topics::source_status, bus::Profile::state, options.bench));
  DYNCAL_TRY(auto samples, StreamWriter::create(participant, options));
  SourceWriters writers{std::move(description), std::move(status), std::move(samples)};
  if (options.hands_out_steps) {
    DYNCAL_TRY(writers.steps, participant.writer<wire::AcsStep>(
                                  bus::topics::acs_step, bus::Profile::results, options.bench));
  }
  return std::make_unique<SourcePublication>(std::move(publisher), std::move(kept),
                                             std::move(software), std::move(writers));
}

SourcePublication::SourcePublication(std::shared_ptr<SourcePublisher> publisher,
                                     std::shared_ptr<RetransmissionBuffer> kept,
                                     std::string software, SourceWriters writers)
    : publisher_(std::move(publisher)), kept_(std::move(kept)), software_(std::move(software)),
      writers_(std::move(writers)),
      pace_(pace_window(publisher_->options().kind, publisher_->options().max_block_bytes),
            patience),
      session_(publisher_->session()) {}

void SourcePublication::answer(const std::string& run) {
  if (std::ranges::count(runs_to_answer_, run) != 0) {
    return;
  }
  runs_to_answer_.push_back(run);
  if (runs_to_answer_.size() > runs_to_answer) {
    runs_to_answer_.pop_front();
  }
}

void SourcePublication::begin_session(std::uint64_t session) {
  session_ = session;
  ended_ = false;
  description_due_ = description_.has_value();
}

bool SourcePublication::write_description(std::chrono::nanoseconds limit) {
  if (auto changed = publisher_->take_changed_description()) {
    description_ = std::move(changed);
    description_due_ = true;
    say_what_can_be_kept();
  }
  if (!description_due_) {
    return true;
  }
  if (writers_.description.write(
          to_message(publisher_->options(), session_, software_, *description_), limit) !=
      bus::WriteOutcome::written) {
    return false;
  }
  description_due_ = false;
  return true;
}

void SourcePublication::say_what_can_be_kept() {
  const SourceOptions& options = publisher_->options();
  const auto span = kept_span(options.kind, *description_, kept_->limits());
  if (!span || span->sentence == said_of_kept_) {
    return;
  }
  said_of_kept_ = span->sentence;
  if (span->is_short) {
    publisher_->warn(span->sentence);
  } else {
    spdlog::info("{}/{}: {}", options.bench, options.source, span->sentence);
  }
}

void SourcePublication::hold(RingEntry entry, const std::string& answers_run) {
  pending_ = Pending{.size = size_of(entry), .end_of_stream = entry.end_of_stream};
  writers_.samples->prepare(std::move(entry), answers_run);
}

// Takes the next thing to be written into pending_. Returns false if there is none.
bool SourcePublication::next_message() {
  // Asked before the session, which starts over when a play is over: the answer belongs to the
  // next.
  const bool may_answer =
      !runs_to_answer_.empty() && publisher_->may_answer(runs_to_answer_.front());
  // Asked before the ring: if the ring is empty afterwards, nothing of an earlier session is left.
  // The other way round a block could come between the two, and its session would start over.
  const std::uint64_t newest = publisher_->session();
  if (auto entry = publisher_->ring().take()) {
    if (entry->session != session_) {
      begin_session(entry->session);
    }
    convert(publisher_->factors(), entry->block.samples, entry->block.values);
    hold(std::move(*entry), "");
    return true;
  }
  if (newest != session_) {
    begin_session(newest);
  }
  if (!may_answer || !description_) {
    return false;
  }
  RingEntry answer;
  answer.session = session_;
  answer.block.received_utc_ns = utc_now_ns();
  hold(std::move(answer), runs_to_answer_.front());
  runs_to_answer_.pop_front();
  return true;
}

// A writer that waits for its readers needs no pace.
bool SourcePublication::may_write() {
  return waits(publisher_->options().when_full) || pace_.may_write(Clock::now(), [&] {
    return writers_.samples->wait_for_acknowledgments(std::chrono::nanoseconds(0));
  });
}

bool SourcePublication::write_next(std::chrono::nanoseconds limit) {
  // The session of the block to be written decides what the description in front of it says.
  if (!pending_ && !next_message()) {
    return false;
  }
  if (!write_description(limit)) {
    return false;
  }
  if (!may_write()) {
    return false;
  }
  const auto outcome = writers_.samples->write(limit);
  if (outcome == bus::WriteOutcome::timed_out) {
    return false;
  }
  pace_.wrote(writers_.samples->keep_in(*kept_)); // also what the bus refused: it can be asked for
  if (outcome == bus::WriteOutcome::failed) {
    ++failed_writes_;
    lost_in_writes_ += pending_->size;
  } else {
    ++written_;
  }
  if (pending_->end_of_stream) {
    ended_ = true;
  }
  pending_.reset();
  return true;
}

bool SourcePublication::write_steps(std::chrono::nanoseconds limit) {
  if (!writers_.steps) {
    return true;
  }
  for (HandedOutStep& step : publisher_->take_handed_out()) {
    steps_due_.push_back(std::move(step));
  }
  for (; !steps_due_.empty(); steps_due_.pop_front()) {
    const SourceOptions& options = publisher_->options();
    wire::AcsStep message = to_message(steps_due_.front().step);
    message.bench(options.bench);
    message.source(options.source);
    message.run(steps_due_.front().run);
    message.session(session_);
    const auto outcome = writers_.steps->write(message, limit);
    if (outcome == bus::WriteOutcome::timed_out) {
      return false;
    }
    failed_writes_ += outcome == bus::WriteOutcome::failed ? 1 : 0;
  }
  return true;
}

bool SourcePublication::step(std::chrono::nanoseconds write_limit) {
  if (!write_description(write_limit) || !write_steps(write_limit)) {
    return false;
  }
  if (!description_ && !flushing_) {
    return false;
  }
  for (int i = 0; i < blocks_per_step; ++i) {
    if (!write_next(write_limit)) {
      return false;
    }
    if (ended_) {
      write_status(Clock::now(),
                   write_limit); // ENDED is seen even if the next session follows at once
    }
  }
  return true;
}

dyncal::wire::SourceState SourcePublication::state(const SourcePublisher::Snapshot& snapshot,
                                                   Clock::time_point now) const {
  if (snapshot.stage == SourceStage::failed) {
    return wire::SOURCE_FAILED;
  }
  if (ended_ && snapshot.stage == SourceStage::starting) {
    return wire::SOURCE_ENDED;
  }
  if (ended_ && snapshot.stage == SourceStage::ended) {
    return wire::SOURCE_ENDED;
  }
  if (snapshot.reachable && snapshot.stage != SourceStage::ended) {
    return *snapshot.reachable ? wire::SOURCE_RUNNING : wire::SOURCE_SILENT;
  }
  const bool watched =
      snapshot.silent_after > std::chrono::nanoseconds(0) && snapshot.stage != SourceStage::ended;
  if (watched && now - snapshot.last_offer > snapshot.silent_after) {
    return wire::SOURCE_SILENT;
  }
  return snapshot.stage == SourceStage::starting ? wire::SOURCE_STARTING : wire::SOURCE_RUNNING;
}

// From block to block: between two statuses there is a part of one.
void SourcePublication::measure_rate(const SourcePublisher::Snapshot& snapshot,
                                     Clock::time_point now) {
  if (snapshot.offered_samples == 0) {
    return; // the first block began before it came
  }
  if (rate_points_.empty() || snapshot.last_offer != rate_points_.back().time) {
    rate_points_.push_back({snapshot.last_offer, snapshot.offered_samples});
  }
  while (rate_points_.size() > 2 && now - rate_points_.front().time > rate_window) {
    rate_points_.pop_front();
  }
  const RatePoint& first = rate_points_.front();
  const RatePoint& last = rate_points_.back();
  const double elapsed_s = std::chrono::duration<double>(last.time - first.time).count();
  rate_hz_ = elapsed_s > 0.0 && now - last.time <= rate_window
                 ? static_cast<double>(last.samples - first.samples) / elapsed_s
                 : 0.0;
}

void SourcePublication::add_what_is_kept(dyncal::wire::SourceStatus& message) {
  add_cause(message, "not kept for catching up", kept_->not_kept());
  const std::string problem = kept_->problem();
  if (problem.empty()) {
    return;
  }
  if (message.message().empty()) {
    message.message(problem);
  }
  if (!warned_of_kept_) {
    warned_of_kept_ = true;
    publisher_->warn(problem);
  }
}

void SourcePublication::write_status(Clock::time_point now, std::chrono::nanoseconds limit) {
  const auto snapshot = publisher_->snapshot();
  measure_rate(snapshot, now);
  auto message = to_message(publisher_->options(), snapshot);
  message.session(session_);
  message.state(state(snapshot, now));
  message.published_utc_ns(utc_now_ns());
  message.rate_hz(rate_hz_);
  message.dropped_in_service(publisher_->ring().dropped() + lost_in_writes_);
  message.buffer_fill(publisher_->ring().fill());
  message.matched_readers(
      static_cast<std::uint32_t>(std::max(0, writers_.samples->matched_readers())));
  add_cause(message, "writes refused by the bus", failed_writes_);
  add_what_is_kept(message);
  if (writers_.status.write(message, limit) != bus::WriteOutcome::written) {
    return; // the next one is due soon anyway
  }
  published_state_ = message.state();
  status_written_ = now;
  if (report_) {
    report_(message, written_);
  }
}

SourcePublication::Clock::time_point
SourcePublication::step_status(std::chrono::nanoseconds interval,
                               std::chrono::nanoseconds write_limit) {
  const auto now = Clock::now();
  const bool changed = state(publisher_->snapshot(), now) != published_state_;
  if (!status_written_ || changed || now - *status_written_ >= interval) {
    write_status(now, write_limit);
  }
  return (status_written_ ? *status_written_ : now) + interval;
}

} // namespace dyncal::inline stream
