#include "services/bus/fastdds/screen/reader_progress.hpp"

#include <algorithm>

namespace dyncal::bus {

using namespace rtps_format;

ReaderProgress::Key ReaderProgress::key_of(Bytes source, Bytes entities) {
  Key key;
  std::ranges::copy(source.first(prefix_bytes), key.participant.begin());
  std::ranges::copy(entities.first(entity_bytes), key.reader.begin());
  std::ranges::copy(entities.subspan(entity_bytes, entity_bytes), key.writer.begin());
  return key;
}

template <class IsBetter>
ReaderProgress::AllProgress::iterator ReaderProgress::find(const Key& key, IsBetter is_better) {
  if (key.reader != EntityId{}) {
    return readers_.find(key);
  }
  auto best = readers_.end();
  for (auto one = readers_.lower_bound(key); // the reader's id is its last part
       one != readers_.end() && one->first.participant == key.participant &&
       one->first.writer == key.writer;
       ++one) {
    best = best == readers_.end() || is_better(one->second, best->second) ? one : best;
  }
  return best;
}

void ReaderProgress::sent(Bytes datagram, Instant now) {
  Prefix to{};
  visit_submessages(datagram, [&](const Submessage& one) {
    if (one.id == info_destination && one.body.size() >= prefix_bytes) {
      std::ranges::copy(one.body.first(prefix_bytes), to.begin());
    } else if (one.id == acknack && one.body.size() >= entities_bytes + sequence_bytes) {
      if (const auto next = sequence_at(one.body, entities_bytes, one.flags)) {
        acknowledged(key_of(to, one.body), std::max<std::int64_t>(*next, 1), now);
      }
    }
    return true;
  });
}

void ReaderProgress::acknowledged(const Key& key, std::int64_t next, Instant now) {
  const std::lock_guard lock(mutex_);
  if (readers_.size() >= max_readers && !readers_.contains(key)) {
    readers_.clear();
  }
  readers_[key] = {.next = next, .told = now};
}

std::int64_t ReaderProgress::allowed(std::int64_t wanted, std::int64_t visits, Instant now) {
  const double waited_s = std::chrono::duration<double>(now - granted_).count();
  granted_ = now;
  allowance_ += static_cast<std::int64_t>(
      std::min(waited_s * visits_per_s, static_cast<double>(max_visits - allowance_)));
  const std::int64_t granted = std::min(wanted, std::max(allowance_ / visits, window));
  allowance_ = std::max<std::int64_t>(allowance_ - granted * visits, 0);
  return granted;
}

ReaderProgress::Range ReaderProgress::of_gap(Bytes source, Bytes entities, Range range,
                                             Instant now) {
  const std::lock_guard lock(mutex_);
  const auto reader =
      find(key_of(source, entities), [&](const Progress& one, const Progress& other) {
        return now - one.told < lives && (now - other.told >= lives || one.next < other.next);
      });
  if (reader == readers_.end() || now - reader->second.told >= lives) {
    return {range.first, std::min(range.end, range.first + window)};
  }
  Progress& progress = reader->second;
  range.first = std::max(range.first, progress.next);
  if (range.first != progress.next || range.end - progress.next <= window || progress.moved) {
    range.end = std::min(range.end, progress.next + window);
  } else {
    range.end = progress.next + allowed(range.end - progress.next, visits_in_gap, now);
    progress.moved = true;
  }
  return range;
}

std::int64_t ReaderProgress::heartbeat_begin(Bytes source, Bytes entities, std::int64_t first,
                                             Instant now) {
  const std::lock_guard lock(mutex_);
  const auto reader =
      find(key_of(source, entities),
           [](const Progress& one, const Progress& other) { return one.next > other.next; });
  const std::int64_t next = reader == readers_.end() ? 1 : reader->second.next;
  if (first - next <= window) {
    return first;
  }
  return next + allowed(first - next, 1, now);
}

} // namespace dyncal::bus
