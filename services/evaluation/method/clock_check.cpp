#include "services/evaluation/method/clock_check.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "analysis/clock/clock_steps.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double worth_a_flag = 0.5; // of u

} // namespace

std::vector<SteppedClock> find_stepped_clock(const SelectedChannels& channels,
                                             const analysis::Frequency& frequency,
                                             bool linked_by_sync) {
  const TimeInterval& interval = channels.interval();
  const auto inside = [&](std::int64_t stamp_ns) {
    return stamp_ns >= interval.begin_ns && stamp_ns <= interval.end_ns;
  };
  const auto all = channels.record().stamps_ns();
  const auto first = std::find_if(all.begin(), all.end(), inside);
  const auto behind = std::find_if(all.rbegin(), std::make_reverse_iterator(first), inside).base();
  const auto begin = static_cast<std::size_t>(first - all.begin());
  const auto count = static_cast<std::size_t>(behind - first);
  const auto found = analysis::find_clock_steps(all.subspan(begin, count),
                                                channels.record().flags().subspan(begin, count));
  if (found.empty()) {
    return {};
  }
  SteppedClock stepped{.source = channels.record().source()};
  const double turn_per_ns = 2.0 * std::numbers::pi * frequency.hz() * 1e-9;
  std::complex<double> sum;
  std::vector<double> turns;
  double offset_ns = 0.0;
  std::size_t from = 0;
  for (std::size_t k = 0; k <= found.size(); ++k) {
    const std::size_t to = k < found.size() ? found[k].sample : count;
    turns.push_back(turn_per_ns * offset_ns);
    sum +=
        static_cast<double>(to - from) / static_cast<double>(count) * std::polar(1.0, turns.back());
    if (k < found.size()) {
      offset_ns += found[k].size_ns;
    }
    from = to;
  }
  stepped.magnitude_rel = 1.0 - std::abs(sum);
  if (!linked_by_sync) {
    for (const double turn : turns) {
      stepped.phase_rad =
          std::max(stepped.phase_rad, std::abs(std::arg(sum * std::polar(1.0, -turn))));
    }
  }
  return {stepped};
}

void add_clock_check(const std::vector<SteppedClock>& stepped, StepResult& result) {
  for (const SteppedClock& clock : stepped) {
    if (clock.magnitude_rel * result.magnitude > worth_a_flag * result.u_magnitude ||
        clock.phase_rad > worth_a_flag * result.u_phase_rad) {
      result.flags.push_back(flag_of_source(ResultFlag::clock_stepped, clock.source));
    }
  }
}

} // namespace dyncal::inline evaluation
