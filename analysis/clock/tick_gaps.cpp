#include "analysis/clock/tick_gaps.hpp"

namespace dyncal::analysis {
namespace {

constexpr PeriodRange periods_in_ticks = {1.0, 1.25};

} // namespace

// With the gaps of these places as losses, the others as ticks.
std::optional<TickLine> TickGaps::line_without(std::size_t one, std::size_t other) const {
  const auto tick_ns = static_cast<double>(interval_ns_);
  TickLine line(tick_ns, {periods_in_ticks.min_ns * tick_ns, periods_in_ticks.max_ns * tick_ns},
                strays_ > 0 ? TickLine::most_latency_ticks : TickLine::least_latency_ticks);
  line.begin(first_, first_ns_);
  std::uint64_t lost = 0;
  for (std::size_t i = 0; i < gaps_.size(); ++i) {
    const TickGap& gap = gaps_[i];
    const bool is_loss = i == one || i == other || gap.missing > 1;
    const bool fits_before = line.add(gap.before + lost, gap.before_ns);
    lost += is_loss ? gap.missing : 0;
    if (!fits_before || !line.add(gap.after + lost, gap.after_ns)) {
      return std::nullopt;
    }
  }
  return line;
}

std::optional<ExplainedGaps> TickGaps::explained() const {
  const std::size_t none = gaps_.size();
  std::size_t single = 0;
  for (const TickGap& gap : gaps_) {
    single += gap.missing == 1 ? 1 : 0;
  }
  const auto with_losses = [&](std::size_t one, std::size_t other) -> std::optional<ExplainedGaps> {
    const std::size_t lost = (one < none ? 1U : 0U) + (other < none ? 1U : 0U);
    if (single < gaps_that_convince + 2 * lost) {
      return std::nullopt;
    }
    const auto line = line_without(one, other);
    if (!line) {
      return std::nullopt;
    }
    ExplainedGaps result{*line, {}, strays_ == 0 || flicker()};
    for (std::size_t i = 0; i < none; ++i) {
      if (i == one || i == other || gaps_[i].missing > 1) {
        result.losses.push_back(gaps_[i]);
      }
    }
    return result;
  };
  if (auto found = with_losses(none, none)) {
    return found;
  }
  for (std::size_t one = 0; one < none; ++one) {
    if (auto found = with_losses(one, none)) {
      return found;
    }
  }
  for (std::size_t one = 0; one < none; ++one) {
    for (std::size_t other = one + 1; other < none; ++other) {
      if (auto found = with_losses(one, other)) {
        return found;
      }
    }
  }
  return std::nullopt;
}

std::optional<TickLine> TickGaps::line_to(std::uint64_t last, std::int64_t last_ns) const {
  auto line = line_without(gaps_.size(), gaps_.size());
  return line && line->add(last, last_ns) ? line : std::nullopt;
}

} // namespace dyncal::analysis
