#include "services/evaluation/record/step_samples.hpp"

#include <algorithm>
#include <cmath>

namespace dyncal::inline evaluation {
namespace {

struct IndexRun { // of samples that follow one another
  std::size_t begin;
  std::size_t end;
};

class Selection {
public:
  Selection(const SourceRecord& record, const TimeInterval& interval,
            const std::vector<std::size_t>& channels)
      : interval_(interval), stamps_(record.stamps_ns()), flags_(record.flags()) {
    for (const std::size_t channel : channels) {
      columns_.push_back(record.column(channel));
    }
  }

  [[nodiscard]] StepSamples samples() {
    find_runs();
    StepSamples result;
    result.not_trusted = not_trusted_;
    result.not_measured = not_measured_;
    result.columns.resize(columns_.size());
    if (runs_.size() > 1) {
      copy_into(result);
    } else if (runs_.size() == 1) {
      result.stamps_ns = part(stamps_, runs_.front());
      std::transform(columns_.begin(), columns_.end(), result.columns.begin(),
                     [&](auto column) { return part(column, runs_.front()); });
    }
    return result;
  }

private:
  template <class Number>
  static std::span<const Number> part(std::span<const Number> all, const IndexRun& run) {
    return all.subspan(run.begin, run.end - run.begin);
  }

  [[nodiscard]] bool inside(std::size_t i) const {
    return stamps_[i] >= interval_.begin_ns && stamps_[i] <= interval_.end_ns;
  }

  // And later than that of the sample taken last.
  [[nodiscard]] bool has_trusted_stamp(std::size_t i) const {
    return flags_[i] == 0 && (runs_.empty() || stamps_[i] > last_ns_);
  }

  // Behind the last sample in the interval.
  [[nodiscard]] std::size_t end_inside() const {
    std::size_t end = stamps_.size();
    while (end > 0 && !inside(end - 1)) {
      --end;
    }
    return end;
  }

  void find_runs() {
    const std::size_t end_of_all = end_inside();
    bool begun = false;
    for (std::size_t i = 0; i < end_of_all;) {
      if (!inside(i)) {
        // Whatever it says, it was sampled between others of the interval.
        not_trusted_ += begun && flags_[i] != 0 ? 1 : 0;
        ++i;
        continue;
      }
      begun = true;
      const std::size_t end = good_until(i);
      if (end == i) {
        ++(has_trusted_stamp(i) ? not_measured_ : not_trusted_);
        ++i;
        continue;
      }
      if (runs_.empty() || runs_.back().end != i) {
        runs_.push_back({i, i});
      }
      runs_.back().end = end;
      last_ns_ = stamps_[end - 1];
      i = end;
    }
  }

  // Looks a little way ahead column by column, for that is quicker than sample by sample.
  [[nodiscard]] std::size_t good_until(std::size_t begin) const {
    constexpr std::size_t max_ahead = 512;
    const std::size_t limit = std::min(begin + max_ahead, stamps_.size());
    std::int64_t last_ns = last_ns_;
    bool any = !runs_.empty();
    std::size_t end = begin;
    for (; end < limit && inside(end) && flags_[end] == 0 && (!any || stamps_[end] > last_ns);
         ++end) {
      last_ns = stamps_[end];
      any = true;
    }
    for (const auto& column : columns_) {
      const auto first = column.begin() + static_cast<std::ptrdiff_t>(begin);
      const auto bad = std::find_if(first, column.begin() + static_cast<std::ptrdiff_t>(end),
                                    [](double y) { return !std::isfinite(y); });
      end = begin + static_cast<std::size_t>(bad - first);
    }
    return end;
  }

  void copy_into(StepSamples& result) const {
    auto copies = std::make_shared<StepSamples::Copies>();
    std::size_t count = 0;
    for (const IndexRun& run : runs_) {
      count += run.end - run.begin;
    }
    const auto copy = [&](const auto& from, auto& to) {
      to.reserve(count);
      for (const IndexRun& run : runs_) {
        const auto one = part(from, run);
        to.insert(to.end(), one.begin(), one.end());
      }
    };
    copy(stamps_, copies->stamps_ns);
    copies->columns.resize(columns_.size());
    for (std::size_t channel = 0; channel < columns_.size(); ++channel) {
      copy(columns_[channel], copies->columns[channel]);
    }
    result.stamps_ns = copies->stamps_ns;
    std::copy(copies->columns.begin(), copies->columns.end(), result.columns.begin());
    result.copies = std::move(copies);
  }

  TimeInterval interval_;
  std::span<const std::int64_t> stamps_;
  std::span<const std::uint8_t> flags_;
  std::vector<std::span<const double>> columns_;
  std::vector<IndexRun> runs_;
  std::int64_t last_ns_ = 0; // of the sample taken last
  std::uint64_t not_trusted_ = 0;
  std::uint64_t not_measured_ = 0;
};

} // namespace

StepSamples select_samples(const SourceRecord& record, const TimeInterval& interval,
                           const std::vector<std::size_t>& channels) {
  return Selection(record, interval, channels).samples();
}

} // namespace dyncal::inline evaluation
