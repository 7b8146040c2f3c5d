#include "services/stream/block_ring.hpp"

#include <algorithm>
#include <utility>

namespace dyncal::inline stream {

std::size_t held_bytes(const drivers::SampleBlock& block) {
  return sizeof(RingEntry) + block.values.capacity() * sizeof(double) +
         block.stamps_ns.capacity() * sizeof(std::int64_t) +
         block.stamp_uncertainty_ns.capacity() * sizeof(std::uint32_t) + block.flags.capacity();
}

std::uint64_t size_of(const RingEntry& entry) {
  return entry.shot ? 1 : entry.block.samples;
}

bool BlockRing::has_room(const RingEntry& entry) const {
  if (entries_.empty() || entry.block.samples == 0) {
    return true;
  }
  return bytes_ + held_bytes(entry.block) <= limits_.bytes &&
         entry.offered - entries_.front().offered <= limits_.span;
}

void BlockRing::append(RingEntry entry, std::unique_lock<std::mutex> lock) {
  bytes_ += held_bytes(entry.block);
  entries_.push_back(std::move(entry));
  lock.unlock();
  changed_.notify_all();
}

bool BlockRing::offer(RingEntry entry) {
  std::unique_lock lock(mutex_);
  if (!has_room(entry)) {
    dropped_ += size_of(entry);
    return false;
  }
  append(std::move(entry), std::move(lock));
  return true;
}

bool BlockRing::offer_waiting(RingEntry entry, const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  if (!changed_.wait(lock, stop, [&] { return has_room(entry); })) {
    return false;
  }
  append(std::move(entry), std::move(lock));
  return true;
}

bool BlockRing::offer_within(RingEntry entry, std::chrono::nanoseconds limit,
                             const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  const auto patience = waited_in_vain_ ? std::chrono::nanoseconds(0) : limit;
  waited_in_vain_ = !changed_.wait_for(lock, stop, patience, [&] { return has_room(entry); });
  if (waited_in_vain_) {
    dropped_ += size_of(entry);
    return false;
  }
  append(std::move(entry), std::move(lock));
  return true;
}

std::optional<RingEntry> BlockRing::take_oldest(std::unique_lock<std::mutex> lock) {
  if (entries_.empty()) {
    return std::nullopt;
  }
  RingEntry entry = std::move(entries_.front());
  entries_.pop_front();
  bytes_ -= held_bytes(entry.block);
  lock.unlock();
  changed_.notify_all();
  return entry;
}

std::optional<RingEntry> BlockRing::take() {
  return take_oldest(std::unique_lock(mutex_));
}

std::optional<RingEntry> BlockRing::take_waiting(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  const bool has_come = changed_.wait(lock, stop, [&] { return !entries_.empty(); });
  return has_come ? take_oldest(std::move(lock)) : std::nullopt;
}

void BlockRing::discard() {
  {
    const std::lock_guard lock(mutex_);
    std::erase_if(entries_, [](const RingEntry& entry) { return size_of(entry) > 0; });
    bytes_ = 0;
    for (const RingEntry& mark : entries_) {
      bytes_ += held_bytes(mark.block);
    }
  }
  changed_.notify_all();
}

bool BlockRing::empty() const {
  const std::lock_guard lock(mutex_);
  return entries_.empty();
}

double BlockRing::fill() const {
  const std::lock_guard lock(mutex_);
  if (entries_.empty()) {
    return 0.0;
  }
  const double span =
      std::chrono::duration<double>(entries_.back().offered - entries_.front().offered).count();
  const double by_span = span / std::chrono::duration<double>(limits_.span).count();
  const double by_bytes = static_cast<double>(bytes_) / static_cast<double>(limits_.bytes);
  return std::clamp(std::max(by_span, by_bytes), 0.0, 1.0);
}

std::uint64_t BlockRing::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

} // namespace dyncal::inline stream
