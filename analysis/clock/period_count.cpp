#include "analysis/clock/period_count.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "analysis/base/statistics.hpp"

namespace dyncal::analysis {
namespace {

constexpr std::size_t first_samples = 65;
constexpr double max_drift_rel = 1e-4; // of the period in what is missing
constexpr double named_tick_part = 1.0 / 16.0;
constexpr double one_tick = 1.01;
constexpr double period_margin_ticks = 1.0 / 8.0; // of a period learned from alike intervals
constexpr double tick_about_period = 0.75;        // of it: a loss looks like a tick
constexpr double always_counted = 1000.0;         // periods in a gap
constexpr double period_drift_rel = 5e-6;         // of an oscillator within a record
constexpr double known_to_periods = 1.0 / 8.0;
constexpr std::uint64_t periods_for_mean = 256;
constexpr std::uint32_t followers_of_a_move = 8;
constexpr std::uint32_t max_passed_over = 32;
// A clock that is set does so once or twice in a record; a FIFO or a coarse tick at every turn.
constexpr std::uint64_t moves_of_stamping = 5;
constexpr double max_time_in_moves = 0.2;
constexpr std::uint64_t ticks_that_convince = 12; // behind some that are not sure to be ticks

} // namespace

void PeriodCount::add(std::uint64_t sample, std::int64_t stamp_ns) {
  const TimedSample one{sample, stamp_ns, std::exchange(begins_stretch_, false)};
  if (learned_) {
    count(one);
    return;
  }
  first_.push_back(one);
  if (first_.size() == first_samples) {
    learn();
  }
}

void PeriodCount::finish() {
  if (!learned_) {
    learn();
  }
  settle();
}

// What waits for a next sample does so no longer.
void PeriodCount::settle() {
  if (doubtful_ && periods_to_doubtful()) {
    accept_missing();
  }
  if (ticked_) {
    count_ticked(ticked_->finish());
  }
  if (alike_) {
    take_waiting_as_losses();
  }
}

void PeriodCount::learn() {
  learned_ = true;
  if (const auto interval_ns = alike_interval_ns(first_)) {
    tick_ns_ = *interval_ns;
    period_ns_ = static_cast<double>(*interval_ns);
    alike_.emplace(*interval_ns, first_.front().number, first_.front().stamp_ns);
  } else if (const auto ticks = ticks_of(first_)) {
    tick_ns_ = ticks->tick_ns;
    period_ns_ = ticks->line.period_ns();
    ticked_.emplace(ticks->line, first_.front().number, first_.front().stamp_ns);
  } else if (const auto period = period_of(first_)) {
    tick_ns_ = period->tick_ns;
    period_ns_ = period->period_ns;
    scatter_ns_ = period->scatter_ns;
    coarse_tick_ns_ = period->coarse_tick_ns;
  }
  for (const TimedSample& sample : std::exchange(first_, {})) {
    count(sample);
  }
}

void PeriodCount::follow_tick(std::int64_t distance_ns) {
  if (tick_ns_ > 0) {
    tick_ns_ = std::gcd(tick_ns_, distance_ns);
    tick_ns_ = static_cast<double>(tick_ns_) < named_tick_part * period_ns_ ? 0 : tick_ns_;
  }
}

double PeriodCount::margin_ns() const {
  return period_margin_ns(period_ns_, coarse_tick_ns_);
}

bool PeriodCount::in_order(const TimedSample& before, const TimedSample& sample) const {
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

void PeriodCount::begin_stretch(const TimedSample& sample) {
  ++stretches_;
  last_ = sample;
  doubtful_.reset();
  if (alike_) {
    take_waiting_as_losses();
  }
  if (ticked_) {
    ticked_->begin(sample.number, sample.stamp_ns);
  }
}

void PeriodCount::accept(const TimedSample& sample, std::uint64_t periods) {
  const std::int64_t distance_ns = sample.stamp_ns - last_.stamp_ns;
  follow_tick(distance_ns);
  span_ns_ += distance_ns;
  periods_ += periods;
  last_ = sample;
  doubtful_.reset();
}

void PeriodCount::add_missing(std::int64_t before_ns, std::int64_t after_ns,
                              std::uint64_t missing) {
  gaps_.push_back({before_ns, after_ns, missing});
  unnumbered_ += missing;
}

// REQUIRES: periods_to_doubtful().
void PeriodCount::accept_missing() {
  const std::uint64_t periods = *periods_to_doubtful();
  const TimedSample sample = *doubtful_;
  const std::uint64_t numbered = sample.number - last_.number;
  const std::int64_t distance_ns = sample.stamp_ns - last_.stamp_ns;
  if (alike_ && distance_ns == static_cast<std::int64_t>(periods) * alike_->interval_ns()) {
    alike_->add({last_.number, sample.number, last_.stamp_ns, sample.stamp_ns, periods - numbered});
    accept(sample, numbered); // as ticks, so far
    explain_gaps();
    return;
  }
  if (alike_ && turn_to_ticks(distance_ns)) {
    doubtful_.reset();
    count_ticked(ticked_->add(sample.number, sample.stamp_ns));
    return;
  }
  add_missing(last_.stamp_ns, sample.stamp_ns, periods - numbered);
  accept(sample, periods);
}

// The stamps have moved between the last one in order and the doubtful one, which `sample` follows.
void PeriodCount::accept_move(const TimedSample& sample) {
  const TimedSample moved = *doubtful_;
  if (alike_ && turn_to_ticks(moved.stamp_ns - last_.stamp_ns)) {
    doubtful_.reset();
    count_ticked(ticked_->add(moved.number, moved.stamp_ns));
    count_ticked(ticked_->add(sample.number, sample.stamp_ns));
    return;
  }
  count_move(moved.stamp_ns - last_.stamp_ns, moved.number - last_.number);
  last_ = moved;
  accept(sample, sample.number - last_.number);
}

void PeriodCount::count_move(std::int64_t across_ns, std::uint64_t numbered) {
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
}

void PeriodCount::take_waiting_as_losses() {
  unsure_ticks_ += alike_->are_unsure() ? alike_->gaps().size() : 0;
  for (const TickGap& gap : alike_->gaps()) {
    add_missing(gap.before_ns, gap.after_ns, gap.missing);
    periods_ += gap.missing;
  }
  alike_.emplace(alike_->interval_ns(), last_.number, last_.stamp_ns);
}

// REQUIRES: the last one in order is behind a gap.
void PeriodCount::explain_gaps() {
  if (const auto explained = alike_->explained()) {
    std::uint64_t missing = 0;
    for (const TickGap& gap : explained->losses) {
      add_missing(gap.before_ns, gap.after_ns, gap.missing);
      missing += gap.missing;
    }
    periods_ += missing;
    unsure_as_ticks_ += explained->is_sure ? 0 : alike_->gaps().size() - explained->losses.size();
    ticked_.emplace(explained->line, missing);
    alike_.reset();
  } else if (alike_->are_losses()) {
    take_waiting_as_losses();
    alike_.reset();
  }
}

// An interval that is no multiple of those before, which were alike: whether it tells a coarse
// tick. The order goes on from the last sample.
bool PeriodCount::turn_to_ticks(std::int64_t distance_ns) {
  const std::int64_t interval_ns = alike_->interval_ns();
  const auto tick_ns = static_cast<double>(std::gcd(interval_ns, distance_ns));
  std::optional<TickLine> line;
  if (tick_ns >= static_cast<double>(interval_ns)) {
    // Back or forth by a whole interval, as ticks with a latency go.
    alike_->add_stray();
    unsure_as_ticks_ += alike_->flicker() ? 0 : alike_->gaps().size();
    line = alike_->line_to(last_.number, last_.stamp_ns);
  } else {
    take_waiting_as_losses();
  }
  alike_.reset();
  const auto period_ns = static_cast<double>(interval_ns);
  if (tick_ns < TickLine::least_tick_periods * period_ns) {
    return false;
  }
  tick_ns_ = std::gcd(interval_ns, distance_ns);
  if (line) {
    ticked_.emplace(*line, 0);
  } else {
    const double margin_ns = period_margin_ticks * tick_ns;
    ticked_.emplace(TickLine(tick_ns, {period_ns - margin_ns, period_ns + margin_ns}), last_.number,
                    last_.stamp_ns);
  }
  return true;
}

// Whether the ticks went further than the samples, where one of the other looks the same.
void PeriodCount::watch_slip(const TickedSample& sample) {
  if (static_cast<double>(tick_ns_) < tick_about_period * period_ns_) {
    return;
  }
  const auto numbered = static_cast<std::int64_t>(sample.number - last_.number);
  const std::int64_t further_ns = sample.stamp_ns - last_.stamp_ns - numbered * tick_ns_;
  if (sample.missing > 0 || further_ns > 0) {
    slips_.add(sample.number, sample.missing);
  } else if (further_ns < 0) {
    slips_.take_back();
  }
}

void PeriodCount::count_ticked(std::span<const TickedSample> samples) {
  for (const TickedSample& one : samples) {
    const TimedSample sample{one.number, one.stamp_ns, false};
    const std::uint64_t numbered = one.number - last_.number;
    watch_slip(one);
    switch (one.step) {
    case TickedStep::missing:
      add_missing(last_.stamp_ns, one.stamp_ns, one.missing);
      [[fallthrough]];
    case TickedStep::follows:
      ticks_on_line_ += one.missing == 0 && one.stamp_ns - last_.stamp_ns >
                                                static_cast<std::int64_t>(numbered) * tick_ns_
                            ? 1
                            : 0;
      accept(sample, numbered + one.missing);
      break;
    case TickedStep::jump:
      count_move(one.stamp_ns - last_.stamp_ns, numbered);
      last_ = sample;
      break;
    case TickedStep::begins_stretch:
      begin_stretch(sample);
      break;
    }
  }
}

void PeriodCount::count(const TimedSample& sample) {
  if (!knows_period()) {
    return;
  }
  if (sample.begins_stretch || stretches_ == 0) {
    settle();
    begin_stretch(sample);
  } else if (ticked_) {
    count_ticked(ticked_->add(sample.number, sample.stamp_ns));
  } else if (in_order(last_, sample)) { // and so a doubtful one before it had a wrong stamp
    count_in_order(sample);
  } else if (doubtful_) {
    count_behind_doubtful(sample);
  } else {
    doubtful_ = sample;
    followers_ = 0;
    passed_over_ = 0;
  }
}

void PeriodCount::count_in_order(const TimedSample& sample) {
  const std::uint64_t numbered = sample.number - last_.number;
  const std::int64_t distance_ns = sample.stamp_ns - last_.stamp_ns;
  if (alike_ && distance_ns != static_cast<std::int64_t>(numbered) * alike_->interval_ns() &&
      turn_to_ticks(distance_ns)) {
    doubtful_.reset();
    count_ticked(ticked_->add(sample.number, sample.stamp_ns));
    return;
  }
  if (alike_ && doubtful_) {
    const auto stray_numbered = static_cast<std::int64_t>(doubtful_->number - last_.number);
    const std::int64_t stray_ns =
        doubtful_->stamp_ns - last_.stamp_ns - stray_numbered * alike_->interval_ns();
    if (std::abs(stray_ns) == alike_->interval_ns()) {
      alike_->add_stray();
    }
  }
  accept(sample, numbered);
}

// REQUIRES: a doubtful one, and `sample` does not follow the last one in order.
void PeriodCount::count_behind_doubtful(const TimedSample& sample) {
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

double PeriodCount::mean_ns() const {
  const std::int64_t span_ns = span_ns_ + (moves_as_made() ? span_across_moves_ns_ : 0);
  return static_cast<double>(static_cast<long double>(span_ns) /
                             static_cast<long double>(periods()));
}

// Beside losses a move of the stamps may be one; and where ticks are of about a period, all losses
// look like ticks whose line is wide, was left, or has few of them.
std::uint64_t PeriodCount::losses_like_ticks() const {
  if (!ticked_ || unnumbered_ == 0) {
    return 0;
  }
  const bool about_period = static_cast<double>(tick_ns_) >= tick_about_period * period_ns_;
  const bool is_loose = ticked_->is_wide() || moves_ > 0 || ticks_on_line_ < ticks_that_convince;
  return about_period && is_loose ? unnumbered_ : moves_;
}

double PeriodCount::u_ends_ns() const {
  const bool is_coarse = coarse_tick_ns_ > 0.0 || moves_ > 0 || ticked_;
  const double tick_ns = is_coarse ? static_cast<double>(tick_ns_) : 0.0;
  const std::uint64_t unsure = unsure_ticks_ +
                               std::max(slips_.unsure_losses(), losses_like_ticks()) +
                               (ticks_on_line_ < ticks_that_convince ? unsure_as_ticks_ : 0);
  const double unsure_ns = static_cast<double>(unsure) * static_cast<double>(tick_ns_);
  double variance_ns2 = tick_ns * tick_ns / 6.0 + unsure_ns * unsure_ns;
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
