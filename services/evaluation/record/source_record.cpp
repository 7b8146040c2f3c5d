#include "services/evaluation/record/source_record.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include "analysis/clock/period_count.hpp"

namespace dyncal::inline evaluation {
namespace {

// Memory is given back once this many forgotten samples lead the buffers, and half of them.
constexpr std::size_t forgotten_worth_moving = std::size_t{1} << 12U;

// More losses than this at a time are told apart no further: the oldest two become one.
constexpr std::size_t max_gaps = std::size_t{1} << 16U;

constexpr std::int64_t beginning_of_time = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t end_of_time = std::numeric_limits<std::int64_t>::max();

SampleLoss sum(const SampleLoss& a, const SampleLoss& b) {
  return {a.missing + b.missing, a.unusable + b.unusable, a.overflowed + b.overflowed};
}

} // namespace

SourceRecord::SourceRecord(std::string source, std::size_t capacity)
    : source_(std::move(source)), capacity_(capacity),
      periods_(std::make_unique<analysis::PeriodCount>()) {}

SourceRecord::~SourceRecord() = default;
SourceRecord::SourceRecord(SourceRecord&&) noexcept = default;
SourceRecord& SourceRecord::operator=(SourceRecord&&) noexcept = default;

void SourceRecord::keep_only(std::set<std::size_t> channels) {
  for (std::size_t channel = 0; channel < columns_.size(); ++channel) {
    if (!channels.contains(channel)) {
      columns_[channel] = {};
    } else if (!keeps(channel)) {
      columns_[channel].assign(stamps_ns_.size(), std::numeric_limits<double>::quiet_NaN());
    }
  }
  kept_channels_ = std::move(channels);
}

std::optional<std::size_t> SourceRecord::channel(const std::string& name) const {
  if (!description_) {
    return std::nullopt;
  }
  const auto& channels = description_->channels;
  const auto found = std::ranges::find(channels, name, &drivers::ChannelDescription::name);
  return found == channels.end()
             ? std::nullopt
             : std::optional(static_cast<std::size_t>(found - channels.begin()));
}

BlockUse SourceRecord::use_of(const SourceBlock& block) const {
  const bool fits = columns_.empty() || columns_.size() == block.channels;
  return block.samples == 0 || (block.is_consistent() && fits) ? BlockUse::usable
                                                               : BlockUse::unusable;
}

bool SourceRecord::add(const SourceBlock& block) {
  const BlockUse use = use_of(block);
  const ContinuityFinding finding = continuity_.add(block, use);
  if (finding.duplicate) {
    return false;
  }
  if (finding.new_session) {
    restart();
  }
  ended_ = block.end_of_stream;
  if (use == BlockUse::unusable || block.samples == 0) {
    return false;
  }
  if (finding.missing_samples > 0) {
    add_gap(gaps_, {newest_ns_.value_or(beginning_of_time),
                    block.first_stamp_ns(),
                    {.missing = finding.missing_samples - finding.unusable_samples,
                     .unusable = finding.unusable_samples}});
  }
  append(block);
  return true;
}

void SourceRecord::note_second_writer() {
  const std::int64_t at_ns = newest_ns_.value_or(beginning_of_time);
  if (second_writer_ns_.empty() || second_writer_ns_.back() != at_ns) {
    second_writer_ns_.push_back(at_ns);
  }
  if (second_writer_ns_.size() > max_gaps) {
    second_writer_ns_.pop_front();
  }
}

bool SourceRecord::has_second_writer_in(const TimeInterval& interval) const {
  return std::ranges::any_of(second_writer_ns_, [&](std::int64_t at_ns) {
    return at_ns >= interval.begin_ns && at_ns <= interval.end_ns;
  });
}

void SourceRecord::append(const SourceBlock& block) {
  columns_.resize(block.channels);
  append_stamps(block);
  append_stamp_uncertainties(block);
  if (block.flags.empty()) {
    flags_.resize(flags_.size() + block.samples, 0);
  } else {
    flags_.insert(flags_.end(), block.flags.begin(), block.flags.end());
  }
  for (std::size_t channel = 0; channel < columns_.size(); ++channel) {
    if (keeps(channel)) {
      const auto values = block.values.subspan(channel * block.samples, block.samples);
      columns_[channel].insert(columns_[channel].end(), values.begin(), values.end());
    }
  }
  began_ns_ = began_ns_.value_or(block.first_stamp_ns());
  newest_ns_ = stamps_ns_.back();
  find_unnumbered_gaps(block);
  drop_overflow();
}

// REQUIRES: the samples of the block are the newest.
void SourceRecord::find_unnumbered_gaps(const SourceBlock& block) {
  const auto stamps = std::span(stamps_ns_).last(block.samples);
  const auto flags = std::span(flags_).last(block.samples);
  // Stamps that follow from a clock show nothing within a block.
  const bool ends_suffice = block.stamps_ns.empty() && periods_->knows_period();
  const std::size_t stride = ends_suffice ? std::max<std::size_t>(1, block.samples - 1) : 1;
  for (std::size_t i = 0; i < block.samples; i += stride) {
    if (flags[i] == 0) {
      periods_->add(block.first_sample + i, stamps[i]);
      latest_ns_ = std::max(latest_ns_.value_or(stamps[i]), stamps[i]);
      set_back_ns_ = std::max(set_back_ns_, *latest_ns_ - stamps[i]);
    }
  }
  if (block.end_of_stream) {
    periods_->finish();
  }
  for (const analysis::UnnumberedGap& gap : periods_->take_gaps()) {
    unnumbered_ += gap.missing;
    add_gap(gaps_, {gap.before_ns, gap.after_ns, {.missing = gap.missing}});
  }
}

void SourceRecord::append_stamps(const SourceBlock& block) {
  if (!block.stamps_ns.empty()) {
    stamps_ns_.insert(stamps_ns_.end(), block.stamps_ns.begin(), block.stamps_ns.end());
    return;
  }
  const std::int64_t first_ns = block.first_stamp_ns();
  const std::int64_t interval_ns = block.clock.interval_numerator_ns;
  const bool whole = block.clock.interval_denominator == 1; // then no division a sample is needed
  for (std::size_t i = 0; i < block.samples; ++i) {
    stamps_ns_.push_back(whole ? first_ns + static_cast<std::int64_t>(i) * interval_ns
                               : block.clock.stamp_ns(block.first_sample + i));
  }
}

void SourceRecord::append_stamp_uncertainties(const SourceBlock& block) {
  if (block.stamp_uncertainty_ns.size() == block.samples) {
    stamp_uncertainties_ns_.resize(stamps_ns_.size() - block.samples, 0);
    stamp_uncertainties_ns_.insert(stamp_uncertainties_ns_.end(),
                                   block.stamp_uncertainty_ns.begin(),
                                   block.stamp_uncertainty_ns.end());
  } else if (!stamp_uncertainties_ns_.empty()) {
    stamp_uncertainties_ns_.resize(stamps_ns_.size(), 0);
  }
}

void SourceRecord::drop_overflow() {
  const auto stamps = stamps_ns();
  if (stamps.size() <= capacity_) {
    return;
  }
  const std::size_t excess = stamps.size() - capacity_;
  add_gap(overflow_, {stamps.front() - 1, stamps[excess - 1] + 1, {.overflowed = excess}});
  overflowed_ += excess;
  forget(excess);
}

void SourceRecord::add_gap(std::deque<Gap>& gaps, const Gap& gap) {
  gaps.push_back(gap);
  if (gaps.size() > max_gaps) {
    const Gap oldest = gaps.front();
    gaps.pop_front();
    gaps.front().before_ns = oldest.before_ns;
    gaps.front().loss = sum(gaps.front().loss, oldest.loss);
  }
}

void SourceRecord::restart() {
  ++restarts_;
  forget(stamps_ns().size());
  gaps_.clear();
  overflow_.clear();
  second_writer_ns_.clear();
  began_ns_.reset();
  newest_ns_.reset();
  latest_ns_.reset();
  set_back_ns_ = 0;
  *periods_ = {};
}

std::span<const double> SourceRecord::column(std::size_t channel) const {
  return channel < columns_.size() && keeps(channel) ? std::span(columns_[channel]).subspan(first_)
                                                     : std::span<const double>{};
}

void SourceRecord::forget_before(std::int64_t stamp_ns) {
  const auto stamps = stamps_ns();
  // Stamps of a faulty clock may step back, so the first one that is not earlier ends the search.
  const auto keep =
      std::ranges::find_if(stamps, [&](std::int64_t stamp) { return stamp >= stamp_ns; });
  forget(static_cast<std::size_t>(keep - stamps.begin()));
  while (!second_writer_ns_.empty() && second_writer_ns_.front() < stamp_ns) {
    second_writer_ns_.pop_front();
  }
  for (std::deque<Gap>* gaps : {&gaps_, &overflow_}) {
    while (!gaps->empty() && gaps->front().after_ns < stamp_ns) {
      gaps->pop_front();
    }
  }
}

std::optional<SourceRecord::Gap> SourceRecord::open_gap() const {
  const std::uint64_t samples = continuity_.pending_samples();
  return samples == 0
             ? std::nullopt
             : std::optional(
                   Gap{newest_ns_.value_or(beginning_of_time), end_of_time, {.unusable = samples}});
}

SourceRecord SourceRecord::part(const TimeInterval& interval) const {
  SourceRecord part(source_, capacity_);
  part.description_ = description_;
  part.kept_channels_ = kept_channels_;
  part.gaps_ = gaps_;
  part.overflow_ = overflow_;
  part.second_writer_ns_ = second_writer_ns_;
  if (const auto open = open_gap()) {
    part.gaps_.push_back(*open);
  }
  part.columns_.resize(columns_.size());
  const auto inside = [&](std::int64_t stamp) {
    return stamp >= interval.begin_ns && stamp <= interval.end_ns;
  };
  // Stamps of a faulty clock may step back: all that lies between the first one inside and the last
  // one is taken.
  const auto stamps = stamps_ns();
  const auto first = std::ranges::find_if(stamps, inside);
  const auto behind =
      std::find_if(stamps.rbegin(), std::make_reverse_iterator(first), inside).base();
  const auto begin = static_cast<std::ptrdiff_t>(first_) + (first - stamps.begin());
  const auto end = begin + (behind - first);
  const auto take = [&](const auto& from, auto& to) {
    to.assign(from.begin() + begin, from.begin() + end);
  };
  take(stamps_ns_, part.stamps_ns_);
  take(flags_, part.flags_);
  if (!stamp_uncertainties_ns_.empty()) {
    take(stamp_uncertainties_ns_, part.stamp_uncertainties_ns_);
  }
  for (std::size_t channel = 0; channel < columns_.size(); ++channel) {
    if (keeps(channel)) {
      take(columns_[channel], part.columns_[channel]);
    }
  }
  return part;
}

void SourceRecord::forget(std::size_t samples) {
  first_ += samples;
  forgotten_ += samples;
  if (first_ < forgotten_worth_moving || first_ * 2 < stamps_ns_.size()) {
    return;
  }
  const auto erase = [this](auto& column) {
    column.erase(column.begin(), column.begin() + static_cast<std::ptrdiff_t>(first_));
  };
  erase(stamps_ns_);
  erase(flags_);
  if (!stamp_uncertainties_ns_.empty()) {
    erase(stamp_uncertainties_ns_);
  }
  for (std::size_t channel = 0; channel < columns_.size(); ++channel) {
    if (keeps(channel)) {
      erase(columns_[channel]);
    }
  }
  first_ = 0;
}

double SourceRecord::stamp_uncertainty_s(const TimeInterval& interval) const {
  const auto stamps = stamps_ns();
  const bool any = !stamp_uncertainties_ns_.empty();
  const auto uncertainties = std::span(stamp_uncertainties_ns_).subspan(any ? first_ : 0);
  double sum_ns = 0.0;
  std::size_t known = 0;
  for (std::size_t i = 0; any && i < stamps.size(); ++i) {
    if (stamps[i] >= interval.begin_ns && stamps[i] <= interval.end_ns && uncertainties[i] > 0) {
      sum_ns += static_cast<double>(uncertainties[i]);
      ++known;
    }
  }
  const double mean_s = known > 0 ? sum_ns * 1e-9 / static_cast<double>(known) : 0.0;
  return std::max(mean_s, description().stamp_uncertainty_s);
}

SampleLoss SourceRecord::lost_in(const TimeInterval& interval) const {
  SampleLoss lost;
  const auto count = [&](const Gap& gap) {
    if (gap.before_ns < interval.end_ns && gap.after_ns > interval.begin_ns) {
      lost = sum(lost, gap.loss);
    }
  };
  std::ranges::for_each(gaps_, count);
  std::ranges::for_each(overflow_, count);
  if (const auto open = open_gap()) {
    count(*open);
  }
  return lost;
}

} // namespace dyncal::inline evaluation
