#include "drivers/smartup/sync_join.hpp"

#include <algorithm>

namespace dyncal::drivers::smartup {

void SyncJoin::add(const SampleRow& row) {
  rows_.push_back(row);
  if (rows_.size() > max_wait) {
    releasing_ = std::max<std::size_t>(releasing_, 1);
  }
}

void SyncJoin::add_sync(std::int64_t stamp_ns, std::uint16_t present,
                        const std::array<float, channels_of_unit>& values) {
  sync_.push_back({stamp_ns, present, values});
  if (sync_.size() > max_wait) {
    drop_sync(1);
  }
}

void SyncJoin::drop_sync(std::size_t count) {
  sync_.erase(sync_.begin(), sync_.begin() + static_cast<std::ptrdiff_t>(count));
  sync_left_out_ += count;
}

std::size_t SyncJoin::discard() {
  const std::size_t waiting = rows_.size();
  rows_.clear();
  releasing_ = 0;
  return waiting;
}

bool SyncJoin::take(SampleRow& row) {
  if (rows_.empty()) {
    return false;
  }
  const auto partner = std::ranges::find(sync_, rows_.front().stamp_ns, &SyncSample::stamp_ns);
  if (partner != sync_.end()) {
    drop_sync(static_cast<std::size_t>(partner - sync_.begin())); // their samples did not come
    rows_.front().sync_present = sync_.front().present;
    rows_.front().sync_values = sync_.front().values;
    sync_.pop_front();
  } else {
    // A later row that has its partner already proves that this one's will not come.
    const bool overtaken =
        !sync_.empty() && std::ranges::any_of(rows_, [&](const SampleRow& later) {
          return later.stamp_ns == sync_.front().stamp_ns;
        });
    if (!overtaken && releasing_ == 0) {
      return false;
    }
    ++without_sync_;
  }
  row = rows_.front();
  rows_.pop_front();
  if (releasing_ > 0) {
    --releasing_;
  }
  return true;
}

} // namespace dyncal::drivers::smartup
