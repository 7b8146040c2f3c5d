#include "services/evaluation/source_record.hpp"

#include <algorithm>
#include <iterator>
#include <limits>

namespace dyncal::services {
namespace {

// Memory is given back once this many forgotten samples lead the buffers.
constexpr std::size_t forgotten_worth_moving = std::size_t{1} << 16U;

drivers::RegularClock regular_clock(const wire::SampleBlock& block) {
  return {block.origin_ns(), block.interval_numerator_ns(), block.interval_denominator()};
}

} // namespace

void SourceRecord::describe(const wire::SourceDescription& description) {
  description_ = description;
}

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
  const auto& channels = description_->channels();
  const auto found =
      std::find_if(channels.begin(), channels.end(),
                   [&](const wire::ChannelDescription& channel) { return channel.name() == name; });
  return found == channels.end()
             ? std::nullopt
             : std::optional(static_cast<std::size_t>(found - channels.begin()));
}

bool SourceRecord::usable(const wire::SampleBlock& block) const {
  const std::size_t samples = block.sample_count();
  const bool stamped = block.stamps_ns().empty()
                           ? block.interval_numerator_ns() > 0 && block.interval_denominator() > 0
                           : block.stamps_ns().size() == samples;
  const bool flagged = block.stamp_flags().empty() || block.stamp_flags().size() == samples;
  const bool filled =
      block.values().size() == samples * block.channel_count() && block.channel_count() > 0;
  return stamped && flagged && filled;
}

bool SourceRecord::add(const wire::SampleBlock& block) {
  const bus::ContinuityFinding step = continuity_.add(block);
  if (step.duplicate) {
    return true;
  }
  if (step.new_session) {
    restart();
  }
  newest_received_utc_ns_ = std::max(newest_received_utc_ns_, block.received_utc_ns());
  ended_ = block.end_of_stream();
  if (block.sample_count() == 0) {
    return true;
  }
  if (!usable(block) || (!columns_.empty() && columns_.size() != block.channel_count())) {
    ++unusable_blocks_;
    return false;
  }
  const std::int64_t first_ns = block.stamps_ns().empty()
                                    ? regular_clock(block).stamp_ns(block.first_sample())
                                    : block.stamps_ns().front();
  if (step.missing_samples > 0) {
    lost_ += step.missing_samples;
    gaps_.push_back({newest_ns_.value_or(first_ns), first_ns, step.missing_samples});
  }
  append(block);
  return true;
}

void SourceRecord::append(const wire::SampleBlock& block) {
  const std::size_t samples = block.sample_count();
  columns_.resize(block.channel_count());
  if (block.stamps_ns().empty()) {
    const drivers::RegularClock clock = regular_clock(block);
    const std::int64_t first_ns = clock.stamp_ns(block.first_sample());
    const bool whole = clock.interval_denominator == 1; // then no division a sample is needed
    for (std::size_t i = 0; i < samples; ++i) {
      stamps_ns_.push_back(whole ? first_ns +
                                       static_cast<std::int64_t>(i) * clock.interval_numerator_ns
                                 : clock.stamp_ns(block.first_sample() + i));
    }
  } else {
    stamps_ns_.insert(stamps_ns_.end(), block.stamps_ns().begin(), block.stamps_ns().end());
  }
  if (block.stamp_flags().empty()) {
    flags_.resize(flags_.size() + samples, 0);
  } else {
    flags_.insert(flags_.end(), block.stamp_flags().begin(), block.stamp_flags().end());
  }
  const bool told = block.stamp_uncertainty_ns().size() == samples;
  if (told) {
    stamp_uncertainties_ns_.resize(stamps_ns_.size() - samples, 0);
    stamp_uncertainties_ns_.insert(stamp_uncertainties_ns_.end(),
                                   block.stamp_uncertainty_ns().begin(),
                                   block.stamp_uncertainty_ns().end());
  } else if (!stamp_uncertainties_ns_.empty()) {
    stamp_uncertainties_ns_.resize(stamps_ns_.size(), 0);
  }
  for (std::size_t channel = 0; channel < columns_.size(); ++channel) {
    if (!keeps(channel)) {
      continue;
    }
    const auto begin = block.values().begin() + static_cast<std::ptrdiff_t>(channel * samples);
    columns_[channel].insert(columns_[channel].end(), begin,
                             begin + static_cast<std::ptrdiff_t>(samples));
  }
  newest_ns_ = stamps_ns_.back();
  if (stamps_ns().size() > capacity_) {
    const std::size_t excess = stamps_ns().size() - capacity_;
    overflowed_ += excess;
    forget(excess);
  }
}

void SourceRecord::restart() {
  ++restarts_;
  forget(stamps_ns().size());
  gaps_.clear();
  newest_ns_.reset();
}

std::span<const double> SourceRecord::column(std::size_t channel) const {
  return channel < columns_.size() && keeps(channel) ? std::span(columns_[channel]).subspan(first_)
                                                     : std::span<const double>{};
}

void SourceRecord::forget_before(std::int64_t stamp_ns) {
  const auto stamps = stamps_ns();
  // Stamps of a faulty clock may step back, so the first one that is not earlier ends the search.
  const auto keep = std::find_if(stamps.begin(), stamps.end(),
                                 [&](std::int64_t stamp) { return stamp >= stamp_ns; });
  forget(static_cast<std::size_t>(keep - stamps.begin()));
  while (!gaps_.empty() && gaps_.front().after_ns < stamp_ns) {
    gaps_.pop_front();
  }
}

SourceRecord SourceRecord::part(std::int64_t begin_ns, std::int64_t end_ns) const {
  SourceRecord part(source_, capacity_);
  part.description_ = description_;
  part.kept_channels_ = kept_channels_;
  part.gaps_ = gaps_;
  part.columns_.resize(columns_.size());
  const auto inside = [&](std::int64_t stamp) { return stamp >= begin_ns && stamp <= end_ns; };
  // Stamps of a faulty clock may step back: all that lies between the first one inside and the last
  // one is taken.
  const auto stamps = stamps_ns();
  const auto first = std::find_if(stamps.begin(), stamps.end(), inside);
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

double SourceRecord::stamp_uncertainty_s(std::int64_t begin_ns, std::int64_t end_ns) const {
  const auto stamps = stamps_ns();
  const bool any = !stamp_uncertainties_ns_.empty();
  const auto uncertainties = std::span(stamp_uncertainties_ns_).subspan(any ? first_ : 0);
  double sum_ns = 0.0;
  std::size_t told = 0;
  for (std::size_t i = 0; any && i < stamps.size(); ++i) {
    if (stamps[i] >= begin_ns && stamps[i] <= end_ns && uncertainties[i] > 0) {
      sum_ns += static_cast<double>(uncertainties[i]);
      ++told;
    }
  }
  const double mean_s = told > 0 ? sum_ns * 1e-9 / static_cast<double>(told) : 0.0;
  return std::max(mean_s, description().stamp_uncertainty_s());
}

std::uint64_t SourceRecord::lost_between(std::int64_t begin_ns, std::int64_t end_ns) const {
  std::uint64_t lost = 0;
  for (const Gap& gap : gaps_) {
    if (gap.before_ns < end_ns && gap.after_ns > begin_ns) {
      lost += gap.samples;
    }
  }
  return lost;
}

} // namespace dyncal::services
