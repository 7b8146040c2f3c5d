#include "services/evaluation/clock_report_builder.hpp"

#include <algorithm>

namespace dyncal::services {

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
      std::find_if(channels.begin(), channels.end(), [&](const drivers::ChannelDescription& one) {
        return one.name == temperature_channel_;
      });
  if (found != channels.end()) {
    temperature_column_ = static_cast<std::size_t>(found - channels.begin());
  }
  analysis::SampleClockSettings settings;
  settings.nominal_rate_hz = description.nominal_rate_hz;
  settings.tick_s = description.tick_s;
  settings.stamp_uncertainty_s = description.stamp_uncertainty_s;
  clock_.emplace(settings);
}

void ClockReportBuilder::add(const SourceBlock& block) {
  if (!clock_ || block.stamps_ns.empty()) {
    return;
  }
  std::span<const double> temperature;
  if (temperature_column_) {
    temperature = block.values.subspan(*temperature_column_ * block.samples, block.samples);
  }
  clock_->push(block.first_sample, block.stamps_ns, block.flags, temperature);
}

std::vector<ClockReport> ClockReportBuilder::reports(std::uint64_t lost) const {
  auto statistics = clock_ ? clock_->statistics() : std::nullopt;
  if (!statistics) {
    return {};
  }
  statistics->lost = lost;
  return {{source_, std::move(*statistics)}};
}

} // namespace dyncal::services
