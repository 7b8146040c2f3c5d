// Sample blocks of one source that the evaluator cannot take yet, oldest first.
//
// Bounded in bytes: of more than `max_bytes` the oldest are thrown away; the evaluator finds their
// samples missing and counts them as lost. Belongs to one thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include "idl/dyncal.h"

namespace dyncal::inline programs {

class WaitingBlocks {
public:
  static constexpr std::size_t max_bytes = std::size_t{64} << 20U;

  explicit WaitingBlocks(std::size_t bound_bytes = max_bytes) : bound_bytes_(bound_bytes) {}

  [[nodiscard]] bool empty() const { return blocks_.empty(); }
  [[nodiscard]] const wire::SampleBlock& oldest() const { return blocks_.front(); }
  void add(const wire::SampleBlock& block);
  void take_off_oldest();
  void leave_out_session(std::uint64_t session);

private:
  std::size_t bound_bytes_;
  std::deque<wire::SampleBlock> blocks_;
  std::size_t bytes_ = 0;
};

} // namespace dyncal::inline programs
