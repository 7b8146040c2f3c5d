#include "analysis/clock/ticked_samples.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dyncal::analysis {
namespace {

constexpr std::size_t samples_to_decide = 32;
constexpr double most_of_them = 0.75;
constexpr std::uint32_t max_passed_over = 32;
constexpr double known_to_periods = 1.0 / 8.0;
constexpr double about_a_tick = 1.5;
constexpr std::uint32_t strays_that_convince = 3;

bool are_most(std::size_t some, std::size_t all) {
  return static_cast<double>(some) >= most_of_them * static_cast<double>(all);
}

} // namespace

TickedSamples::TickedSamples(TickLine line, std::uint64_t number, std::int64_t stamp_ns)
    : line_(std::move(line)) {
  line_.begin(number, stamp_ns);
}

void TickedSamples::begin(std::uint64_t number, std::int64_t stamp_ns) {
  waiting_.clear();
  missing_ = 0;
  line_.begin(number, stamp_ns);
}

std::span<const TickedSample> TickedSamples::add(std::uint64_t number, std::int64_t stamp_ns) {
  decided_.clear();
  take({number, stamp_ns});
  return decided_;
}

std::span<const TickedSample> TickedSamples::finish() {
  decided_.clear();
  while (!waiting_.empty()) {
    decide();
  }
  return decided_;
}

void TickedSamples::take(const TimedSample& sample) {
  if (waiting_.empty() && line_.add(sample.number + missing_, sample.stamp_ns)) {
    follow(sample, TickedStep::follows, 0);
    return;
  }
  waiting_.push_back(sample);
  if (waiting_.size() >= samples_to_decide) {
    decide();
  }
}

void TickedSamples::follow(const TimedSample& sample, TickedStep step, std::uint64_t missing) {
  decided_.push_back({step, sample.number, sample.stamp_ns, missing});
  passed_over_ = 0;
}

// How many of the waiting ones lie on a line with each other and those before.
std::size_t TickedSamples::agree(TickLine line, std::uint64_t missing) const {
  std::size_t count = 0;
  for (const TimedSample& one : waiting_) {
    count += line.add(one.number + missing_ + missing, one.stamp_ns) ? 1 : 0;
  }
  return count;
}

std::uint64_t TickedSamples::best_missing(std::size_t& agreeing) const {
  agreeing = agree(line_, 0);
  const TimedSample& first = waiting_.front();
  const PeriodRange range = line_.periods();
  const double about =
      std::round(line_.late_ns(first.number + missing_, first.stamp_ns) / line_.period_ns());
  const double either_side = std::ceil(line_.tick_ns() / line_.period_ns());
  std::uint64_t best = 0;
  if (about + either_side < 1.0 ||
      about * (range.max_ns - range.min_ns) > 2.0 * known_to_periods * range.min_ns) {
    return best;
  }
  const auto most = static_cast<std::uint64_t>(about + either_side);
  for (auto k = static_cast<std::uint64_t>(std::max(1.0, about - either_side)); k <= most; ++k) {
    const std::size_t count = agree(line_, k);
    if (count > agreeing) {
      agreeing = count;
      best = k;
    }
  }
  return best;
}

TickLine TickedSamples::begun(const TimedSample& sample) const {
  TickLine line = line_;
  line.begin(sample.number + missing_, sample.stamp_ns);
  return line;
}

// Whether one that lies on no line, but about a tick beside it, is the last that shows a latency at
// the edge of a tick.
bool TickedSamples::widens(const TimedSample& sample) {
  const double off_ns = line_.late_ns(sample.number + missing_, sample.stamp_ns);
  return !line_.is_wide() && std::abs(off_ns) <= about_a_tick * line_.tick_ns() &&
         ++strays_ >= strays_that_convince;
}

// REQUIRES: some wait.
void TickedSamples::decide() {
  std::size_t agreeing = 0;
  const std::uint64_t missing = best_missing(agreeing);
  const TickLine behind_jump = begun(waiting_.front());
  const bool is_jump = waiting_.size() > 1 && !are_most(agreeing, waiting_.size()) &&
                       are_most(agree(behind_jump, 0), waiting_.size());
  const std::vector<TimedSample> samples = std::exchange(waiting_, {});
  const bool is_stray = missing == 0 && are_most(agreeing, samples.size());
  std::size_t next = 1; // the first counts for nothing, unless
  if ((is_stray || is_jump) && samples.size() > 1 && widens(samples.front())) {
    next = is_jump ? 0 : 1;
    line_.widen(samples[next].number + missing_, samples[next].stamp_ns);
  } else if (are_most(agreeing, samples.size())) {
    next = missing > 0 ? follow_missing(samples, missing) : next;
  } else if (is_jump || ++passed_over_ >= max_passed_over) {
    line_ = behind_jump;
    follow(samples.front(), is_jump ? TickedStep::jump : TickedStep::begins_stretch, 0);
  }
  for (; next < samples.size(); ++next) {
    take(samples[next]);
  }
}

// The place behind the first of these that lies on the line when so many are missing before it.
std::size_t TickedSamples::follow_missing(const std::vector<TimedSample>& samples,
                                          std::uint64_t missing) {
  missing_ += missing;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (line_.add(samples[i].number + missing_, samples[i].stamp_ns)) {
      follow(samples[i], TickedStep::missing, missing);
      return i + 1;
    }
  }
  return samples.size();
}

} // namespace dyncal::analysis
