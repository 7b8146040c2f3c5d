#include "services/programs/analysis/waiting_blocks.hpp"

#include "services/programs/analysis/stream_follower.hpp"

namespace dyncal::inline programs {

void WaitingBlocks::add(const wire::SampleBlock& block) {
  blocks_.push_back(block);
  bytes_ += bytes_of(block);
  while (bytes_ > bound_bytes_) {
    take_off_oldest();
  }
}

void WaitingBlocks::take_off_oldest() {
  bytes_ -= bytes_of(blocks_.front());
  blocks_.pop_front();
}

void WaitingBlocks::leave_out_session(std::uint64_t session) {
  std::erase_if(blocks_, [&](const wire::SampleBlock& block) {
    const bool leaves = block.session() == session;
    bytes_ -= leaves ? bytes_of(block) : 0;
    return leaves;
  });
}

} // namespace dyncal::inline programs
