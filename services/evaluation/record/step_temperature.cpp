#include "services/evaluation/record/step_temperature.hpp"

#include <numeric>

#include "services/evaluation/record/step_samples.hpp"

namespace dyncal::inline evaluation {
namespace {

constexpr double zero_degc_in_kelvin = 273.15;

// What is added to a value of this unit; nothing when it is no temperature.
std::optional<double> offset_to_degc(const std::string& unit) {
  if (unit == R"(\degreecelsius)") {
    return 0.0;
  }
  return unit == R"(\kelvin)" ? std::optional(-zero_degc_in_kelvin) : std::nullopt;
}

} // namespace

std::optional<double> step_temperature_degc(const RunRecords& records, const ChannelName& channel,
                                            std::size_t step) {
  const auto interval = records.interval_in(channel.source, step);
  if (!interval) {
    return std::nullopt;
  }
  const SourceRecord& record = records.of(channel.source);
  const auto column = record.channel(channel.channel);
  if (!column) {
    return std::nullopt;
  }
  const auto offset = offset_to_degc(record.description().channels[*column].unit);
  const StepSamples samples = select_samples(record, *interval, {*column});
  const auto& values = samples.columns.front();
  if (!offset || values.empty()) {
    return std::nullopt;
  }
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size()) +
         *offset;
}

} // namespace dyncal::inline evaluation
