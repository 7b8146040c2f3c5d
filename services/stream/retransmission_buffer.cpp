#include "services/stream/retransmission_buffer.hpp"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

namespace dyncal::inline stream {

namespace {

constexpr std::size_t max_sessions = 256;
constexpr std::size_t max_answers = 64;
constexpr std::size_t entry_bytes = 128; // of memory beside a payload

KeptLimits with_folder(KeptLimits limits) {
  if (limits.folder.empty()) {
    limits.folder = folder_for_kept_messages();
  }
  return limits;
}

double minutes(std::chrono::nanoseconds time) {
  return std::chrono::duration<double, std::ratio<60>>(time).count();
}

} // namespace

RetransmissionBuffer::RetransmissionBuffer(KeptLimits limits)
    : limits_(with_folder(std::move(limits))) {}

void RetransmissionBuffer::note(const KeptMessage& message) {
  if (sessions_.empty() || sessions_.back().session != message.session) {
    sessions_.push_back({message.session, next_place_});
    if (sessions_.size() > max_sessions) {
      sessions_.pop_front();
    }
  }
  if (!message.acknowledged_run.empty() &&
      std::ranges::none_of(
          answers_, [&](const Answer& answer) { return answer.run == message.acknowledged_run; })) {
    answers_.push_back({message.acknowledged_run, next_place_});
    if (answers_.size() > max_answers) {
      answers_.pop_front();
    }
  }
}

void RetransmissionBuffer::keep(KeptMessage message, Instant now) {
  const std::lock_guard lock(mutex_);
  note(message);
  const std::size_t size = message.payload->size();
  entries_.push_back({.place = next_place_++,
                      .session = message.session,
                      .number = message.number,
                      .time = now,
                      .size = size,
                      .payload = std::move(message.payload)});
  memory_bytes_ += size + entry_bytes;
  while (memory_bytes_ > limits_.max_memory_bytes && entries_.size() > in_file_ + 1) {
    const Place dropped = entries_[in_file_].place;
    drop_entry(in_file_);
    ++not_kept_;
    run_short(dropped, now, "the disk is too slow");
  }
}

void RetransmissionBuffer::want(Instant now) {
  const std::lock_guard lock(mutex_);
  wanted_until_ = now + limits_.span;
}

bool RetransmissionBuffer::tidy_due() const {
  const std::lock_guard lock(mutex_);
  return memory_bytes_ > 2 * limits_.memory_bytes;
}

void RetransmissionBuffer::drop_entry(std::size_t index) {
  if (index < in_file_) {
    --in_file_;
  } else {
    memory_bytes_ -= entries_[index].size + entry_bytes;
  }
  entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(index));
}

bool RetransmissionBuffer::is_of_newest_run(Place place, Instant now) const {
  return wanted_until_ && now <= *wanted_until_ && !answers_.empty() &&
         place >= answers_.back().place;
}

void RetransmissionBuffer::drop_old(Instant now) {
  while (!entries_.empty()) {
    const Place oldest = entries_.front().place;
    const bool is_of_run = is_of_newest_run(oldest, now);
    const auto age = now - entries_.front().time;
    if (age <= (is_of_run ? std::max(limits_.run_span, limits_.span) : limits_.span)) {
      return;
    }
    drop_oldest();
    if (is_of_run) {
      run_short(
          oldest, now,
          fmt::format("no more than {:.0f} min of a run are kept", minutes(limits_.run_span)));
    }
  }
}

void RetransmissionBuffer::drop_oldest() {
  drop_entry(0);
}

void RetransmissionBuffer::run_short(Place place, Instant now, const std::string& reason) {
  short_since_ = now;
  short_place_ = place;
  const auto kept = entries_.empty() ? std::chrono::nanoseconds(0) : now - entries_.front().time;
  if (kept < limits_.span) {
    problem_ = fmt::format("keeps {:.1f} of {:.1f} min for who catches up: {}", minutes(kept),
                           minutes(limits_.span), reason);
  } else {
    problem_ = fmt::format("keeps the last {:.1f} min of run '{}', not its beginning, so that no "
                           "other analysis can take it over: {}",
                           minutes(kept), answers_.empty() ? "" : answers_.back().run, reason);
  }
}

