#include "analysis/clock/period_count.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "analysis/base/statistics.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t first_samples = 65;
constexpr double periods_among_first = 0.9;
constexpr double time_in_periods = 0.5; // of the first intervals, but for the longest three
constexpr std::size_t longest_left_out = 3;
constexpr double margin_periods = 0.25;
constexpr double max_margin_periods = 0.75; // with a tick; a whole period is a missing sample
constexpr double max_drift_rel = 1e-4;      // of the period in what is missing
constexpr double coarse_tick_part = 1.0 / 8.0;
constexpr double named_tick_part = 1.0 / 16.0;
constexpr double one_tick = 1.01;
constexpr double always_counted = 1000.0; // periods in a gap
constexpr double period_drift_rel = 5e-6; // of an oscillator within a record
constexpr double known_to_periods = 1.0 / 8.0;
constexpr std::uint64_t periods_for_mean = 256;
constexpr std::uint32_t followers_of_a_move = 8;
constexpr std::uint32_t max_passed_over = 32;
// A clock that is set does so once or twice in a record; a FIFO or a coarse tick at every turn.
constexpr std::uint64_t moves_of_stamping = 5;
constexpr double max_time_in_moves = 0.2;

bool is_multiple(double distance_ns, double period_ns, double margin_ns) {
  const double times = std::round(distance_ns / period_ns);
  return times >= 1.0 && std::abs(distance_ns - times * period_ns) <= margin_ns;
}

// Most of the time passes in intervals of about this length. What is read from a FIFO with stamps a
// few ns apart has its time between the read-outs.
bool holds_most_of_the_time(std::vector<double> intervals_ns, double usual_ns) {
  std::sort(intervals_ns.begin(), intervals_ns.end());
  intervals_ns.resize(intervals_ns.size() - std::min(longest_left_out, intervals_ns.size() / 4));
  double usual = 0.0, all = 0.0;
  for (const double one_ns : intervals_ns) {
    all += one_ns;
    usual += one_ns < 2.5 * usual_ns ? one_ns : 0.0;
  }
  return usual >= time_in_periods * all;
}

} // namespace

void PeriodCount::add(std::uint64_t sample, std::int64_t stamp_ns) {
  const Sample one{sample, stamp_ns, std::exchange(begins_stretch_, false)};
  if (learned_) {
    count(one);
    return;
  }
  first_.push_back(one);
  if (first_.size() == first_samples) {
    learn();
  }
}

void PeriodCount::restart() {
  begins_stretch_ = true;
}

void PeriodCount::finish() {
  if (!learned_) {
    learn();
  }
  if (doubtful_ && periods_to_doubtful()) {
    accept_missing();
  }
}

void PeriodCount::learn() {
  learned_ = true;
  std::vector<double> intervals_ns;
  for (std::size_t i = 1; i < first_.size(); ++i) {
    if (!first_[i].begins_stretch && first_[i].number == first_[i - 1].number + 1) {
      intervals_ns.push_back(static_cast<double>(first_[i].stamp_ns - first_[i - 1].stamp_ns));
    }
  }
  if (!intervals_ns.empty()) {
    std::vector<double> sorted = intervals_ns;
    period_ns_ = upper_median(sorted);
    learn_tick(intervals_ns);
    const auto whole = std::count_if(intervals_ns.begin(), intervals_ns.end(), [&](double one_ns) {
      return period_ns_ > 0.0 && is_multiple(one_ns, period_ns_, margin_ns());
    });
    if (static_cast<double>(whole) <
            periods_among_first * static_cast<double>(intervals_ns.size()) ||
        !holds_most_of_the_time(intervals_ns, period_ns_)) {
      period_ns_ = 0.0;
    }
  }
  for (const Sample& sample : std::exchange(first_, {})) {
    count(sample);
  }
}

// REQUIRES: the median of these intervals is the period so far.
void PeriodCount::learn_tick(const std::vector<double>& intervals_ns) {
  std::vector<double> deviations_ns;
  for (const double one_ns : intervals_ns) {
    tick_ns_ = std::gcd(tick_ns_, std::llround(one_ns));
    deviations_ns.push_back(std::abs(one_ns - period_ns_));
  }
  const auto tick = static_cast<double>(tick_ns_);
  scatter_ns_ = mad_to_sd * upper_median(deviations_ns);
  double sum = 0.0;
  std::size_t near = 0;
  bool differ = false;
  for (const double one_ns : intervals_ns) {
    if (std::abs(one_ns - period_ns_) < one_tick * tick) {
      sum += one_ns;
      ++near;
      differ = differ || one_ns != period_ns_;
    }
  }
  // Intervals that are all alike tell no tick: the period may be one.
  if (differ && tick >= coarse_tick_part * period_ns_ && tick < period_ns_) {
    coarse_tick_ns_ = tick;
    period_ns_ = sum / static_cast<double>(near);
  }
}

void PeriodCount::follow_tick(std::int64_t distance_ns) {
  if (tick_ns_ > 0) {
    tick_ns_ = std::gcd(tick_ns_, distance_ns);
    tick_ns_ = static_cast<double>(tick_ns_) < named_tick_part * period_ns_ ? 0 : tick_ns_;
  }
}

double PeriodCount::margin_ns() const {
  return std::min(margin_periods * period_ns_ + coarse_tick_ns_, max_margin_periods * period_ns_);
}

bool PeriodCount::in_order(const Sample& before, const Sample& sample) const {
  const auto times = static_cast<double>(sample.number - before.number);
  const auto distance = static_cast<double>(sample.stamp_ns - before.stamp_ns);
  return std::abs(distance - times * period_ns_) <=
         margin_ns() + max_drift_rel * times * period_ns_;
}

