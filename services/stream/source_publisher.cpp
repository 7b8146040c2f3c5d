#include "services/stream/source_publisher.hpp"

#include <algorithm>
#include <utility>

#include <spdlog/spdlog.h>

#include "services/bus/bus.hpp"
#include "services/contract/session_number.hpp"
#include "services/stream/block_split.hpp"

namespace dyncal::inline stream {

using Clock = std::chrono::steady_clock;

namespace {

constexpr auto brief_wait = std::chrono::seconds(1);

} // namespace

SourcePublisher::SourcePublisher(SourceOptions options, std::shared_ptr<bus::WakeUp> wake_up)
    : options_(std::move(options)), wake_up_(std::move(wake_up)), ring_(options_.ring) {
  state_.session = options_.session != 0 ? options_.session : random_session();
  state_.last_offer = Clock::now();
}

void SourcePublisher::describe(const drivers::SourceDescription& reported) {
  const drivers::SourceDescription description = with_identity(reported, options_.identity);
  {
    const std::lock_guard lock(mutex_);
    if (description_ == description) {
      return;
    }
    description_ = description;
    description_changed_ = true;
    factors_ = unit_factors(reported, options_.identity);
  }
  for (const std::string& doubt : unit_doubts(reported, options_.identity)) {
    warn(doubt);
  }
  wake_up_->ring();
}

std::vector<double> SourcePublisher::factors() const {
  const std::lock_guard lock(mutex_);
  return factors_;
}

void SourcePublisher::begin_session() {
  const std::lock_guard lock(mutex_);
  if (play_ended_) {
    playing_.clear();
    superseded_ = false;
    play_ended_ = false;
  }
  if (!session_used_) {
    return;
  }
  state_.session = random_session();
  state_.stage = SourceStage::starting;
  state_.last_offer = Clock::now();
  session_used_ = false;
  gap_count_ = 0;
}

RingEntry SourcePublisher::next_entry(drivers::SampleBlock block, std::optional<Shot> shot) {
  const auto now = Clock::now();
  const std::lock_guard lock(mutex_);
  if (session_used_) {
    gaps_[gap_count_++ % gaps_.size()] = now - state_.last_offer;
  }
  session_used_ = true;
  state_.stage = SourceStage::streaming;
  state_.offered_samples += shot ? 0 : block.samples;
  state_.last_offer = now;
  return {.block = std::move(block),
          .shot = std::move(shot),
          .session = state_.session,
          .end_of_stream = false,
          .offered = now};
}

void SourcePublisher::offer(RingEntry entry) {
  switch (options_.when_full) {
  case WhenFull::wait:
    ring_.offer_waiting(std::move(entry), options_.stop);
    break;
  case WhenFull::wait_briefly:
    ring_.offer_within(std::move(entry), brief_wait, options_.stop);
    break;
  case WhenFull::drop:
    ring_.offer(std::move(entry));
    break;
  }
  wake_up_->ring();
}

void SourcePublisher::take(drivers::SampleBlock block) {
  RingEntry whole = next_entry(std::move(block), std::nullopt);
  for (drivers::SampleBlock& part : split(std::move(whole.block), options_.max_block_bytes)) {
    offer({.block = std::move(part),
           .shot = std::nullopt,
           .session = whole.session,
           .end_of_stream = false,
           .offered = whole.offered});
  }
}

bool SourcePublisher::take_shot(Shot shot, drivers::SampleBlock values) {
  const bool taken = ring_.offer(next_entry(std::move(values), std::move(shot)));
  wake_up_->ring();
  return taken;
}

void SourcePublisher::set_reachable(bool reachable) {
  {
    const std::lock_guard lock(mutex_);
    state_.reachable = reachable;
  }
  wake_up_->ring(); // the status is published at once when the state changes
}

void SourcePublisher::close_stream(SourceStage stage) {
  RingEntry mark;
  {
    const std::lock_guard lock(mutex_);
    if (state_.stage == SourceStage::ended || state_.stage == SourceStage::failed) {
      return;
    }
    state_.stage = stage;
    session_used_ = true;
    mark.session = state_.session;
  }
  mark.end_of_stream = true;
  mark.offered = Clock::now();
  ring_.offer(std::move(mark));
  wake_up_->ring();
}

void SourcePublisher::end() {
  close_stream(SourceStage::ended);
}

void SourcePublisher::fail(std::string message) {
  set_message(std::move(message));
  close_stream(SourceStage::failed);
}

void SourcePublisher::count(const drivers::SampleCounts& counts) {
  const std::lock_guard lock(mutex_);
  state_.counts = counts;
}

void SourcePublisher::warn(const std::string& sentence) {
  spdlog::warn("{}/{}: {}", options_.bench, options_.source, sentence);
}

void SourcePublisher::set_message(std::string message) {
  const std::lock_guard lock(mutex_);
  state_.message = std::move(message);
}

std::optional<std::string> SourcePublisher::wait_for_run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  std::optional<std::string> found;
  running_changed_.wait(lock, stop, [&] {
    const auto fresh = std::ranges::find_if(
        running_, [&](const auto& run) { return std::ranges::count(returned_, run) == 0; });
    if (fresh != running_.end()) {
      found = *fresh;
    }
    return found.has_value();
  });
  // Only runs that are still RUNNING need to be remembered, so this stays as short as that list.
  std::erase_if(returned_, [&](const auto& run) { return std::ranges::count(running_, run) == 0; });
  if (found) {
    returned_.push_back(*found);
    playing_ = *found;
  }
  return found;
}