Expected<std::uint64_t> RetransmissionBuffer::append(const std::string& payload) {
  if (!file_ && no_file_.empty()) {
    auto file = ByteLog::create(
        limits_.folder, {.bytes = limits_.file_bytes, .min_free_bytes = limits_.min_free_bytes});
    if (file) {
      file_.emplace(std::move(*file));
    } else {
      no_file_ = file.error().message;
    }
  }
  if (!file_) {
    return fail(ErrorCode::bad_file, no_file_);
  }
  return file_->append(payload);
}

// Returns false if there is nothing more to move.
bool RetransmissionBuffer::move_oldest_to_file(std::unique_lock<std::mutex>& lock, Instant now) {
  if (memory_bytes_ <= limits_.memory_bytes || entries_.size() <= in_file_ + 1) {
    return false;
  }
  if (!wanted_until_ || now > *wanted_until_) {
    drop_oldest();
    return true;
  }
  const Entry oldest = entries_[in_file_];
  lock.unlock();
  const auto offset = append(*oldest.payload);
  lock.lock();
  const std::size_t index = index_of(oldest.place);
  if (index != in_file_ || index >= entries_.size() || entries_[index].place != oldest.place) {
    return true; // dropped meanwhile
  }
  if (offset) {
    entries_[index].offset = *offset;
    entries_[index].payload.reset();
    memory_bytes_ -= oldest.size + entry_bytes;
    ++in_file_;
    return true;
  }
  ++not_kept_;
  const Place dropped = entries_.front().place;
  drop_oldest(); // of the file, if that holds any
  run_short(dropped, now, offset.error().message);
  if (file_) {
    const std::uint64_t begin = in_file_ > 0 ? entries_.front().offset : file_->end();
    file_->drop_before(begin);
  }
  return true;
}

void RetransmissionBuffer::tidy(Instant now) {
  std::unique_lock lock(mutex_);
  drop_old(now);
  while (move_oldest_to_file(lock, now)) {
  }
  if (short_since_ && now - *short_since_ > limits_.span && !is_of_newest_run(short_place_, now)) {
    short_since_.reset();
    problem_.clear();
  }
  if (file_) {
    file_->drop_before(in_file_ > 0 ? entries_.front().offset : file_->end());
  }
}

std::size_t RetransmissionBuffer::index_of(Place place) const {
  const auto found = std::ranges::lower_bound(entries_, place, {}, &Entry::place);
  return static_cast<std::size_t>(found - entries_.begin());
}

RetransmissionBuffer::Place RetransmissionBuffer::end() const {
  const std::lock_guard lock(mutex_);
  return next_place_;
}

RetransmissionBuffer::Place RetransmissionBuffer::place_behind(std::uint64_t session,
                                                               std::uint64_t after,
                                                               const std::string& run) const {
  const std::lock_guard lock(mutex_);
  const auto known = std::ranges::find(sessions_, session, &Session::session);
  if (session == 0 || known == sessions_.end()) {
    const auto answer = std::ranges::find(answers_, run, &Answer::run);
    return answer == answers_.end() ? 0 : answer->place;
  }
  const Place end = std::next(known) == sessions_.end() ? next_place_ : std::next(known)->begin;
  std::optional<Place> same;
  for (std::size_t i = index_of(known->begin); i < entries_.size() && entries_[i].place < end;
       ++i) {
    if (entries_[i].number > after) {
      return entries_[i].place;
    }
    if (entries_[i].number == after && !same) {
      same = entries_[i].place; // records that end or answer all have number 0
    }
  }
  return same ? *same + 1 : end;
}

std::optional<RetransmissionBuffer::Found> RetransmissionBuffer::at_or_behind(Place place) {
  std::unique_lock lock(mutex_);
  for (std::size_t i = index_of(place); i < entries_.size(); i = index_of(place)) {
    const Entry entry = entries_[i];
    Found found{
        .place = entry.place, .session = entry.session, .number = entry.number, .payload = {}};
    if (entry.payload) {
      lock.unlock();
      found.payload = entry.payload;
      return found;
    }
    lock.unlock();
    auto bytes = file_->read(entry.offset, entry.size);
    if (bytes) {
      found.payload = std::make_shared<const std::string>(std::move(*bytes));
      return found;
    }
    lock.lock();
    ++not_kept_; // unreadable
    place = entry.place + 1;
  }
  return std::nullopt;
}

std::uint64_t RetransmissionBuffer::not_kept() const {
  const std::lock_guard lock(mutex_);
  return not_kept_;
}

std::string RetransmissionBuffer::problem() const {
  const std::lock_guard lock(mutex_);
  return problem_;
}

} // namespace dyncal::inline stream