double PeriodCount::best_period_ns() const {
  return periods() >= periods_for_mean ? mean_ns() : period_ns_;
}

std::optional<std::uint64_t> PeriodCount::periods_to_doubtful() const {
  const auto distance = static_cast<double>(doubtful_->stamp_ns - last_.stamp_ns);
  const std::uint64_t numbered = doubtful_->number - last_.number;
  const double period_ns = best_period_ns();
  const double times = std::round(distance / period_ns);
  const auto known = static_cast<double>(std::max<std::uint64_t>(first_samples, periods()));
  const double u_period_rel =
      period_drift_rel + (scatter_ns_ + coarse_tick_ns_) / (period_ns * known);
  if (times <= static_cast<double>(numbered) || !is_multiple(distance, period_ns, margin_ns()) ||
      (times > always_counted && times * u_period_rel > known_to_periods)) {
    return std::nullopt;
  }
  return static_cast<std::uint64_t>(times);
}

void PeriodCount::begin_stretch(const Sample& sample) {
  ++stretches_;
  last_ = sample;
  doubtful_.reset();
}

void PeriodCount::accept(const Sample& sample, std::uint64_t periods) {
  const std::int64_t distance_ns = sample.stamp_ns - last_.stamp_ns;
  follow_tick(distance_ns);
  span_ns_ += distance_ns;
  periods_ += periods;
  last_ = sample;
  doubtful_.reset();
}

// REQUIRES: periods_to_doubtful().
void PeriodCount::accept_missing() {
  const std::uint64_t periods = *periods_to_doubtful();
  const std::uint64_t missing = periods - (doubtful_->number - last_.number);
  gaps_.push_back({last_.stamp_ns, doubtful_->stamp_ns, missing});
  unnumbered_ += missing;
  accept(Sample(*doubtful_), periods);
}

// The stamps have moved between the last one in order and the doubtful one, which `sample` follows.
void PeriodCount::accept_move(const Sample& sample) {
  const std::int64_t across_ns = doubtful_->stamp_ns - last_.stamp_ns;
  const std::uint64_t numbered = doubtful_->number - last_.number;
  const double move_ns =
      static_cast<double>(across_ns) - static_cast<double>(numbered) * best_period_ns();
  ++moves_;
  span_across_moves_ns_ += across_ns;
  periods_across_moves_ += numbered;
  sum_of_moves_ns_ += move_ns;
  size_of_moves_ns_ += std::abs(move_ns);
  squares_of_moves_ns2_ += move_ns * move_ns;
  largest_ns_ = std::abs(move_ns) > std::abs(largest_ns_) ? move_ns : largest_ns_;
  follow_tick(across_ns);
  last_ = *doubtful_;
  accept(sample, sample.number - last_.number);
}

void PeriodCount::count(const Sample& sample) {
  if (!knows_period()) {
    return;
  }
  if (sample.begins_stretch || stretches_ == 0) {
    if (doubtful_ && periods_to_doubtful()) {
      accept_missing();
    }
    begin_stretch(sample);
  } else if (in_order(last_, sample)) { // and so a doubtful one before it had a wrong stamp
    accept(sample, sample.number - last_.number);
  } else if (doubtful_) {
    count_behind_doubtful(sample);
  } else {
    doubtful_ = sample;
    followers_ = 0;
    passed_over_ = 0;
  }
}

// REQUIRES: a doubtful one, and `sample` does not follow the last one in order.
void PeriodCount::count_behind_doubtful(const Sample& sample) {
  if (periods_to_doubtful() && sample.stamp_ns > doubtful_->stamp_ns) {
    accept_missing();
    count(sample);
    return;
  }
  if (in_order(*doubtful_, sample)) {
    if (++followers_ >= followers_of_a_move) {
      accept_move(sample);
    }
    return;
  }
  doubtful_ = sample;
  followers_ = 0;
  if (++passed_over_ >= max_passed_over) {
    begin_stretch(sample);
  }
}

bool PeriodCount::moves_as_made() const {
  const bool are_many = moves_ >= moves_of_stamping &&
                        size_of_moves_ns_ <= max_time_in_moves * static_cast<double>(span_ns_);
  return are_many || std::abs(largest_ns_) <= one_tick * static_cast<double>(tick_ns_);
}

std::uint64_t PeriodCount::periods() const {
  return periods_ + (moves_as_made() ? periods_across_moves_ : 0);
}

std::vector<UnnumberedGap> PeriodCount::take_gaps() {
  return std::exchange(gaps_, {});
}

double PeriodCount::mean_ns() const {
  const std::int64_t span_ns = span_ns_ + (moves_as_made() ? span_across_moves_ns_ : 0);
  return static_cast<double>(static_cast<long double>(span_ns) /
                             static_cast<long double>(periods()));
}

double PeriodCount::u_ends_ns() const {
  const bool is_coarse = coarse_tick_ns_ > 0.0 || moves_ > 0;
  const double tick_ns = is_coarse ? static_cast<double>(tick_ns_) : 0.0;
  double variance_ns2 = tick_ns * tick_ns / 6.0;
  if (moves_ > 0 && moves_as_made() && std::abs(largest_ns_) > one_tick * tick_ns) {
    const auto count = static_cast<double>(moves_);
    const double mean_move_ns = sum_of_moves_ns_ / count;
    const double scatter_ns2 =
        std::max(0.0, squares_of_moves_ns2_ / count - mean_move_ns * mean_move_ns);
    variance_ns2 += mean_move_ns * mean_move_ns + scatter_ns2;
  }
  return std::sqrt(variance_ns2);
}

} // namespace dyncal::analysis
