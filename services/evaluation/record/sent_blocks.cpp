#include "services/evaluation/record/sent_blocks.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::inline evaluation {

void SentBlocks::add(const SourceBlock& block, const BlockTimes& times) {
  // Of all sessions: the first blocks of a source that was started again may all come late.
  min_delay_ns_ = std::min(min_delay_ns_, times.heard_ns - times.sent_ns);
  if (block.samples == 0 || !block.is_consistent()) {
    return;
  }
  if (blocks_.empty() || block.session != session_) {
    session_ = block.session;
    first_ns_ = block.first_stamp_ns();
    blocks_.clear();
  }
  blocks_.push_back(
      {blocks_.empty() ? times.sent_ns : std::max(times.sent_ns, blocks_.back().sent_ns),
       block.last_stamp_ns(), block.number});
  if (blocks_.size() > max_blocks) {
    blocks_.pop_front();
  }
}

std::optional<SourceInstant> SentBlocks::at(std::int64_t heard_ns) const {
  if (blocks_.empty()) {
    return std::nullopt;
  }
  const std::int64_t then_ns = heard_ns - min_delay_ns_;
  const auto next =
      std::upper_bound(blocks_.begin(), blocks_.end(), then_ns,
                       [](std::int64_t ns, const Sent& block) { return ns < block.sent_ns; });
  if (next == blocks_.begin()) {
    return SourceInstant{first_ns_ - 1, false};
  }
  const Sent& before = *(next - 1);
  if (next == blocks_.end() || next->number != before.number + 1) {
    return SourceInstant{before.last_ns + 1, false};
  }
  const double part = static_cast<double>(then_ns - before.sent_ns) /
                      static_cast<double>(next->sent_ns - before.sent_ns);
  return SourceInstant{before.last_ns +
                       std::llround(part * static_cast<double>(next->last_ns - before.last_ns))};
}

} // namespace dyncal::inline evaluation
