#include "services/evaluation/clock_report_builder.hpp"

#include <algorithm>
#include <limits>

namespace dyncal::inline evaluation {
namespace {

constexpr double max_distrusted_part = 0.2; // as where it is the cause that a step has no result

} // namespace

ClockReportBuilder::ClockReportBuilder(std::string source,
                                       const std::optional<ChannelName>& temperature)
    : source_(std::move(source)) {
  if (temperature && temperature->source == source_) {
    temperature_channel_ = temperature->channel;
  }
}

void ClockReportBuilder::describe(const drivers::SourceDescription& description) {
  if (clock_) {
    return;
  }
  const auto& channels = description.channels;
  const auto found =
      std::ranges::find(channels, temperature_channel_, &drivers::ChannelDescription::name);
  if (found != channels.end()) {
    temperature_column_ = static_cast<std::size_t>(found - channels.begin());
  }
  analysis::SampleClockSettings settings;
  settings.nominal_rate_hz = description.nominal_rate_hz;
  settings.tick_s = description.tick_s;
  settings.stamp_uncertainty_s = description.stamp_uncertainty_s;
  clock_.emplace(settings);
  has_own_clock_ = description.time_base == drivers::TimeBase::local;
  states_uncertainty_ = description.stamp_uncertainty_s > 0.0;
}

void ClockReportBuilder::add(const SourceBlock& block) {
  if (!clock_) {
    return;
  }
  last_block_ = BlockPosition{block.session, block.number};
  std::span<const std::int64_t> stamps = block.stamps_ns;
  if (stamps.empty()) {
    stamps_.resize(block.samples);
    for (std::size_t i = 0; i < block.samples; ++i) {
      stamps_[i] = block.clock.stamp_ns(block.first_sample + i);
    }
    stamps = stamps_;
  }
  std::span<const double> temperature;
  if (temperature_column_) {
    temperature = block.values.subspan(*temperature_column_ * block.samples, block.samples);
  }
  samples_ += block.samples;
  not_trusted_ += static_cast<std::uint64_t>(
      std::ranges::count_if(block.flags, [](std::uint8_t flag) { return flag != 0; }));
  clock_->push(block.first_sample, stamps, block.flags, temperature);
}

std::vector<ClockReport> ClockReportBuilder::reports(std::uint64_t lost) const {
  auto statistics = clock_ ? clock_->statistics() : std::nullopt;
  if (!statistics) {
    return {};
  }
  statistics->lost = lost;
  ClockReport report{source_, std::move(*statistics), {}, last_block_};
  if (has_own_clock_) {
    report.clock.u_mean_interval_s = std::numeric_limits<double>::quiet_NaN();
  }
  if (has_own_clock_ || !states_uncertainty_) {
    report.flags.push_back(make_flag(ResultFlag::clock_uncertainty_unknown));
  }
  if (report.clock.left_out_jumps > 0) {
    report.flags.push_back(make_flag(ResultFlag::clock_stepped));
  }
  if (static_cast<double>(not_trusted_) > max_distrusted_part * static_cast<double>(samples_)) {
    report.flags.push_back(make_flag(ResultFlag::stamps_not_trusted));
  }
  if (lost > 0) {
    report.flags.push_back(make_flag(ResultFlag::samples_lost));
  }
  return {std::move(report)};
}

} // namespace dyncal::inline evaluation
