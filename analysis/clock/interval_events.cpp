#include "analysis/clock/interval_events.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "analysis/base/statistics.hpp"

namespace dyncal::analysis {
namespace {

constexpr double duplicate_part = 0.02; // of the median
constexpr double kept_scales = 4.0;
constexpr double unusual_scales = 6.0;
constexpr double pair_sum_scales = 9.0;
constexpr double gap_scales = 8.0;
constexpr std::size_t min_pairs = 5; // before a period is spoken of
constexpr double min_regularity = 0.9;

struct Verdict {
  std::string kind; // empty: nothing unusual
  std::uint32_t missing = 0;
};

Verdict judge_one(const SampleInterval& interval, const SampleInterval* next,
                  const UsualInterval& usual) {
  const double length = static_cast<double>(interval.length_ns);
  const double deviation = length - usual.median_ns;
  if (length < 0.0) {
    return {"backward"};
  }
  if (std::abs(deviation) <= unusual_scales * usual.scale_ns) {
    return {};
  }
  if (length <= duplicate_part * usual.median_ns) {
    return {"duplicate"};
  }
  const double multiple = std::round(length / usual.median_ns);
  const double width =
      std::max(gap_scales * usual.scale_ns * std::sqrt(multiple), duplicate_part * usual.median_ns);
  if (multiple >= 2.0 && std::abs(length - multiple * usual.median_ns) < width) {
    return {"gap", static_cast<std::uint32_t>(std::min(multiple - 1.0, 4e9))};
  }
  if (next && next->ordinal == interval.ordinal + 1 && next->continues) {
    const double other = static_cast<double>(next->length_ns) - usual.median_ns;
    if (deviation * other < 0.0 && std::abs(deviation + other) < pair_sum_scales * usual.scale_ns) {
      return {"pair"};
    }
  }
  return {"step"};
}

void describe_period(IntervalVerdict& verdict, const std::vector<SampleInterval>& pairs) {
  if (pairs.size() < min_pairs) {
    return;
  }
  std::vector<double> samples, seconds;
  for (std::size_t i = 0; i + 1 < pairs.size(); ++i) {
    samples.push_back(static_cast<double>(pairs[i + 1].sample) -
                      static_cast<double>(pairs[i].sample));
    seconds.push_back(static_cast<double>(pairs[i + 1].begin_ns - pairs[i].begin_ns) * 1e-9);
  }
  verdict.pair_period_samples = median(samples);
  verdict.pair_period_s = median(seconds);
  std::complex<double> sum;
  for (const double distance : samples) {
    sum += std::polar(1.0, 2.0 * std::numbers::pi * distance / verdict.pair_period_samples);
  }
  verdict.pair_regularity = std::abs(sum) / static_cast<double>(samples.size());
  if (verdict.pair_regularity < min_regularity) {
    verdict.pair_period_samples = verdict.pair_period_s = 0.0;
  }
}

} // namespace

bool UsualInterval::is_core(std::int64_t interval_ns, double times) const {
  return std::abs(static_cast<double>(interval_ns) - median_ns) <= times * scale_ns;
}

void IntervalEventCollector::add(const SampleInterval& interval, const UsualInterval& usual) {
  if (usual.known() && usual.is_core(interval.length_ns, kept_scales)) {
    return;
  }
  if (kept_.size() < max_kept_) {
    kept_.push_back(interval);
  } else if (!usual.is_core(interval.length_ns, unusual_scales)) {
    ++not_kept_;
  }
}

IntervalVerdict IntervalEventCollector::judge(const UsualInterval& usual,
                                              std::int64_t first_stamp_ns,
                                              std::size_t max_events) const {
  IntervalVerdict result;
  std::vector<SampleInterval> pairs;
  for (std::size_t i = 0; i < kept_.size(); ++i) {
    const SampleInterval& interval = kept_[i];
    const Verdict verdict =
        judge_one(interval, i + 1 < kept_.size() ? &kept_[i + 1] : nullptr, usual);
    if (verdict.kind.empty()) {
      continue;
    }
    ++result.event_count;
    result.unusual_lengths_ns.push_back(interval.length_ns);
    if (verdict.missing > 0) {
      result.gap_lengths_ns.push_back(interval.length_ns);
    }
    if (result.events.size() < max_events) {
      result.events.push_back({verdict.kind, interval.sample,
                               static_cast<double>(interval.begin_ns - first_stamp_ns) * 1e-9,
                               static_cast<double>(interval.length_ns) - usual.median_ns,
                               verdict.missing});
    }
    if (verdict.kind == "pair") {
      pairs.push_back(interval);
      result.unusual_lengths_ns.push_back(kept_[++i].length_ns); // its other half
    }
  }
  result.event_count += not_kept_;
  result.pair_count = pairs.size();
  describe_period(result, pairs);
  return result;
}

} // namespace dyncal::analysis