void SourcePublisher::wait_until_over(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  running_changed_.wait(lock, stop, [&] {
    return superseded_ || playing_.empty() || std::ranges::count(running_, playing_) == 0;
  });
}

void SourcePublisher::end_play() {
  const std::lock_guard lock(mutex_);
  play_ended_ = true;
}

bool SourcePublisher::may_answer(const std::string& run) {
  {
    const std::lock_guard lock(mutex_);
    if (playing_.empty() || playing_ == run) {
      answered_run_ = run;
      return true;
    }
    superseded_ = true;
  }
  running_changed_.notify_all();
  return false;
}

void SourcePublisher::note_running(const std::vector<std::string>& runs) {
  {
    const std::lock_guard lock(mutex_);
    running_ = runs;
  }
  running_changed_.notify_all();
}

void SourcePublisher::note_run(HeardRun run) {
  const std::lock_guard lock(mutex_);
  if (run.is_under_way || !heard_run_ || heard_run_->run == run.run) { // else one that is over
    heard_run_ = std::move(run);
  }
}

std::optional<HeardRun> SourcePublisher::heard_run() const {
  const std::lock_guard lock(mutex_);
  auto heard = heard_run_;
  if (heard) {
    heard->is_answered = heard->run == answered_run_;
  }
  return heard;
}

void SourcePublisher::hand_out(HandedOutStep step) {
  {
    const std::lock_guard lock(mutex_);
    handed_out_.push_back(std::move(step));
  }
  wake_up_->ring();
}

std::vector<HandedOutStep> SourcePublisher::take_handed_out() {
  const std::lock_guard lock(mutex_);
  return std::exchange(handed_out_, {});
}

std::chrono::nanoseconds SourcePublisher::usual_gap() const {
  const auto known = std::min(gap_count_, gaps_.size());
  // The shortest of the last gaps: one long pause does not make a quick source look slow.
  return known == 0
             ? std::chrono::nanoseconds(0)
             : *std::min_element(gaps_.begin(), gaps_.begin() + static_cast<std::ptrdiff_t>(known));
}

SourcePublisher::Snapshot SourcePublisher::snapshot() const {
  const std::lock_guard lock(mutex_);
  Snapshot snapshot = state_;
  if (options_.silent_after > std::chrono::nanoseconds(0)) {
    snapshot.silent_after = std::max(options_.silent_after, 4 * usual_gap());
  }
  return snapshot;
}

std::uint64_t SourcePublisher::session() const {
  const std::lock_guard lock(mutex_);
  return state_.session;
}

std::optional<drivers::SourceDescription> SourcePublisher::take_changed_description() {
  const std::lock_guard lock(mutex_);
  if (!description_changed_) {
    return std::nullopt;
  }
  description_changed_ = false;
  return description_;
}

} // namespace dyncal::inline stream
