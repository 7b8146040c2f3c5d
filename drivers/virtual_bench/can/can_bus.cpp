#include "drivers/virtual_bench/can/can_bus.hpp"
#include "drivers/can/time/frame_duration.hpp"

#include <algorithm>
#include <utility>

namespace dyncal::drivers::virtual_bench {
namespace {

constexpr double intermission_bits = 3.0;

// Lower wins: the bits as they are sent, a base id before an extended one that begins with the same
// eleven bits.
std::pair<std::uint32_t, std::uint32_t> priority(const can::CanFrame& frame) {
  constexpr unsigned extension_bits = 18;
  return frame.extended
             ? std::pair(frame.id >> extension_bits, 1 + (frame.id & ((1U << extension_bits) - 1)))
             : std::pair(frame.id, std::uint32_t{0});
}

} // namespace

void CanBus::offer(const can::CanFrame& frame, double ready_s) {
  waiting_.push_back({frame, ready_s});
}

std::optional<SentFrame> CanBus::next_before(double time_s) {
  if (waiting_.empty()) {
    return std::nullopt;
  }
  const auto earliest =
      std::min_element(waiting_.begin(), waiting_.end(),
                       [](const Waiting& a, const Waiting& b) { return a.ready_s < b.ready_s; });
  const double start_s = std::max(idle_from_s_, earliest->ready_s);
  if (start_s >= time_s) {
    return std::nullopt;
  }
  auto winner = earliest;
  for (auto candidate = waiting_.begin(); candidate != waiting_.end(); ++candidate) {
    if (candidate->ready_s <= start_s && priority(candidate->frame) < priority(winner->frame)) {
      winner = candidate;
    }
  }
  SentFrame sent{winner->frame, winner->ready_s, start_s,
                 start_s + can::frame_duration_s(winner->frame, rates_)};
  waiting_.erase(winner);
  idle_from_s_ = sent.end_s + intermission_bits / rates_.nominal_per_s;
  return sent;
}

} // namespace dyncal::drivers::virtual_bench
