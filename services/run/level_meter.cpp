#include "services/run/level_meter.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/core.h>

#include "services/contract/source_block.hpp"
#include "services/contract/source_description.hpp"
#include "services/contract/topics.hpp"
#include "services/evaluation/record/channel_level.hpp"
#include "services/run/level_settling.hpp"

namespace dyncal::services {
namespace {

constexpr double kept_s = 20.0;
constexpr double max_drift = 1e-4;         // of two clocks
constexpr double max_part_at_range = 5e-4; // as a result is flagged (signal_integrity.hpp)
constexpr std::size_t max_samples = std::size_t{1} << 22U;

std::int64_t ns(double seconds) {
  return std::llround(seconds * 1e9);
}

} // namespace

LevelMeter::LevelMeter(ChannelName reference, bus::Reader<wire::SourceDescription> descriptions,
                       bus::Reader<wire::SampleBlock> samples)
    : reference_(std::move(reference)), descriptions_(std::move(descriptions)),
      samples_(std::move(samples)), record_(reference_.source, max_samples) {}

Expected<LevelMeter> LevelMeter::create(bus::Participant& participant, const BenchFile& bench,
                                        const std::shared_ptr<bus::WakeUp>& wake_up) {
  auto descriptions = participant.reader(bus::topics::source_description, bench.bench, wake_up);
  if (!descriptions) {
    return fail(descriptions.error());
  }
  auto samples = participant.reader<wire::SampleBlock>(
      bus::topics::acs_samples, bus::Profile::live_samples, bench.bench, wake_up);
  if (!samples) {
    return fail(samples.error());
  }
  return LevelMeter(bench.method.reference, std::move(*descriptions), std::move(*samples));
}

void LevelMeter::take(double bench_time_s) {
  descriptions_.take([&](const wire::SourceDescription& description) {
    if (description.source() == reference_.source) {
      record_.describe(from_message(description));
    }
  });
  samples_.take([&](const wire::SampleBlock& block) {
    if (block.source() == reference_.source) {
      record_.add(view_block(block));
    }
  });
  if (record_.restarts() != restarts_) {
    restarts_ = record_.restarts();
    acs_minus_bench_ns_.reset();
  }
  if (record_.stamps_ns().empty()) {
    return;
  }
  const std::int64_t newest_ns = record_.stamps_ns().back();
  const std::int64_t difference_ns = newest_ns - ns(bench_time_s);
  if (acs_minus_bench_ns_) {
    *acs_minus_bench_ns_ -=
        ns(max_drift * (bench_time_s - taken_s_)); // a slow ACS clock must not make everybody wait
  }
  acs_minus_bench_ns_ = std::max(acs_minus_bench_ns_.value_or(difference_ns), difference_ns);
  taken_s_ = bench_time_s;
  record_.forget_before(newest_ns - ns(kept_s));
}

double LevelMeter::part_at_range(std::size_t channel, const TimeInterval& window) const {
  const drivers::ChannelDescription& described = record_.description().channels[channel];
  if (!(described.maximum > described.minimum)) {
    return 0.0;
  }
  const double half = 0.5 * described.resolution;
  const auto stamps = record_.stamps_ns();
  const auto values = record_.column(channel);
  std::size_t all = 0, at_range = 0;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (stamps[i] >= window.begin_ns && stamps[i] <= window.end_ns) {
      ++all;
      at_range +=
          values[i] <= described.minimum + half || values[i] >= described.maximum - half ? 1 : 0;
    }
  }
  return all > 0 ? static_cast<double>(at_range) / static_cast<double>(all) : 0.0;
}

Expected<std::optional<double>> LevelMeter::level_after(double bench_time_s,
                                                        const analysis::Frequency& frequency,
                                                        double agreement_rel) const {
  const auto stamps = record_.stamps_ns();
  if (stamps.empty() || !acs_minus_bench_ns_ || !record_.described()) {
    return std::optional<double>{};
  }
  const auto channel = record_.channel(reference_.channel);
  if (!channel) {
    return std::optional<double>{};
  }
  const std::int64_t window_ns = ns(level_window_s(frequency.hz()));
  const std::int64_t begin_ns = stamps.back() - window_ns;
  if (begin_ns < ns(bench_time_s) + *acs_minus_bench_ns_ + ns(level_transport_s) ||
      record_.lost_in({begin_ns, stamps.back()}).all() > 0) {
    return std::optional<double>{};
  }
  if (const double part = part_at_range(*channel, {begin_ns, stamps.back()});
      part > max_part_at_range) {
    return fail(ErrorCode::device,
                fmt::format("{} is at an end of its range in {:.2g} % of its samples, so that it "
                            "shows less than there is; choose a wider range, or a lower level",
                            reference_.text(), 100.0 * part));
  }
  const std::int64_t middle_ns = begin_ns + window_ns / 2;
  const auto whole = level_in(record_, *channel, {begin_ns, stamps.back()}, frequency);
  const auto first = level_in(record_, *channel, {begin_ns, middle_ns - 1}, frequency);
  const auto second = level_in(record_, *channel, {middle_ns, stamps.back()}, frequency);
  if (!whole || !first || !second || std::abs(*second - *first) > agreement_rel * *whole) {
    return std::optional<double>{};
  }
  return whole;
}

} // namespace dyncal::services
